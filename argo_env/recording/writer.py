"""An .mcap file under way: topics, messages and attachments at simulated times."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import IO, cast

from google.protobuf.message import Message
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import CompressionType, Writer
from mcap_protobuf.schema import build_file_descriptor_set

from argo_compiler.base.model import Model
from argo_env.recording.output import RecordingFile
from argo_env.recording.plain_schema import plain_schema

FLUSH_PERIOD = 10.0
"""s of simulated time after which what was recorded is on disk, whatever happens to the process"""


def nanoseconds(t: float) -> int:
    """The time t (s) as recordings tell it: simulated time, which begins at 0."""
    return round(t * 1e9)


class RecordingWriter:
    """Writes one file. Holds the open chunk and what has been registered; close it at the end."""

    def __init__(self, stream: RecordingFile) -> None:
        self._stream = stream
        self.until: float | None = None
        """s of simulated time up to which all can be read, whatever happens; None: nothing can"""
        self._latest = 0.0
        self._writer = Writer(
            cast(IO[bytes], stream),
            compression=CompressionType.ZSTD,
            enable_crcs=True,
            enable_data_crcs=True,
        )
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._sequences: dict[str, int] = {}
        self._flushed = 0.0
        self._writer.start(profile="", library="argo")

    def put(self, topic: str, message: Message, t: float) -> None:
        """Writes a protobuf message at time t (s)."""
        if topic not in self._channels:
            name = message.DESCRIPTOR.full_name
            if name not in self._schemas:
                self._schemas[name] = self._writer.register_schema(
                    name,
                    SchemaEncoding.Protobuf,
                    build_file_descriptor_set(type(message)).SerializeToString(deterministic=True),
                )
            self._register(topic, MessageEncoding.Protobuf, self._schemas[name])
        self._add(topic, message.SerializeToString(), t)

    def put_json(self, topic: str, message: Model, t: float) -> None:
        """Writes a model as JSON at time t (s); fields that are None are left out."""
        if topic not in self._channels:
            name = f"argo.{type(message).__name__}"
            if name not in self._schemas:
                schema = json.dumps(plain_schema(type(message)), ensure_ascii=False)
                self._schemas[name] = self._writer.register_schema(
                    name, SchemaEncoding.JSONSchema, schema.encode()
                )
            self._register(topic, MessageEncoding.JSON, self._schemas[name])
        self._add(topic, message.model_dump_json(exclude_none=True).encode(), t)

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

    def _register(self, topic: str, encoding: str, schema: int) -> None:
        self._channels[topic] = self._writer.register_channel(topic, encoding, schema)
        self._sequences[topic] = 0

    def _add(self, topic: str, data: bytes, t: float) -> None:
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
