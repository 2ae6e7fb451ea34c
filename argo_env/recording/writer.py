"""Writer of an .mcap file: topics, messages and attachments at simulated times."""

from collections.abc import Mapping
from pathlib import Path
from typing import IO, cast

from mcap.well_known import SchemaEncoding
from mcap.writer import CompressionType, Writer

from argo_env.recording.output import RecordingFile
from argo_env.recording.topic_writer import TopicWriter

FLUSH_PERIOD = 10.0
"""time in s of simulated time after which messages are on disk, whatever happens to the process"""


def nanoseconds(t: float) -> int:
    """Return a simulated time t (s, from the mission's start) in ns, the unit of recordings."""
    return round(t * 1e9)


class RecordingWriter(TopicWriter):
    """Writer of one file; it holds the open chunk and the channels, and must be closed."""

    def __init__(self, stream: RecordingFile) -> None:
        super().__init__()
        self._stream = stream
        self._latest = 0.0
        self._writer = Writer(
            cast(IO[bytes], stream),
            compression=CompressionType.ZSTD,
            enable_crcs=True,
            enable_data_crcs=True,
        )
        self._schemas: dict[str, int] = {}
        self._sequences: dict[str, int] = {}
        self._flushed = 0.0
        self._writer.start(profile="", library="argo")

    def attach(self, name: str, media_type: str, content: str | bytes, t: float = 0.0) -> None:
        """Add a file at the time t (s), after writing all messages so far to disk."""
        data = content.encode() if isinstance(content, str) else content
        self.flush(t)
        self._writer.add_attachment(nanoseconds(t), nanoseconds(t), name, media_type, data)
        self._mark_intact()

    def write_metadata(self, name: str, facts: Mapping[str, str]) -> None:
        """Add metadata to the recording under this name: texts by key."""
        self._writer.add_metadata(name, dict(facts))

    def flush_if_due(self, t: float) -> None:
        """Write all messages so far to disk if `FLUSH_PERIOD` has passed by the time t (s).

        The period is one of simulated time, so that equal runs give equal files.
        """
        if t >= self._flushed + FLUSH_PERIOD:
            self.flush(t)

    def flush(self, t: float) -> None:
        """Write all messages so far to disk; the next period begins at the present time t (s)."""
        self._flushed = t
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._mark_intact()

    def complete_without_closing(self) -> None:
        """Write the index, which completes the file."""
        self.flush(self._latest)
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _open_channel(self, topic: str, encoding: str, name: str, schema: bytes) -> None:
        if name not in self._schemas:
            kind = SchemaEncoding.Protobuf if encoding == "protobuf" else SchemaEncoding.JSONSchema
            self._schemas[name] = self._writer.register_schema(name, kind, schema)
        self._channels[topic] = self._writer.register_channel(topic, encoding, self._schemas[name])
        self._sequences[topic] = 0

    def _write_message(self, topic: str, data: bytes, t: float) -> None:
        time, size = nanoseconds(t), self._stream.tell()
        self._latest = max(self._latest, t)
        self._writer.add_message(self._channels[topic], time, data, time, self._sequences[topic])
        self._sequences[topic] += 1
        if self._stream.tell() > size:  # the message has filled a chunk, which is written whole
            self._mark_intact()

    def _mark_intact(self) -> None:
        self.readable_until = self._latest
        self._stream.mark_intact()


def media_type(path: Path) -> str:
    """Return the media type of a mission's source by its suffix, or that of any bytes."""
    return {".json": "application/json", ".txt": "text/plain"}.get(
        path.suffix.lower(), "application/octet-stream"
    )
