"""Addresses of clusters: whether anybody answers there, before a library waits for it."""

import socket
from urllib.parse import urlsplit

from argo_compiler.base.errors import Invalid, Unavailable

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
