"""Interface of the back ends that make worker processes, and a check of cluster addresses."""

import socket
from collections.abc import Callable, Sequence
from typing import Any, Protocol
from urllib.parse import urlsplit

from argo_compiler.base.errors import Invalid, Unavailable


class WorkerDiedError(Exception):
    """Raised when a worker process ended before its call did; the message is the known reason."""

    def __init__(self, reason: str, killed: bool = False) -> None:
        """Store the reason of the death, and whether another process is known to have killed it."""
        super().__init__(reason)
        self.killed = killed


class WorkerBackend(Protocol):
    """Back end that owns worker processes and calls functions in them.

    Functions, their arguments and their results must be picklable.
    """

    name: str
    workers: int
    """number of calls that are executed at once"""
    isolates_deaths: bool
    """whether a dying worker loses its own call only, so that the call is known"""

    def submit(self, function: Callable[[Any], Any], argument: Any) -> Any:
        """Send a call of the function to the workers, and return the handle of the call."""

    def wait(self, calls: Sequence[Any]) -> Sequence[Any]:
        """Wait until one or more of these calls have ended, and return the handles of those."""

    def result(self, call: Any) -> Any:
        """Return the result of a call that has ended; raise its exception, or WorkerDiedError."""

    def replace_dead_workers(self) -> None:
        """Start new workers in place of dead ones."""

    def close(self) -> None:
        """End the workers, whether or not they execute calls."""


_CONNECT_TIMEOUT = 5.0  # s


def require_listener(address: str, cluster: str) -> None:
    """Raise an error if no server listens at an address; `cluster` is its kind, such as `Ray`.

    Raises Invalid for a malformed address, Unavailable if no server listens there.
    """
    try:
        parts = urlsplit(address if "://" in address else f"tcp://{address}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if host is None or port is None:
        raise Invalid(f"`{address}` is not an address of a {cluster} cluster: give host:port")
    try:
        socket.create_connection((host, port), timeout=_CONNECT_TIMEOUT).close()
    except OSError as error:
        why = error.strerror or "no answer"
        raise Unavailable(f"no {cluster} cluster at {address}: {why}") from None
