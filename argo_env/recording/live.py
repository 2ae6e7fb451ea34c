"""A run live in Foxglove: the topics of a recording, served to those who look on."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any, cast

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.extras import install_line
from argo_env.recording.files import require_libraries
from argo_env.recording.topic_writer import TopicWriter

if TYPE_CHECKING:  # what the extras bring
    import foxglove
    from foxglove.websocket import WebSocketServer

PORT = 8765
"""where Foxglove looks by itself"""
HOST = "127.0.0.1"
"""this machine only: the server lets pages of any origin in"""

_PATIENCE = 1.0
"""s that clients have at the end to read what they were sent"""


class LiveWriter(TopicWriter):
    """Serves what a recorder writes. Holds the last message of each topic, which whoever begins to
    look at it gets first. Nobody can send anything."""

    def __init__(self, server: "WebSocketServer", context: "foxglove.Context") -> None:
        super().__init__()
        self.server = server
        self._context = context
        self._lock = Lock()
        self._last: dict[int, tuple[foxglove.Channel, bytes, int]] = {}

    def tell_again(self, channel: int) -> None:
        """Tells the last message of a channel once more, as somebody has begun to look at it."""
        with self._lock:
            known = self._last.get(channel)
        if known is not None:
            known[0].log(known[1], log_time=known[2])

    def _open(self, topic: str, encoding: str, name: str, schema: bytes) -> None:
        import foxglove

        kind = "protobuf" if encoding == "protobuf" else "jsonschema"
        self._channels[topic] = foxglove.Channel(
            topic,
            schema=foxglove.Schema(name=name, encoding=kind, data=schema),
            message_encoding=encoding,
            context=self._context,
        )

    def _tell(self, topic: str, data: bytes, t: float) -> None:
        channel, at = self._channels[topic], round(t * 1e9)
        with self._lock:
            self._last[channel.id()] = channel, data, at
        channel.log(data, log_time=at)


class _Latch:
    """Gives those who begin to look at a topic what was told last."""

    def __init__(self) -> None:
        self.writer: LiveWriter | None = None

    def on_subscribe(self, client: Any, channel: Any) -> None:  # noqa: ARG002
        if self.writer is not None:
            self.writer.tell_again(channel.id)

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Nothing changes."""


def require_foxglove() -> None:
    """Raises Unavailable if an extra that this needs isn't installed."""
    if find_spec("foxglove") is None:
        raise Unavailable(f"a live view needs foxglove: {install_line('foxglove')}")
    require_libraries()


@contextmanager
def served_live(port: int = PORT) -> Iterator[LiveWriter]:
    """A writer for a `RunRecorder` that Foxglove shows live, on this machine at the port; 0: a free
    one. It is read only.

    Raises Unavailable if an extra is missing, or the port is taken.
    """
    require_foxglove()
    import foxglove

    context, latch = foxglove.Context(), _Latch()
    try:
        server = foxglove.start_server(
            name="Argo",
            host=HOST,
            port=port,
            capabilities=[],
            server_listener=cast(Any, latch),
            context=context,
        )
    except (RuntimeError, OSError) as error:
        raise Unavailable(f"{HOST}:{port}: no live view can be served there: {error}") from None
    latch.writer = writer = LiveWriter(server, context)
    try:
        yield writer
    finally:
        # The library waits for clients that read nothing, for as long as they stay.
        stopping = Thread(target=server.stop, daemon=True)
        stopping.start()
        stopping.join(_PATIENCE)
