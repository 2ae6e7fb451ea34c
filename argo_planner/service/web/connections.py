"""Connections: how many there may be, and how long one may say nothing."""

import asyncio
import resource
from collections import OrderedDict
from typing import Any, ClassVar

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from argo_planner.service.web.upload_limits import MOST_OF_A_MESSAGE

MOST_CONNECTIONS = 2_000
FIRST_REQUEST_WITHIN = 10.0
"""s"""
_FULL = (
    b"HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/problem+json\r\n"
    b"retry-after: 10\r\nconnection: close\r\ncontent-length: %d\r\n\r\n%s"
)
_SAID = b'{"status":503,"code":"full","detail":"too many connections are open: try again later"}'


class LimitedProtocol(HttpToolsProtocol):
    """One connection. Those that have asked for nothing yet make room for others, and are closed
    after a while."""

    waiting: ClassVar[OrderedDict[asyncio.Transport, "LimitedProtocol"]] = OrderedDict()
    """those that have asked for nothing yet, the oldest first"""
    most: ClassVar[int] = MOST_CONNECTIONS
    _timeout: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Somebody has connected."""
        super().connection_made(transport)
        if len(self.connections) > self.most:
            oldest = next(iter(self.waiting.values()), self)
            oldest.refuse()
        if not transport.is_closing():
            self.waiting[transport] = self
            self._timeout = self.loop.call_later(FIRST_REQUEST_WITHIN, self.give_up)

    def on_headers_complete(self) -> None:
        """A request has come."""
        self._heard()
        super().on_headers_complete()

    def connection_lost(self, exc: Exception | None) -> None:
        """The connection has ended."""
        self._heard()
        super().connection_lost(exc)

    def give_up(self) -> None:
        """Closes the connection without a word: browsers open some in advance, and ask anew on
        another one where such a one is closed; an answer they would take for that of a request."""
        self._heard()
        self.transport.close()

    def refuse(self) -> None:
        """Closes the connection, with an answer for who still reads."""
        self._heard()
        self.transport.write(_FULL % (len(_SAID), _SAID))
        self.transport.close()

    def _heard(self) -> None:
        self.waiting.pop(self.transport, None)
        if self._timeout is not None:
            self._timeout.cancel()
            self._timeout = None


def raise_file_limit() -> None:
    """Lets the process have as many connections open as the system allows, up to what it takes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = 4 * MOST_CONNECTIONS
    most = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
    if soft != resource.RLIM_INFINITY and soft < most:
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, hard))


def server_options() -> dict[str, Any]:
    """How the server is set up: what it answers with is the same wherever it runs."""
    return {
        "http": LimitedProtocol,
        "ws": "websockets-sansio",
        "ws_max_size": MOST_OF_A_MESSAGE,
        "ws_per_message_deflate": False,
        "h11_max_incomplete_event_size": 65_536,
        "timeout_keep_alive": 30,
        "timeout_graceful_shutdown": 5,
        "server_header": False,
        "access_log": False,
        "log_config": None,
        "lifespan": "on",
    }
