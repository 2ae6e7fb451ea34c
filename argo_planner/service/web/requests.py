"""What all routes share: who asks, of what service, on which revision; and how answers are made."""

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
from argo_compiler.base.model import Model
from argo_env.planning.opening import OpenedSite
from argo_planner.service.evaluations.evaluations import Evaluations
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_searches import OrderSearches
from argo_planner.service.rooms.rooms import PlanRooms
from argo_planner.service.runs.host import RunHost
from argo_planner.service.storage.folder import PLAN_ID
from argo_planner.service.web.access import AccessRole, Visitor
from argo_planner.service.web.problems import RevisionMissing, documented
from argo_planner.service.world.kept import KeptObstacles

JSON = "application/json"
# A report is one file, with its styles and pictures in it; it runs nothing and loads nothing.
REPORT_POLICY = {
    "content-security-policy": "default-src 'none'; style-src 'unsafe-inline'; img-src data:; "
    "frame-ancestors 'none'"
}
T = TypeVar("T")


@dataclass(frozen=True)
class PlanningService:
    """What the routes stand on."""

    site: OpenedSite
    folder: FilePath
    rooms: PlanRooms
    jobs: Jobs
    orders: OrderSearches
    evaluations: Evaluations
    runs: RunHost
    obstacles: KeptObstacles
    site_thread: Executor
    """one thread, as a site is used by one at a time"""

    async def on_site(self, work: Callable[..., T], *arguments: Any) -> T:
        """What comes of work on the site, which may take long."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self.site_thread, partial(work, *arguments))


class NameGiven(Model):
    """A name for something."""

    name: str = Field(max_length=1_000)


def service_of(request: Request) -> PlanningService:
    """The service that a request is for."""
    service: PlanningService = request.app.state.service
    return service


def visitor_of(request: Request) -> Visitor:
    """Who has sent a request."""
    found: Visitor = request.scope["visitor"]
    return found


def _who_may(role: AccessRole) -> Any:
    def found(request: Request) -> Visitor:
        visitor = visitor_of(request)
        visitor.require(role)
        return visitor

    return Depends(found)


Service = Annotated[PlanningService, Depends(service_of)]
Viewer = Annotated[Visitor, _who_may(AccessRole.VIEW)]
Planner = Annotated[Visitor, _who_may(AccessRole.PLAN)]
Operator = Annotated[Visitor, _who_may(AccessRole.OPERATE)]
PlanId = Annotated[str, Path(pattern=f"^{PLAN_ID}$", description="id of the mission")]

# The guard looks at these before any route; here they are for the document.
KEYS = [
    Depends(HTTPBearer(auto_error=False, description="a token of the service")),
    Depends(APIKeyCookie(name="argo", auto_error=False, description="set by the page's address")),
]


def routes(*tags: str, prefix: str = "/api") -> APIRouter:
    """A router for a part of what the service offers."""
    problems = documented(400, 401, 403, 404, 409, 413, 422, 503)
    return APIRouter(prefix=prefix, tags=[*tags], dependencies=KEYS, responses=problems)


def answers_file(what: str, *media: str) -> dict[str, Any]:
    """What the OpenAPI document says of a route that answers with a file."""
    content = {one: {"schema": {"type": "string", "format": "binary"}} for one in media}
    told = {200: {"description": what, "content": content}}
    return {"response_class": Response, "responses": told}


def _made_on(
    if_match: Annotated[
        str | None,
        Header(
            alias="If-Match",
            description='the revision that the request was made on, as `"12"`, or `*` for '
            "whichever there is; without it the answer is 428",
        ),
    ] = None,
) -> int | None:
    if if_match is None:
        raise RevisionMissing(
            'say on which revision this was made: `If-Match: "12"`, as the ETag of the mission has '
            "it, or `If-Match: *`"
        )
    if if_match.strip() == "*":
        return None
    if not (found := re.fullmatch(r'\s*"(\d{1,12})"\s*', if_match, re.ASCII)):
        raise Invalid(f'`If-Match: {if_match[:40]}` is no revision: write it as `"12"`')
    return int(found[1])


MadeOn = Annotated[int | None, Depends(_made_on)]


def said(
    model: Model, status: int = 200, revision: int | None = None, location: str | None = None
) -> Response:
    """A model as an answer, with its revision as ETag. It is not checked once more."""
    headers: dict[str, str] = {}
    if revision is not None:
        headers["etag"] = f'"{revision}"'
    if location is not None:
        headers["location"] = location
    return Response(model.model_dump_json(), status, headers, JSON)


def created(model: Mapping[str, Any] | type[Model], links: Mapping[str, Any]) -> dict[str, Any]:
    """What the OpenAPI document says of an answer that something was made, with its links."""
    return {"model": model, "description": "Created", "links": links, "headers": _LOCATION}


_LOCATION = {"Location": {"description": "where it is", "schema": {"type": "string"}}}


def link(operation: str, **parameters: str) -> dict[str, Any]:
    """A link of the OpenAPI document: parameters of another operation that the answer has."""
    return {"operationId": operation, "parameters": parameters}


def links(*operations: str, **parameters: str) -> dict[str, dict[str, Any]]:
    """Return links to operations that take the same parameters, by their names."""
    return {name: link(name, **parameters) for name in operations}
