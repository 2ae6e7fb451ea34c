"""The web application with all its routes, and its OpenAPI document."""

import json
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from functools import partial
from typing import Any

from fastapi import APIRouter, FastAPI, Response

from argo_compiler.base.extensions import InstalledExtension
from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_planner.service.rooms.messages import RoomMessage
from argo_planner.service.runs.state import RunMessage
from argo_planner.service.web import (
    commands,
    drafts,
    durations,
    evaluations,
    examples,
    faults,
    jobs,
    live,
    missions,
    page,
    runs,
    versions,
    world,
)
from argo_planner.service.web.access import AccessRole
from argo_planner.service.web.problems import (
    PROBLEM_MEDIA_TYPE,
    install_problem_handlers,
    problem_responses,
)
from argo_planner.service.web.requests import (
    AUTHENTICATION,
    PlanningService,
    Service,
    Viewer,
    json_response,
)

OpenService = Callable[[], AbstractAsyncContextManager[PlanningService]]
"""function that returns a context manager, which opens the service and closes it at the end"""

router = APIRouter(
    prefix="/api",
    tags=["service"],
    dependencies=AUTHENTICATION,
    responses=problem_responses(401, 403),
)


class ServiceSummary(Model):
    """Version and site of the service, and the identity of the client."""

    argo: str
    """version of Argo"""
    site: str
    author: str
    named: bool
    """whether the author's name comes from the token; the client then can't choose it"""
    role: AccessRole
    extensions: tuple[InstalledExtension, ...]
    """what installed packages offer and can be used, such as sensors and formats"""


@router.get("/service", operation_id="read_service", response_model=ServiceSummary)
async def read_service(service: Service, visitor: Viewer) -> Response:
    """Return the version and the site of the service, and the client's name and role."""
    return json_response(
        ServiceSummary(
            argo=__version__,
            site=service.site.name,
            author=visitor.author,
            named=visitor.named,
            role=visitor.role,
            extensions=service.extensions,
        )
    )


webhooks = APIRouter()
"""messages over WebSockets, for the OpenAPI document: each socket is described as a webhook whose
response is one of its messages"""


@webhooks.get("mission", operation_id="mission_told", response_model=RoomMessage)
def mission_message() -> None:
    """Describe what the service sends on `/api/missions/{id}/live`, only for OpenAPI."""


@webhooks.get("robot", operation_id="robot_told", response_model=RunMessage)
def robot_message() -> None:
    """Describe what the service sends on `/api/robot/live`, for the OpenAPI document only."""


def make_app(open_service: OpenService) -> FastAPI:
    """Return the application with all routes, but without the guard that checks tokens."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with open_service() as service:
            app.state.service = service
            yield

    app = FastAPI(
        title="Argo planning service",
        version=__version__,
        description="Plans inspection missions for one robot; many people can edit them at once.",
        lifespan=lifespan,
        openapi_url="/api/openapi.json",
        docs_url=None,
        redoc_url=None,
        swagger_ui_oauth2_redirect_url=None,
        webhooks=webhooks,
    )
    install_problem_handlers(app)
    app.openapi = partial(_make_document, app)  # type: ignore[method-assign]
    parts = (
        page, missions, drafts, versions, commands, jobs, evaluations, world, runs, live,
        durations, examples, faults,
    )  # fmt: skip
    for part in (router, *(one.router for one in parts), runs.socket_router):
        app.include_router(part)
    return app


def _make_document(app: FastAPI) -> dict[str, Any]:
    """Return the OpenAPI document, with the media type of problems for all error responses."""
    if app.openapi_schema is None:
        document = FastAPI.openapi(app)
        for path in document["paths"].values():
            for operation in path.values():
                for status, response in operation["responses"].items():
                    if status >= "400":
                        content = response["content"]["application/json"]
                        response["content"] = {PROBLEM_MEDIA_TYPE: content}
    assert app.openapi_schema is not None
    return app.openapi_schema


def openapi_document() -> str:
    """Return the OpenAPI document as JSON."""

    def open_nothing() -> AbstractAsyncContextManager[PlanningService]:
        raise AssertionError("the document needs no service")

    return json.dumps(make_app(open_nothing).openapi(), indent=1, ensure_ascii=False) + "\n"
