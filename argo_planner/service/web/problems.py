"""Responses to errors of all kinds, in one form (RFC 9457)."""

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
from argo_compiler.base.extensions import package_failure
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, wording_field
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_planner.service.core.commands import Revision
from argo_planner.service.core.refusals import ChangedSince, EditRefused, StaleRevision
from argo_planner.service.web.access import AccessDenied, TokenMissing

_log = logging.getLogger(__name__)
PROBLEM_MEDIA_TYPE = "application/problem+json"
_MAX_DETAIL_LENGTH = 2_000  # characters of a message


class Problem(Model):
    """Reason why a request was refused. Nothing was changed."""

    status: int
    """status of the HTTP response"""
    code: str
    """kind of problem, for programs; it stays the same in later versions"""
    detail: Text
    """message for people, with the place and the remedy"""
    detail_wording: Wording | None = wording_field("detail")
    diagnostics: tuple[Diagnostic, ...] = ()
    remedies: tuple[str, ...] = ()
    place: int | None = None
    """index of the refused edit in its command, from 0"""
    newest: int | None = None
    """newest revision, if the request was made on an older one"""
    since: tuple[Revision, ...] | None = Field(default=None)
    """revisions since the one that the request was made on; null: not known, or not relevant"""


class RevisionMissing(ArgoError):
    """A request without the revision that it was made on."""

    code = "revision-missing"


class TooLarge(Invalid):
    """A request or an upload that exceeds the limit of its size."""

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


def problem_from_error(error: ArgoError) -> Problem:
    """Return the problem that describes an error of Argo, with its HTTP status."""
    status = next(status for kind, status in _STATUS if isinstance(error, kind))
    diagnostics: tuple[Diagnostic, ...] = ()
    if isinstance(error, DiagnosticError | EditRefused | ChangedSince):
        diagnostics = tuple(error.diagnostics[:100])
    remedies = [*error.remedies, *(r for diagnostic in diagnostics for r in diagnostic.remedies)]
    return Problem.model_construct(
        status=int(status),
        code=error.code,
        detail=_limited(str(error)),
        diagnostics=diagnostics,
        remedies=tuple(dict.fromkeys(map(str, remedies))),
        place=error.place if isinstance(error, EditRefused) else None,
        newest=error.newest if isinstance(error, StaleRevision) else None,
        since=error.since if isinstance(error, StaleRevision) else None,
    )


def _limited(detail: str) -> str:
    return detail if len(detail) <= _MAX_DETAIL_LENGTH else detail[:_MAX_DETAIL_LENGTH]


def problem_response(problem: Problem, headers: dict[str, str] | None = None) -> Response:
    """Return the response that sends a problem."""
    body = problem.model_dump_json().encode(errors="replace")
    return Response(body, problem.status, headers, PROBLEM_MEDIA_TYPE)


def plain_problem(status: HTTPStatus | int, code: str, detail: str) -> Problem:
    """Return a problem without diagnostics and remedies."""
    return Problem.model_construct(
        status=int(status),
        code=code,
        detail=_limited(detail),
        diagnostics=(),
        remedies=(),
    )


def install_problem_handlers(app: FastAPI) -> None:
    """Make an app answer all errors, also those that are defects, with a `Problem`."""

    async def handle_argo_error(_: Request, error: Exception) -> Response:
        assert isinstance(error, ArgoError)
        return problem_response(problem_from_error(error))

    async def handle_invalid_request(_: Request, error: Exception) -> Response:
        assert isinstance(error, RequestValidationError)
        return problem_response(_invalid(error))

    async def handle_invalid_socket(socket: WebSocket, error: Exception) -> None:
        assert isinstance(error, WebSocketRequestValidationError)
        await socket.send_denial_response(problem_response(_invalid(error)))

    async def handle_http_error(request: Request, error: Exception) -> Response:
        assert isinstance(error, HTTPException)
        code = {404: "not-found", 405: "method-not-allowed"}.get(error.status_code, "invalid")
        headers = dict(error.headers or {})
        if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
            headers["allow"] = ", ".join(_allowed_methods(request))
        return problem_response(plain_problem(error.status_code, code, str(error.detail)), headers)

    async def handle_defect(_: Request, error: Exception) -> Response:
        if (failure := package_failure(error)) is not None:
            _log.error("%s", failure, exc_info=error)
            return problem_response(problem_from_error(failure))
        _log.error("a defect of Argo", exc_info=error)
        detail = Message(
            "this is a defect of Argo: please report it with the traceback in the service's log"
        )
        return problem_response(plain_problem(HTTPStatus.INTERNAL_SERVER_ERROR, "defect", detail))

    handlers: dict[Any, Callable[[Request, Exception], Awaitable[Response]]] = {
        ArgoError: handle_argo_error,
        RequestValidationError: handle_invalid_request,
        HTTPException: handle_http_error,
        Exception: handle_defect,
    }
    for kind, handler in handlers.items():
        app.add_exception_handler(kind, handler)
    app.add_exception_handler(WebSocketRequestValidationError, handle_invalid_socket)


def _allowed_methods(request: Request) -> list[str]:
    """Return the HTTP methods of a request's address, by the OpenAPI document."""
    path = request.scope["path"]
    return [
        method.upper()
        for known, operations in request.app.openapi()["paths"].items()
        if re.fullmatch(re.sub(r"\\{.*?\\}", "[^/]+", re.escape(known)), path)
        for method in operations
    ]


def _invalid(error: ValidationException) -> Problem:
    """Return the problem of an invalid request, with its first error and the place of that."""
    faults = error.errors()
    fault = faults[0]
    place = ".".join(str(part) for part in fault["loc"])[:200]
    more = Message(" (and {count} more)", count=len(faults) - 1) if len(faults) > 1 else ""
    detail = f"{place}: {fault['msg']}{more}"
    return plain_problem(HTTPStatus.UNPROCESSABLE_ENTITY, "invalid", detail)


_NEW_PHRASES = {413: "Content Too Large", 422: "Unprocessable Content"}
"""phrases that Python has only since 3.13"""


def problem_responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """Return the descriptions of the error responses with these statuses, for OpenAPI."""
    return {
        status: {
            "model": Problem,
            "description": _NEW_PHRASES.get(status) or HTTPStatus(status).phrase,
        }
        for status in statuses
    }
