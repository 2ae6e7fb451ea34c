"""An .mcap file under way: topics, messages and attachments at simulated times."""

from collections.abc import Mapping
from pathlib import Path
from typing import IO, cast

from mcap.well_known import SchemaEncoding
from mcap.writer import CompressionType, Writer

from argo_env.recording.output import RecordingFile
from argo_env.recording.topic_writer import TopicWriter

FLUSH_PERIOD = 10.0
"""s of simulated time after which what was recorded is on disk, whatever happens to the process"""


def nanoseconds(t: float) -> int:
    """The time t (s) as recordings tell it: simulated time, which begins at 0."""
    return round(t * 1e9)


class RecordingWriter(TopicWriter):
    """Writes one file. Holds the open chunk and what has been registered; close it at the end."""

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
        """Adds a file to the recording, and has all on disk that came before."""
        data = content.encode() if isinstance(content, str) else content
        self.flush(t)
        self._writer.add_attachment(nanoseconds(t), nanoseconds(t), name, media_type, data)
        self._keep()

    def describe(self, name: str, facts: Mapping[str, str]) -> None:
        """Adds metadata: texts by name."""
        self._writer.add_metadata(name, dict(facts))

    def flush_if_due(self, t: float) -> None:
        """Has all on disk now and then, counted in simulated time so that equal runs give equal
        files."""
        if t >= self._flushed + FLUSH_PERIOD:
            self.flush(t)

    def flush(self, t: float) -> None:
        """Has all on disk that came before the time t (s)."""
        self._flushed = t
        self._writer.flush()  # type: ignore[no-untyped-call]
        self._keep()

    def close(self) -> None:
        """Writes the index; the file is complete then."""
        self.flush(self._latest)
        self._writer.finish()  # type: ignore[no-untyped-call]

    def _open(self, topic: str, encoding: str, name: str, schema: bytes) -> None:
        if name not in self._schemas:
            kind = SchemaEncoding.Protobuf if encoding == "protobuf" else SchemaEncoding.JSONSchema
            self._schemas[name] = self._writer.register_schema(name, kind, schema)
        self._channels[topic] = self._writer.register_channel(topic, encoding, self._schemas[name])
        self._sequences[topic] = 0

    def _tell(self, topic: str, data: bytes, t: float) -> None:
        time, size = nanoseconds(t), self._stream.tell()
        self._latest = max(self._latest, t)
        self._writer.add_message(self._channels[topic], time, data, time, self._sequences[topic])
        self._sequences[topic] += 1
        if self._stream.tell() > size:  # it has filled a chunk, which is written as a whole
            self._keep()

    def _keep(self) -> None:
        self.until = self._latest
        self._stream.keep()


def media_type(path: Path) -> str:
    """What a mission's source is, by its suffix."""
    return {".json": "application/json", ".txt": "text/plain"}.get(
        path.suffix.lower(), "application/octet-stream"
    )
