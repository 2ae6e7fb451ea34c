"""Guard in front of all routes: checks the origin, the token and the size of each request."""

import asyncio
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qsl, quote, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.types import Message as AsgiMessage

from argo_compiler.base.errors import ArgoError, Unavailable
from argo_compiler.base.message import Message
from argo_planner.service.web.access import AccessToken, TokenBook, TokenMissing, identify_visitor
from argo_planner.service.web.problems import (
    Problem,
    TooLarge,
    plain_problem,
    problem_from_error,
    problem_response,
)
from argo_planner.service.web.upload_limits import (
    MOST_REQUESTS,
    PART_TIMEOUT,
    REQUEST_TIMEOUT,
    max_body_bytes,
)

LOOPBACK = ("localhost", "127.0.0.1", "[::1]")

_POLICY = (
    "default-src 'self'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; "
    "form-action 'none'; frame-ancestors 'none'"
)
_HEADERS = {
    "content-security-policy": _POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
    "x-frame-options": "DENY",
}


@dataclass(frozen=True)
class GuardSettings:
    """Allowed hosts and origins of requests, and the name of the cookie."""

    hosts: frozenset[str]
    """accepted values of the header `Host`, without ports; `*`: any"""
    origins: frozenset[str] = frozenset()
    """further accepted origins of pages, such as that of a proxy: `https://argo.example.org`"""
    cookie: str = "argo"
    """name of the cookie; should differ by port, as browsers share cookies between ports"""


class Guard:
    """ASGI application that passes valid requests on to another one, and refuses all others.

    A valid request has a known token, an allowed host and origin, and a body of limited size.
    """

    def __init__(self, app: ASGIApp, tokens: TokenBook, settings: GuardSettings) -> None:
        self._app = app
        self._tokens = tokens
        self._settings = settings
        self._under_way: Counter[str] = Counter()
        """requests and pages under way, by the key of their token"""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refused = self._check_origin(scope, headers)
        if refused is None:
            token, in_address = self._find_token(scope, headers)
            if token is None:
                refused = problem_from_error(
                    TokenMissing(
                        Message(
                            "the token is missing or unknown: open the address that the service "
                            "printed when it started, or send `Authorization: Bearer TOKEN`"
                        )
                    )
                )
            elif in_address:
                await self._redirect_with_cookie(scope, token)(scope, receive, send)
                return
            else:
                try:
                    scope["visitor"] = identify_visitor(token, headers, _parse_query(scope))
                except ArgoError as error:
                    refused = problem_from_error(error)
        if refused is None:
            refused = _check_content_length(scope, headers)
        if refused is None and self._under_way[scope["visitor"].key] >= MOST_REQUESTS:
            refused = problem_from_error(
                Unavailable(
                    Message(
                        "{most_requests} requests with this token are under way: try again when "
                        "some of them have ended",
                        most_requests=MOST_REQUESTS,
                    )
                )
            )
        if refused is not None:
            await _refuse(refused, scope, receive, send)
            return
        key = scope["visitor"].key
        self._under_way[key] += 1
        try:
            await self._pass_on(scope, receive, send)
        finally:
            self._under_way[key] -= 1

    async def _pass_on(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let the application answer a request, within the limits of its size and time."""
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
            return
        body = _LimitedBody(scope, receive)
        refused: Problem | None = None
        try:
            async with asyncio.timeout(REQUEST_TIMEOUT) as limit:
                await self._app(scope, body.receive, _add_headers(scope, body.wrap_send(send)))
        except TimeoutError:
            if not limit.expired():  # an error of the application
                raise
            late = Message(
                "the request was not answered within {request_timeout:.0f} s: try again later",
                request_timeout=REQUEST_TIMEOUT,
            )
            refused = None if body.answered else problem_from_error(Unavailable(late))
        if body.refusal is not None:
            refused = problem_from_error(body.refusal)
        if refused is not None:
            await _refuse(refused, scope, receive, send)

    def _check_origin(self, scope: Scope, headers: Headers) -> Problem | None:
        """Return a problem if the header Host, Origin or Sec-Fetch-Site is not allowed."""
        hosts = headers.getlist("host")
        name = hosts[0].rpartition(":")[0] if hosts and _has_port(hosts[0]) else "".join(hosts)
        if len(hosts) != 1 or not (
            "*" in self._settings.hosts or name.lower() in self._settings.hosts
        ):
            reason = Message(
                "the service does not accept this host name (`Host`): open the address "
                "that it printed when it started, or allow the name with `argo serve "
                "--allow-host`"
            )
            return plain_problem(HTTPStatus.FORBIDDEN, "foreign-host", reason)
        origin = headers.get("origin")
        if origin is not None and origin not in self._settings.origins:
            if origin.lower() not in (f"http://{hosts[0].lower()}", f"https://{hosts[0].lower()}"):
                reason = Message(
                    "pages of another origin may not use the service (`Origin`): allow the "
                    "address of a proxy with `argo serve --origin`"
                )
                return plain_problem(HTTPStatus.FORBIDDEN, "foreign-origin", reason)
        elif origin is None and headers.get("sec-fetch-site") in ("cross-site", "same-site"):
            safe = scope["type"] == "http" and scope["method"] == "GET"
            if not (safe and headers.get("sec-fetch-mode") == "navigate"):
                reason = Message("pages of another site may not use the service (`Sec-Fetch-Site`)")
                return plain_problem(HTTPStatus.FORBIDDEN, "foreign-origin", reason)
        return None

    def _find_token(self, scope: Scope, headers: Headers) -> tuple[AccessToken | None, bool]:
        """Return the request's token, and True if the address of a page states a token.

        The address of a page is one outside `/api/`; the token is its parameter `token`. The token
        is None if the request states none, or an unknown one.
        """
        kind, _, secret = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer":
            return self._tokens.find_by_secret(secret.strip()), False
        given = _parse_query(scope).get("token")
        if given is not None:
            page = scope["type"] == "http" and not scope["path"].startswith("/api/")
            return self._tokens.find_by_secret(given), page
        cookie = _read_cookie(headers, self._settings.cookie)
        return (None if cookie is None else self._tokens.find_by_cookie(cookie)), False

    def _redirect_with_cookie(self, scope: Scope, token: AccessToken) -> Response:
        """Return a redirection to the address without the token, which sets the cookie."""
        query = [(k, v) for k, v in parse_qsl(scope["query_string"].decode()) if k != "token"]
        path = "/" + quote(scope["path"].lstrip("/\\"))  # never to another host
        response = RedirectResponse(path + ("?" + urlencode(query) if query else ""), 303)
        secure = scope["scheme"] == "https"
        response.set_cookie(
            self._settings.cookie, token.cookie, httponly=True, samesite="strict", secure=secure
        )
        response.headers["cache-control"] = "no-store"
        return response


async def _refuse(problem: Problem, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "http":
        response = problem_response(problem, {"connection": "close"})
        response.headers.update(_HEADERS)
        if problem.status == HTTPStatus.UNAUTHORIZED:
            response.headers["www-authenticate"] = "Bearer"
        await response(scope, receive, send)
        return
    if "websocket.http.response" in scope.get("extensions", {}):
        response = problem_response(problem)
        await response(scope, receive, send)
        return
    await send({"type": "websocket.close", "code": 1008, "reason": problem.code})


def _check_content_length(scope: Scope, headers: Headers) -> Problem | None:
    """Return a problem if the header states a body that is too large."""
    stated = headers.get("content-length")
    if scope["type"] != "http" or stated is None:
        return None
    return (
        problem_from_error(_too_large(scope))
        if len(stated) > 12 or int(stated) > max_body_bytes(scope["path"])
        else None
    )


def _too_large(scope: Scope) -> TooLarge:
    megabytes = max_body_bytes(scope["path"]) // 1_000_000
    return TooLarge(
        Message(
            "the request has more than {megabytes} MB: send at most {megabytes} MB",
            megabytes=megabytes,
        )
    )


def _too_slow() -> ArgoError:
    return Unavailable(
        Message(
            "no part of the request's body arrived for {part_timeout:.0f} s: send it again",
            part_timeout=PART_TIMEOUT,
        )
    )


class _LimitedBody:
    """Reader of a request's body, which stops at the limit of its size, and if no part arrives.

    It does not rely on the header that states the size.
    """

    def __init__(self, scope: Scope, receive: Receive) -> None:
        self._scope, self._receive = scope, receive
        self._received = 0
        self._complete = False
        self.answered = False
        """whether a response has begun"""
        self.refusal: ArgoError | None = None
        """why the rest of the body was not read, unless a response had begun"""

    async def receive(self) -> AsgiMessage:
        try:
            # After the whole body, this waits until the client disconnects.
            async with asyncio.timeout(None if self._complete else PART_TIMEOUT):
                message = await self._receive()
        except TimeoutError:
            raise self._refused(_too_slow()) from None
        self._complete = not message.get("more_body", False)
        self._received += len(message.get("body", b""))
        if self._received > max_body_bytes(self._scope["path"]):
            raise self._refused(_too_large(self._scope))
        return message

    def _refused(self, error: ArgoError) -> ArgoError:
        """Return the error, and store it as the refusal unless a response has begun."""
        if not self.answered:
            self.refusal = error
        return error

    def wrap_send(self, send: Send) -> Send:
        """Return a function that sends a response, unless the body was refused.

        For such a body, the guard sends the response: the framework between it and the routes would
        answer that the request is bad, which is dropped here.
        """

        async def send_unless_refused(message: AsgiMessage) -> None:
            self.answered = True
            if self.refusal is None:
                await send(message)

        return send_unless_refused


def _add_headers(scope: Scope, send: Send) -> Send:
    """Return a function that sends a message with security headers added.

    Responses of the API that do not state how to cache them must not be cached.
    """
    api = scope["path"].startswith("/api/")

    async def send_with_headers(message: AsgiMessage) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
            if api and "cache-control" not in headers:
                headers["cache-control"] = "no-store"
        await send(message)

    return send_with_headers


def _has_port(host: str) -> bool:
    tail = host.rpartition(":")[2]
    return ":" in host and tail.isdigit()


def _parse_query(scope: Scope) -> Mapping[str, str]:
    return dict(parse_qsl(scope["query_string"].decode(errors="replace")))


def _read_cookie(headers: Headers, name: str) -> str | None:
    try:
        cookie = SimpleCookie(headers.get("cookie", "")).get(name)
    except CookieError:
        return None
    return cookie.value if cookie else None
