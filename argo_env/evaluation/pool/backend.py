"""The seam to what has the worker processes, and whether a cluster answers at an address."""

import socket
from collections.abc import Callable, Sequence
from typing import Any, Protocol
from urllib.parse import urlsplit

from argo_compiler.base.errors import Invalid, Unavailable


class WorkerDiedError(Exception):
    """The worker process ended before the call did; holds what is known of why."""

    def __init__(self, reason: str, killed: bool = False) -> None:
        """`killed`: somebody else has ended it, as far as that is known."""
        super().__init__(reason)
        self.killed = killed


class WorkerBackend(Protocol):
    """Has worker processes, and calls a function in them. What is called and what it is given and
    returns can be pickled."""

    name: str
    workers: int
    """how many calls are carried out at once"""
    names_the_dead: bool
    """whether a worker that dies tells which call it died of, and takes no other along"""

    def submit(self, call: Callable[[Any], Any], argument: Any) -> Any:
        """Hands the call to the workers; returns what stands for it."""

    def wait(self, calls: Sequence[Any]) -> Sequence[Any]:
        """Waits until some of these have ended, and returns those."""

    def result(self, call: Any) -> Any:
        """What a call that has ended has returned; raises what it raised, or WorkerDiedError."""

    def mend(self) -> None:
        """New workers in place of those that have died."""

    def close(self) -> None:
        """Ends the workers, whatever they do."""


_PATIENCE = 5.0  # s until somebody who listens has taken a connection


def require_listener(address: str, cluster: str) -> None:
    """Raises Invalid for what is no address of a `cluster`, such as `Ray`, Unavailable if nobody
    listens there."""
    try:
        parts = urlsplit(address if "://" in address else f"tcp://{address}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host = port = None
    if host is None or port is None:
        raise Invalid(f"`{address}` is no address of a {cluster} cluster: give host:port")
    try:
        socket.create_connection((host, port), timeout=_PATIENCE).close()
    except OSError as error:
        why = error.strerror or "no answer"
        raise Unavailable(f"no {cluster} cluster at {address}: {why}") from None
