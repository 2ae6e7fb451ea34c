"""Limits on the number of connections, and on the time until their first request."""

import asyncio
from collections import OrderedDict
from typing import Any, ClassVar

from uvicorn.protocols.http.httptools_impl import HttpToolsProtocol

from argo_compiler.base.operating_system import raise_open_file_limit
from argo_planner.service.web.upload_limits import MAX_MESSAGE_BYTES

MAX_CONNECTIONS = 2_000
FIRST_REQUEST_TIMEOUT = 10.0
"""in s"""
_FULL_HEAD = (
    b"HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/problem+json\r\n"
    b"retry-after: 10\r\nconnection: close\r\ncontent-length: %d\r\n\r\n%s"
)
_FULL_BODY = (
    b'{"status":503,"code":"full","detail":"too many connections are open: try again later"}'
)


class LimitedProtocol(HttpToolsProtocol):
    """Connection to a client.

    A connection without a request is closed after `FIRST_REQUEST_TIMEOUT`, or earlier, the oldest
    first, if there are more than `limit` connections. If all have sent a request, a new one is
    refused. Connections whose last request is answered are closed like those without one, after
    them.
    """

    waiting: ClassVar[OrderedDict[asyncio.Transport, "LimitedProtocol"]] = OrderedDict()
    """connections without a request so far, the oldest first"""
    idle: ClassVar[OrderedDict[asyncio.Transport, "LimitedProtocol"]] = OrderedDict()
    """connections whose requests are all answered, the one that has waited longest first"""
    limit: ClassVar[int] = MAX_CONNECTIONS
    _timeout: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for the first request; if there are too many connections, refuse one with 503.

        That is the one that has waited longest for its first request, or this one if none waits.
        """
        super().connection_made(transport)
        if len(self.connections) > self.limit:
            if self.idle and not self.waiting:
                next(iter(self.idle.values())).close_silently()
            else:
                next(iter(self.waiting.values()), self).refuse_connection()
        if not transport.is_closing():
            self.waiting[transport] = self
            self._timeout = self.loop.call_later(FIRST_REQUEST_TIMEOUT, self.close_silently)

    def on_headers_complete(self) -> None:
        """Stop waiting for the first request."""
        self._stop_waiting()
        super().on_headers_complete()

    def on_response_complete(self) -> None:
        """Note that the connection is idle, unless another request waits on it."""
        super().on_response_complete()
        if self.cycle.response_complete and not self.transport.is_closing():
            self.idle[self.transport] = self

    def connection_lost(self, exc: Exception | None) -> None:
        """Stop waiting for the first request of a connection that has ended."""
        self._stop_waiting()
        super().connection_lost(exc)

    def close_silently(self) -> None:
        """Close the connection without a response.

        Browsers open connections in advance. If one of them is closed they use another one, but
        they would take a response on it as that of their next request.
        """
        self._stop_waiting()
        self.transport.close()

    def refuse_connection(self) -> None:
        """Close the connection after a response with status 503."""
        self._stop_waiting()
        self.transport.write(_FULL_HEAD % (len(_FULL_BODY), _FULL_BODY))
        self.transport.close()

    def _stop_waiting(self) -> None:
        self.waiting.pop(self.transport, None)
        self.idle.pop(self.transport, None)
        if self._timeout is not None:
            self._timeout.cancel()
            self._timeout = None


def raise_file_limit_for_connections() -> None:
    """Raise the limit of open files to four per connection, as far as the hard limit allows."""
    raise_open_file_limit(4 * MAX_CONNECTIONS)


def server_options() -> dict[str, Any]:
    """Return the options of Uvicorn, the same for the command and for tests."""
    return {
        "http": LimitedProtocol,
        "ws": "websockets-sansio",
        "ws_max_size": MAX_MESSAGE_BYTES,
        "ws_per_message_deflate": False,
        "h11_max_incomplete_event_size": 65_536,
        "timeout_keep_alive": 30,
        "timeout_graceful_shutdown": 5,
        "server_header": False,
        "access_log": False,
        "log_config": None,
        "lifespan": "on",
    }
