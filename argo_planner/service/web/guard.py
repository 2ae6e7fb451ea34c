"""What stands before every request: who may come in, from where, and how much they may bring."""

from collections.abc import Mapping
from dataclasses import dataclass
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from urllib.parse import parse_qsl, quote, urlencode

from starlette.datastructures import Headers, MutableHeaders
from starlette.responses import RedirectResponse, Response
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from argo_compiler.base.errors import ArgoError
from argo_planner.service.web.access import AccessToken, TokenBook, TokenMissing, visitor
from argo_planner.service.web.problems import Problem, TooLarge, answer, plain, problem_of
from argo_planner.service.web.upload_limits import most_bytes

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
class Doors:
    """From where requests may come."""

    hosts: frozenset[str]
    """names under which the service is asked for, without ports; `*`: any"""
    origins: frozenset[str] = frozenset()
    """further origins of pages, such as that of a proxy: `https://argo.example.org`"""
    cookie: str = "argo"
    """name of the cookie, one for each port, as browsers don't tell ports apart"""


class Guard:
    """Lets requests in that have a token, and come from where they may; limits what they bring."""

    def __init__(self, app: ASGIApp, tokens: TokenBook, doors: Doors) -> None:
        self._app = app
        self._tokens = tokens
        self._doors = doors

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        refused = self._refused(scope, headers)
        if refused is None:
            token, entering = self._token(scope, headers)
            if token is None:
                refused = problem_of(
                    TokenMissing(
                        "no token was given, or an unknown one: open the address that the service "
                        "printed when it began, or send `Authorization: Bearer TOKEN`"
                    )
                )
            elif entering:
                await self._entered(scope, token)(scope, receive, send)
                return
            else:
                try:
                    scope["visitor"] = visitor(token, headers, _query(scope))
                except ArgoError as error:
                    refused = problem_of(error)
        if refused is None:
            refused = _too_large(scope, headers)
        if refused is not None:
            await _refuse(refused, scope, receive, send)
            return
        if scope["type"] == "websocket":
            await self._app(scope, receive, send)
        else:
            arriving = _Arriving(scope, receive)
            await self._app(scope, arriving.receive, _protected(scope, arriving.answered(send)))
            if arriving.too_large:
                await _refuse(problem_of(_too_much(scope)), scope, receive, send)

    def _refused(self, scope: Scope, headers: Headers) -> Problem | None:
        """Why a request from there is not let in, if it is not."""
        hosts = headers.getlist("host")
        name = hosts[0].rpartition(":")[0] if hosts and _has_port(hosts[0]) else "".join(hosts)
        if len(hosts) != 1 or not ("*" in self._doors.hosts or name.lower() in self._doors.hosts):
            said = "the service is not known under this name (`Host`)"
            return plain(HTTPStatus.FORBIDDEN, "foreign-host", said)
        origin = headers.get("origin")
        if origin is not None and origin not in self._doors.origins:
            if origin.lower() not in (f"http://{hosts[0].lower()}", f"https://{hosts[0].lower()}"):
                said = "pages of another origin may not use the service (`Origin`)"
                return plain(HTTPStatus.FORBIDDEN, "foreign-origin", said)
        elif origin is None and headers.get("sec-fetch-site") in ("cross-site", "same-site"):
            safe = scope["type"] == "http" and scope["method"] == "GET"
            if not (safe and headers.get("sec-fetch-mode") == "navigate"):
                said = "pages of another site may not use the service (`Sec-Fetch-Site`)"
                return plain(HTTPStatus.FORBIDDEN, "foreign-origin", said)
        return None

    def _token(self, scope: Scope, headers: Headers) -> tuple[AccessToken | None, bool]:
        """The token that was given, and whether it was in the address of a page."""
        kind, _, secret = headers.get("authorization", "").partition(" ")
        if kind.lower() == "bearer":
            return self._tokens.of_secret(secret.strip()), False
        given = _query(scope).get("token")
        if given is not None:
            page = scope["type"] == "http" and not scope["path"].startswith("/api/")
            return self._tokens.of_secret(given), page
        cookie = _cookie(headers, self._doors.cookie)
        return (None if cookie is None else self._tokens.of_cookie(cookie)), False

    def _entered(self, scope: Scope, token: AccessToken) -> Response:
        """Keeps the token in a cookie, and takes it out of the address."""
        query = [(k, v) for k, v in parse_qsl(scope["query_string"].decode()) if k != "token"]
        path = "/" + quote(scope["path"].lstrip("/\\"))  # never another host
        response = RedirectResponse(path + ("?" + urlencode(query) if query else ""), 303)
        secure = scope["scheme"] == "https"
        response.set_cookie(
            self._doors.cookie, token.cookie, httponly=True, samesite="strict", secure=secure
        )
        response.headers["cache-control"] = "no-store"
        return response


async def _refuse(problem: Problem, scope: Scope, receive: Receive, send: Send) -> None:
    if scope["type"] == "http":
        response = answer(problem, {"connection": "close"})
        response.headers.update(_HEADERS)
        if problem.status == HTTPStatus.UNAUTHORIZED:
            response.headers["www-authenticate"] = "Bearer"
        await response(scope, receive, send)
        return
    if "websocket.http.response" in scope.get("extensions", {}):
        response = answer(problem)
        await response(scope, receive, send)
        return
    await send({"type": "websocket.close", "code": 1008, "reason": problem.code})


def _too_large(scope: Scope, headers: Headers) -> Problem | None:
    said = headers.get("content-length")
    if scope["type"] != "http" or said is None:
        return None
    return (
        problem_of(_too_much(scope))
        if len(said) > 12 or int(said) > most_bytes(scope["path"])
        else None
    )


def _too_much(scope: Scope) -> TooLarge:
    return TooLarge(
        f"more than {most_bytes(scope['path']) // 1_000_000} MB were sent: that is not taken"
    )


class _Arriving:
    """A request's body as it arrives. Counts it: what is too large is no longer read, whatever was
    said of its size before."""

    def __init__(self, scope: Scope, receive: Receive) -> None:
        self._scope, self._receive = scope, receive
        self._arrived = 0
        self._begun = False
        self.too_large = False
        """and nothing has been answered yet"""

    async def receive(self) -> Message:
        message = await self._receive()
        self._arrived += len(message.get("body", b""))
        if self._arrived > most_bytes(self._scope["path"]):
            self.too_large = not self._begun
            raise _too_much(self._scope)
        return message

    def answered(self, send: Send) -> Send:
        """Sends an answer, unless it is one to a body that was too large: the frameworks between
        here and the routes call that a bad request."""

        async def sending(message: Message) -> None:
            self._begun = True
            if not self.too_large:
                await send(message)

        return sending


def _protected(scope: Scope, send: Send) -> Send:
    """Adds the headers that keep a page safe, and keeps what is told out of caches."""
    api = scope["path"].startswith("/api/")

    async def sending(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in _HEADERS.items():
                headers.setdefault(name, value)
            if api and "cache-control" not in headers:
                headers["cache-control"] = "no-store"
        await send(message)

    return sending


def _has_port(host: str) -> bool:
    tail = host.rpartition(":")[2]
    return ":" in host and tail.isdigit()


def _query(scope: Scope) -> Mapping[str, str]:
    return dict(parse_qsl(scope["query_string"].decode(errors="replace")))


def _cookie(headers: Headers, name: str) -> str | None:
    try:
        found = SimpleCookie(headers.get("cookie", "")).get(name)
    except CookieError:
        return None
    return found.value if found else None
