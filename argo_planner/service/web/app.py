"""The app: all routes, which stand behind the guard."""

import json
from collections.abc import AsyncIterator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from functools import partial
from typing import Any

from fastapi import APIRouter, FastAPI, Response

from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_planner.service.rooms.messages import RoomMessage
from argo_planner.service.runs.state import RunMessage
from argo_planner.service.web import (
    commands,
    evaluations,
    jobs,
    live,
    missions,
    page,
    runs,
    versions,
    world,
)
from argo_planner.service.web.access import AccessRole
from argo_planner.service.web.problems import MEDIA, answer_problems, documented
from argo_planner.service.web.requests import KEYS, PlanningService, Service, Viewer, said

Opened = Callable[[], AbstractAsyncContextManager[PlanningService]]
"""opens the service when the app begins, and closes it when it ends"""

router = APIRouter(
    prefix="/api", tags=["service"], dependencies=KEYS, responses=documented(401, 403)
)


class ServiceSummary(Model):
    """What the service is, and who asks."""

    argo: str
    """its version"""
    site: str
    author: str
    named: bool
    """whether the token says who asks, whatever they say themselves"""
    role: AccessRole


@router.get("/service", operation_id="read_service", response_model=ServiceSummary)
async def read_service(service: Service, visitor: Viewer) -> Response:
    """What the service is, and what whoever asks may do."""
    return said(
        ServiceSummary(
            argo=__version__,
            site=service.site.name,
            author=visitor.author,
            named=visitor.named,
            role=visitor.role,
        )
    )


webhooks = APIRouter()
"""what is told over WebSockets, for the OpenAPI document: each socket as a webhook of its own,
whose answer is one of its messages"""


@webhooks.get("mission", operation_id="mission_told", response_model=RoomMessage)
def mission_told() -> None:
    """What `/api/missions/{id}/live` sends, message by message."""


@webhooks.get("robot", operation_id="robot_told", response_model=RunMessage)
def robot_told() -> None:
    """What `/api/robot/live` sends, message by message."""


def make_app(opened: Opened) -> FastAPI:
    """The app without its guard, as the OpenAPI document is made from it."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with opened() as service:
            app.state.service = service
            yield

    app = FastAPI(
        title="Argo planning service",
        version=__version__,
        description="Plans inspection missions for one robot: many people at once, one authority.",
        lifespan=lifespan,
        openapi_url="/api/openapi.json",
        docs_url=None,
        redoc_url=None,
        swagger_ui_oauth2_redirect_url=None,
        webhooks=webhooks,
    )
    answer_problems(app)
    app.openapi = partial(_document_of, app)  # type: ignore[method-assign]
    parts = (
        page, missions, versions, commands, jobs, evaluations, world, runs, live,
    )  # fmt: skip
    for part in (router, *(one.router for one in parts), runs.socket_router):
        app.include_router(part)
    return app


def _document_of(app: FastAPI) -> dict[str, Any]:
    """The OpenAPI document, in which problems have the media type that they are answered with."""
    if app.openapi_schema is None:
        made = FastAPI.openapi(app)
        for path in made["paths"].values():
            for operation in path.values():
                for status, told in operation["responses"].items():
                    if status >= "400":
                        told["content"] = {MEDIA: told["content"]["application/json"]}
    assert app.openapi_schema is not None
    return app.openapi_schema


def document() -> str:
    """The OpenAPI document as JSON."""

    def never() -> AbstractAsyncContextManager[PlanningService]:
        raise AssertionError("the document needs no service")

    return json.dumps(make_app(never).openapi(), indent=1, ensure_ascii=False) + "\n"
