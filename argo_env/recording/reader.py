"""A recording read back: what a report is made from, or what is left of a run cut short.

An .mcap file has two sections, the data and the index, with their checksums. The library checks
those of chunks and of the data section. Those of attachments and of the index it leaves to its
users.
"""

import struct
import zlib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from pydantic import ValidationError

from argo_compiler.base.errors import Invalid, NotFound, Remedy
from argo_compiler.files.json_places import format_path
from argo_compiler.files.loading import FileError, FileProblem, read_bytes
from argo_env.files.yaml_messages import error_message
from argo_env.recording.files import require_libraries
from argo_env.recording.output import MAGIC, VERSION
from argo_env.run.record import Reading, RunRecord, TaskRun
from argo_env.site import Site, make_site
from argo_env.site.spec import SiteSpec

if TYPE_CHECKING:
    from mcap.records import Attachment, McapRecord

_FOOTER = struct.Struct("<BQQQI")
"""opcode, length, where the index and its offsets begin, checksum (MCAP specification)"""
_FOOTER_OPCODE = 2


class Content(BytesIO):
    """The bytes of a file, which are never fewer than asked for: EndOfFile instead."""

    def read(self, size: int | None = -1, /) -> bytes:
        from mcap.exceptions import EndOfFile

        data = super().read(size)
        if size is not None and len(data) < size:
            raise EndOfFile
        return data


def data_section(content: Content) -> "Iterator[McapRecord]":
    """The records of the data section up to its DataEnd, each once its checksum is found right; the
    content stands behind that section then.

    Raises what `unreadable` names where they make no sense.
    """
    from mcap.exceptions import McapError
    from mcap.records import Attachment, Chunk, DataEnd, Footer, Metadata
    from mcap.stream_reader import StreamReader, breakup_chunk

    limit = len(content.getbuffer())  # a longer part can't be in it
    reader = StreamReader(content, emit_chunks=True, validate_crcs=True, record_size_limit=limit)
    argos = False
    for record in reader.records:
        match record:
            case Metadata() if record.name == "argo":
                argos = True
                yield record
            case Chunk():
                yield from breakup_chunk(record, validate_crc=True)
            case Attachment():
                if not _is_as_written(record, content):
                    raise McapError(f"the checksum of {record.name} is wrong")
                yield record
            case DataEnd():
                if argos and record.data_section_crc == 0:
                    # 0 says that there is none (MCAP specification); Argo always writes it.
                    raise McapError("the checksum of its data is missing")
                yield record
                return
            case Footer():
                raise McapError("the end of its data is missing")
            case _:
                yield record


def is_sound_end(content: bytes, start: int) -> bool:
    """Whether from `start` on there is the index that was written, the footer and nothing else."""
    at = len(content) - len(MAGIC) - _FOOTER.size
    if at < start or not content.endswith(MAGIC):
        return False
    opcode, _, index, _, checksum = _FOOTER.unpack_from(content, at)
    summed = content[start : -len(MAGIC) - 4]
    return bool(opcode == _FOOTER_OPCODE and index == start and zlib.crc32(summed) == checksum)


def trailing(content: bytes, start: int) -> int | None:
    """How many bytes follow after a sound end, where the index begins at `start`; None if no sound
    end is in it."""
    at = start
    while (at := content.find(MAGIC, at)) >= 0:
        at += len(MAGIC)
        if is_sound_end(content[:at], start):
            return len(content) - at
    return None


def unreadable() -> tuple[type[Exception], ...]:
    """What the libraries raise for bytes that make no sense."""
    from mcap.exceptions import McapError
    from zstandard import ZstdError

    return McapError, ZstdError, struct.error, ValueError, OverflowError, MemoryError


def _is_as_written(attachment: "Attachment", content: Content) -> bool:
    """Whether what was read last is what the library would write of it, checksum included."""
    from mcap.data_stream import RecordBuilder

    builder = RecordBuilder()
    attachment.write(builder)
    written: bytes = builder.end()  # type: ignore[no-untyped-call]
    end = content.tell()
    return content.getbuffer()[end - len(written) : end] == written


MAX_BYTES = 16 * 1024**3
"""of a recording; one with a camera's pictures takes some 100 MB an hour"""
_HINT = "name a file that a run was recorded in"


@dataclass(frozen=True)
class Recording:
    """What a recording holds beside its pictures of the run."""

    name: str
    """what the file is called"""
    facts: dict[str, str]
    """site, robot, drive, sensor and seed of the run, as texts"""
    site: Site
    record: RunRecord | None
    """None: the run did not come to its end"""
    flaw: str | None
    """what is wrong with the file's end, in words; None: it is as it was written"""
    until: float
    """s of simulated time that it reaches to"""
    messages: dict[str, int]
    """how many there are, by topic"""
    readings: tuple[Reading, ...]
    tasks: tuple[TaskRun, ...]

    def require_record(self) -> RunRecord:
        """The run's record; ArgoError if the run did not come to its end."""
        if self.record is None:
            raise Invalid(
                f"{self.name}: has no record of the run, which is written at its end: {self.loss}. "
                "No report and no film can be made of it; what is there can be shown",
                remedies=(Remedy.SHOW_REST,),
            )
        return self.record

    @property
    def loss(self) -> str:
        """What is missing of a run without a record, in words."""
        if self.flaw is None:
            return f"the run broke off after {self.until:g} s"
        return f"the recording {self.flaw}"


def read_recording(path: Path) -> Recording:
    """Reads a recording, also one that breaks off or has a damaged end: its `flaw` says so.

    What it returns has the checksums that it was written with. Raises ArgoError if the file can't
    be read, is damaged before its end, is no .mcap file or none of Argo's.
    """
    return decode_recording(_content(path), str(path))


def decode_recording(content: bytes, name: str) -> Recording:
    """The same of a recording's bytes, which messages call `name`."""
    require_libraries()
    parts = _Parts()
    flaw = _read(name, content, parts)
    if parts.facts is None:
        _refuse(name, f"is no recording of Argo's: {_HINT}", Remedy.RECORD)
    if parts.facts.get("version") != VERSION:
        _refuse(
            name,
            f"has version {parts.facts.get('version')} of Argo's recordings, and this Argo reads "
            f"{VERSION}: replay it with the Argo that made it",
        )
    if "site.json" not in parts.attachments:
        _refuse(name, "breaks off before the run's first step: there is nothing to replay")
    try:
        record = parts.attachments.get("record.json")
        return Recording(
            name,
            parts.facts,
            make_site(SiteSpec.model_validate_json(parts.attachments["site.json"])),
            None if record is None else RunRecord.model_validate_json(record),
            flaw,
            parts.until / 1e9,
            dict(parts.messages),
            tuple(Reading.model_validate_json(text) for text in parts.readings),
            tuple(TaskRun.model_validate_json(text) for text in parts.tasks),
        )
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        place, said = format_path(fault["loc"]), error_message(fault, fault["loc"])
        _refuse(name, f"does not fit this Argo: {place}: {said}")


class _Parts:
    """What has been read of a file so far."""

    def __init__(self) -> None:
        self.facts: dict[str, str] | None = None
        self.attachments: dict[str, bytes] = {}
        self.messages: Counter[str] = Counter()
        self.readings: list[bytes] = []
        self.tasks: list[bytes] = []
        self.until = 0
        """ns"""
        self._topics: dict[int, str] = {}

    def add(self, record: "McapRecord") -> None:
        from mcap.records import Attachment, Channel, Message, Metadata

        match record:
            case Metadata() if record.name == "argo":
                self.facts = record.metadata
            case Attachment():
                self.attachments[record.name] = record.data
            case Channel():
                self._topics[record.id] = record.topic
            case Message():
                topic = self._topics.get(record.channel_id, "")
                self.messages[topic] += 1
                self.until = max(self.until, record.log_time)
                if topic == "/readings":
                    self.readings.append(record.data)
                elif topic == "/tasks":
                    self.tasks.append(record.data)


def _read(name: str, content: bytes, parts: _Parts) -> str | None:
    """Reads as far as there is anything; what is wrong with the file's end, if anything is."""
    from mcap.exceptions import EndOfFile, RecordLengthLimitExceeded

    if not content:
        _refuse(name, f"is empty: {_HINT}", Remedy.RECORD)
    if not MAGIC.startswith(content[: len(MAGIC)]):
        _refuse(name, f"is no .mcap file: {_HINT}", Remedy.RECORD)
    stream = Content(content)
    try:
        for record in data_section(stream):
            parts.add(record)
    except unreadable() as error:
        until, why = f"after {parts.until / 1e9:g} s", f"({str(error) or type(error).__name__})"
        if len(content) > len(MAGIC) and content.endswith(MAGIC):
            _refuse(name, f"is damaged {until} {why}: take it from a copy")
        # A part that reaches beyond the end of the file is the last one of a file that breaks off.
        if isinstance(error, EndOfFile | RecordLengthLimitExceeded):
            return f"breaks off {until}, as where its process was killed, or the disk full"
        return f"is damaged {until} {why}, and has no end"
    if is_sound_end(content, stream.tell()):
        return None
    extra = trailing(content, stream.tell())
    if extra is None:
        return "has a missing or damaged index"
    return f"goes on for {extra} byte{'s' if extra > 1 else ''} after its end"


def _content(path: Path) -> bytes:
    try:
        return read_bytes(path, "recording", MAX_BYTES, MAGIC)
    except FileError as error:
        match error.problem:
            case FileProblem.MISSING:
                message = "there is no such recording: a run makes one"
                raise NotFound(f"{path}: {message}", remedies=(Remedy.RECORD,)) from None
            case FileProblem.DIRECTORY:
                _refuse(str(path), f"is a folder: {_HINT}", Remedy.RECORD)
        raise


def _refuse(name: str, message: str, *remedies: Remedy) -> NoReturn:
    raise Invalid(f"{name}: {message}", remedies=remedies) from None
