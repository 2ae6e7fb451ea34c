"""What went wrong, as one answer (RFC 9457), whatever it was."""

import logging
import re
from collections.abc import Awaitable, Callable
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request, Response, WebSocket
from fastapi.exceptions import (
    RequestValidationError,
    ValidationException,
    WebSocketRequestValidationError,
)
from pydantic import Field
from starlette.exceptions import HTTPException

from argo_compiler.base.errors import (
    ArgoError,
    Conflict,
    Invalid,
    NotFound,
    Unavailable,
    Unreachable,
)
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.refusals import ChangedSince, EditRefused, StaleRevision
from argo_planner.service.web.access import AccessDenied, TokenMissing

_log = logging.getLogger(__name__)
MEDIA = "application/problem+json"
_LONGEST = 2_000  # characters of a message


class Problem(Model):
    """Why a request was refused. Nothing was changed."""

    status: int
    """of the HTTP answer"""
    code: str
    """the kind, for programs; stable"""
    detail: str
    """for people: the thing, the place and the way out"""
    diagnostics: tuple[Diagnostic, ...] = ()
    remedies: tuple[str, ...] = ()
    place: int | None = None
    """of the edit that was refused, in its command, from 0"""
    newest: int | None = None
    """with a stale revision: the newest one"""
    since: tuple[Revision, ...] | None = Field(default=None)
    """with a stale revision: what was done since; null: that is not known any more"""


class RevisionMissing(ArgoError):
    """A command says not on which revision it was made."""

    code = "revision-missing"


class TooLarge(Invalid):
    """More was sent than is taken."""

    code = "too-large"


_STATUS: tuple[tuple[type[ArgoError], HTTPStatus], ...] = (
    (TokenMissing, HTTPStatus.UNAUTHORIZED),
    (AccessDenied, HTTPStatus.FORBIDDEN),
    (RevisionMissing, HTTPStatus.PRECONDITION_REQUIRED),
    (StaleRevision, HTTPStatus.PRECONDITION_FAILED),
    (TooLarge, HTTPStatus.REQUEST_ENTITY_TOO_LARGE),
    (EditRefused, HTTPStatus.CONFLICT),
    (NotFound, HTTPStatus.NOT_FOUND),
    (Conflict, HTTPStatus.CONFLICT),
    (Unavailable, HTTPStatus.SERVICE_UNAVAILABLE),
    (Unreachable, HTTPStatus.UNPROCESSABLE_ENTITY),
    (Invalid, HTTPStatus.UNPROCESSABLE_ENTITY),
    (ArgoError, HTTPStatus.UNPROCESSABLE_ENTITY),
)


def problem_of(error: ArgoError) -> Problem:
    """The answer to an error of Argo."""
    status = next(status for kind, status in _STATUS if isinstance(error, kind))
    diagnostics: tuple[Diagnostic, ...] = ()
    if isinstance(error, DiagnosticError | EditRefused | ChangedSince):
        diagnostics = tuple(error.diagnostics[:100])
    remedies = [*error.remedies, *(one for found in diagnostics for one in found.remedies)]
    return Problem.model_construct(
        status=int(status),
        code=error.code,
        detail=str(error)[:_LONGEST],
        diagnostics=diagnostics,
        remedies=tuple(dict.fromkeys(map(str, remedies))),
        place=error.place if isinstance(error, EditRefused) else None,
        newest=error.newest if isinstance(error, StaleRevision) else None,
        since=error.since if isinstance(error, StaleRevision) else None,
    )


def answer(problem: Problem, headers: dict[str, str] | None = None) -> Response:
    """A problem as a response."""
    body = problem.model_dump_json().encode(errors="replace")
    return Response(body, problem.status, headers, MEDIA)


def plain(status: HTTPStatus | int, code: str, detail: str) -> Problem:
    """A problem that has nothing but words."""
    return Problem.model_construct(
        status=int(status), code=code, detail=detail[:_LONGEST], diagnostics=(), remedies=()
    )


def answer_problems(app: FastAPI) -> None:
    """Lets the app answer all that goes wrong with a `Problem`."""

    async def of_argo(_: Request, error: Exception) -> Response:
        assert isinstance(error, ArgoError)
        return answer(problem_of(error))

    async def of_request(_: Request, error: Exception) -> Response:
        assert isinstance(error, RequestValidationError)
        return answer(plain(HTTPStatus.UNPROCESSABLE_ENTITY, "invalid", _first(error)))

    async def of_socket(socket: WebSocket, error: Exception) -> None:
        assert isinstance(error, WebSocketRequestValidationError)
        said = plain(HTTPStatus.UNPROCESSABLE_ENTITY, "invalid", _first(error))
        await socket.send_denial_response(answer(said))

    async def of_http(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        code = {404: "not-found", 405: "method-not-allowed"}.get(error.status_code, "invalid")
        headers = dict(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers["allow"] = ", ".join(_methods(request))
        return answer(plain(error.status_code, code, str(error.detail)), headers)

    async def of_defect(_: Request, error: Exception) -> Response:
        _log.error("a defect of Argo", exc_info=error)
        said = "this is a defect of Argo; the service's log has more"
        return answer(plain(HTTPStatus.INTERNAL_SERVER_ERROR, "defect", said))

    handlers: dict[Any, Callable[[Request, Exception], Awaitable[Response]]] = {
        ArgoError: of_argo,
        RequestValidationError: of_request,
        HTTPException: of_http,
        Exception: of_defect,
    }
    for kind, handler in handlers.items():
        app.add_exception_handler(kind, handler)
    app.add_exception_handler(WebSocketRequestValidationError, of_socket)


def _methods(request: Request) -> list[str]:
    """What can be asked of an address."""
    path = request.scope["path"]
    return [
        method.upper()
        for known, operations in request.app.openapi()["paths"].items()
        if re.fullmatch(re.sub(r"\\{.*?\\}", "[^/]+", re.escape(known)), path)
        for method in operations
    ]


def _first(error: ValidationException) -> str:
    """What is wrong with a request, in one sentence with the place."""
    faults = error.errors()
    fault = faults[0]
    place = ".".join(str(part) for part in fault["loc"])[:200]
    more = f" (and {len(faults) - 1} more)" if len(faults) > 1 else ""
    return f"{place}: {fault['msg']}{more}"


def documented(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Which problems a request may be answered with, for the OpenAPI document."""
    return {
        status: {"model": Problem, "description": HTTPStatus(status).phrase} for status in statuses
    }
