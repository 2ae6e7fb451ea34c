"""Live view of a run in Foxglove: a server of the topics that a recording has."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from threading import Lock, Thread
from typing import TYPE_CHECKING, Any, cast

from argo_compiler.base.errors import Unavailable, reason_text
from argo_compiler.base.extras import install_line
from argo_env.recording.files import require_libraries
from argo_env.recording.topic_writer import TopicWriter

if TYPE_CHECKING:  # packages of the extras
    import foxglove
    from foxglove.websocket import WebSocketServer

PORT = 8765
"""port that Foxglove connects to by default"""
HOST = "127.0.0.1"
"""address of the server: this machine only, because it accepts pages of any origin"""

_STOP_TIMEOUT = 1.0
"""time in s that clients have at the end to read the remaining messages"""


class LiveWriter(TopicWriter):
    """Writer that serves messages to viewers, which can't send anything.

    It holds the server and the last message of each topic, which a new subscriber gets first.
    """

    def __init__(self, server: "WebSocketServer", context: "foxglove.Context") -> None:
        super().__init__()
        self.server = server
        self._context = context
        self._lock = Lock()
        self._last: dict[int, tuple[foxglove.Channel, bytes, int]] = {}

    def resend_last_to_all(self, channel_id: int) -> None:
        """Send a channel's last message, if any, again to all its subscribers, as one is new."""
        with self._lock:
            last = self._last.get(channel_id)
        if last is not None:
            last[0].log(last[1], log_time=last[2])

    def _open_channel(self, topic: str, encoding: str, name: str, schema: bytes) -> None:
        import foxglove

        kind = "protobuf" if encoding == "protobuf" else "jsonschema"
        self._channels[topic] = foxglove.Channel(
            topic,
            schema=foxglove.Schema(name=name, encoding=kind, data=schema),
            message_encoding=encoding,
            context=self._context,
        )

    def _write_message(self, topic: str, data: bytes, t: float) -> None:
        channel, time = self._channels[topic], round(t * 1e9)
        with self._lock:
            self._last[channel.id()] = channel, data, time
        channel.log(data, log_time=time)


class _SubscriptionListener:
    """Listener of the server that sends new subscribers the last message of the topic."""

    def __init__(self) -> None:
        self.writer: LiveWriter | None = None

    def on_subscribe(self, client: Any, channel: Any) -> None:  # noqa: ARG002
        if self.writer is not None:
            self.writer.resend_last_to_all(channel.id)

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Do nothing."""


def require_foxglove() -> None:
    """Raise Unavailable if an extra that a live view needs is not installed."""
    if find_spec("foxglove") is None:
        raise Unavailable(f"a live view needs foxglove: {install_line('foxglove')}")
    require_libraries()


@contextmanager
def serve_live(port: int = PORT) -> Iterator[LiveWriter]:
    """Serve a live view on this machine, and yield its writer for a `RunRecorder`.

    The view is read-only. Port 0 means a free port. Raises Unavailable if an extra is missing or
    the port is taken.
    """
    require_foxglove()
    import foxglove

    context, listener = foxglove.Context(), _SubscriptionListener()
    try:
        server = foxglove.start_server(
            name="Argo",
            host=HOST,
            port=port,
            capabilities=[],
            server_listener=cast(Any, listener),
            context=context,
        )
    except (RuntimeError, OSError) as error:
        why = reason_text(error)
        raise Unavailable(f"{HOST}:{port}: no live view can be served there: {why}") from None
    listener.writer = writer = LiveWriter(server, context)
    try:
        yield writer
    finally:
        # `stop` waits for connected clients, even for those that read nothing.
        stopping = Thread(target=server.stop, daemon=True)
        stopping.start()
        stopping.join(_STOP_TIMEOUT)
