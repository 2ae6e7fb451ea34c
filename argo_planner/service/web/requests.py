"""Parts that all routes share: dependencies of requests, and responses."""

import asyncio
import re
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path as FilePath
from typing import Annotated, Any, TypeVar

from fastapi import APIRouter, Depends, Header, Path, Request, Response
from fastapi.security import APIKeyCookie, HTTPBearer
from pydantic import Field

from argo_compiler.base.errors import Invalid
from argo_compiler.base.extensions import InstalledExtension
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_env.planning.opening import OpenedSite
from argo_planner.service.drafts.drafts import Drafts
from argo_planner.service.evaluations.evaluations import Evaluations
from argo_planner.service.jobs.imports import Imports
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_searches import OrderSearches
from argo_planner.service.rooms.rooms import PlanRooms
from argo_planner.service.runs.host import RunHost
from argo_planner.service.storage.draft_folder import DRAFT_ID
from argo_planner.service.storage.folder import PLAN_ID
from argo_planner.service.web.access import AccessRole, Visitor
from argo_planner.service.web.problems import RevisionMissing, problem_responses
from argo_planner.service.world.obstacle_store import ObstacleStore

JSON = "application/json"
# A report is one file that contains its styles and pictures; it runs no script and loads nothing.
REPORT_POLICY = {
    "content-security-policy": "default-src 'none'; style-src 'unsafe-inline'; "
    "img-src data:; frame-ancestors 'none'"
}
T = TypeVar("T")


@dataclass(frozen=True)
class PlanningService:
    """Service that the routes call: a site, a folder of missions, and all that works on them."""

    site: OpenedSite
    folder: FilePath
    rooms: PlanRooms
    jobs: Jobs
    orders: OrderSearches
    imports: Imports
    """uploads"""
    scripts: Imports
    """scripts that people edit, which don't wait for uploads"""
    drafts: Drafts
    evaluations: Evaluations
    runs: RunHost
    obstacles: ObstacleStore
    extensions: tuple[InstalledExtension, ...]
    """what installed packages offer and can be used"""
    site_thread: Executor
    """executor with one thread, as a site is not safe for concurrent use"""

    async def run_on_site(self, work: Callable[..., T], *arguments: Any) -> T:
        """Call a function in the site's thread, after all earlier calls, and return its result."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self.site_thread, partial(work, *arguments))


class NameGiven(Model):
    """New name of a mission or a version."""

    name: str = Field(max_length=1_000)


def get_service(request: Request) -> PlanningService:
    """Return the service of the request's app."""
    service: PlanningService = request.app.state.service
    return service


def get_identified_visitor(request: Request) -> Visitor:
    """Return the sender of a request, whom the guard has identified."""
    visitor: Visitor = request.scope["visitor"]
    return visitor


def _visitor_with(role: AccessRole) -> Any:
    """Return a dependency: the visitor, whose role must include the given one."""

    def get_permitted_visitor(request: Request) -> Visitor:
        visitor = get_identified_visitor(request)
        visitor.require(role)
        return visitor

    return Depends(get_permitted_visitor)


Service = Annotated[PlanningService, Depends(get_service)]
Viewer = Annotated[Visitor, _visitor_with(AccessRole.VIEW)]
Planner = Annotated[Visitor, _visitor_with(AccessRole.PLAN)]
Operator = Annotated[Visitor, _visitor_with(AccessRole.OPERATE)]
PlanId = Annotated[str, Path(pattern=f"^{PLAN_ID}$", description="id of the mission")]
DraftId = Annotated[str, Path(pattern=f"^{DRAFT_ID}$", description="id of the draft")]

# The guard checks these before any route; here they only serve the OpenAPI document.
AUTHENTICATION = [
    Depends(HTTPBearer(auto_error=False, description="a token of the service")),
    Depends(APIKeyCookie(name="argo", auto_error=False, description="set by the page's address")),
]


def make_router(*tags: str, prefix: str = "/api") -> APIRouter:
    """Return a router whose routes document the authentication and the common problems."""
    problems = problem_responses(400, 401, 403, 404, 409, 413, 422, 503)
    return APIRouter(prefix=prefix, tags=[*tags], dependencies=AUTHENTICATION, responses=problems)


def file_route_arguments(description: str, *media: str) -> dict[str, Any]:
    """Return keyword arguments for a route that responds with a file of a type in `media`."""
    content = {one: {"schema": {"type": "string", "format": "binary"}} for one in media}
    responses = {200: {"description": description, "content": content}}
    return {"response_class": Response, "responses": responses}


def _parse_if_match(
    if_match: Annotated[
        str | None,
        Header(
            alias="If-Match",
            description='the revision that the request was made on, such as `"12"`, or `*` for '
            "any revision; without it the answer is 428",
        ),
    ] = None,
) -> int | None:
    if if_match is None:
        raise RevisionMissing(
            "the request does not state the revision that it was made on: send the ETag of the "
            'mission, as in `If-Match: "12"`, or `If-Match: *`'
        )
    if if_match.strip() == "*":
        return None
    if not (match := re.fullmatch(r'\s*"(\d{1,12})"\s*', if_match, re.ASCII)):
        raise Invalid(
            Message(
                '`If-Match: {if_match}` is not a revision: write it as `"12"`',
                if_match=if_match[:40],
            )
        )
    return int(match[1])


MadeOn = Annotated[int | None, Depends(_parse_if_match)]
"""revision that the request was made on; None: any"""


def json_response(
    model: Model, status: int = 200, revision: int | None = None, location: str | None = None
) -> Response:
    """Return a response with a model as JSON, and the given headers.

    `revision` is sent as ETag, `location` as Location; None: the header is left out. The model is
    not validated again.
    """
    headers: dict[str, str] = {}
    if revision is not None:
        headers["etag"] = f'"{revision}"'
    if location is not None:
        headers["location"] = location
    return Response(model.model_dump_json(), status, headers, JSON)


def created_response(
    model: Mapping[str, Any] | type[Model], links: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the OpenAPI description of a response after something was created or started.

    The response has `model` as body and the header Location; `links` lead to further operations.
    """
    return {"model": model, "description": "Created", "links": links, "headers": _LOCATION}


_LOCATION = {
    "Location": {
        "description": "address of what was created",
        "schema": {"type": "string"},
    }
}


def openapi_link(operation: str, **parameters: str) -> dict[str, Any]:
    """Return an OpenAPI link to an operation.

    The values of its parameters are expressions such as `$response.body#/id`.
    """
    return {"operationId": operation, "parameters": parameters}


def openapi_links(*operations: str, **parameters: str) -> dict[str, dict[str, Any]]:
    """Return OpenAPI links to several operations with the same parameters, by operation id."""
    return {name: openapi_link(name, **parameters) for name in operations}
