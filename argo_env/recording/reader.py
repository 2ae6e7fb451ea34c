"""Reader of recordings, for reports, and for the rest of recordings that are incomplete.

An .mcap file has two sections, the data and the index, with their checksums. The library checks
those of chunks and of the data section, but not those of attachments and of the index.
"""

import struct
import zlib
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, NoReturn

from pydantic import ValidationError

from argo_compiler.base.errors import Invalid, NotFound, Remedy
from argo_compiler.base.limited_process import LimitExceeded, call_limited, limits_for_size
from argo_compiler.files.json_places import format_path
from argo_compiler.files.loading import (
    FileError,
    FileProblem,
    is_own_open_file,
    is_pipe,
    open_file,
    read_bytes,
    size_on_disk,
)
from argo_env.files.folders import reporting_write_errors
from argo_env.files.yaml_messages import error_message
from argo_env.recording.files import require_libraries
from argo_env.recording.output import MAGIC, VERSION
from argo_env.run.record import Reading, RunRecord, TaskRun
from argo_env.site import Site, make_site
from argo_env.site.spec import SiteSpec

if TYPE_CHECKING:
    from mcap.records import Attachment, Chunk, McapRecord

_FOOTER = struct.Struct("<BQQQI")
"""opcode, length, positions of the index and of its offsets, checksum (MCAP specification)"""
_FOOTER_OPCODE = 2


class ContentStream(BytesIO):
    """Stream of a file's bytes that raises EndOfFile rather than returning too few."""

    def read(self, size: int | None = -1, /) -> bytes:
        from mcap.exceptions import EndOfFile

        data = super().read(size)
        if size is not None and len(data) < size:
            raise EndOfFile
        return data


def iter_verified_records(content: ContentStream) -> "Iterator[McapRecord]":
    """Yield the records of the data section, with DataEnd as the last, after verifying checksums.

    After the last one, the position of the stream is the end of the section. Raises one of
    `decoding_errors` where the bytes can't be decoded.
    """
    from mcap.exceptions import McapError
    from mcap.records import Attachment, Chunk, DataEnd, Footer, Metadata
    from mcap.stream_reader import StreamReader, breakup_chunk

    limit = len(content.getbuffer())  # no record is longer than the file
    reader = StreamReader(content, emit_chunks=True, validate_crcs=True, record_size_limit=limit)
    is_argos = False
    for record in reader.records:
        match record:
            case Metadata() if record.name == "argo":
                is_argos = True
                yield record
            case Chunk():
                _require_stated_size(record)
                yield from breakup_chunk(record, validate_crc=True)
            case Attachment():
                if not _is_intact(record, content):
                    raise McapError(f"the checksum of {record.name} is wrong")
                yield record
            case DataEnd():
                if is_argos and record.data_section_crc == 0:
                    # 0 means no checksum (MCAP specification); Argo always writes one.
                    raise McapError("the checksum of its data is missing")
                yield record
                return
            case Footer():
                raise McapError("the end of its data is missing")
            case _:
                yield record


def has_intact_end(content: bytes, index_start: int) -> bool:
    """Return True if the content from byte `index_start` on is just an intact index and footer."""
    position = len(content) - len(MAGIC) - _FOOTER.size
    if position < index_start or not content.endswith(MAGIC):
        return False
    opcode, _, index, _, checksum = _FOOTER.unpack_from(content, position)
    summed = content[index_start : -len(MAGIC) - 4]
    return bool(
        opcode == _FOOTER_OPCODE and index == index_start and zlib.crc32(summed) == checksum
    )


def count_bytes_after_end(content: bytes, index_start: int) -> int | None:
    """Return the number of bytes after the intact end of a file.

    The file's index begins at byte `index_start`. None means that the content has no intact end.
    """
    position = index_start
    while (position := content.find(MAGIC, position)) >= 0:
        position += len(MAGIC)
        if has_intact_end(content[:position], index_start):
            return len(content) - position
    return None


def decoding_errors() -> tuple[type[Exception], ...]:
    """Return the exceptions that the libraries raise for bytes that can't be decoded."""
    from mcap.exceptions import McapError
    from zstandard import ZstdError

    return McapError, ZstdError, struct.error, ValueError, OverflowError


def _require_stated_size(chunk: "Chunk") -> None:
    """Raise McapError if a chunk is too large when it is unpacked, or larger than it states."""
    from mcap.exceptions import McapError
    from zstandard import frame_content_size

    size = chunk.uncompressed_size
    if size > MAX_CHUNK_BYTES:
        raise McapError(f"a chunk has {size} bytes")
    if chunk.compression == "zstd" and frame_content_size(chunk.data) not in (-1, size):
        raise McapError("a chunk is larger than it states")


def _is_intact(attachment: "Attachment", content: ContentStream) -> bool:
    """Return True if the bytes read last are those that the library would write, checksum included.

    The library reads attachments without verifying their checksums.
    """
    from mcap.data_stream import RecordBuilder

    builder = RecordBuilder()
    attachment.write(builder)
    written: bytes = builder.end()  # type: ignore[no-untyped-call]
    end = content.tell()
    return content.getbuffer()[end - len(written) : end] == written


MAX_BYTES = 16 * 1024**3
"""greatest size of a recording; one with a camera's pictures takes some 100 MB an hour"""
MAX_CHUNK_BYTES = 200_000_000
"""greatest size of a chunk when it is unpacked; Argo's have ten seconds, of some megabytes"""
_MODULES = ("mcap.stream_reader", "zstandard", "lz4.frame")
_HINT = "name a file that a run was recorded in"


@dataclass(frozen=True)
class Recording:
    """Contents of a recording that reports and summaries need; most messages are only counted."""

    name: str
    """name of the file"""
    facts: dict[str, str]
    """metadata of the run, among them version, site, robot, drive, sensor and seed, as texts"""
    site: Site
    record: RunRecord | None
    """record of the run; None if it is missing because the run or the file did not end properly"""
    flaw: str | None
    """defect of the file's end, in words; None if the file is intact"""
    until: float
    """simulated time in s of the last message"""
    messages: dict[str, int]
    """number of messages by topic"""
    readings: tuple[Reading, ...]
    tasks: tuple[TaskRun, ...]

    def require_record(self) -> RunRecord:
        """Return the run's record; raise ArgoError if the recording has none."""
        if self.record is None:
            raise Invalid(
                f"{self.name} has no record of the run, which is written at its end: "
                f"{self.reason_if_record_missing}. "
                "No report and no film can be made of it; what is there can be shown",
                remedies=(Remedy.SHOW_REST,),
            )
        return self.record

    @property
    def reason_if_record_missing(self) -> str:
        """Reason why the record is missing, in words; meaningless if `record` is not None."""
        if self.flaw is None:
            return f"the run broke off after {self.until:g} s"
        return f"the recording {self.flaw}"


def read_recording(path: Path) -> Recording:
    """Return the contents of a recording, also of one whose end is missing or damaged; see `flaw`.

    All checksums of the returned data are verified. The file is read in a process with limits of
    time and memory. Raises ArgoError if it can't be read, is damaged before its end, is not an
    .mcap file of Argo, or exceeds the limits.
    """
    if not is_pipe(path):
        with _naming_file_problems(path), open_file(path, "recording"):
            pass  # what can't be opened needs no process
    with _named_alike_in_all_processes(path) as file:
        size = size_on_disk(file)
        try:
            limits = limits_for_size(size, held=size)
            return call_limited(limits, _MODULES, read_recording_here, file, str(path))
        except LimitExceeded as error:
            _raise_invalid(str(path), f"{error}: {_HINT}", Remedy.RECORD)


@contextmanager
def _named_alike_in_all_processes(path: Path) -> Iterator[Path]:
    """Yield a path by which each process finds a recording: that of a copy for `/dev/stdin`."""
    if not is_own_open_file(path):
        yield path
        return
    with TemporaryDirectory() as folder:
        copy = Path(folder) / "recording.mcap"
        content = _load(path)
        with reporting_write_errors(copy, "a copy of the recording"):
            copy.write_bytes(content)
        yield copy


def read_recording_here(path: Path, name: str) -> Recording:
    """Return the contents of a recording, as `read_recording`, but here and without its limits.

    Messages call it `name`.
    """
    content = _load(path)
    require_libraries()
    parts = _Parts()
    flaw = _read_parts(name, content, parts)
    if parts.facts is None:
        _raise_invalid(name, f"is not a recording of Argo's: {_HINT}", Remedy.RECORD)
    if parts.facts.get("version") != VERSION:
        _raise_invalid(
            name,
            f"has version {parts.facts.get('version')} of Argo's recordings, and this Argo reads "
            f"version {VERSION}: replay it with the Argo that made it",
        )
    if "site.json" not in parts.attachments:
        _raise_invalid(name, "breaks off before the run's first step: there is nothing to replay")
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
        first = error.errors(include_url=False)[0]
        place, message = format_path(first["loc"]), error_message(first, first["loc"])
        _raise_invalid(name, f"does not fit this Argo: {place}: {message}")


class _Parts:
    """Parts of a recording that have been read so far."""

    def __init__(self) -> None:
        self.facts: dict[str, str] | None = None
        self.attachments: dict[str, bytes] = {}
        self.messages: Counter[str] = Counter()
        self.readings: list[bytes] = []
        self.tasks: list[bytes] = []
        self.until = 0
        """simulated time in ns of the last message"""
        self._topics: dict[int, str] = {}

    def add(self, record: "McapRecord") -> None:
        """Add a record of the data section."""
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


def _read_parts(name: str, content: bytes, parts: _Parts) -> str | None:
    """Add all readable records of the content to `parts`; return the defect of the end, if any."""
    from mcap.exceptions import EndOfFile, RecordLengthLimitExceeded

    if not content:
        _raise_invalid(name, f"is empty: {_HINT}", Remedy.RECORD)
    if not MAGIC.startswith(content[: len(MAGIC)]):
        _raise_invalid(name, f"is not an .mcap file: {_HINT}", Remedy.RECORD)
    stream = ContentStream(content)
    try:
        for record in iter_verified_records(stream):
            parts.add(record)
    except decoding_errors() as error:
        until, why = f"after {parts.until / 1e9:g} s", f"({str(error) or type(error).__name__})"
        if len(content) > len(MAGIC) and content.endswith(MAGIC):
            _raise_invalid(name, f"is damaged {until} {why}: restore it from a copy")
        # A record that is longer than the rest of the file is the last one of an incomplete file.
        if isinstance(error, EndOfFile | RecordLengthLimitExceeded):
            return f"breaks off {until}, as if its process was killed or the disk was full"
        return f"is damaged {until} {why}, and has no end"
    if has_intact_end(content, stream.tell()):
        return None
    extra = count_bytes_after_end(content, stream.tell())
    if extra is None:
        return "has a missing or damaged index"
    return f"has {extra} more byte{'s' if extra > 1 else ''} after its end"


def _load(path: Path) -> bytes:
    with _naming_file_problems(path):
        return read_bytes(path, "recording", MAX_BYTES, MAGIC)


@contextmanager
def _naming_file_problems(path: Path) -> Iterator[None]:
    """Say what can be done about a file that can't be read."""
    try:
        yield
    except FileError as error:
        match error.problem:
            case FileProblem.MISSING:
                message = "there is no such recording: a run makes one"
                raise NotFound(f"{path}: {message}", remedies=(Remedy.RECORD,)) from None
            case FileProblem.DIRECTORY:
                _raise_invalid(str(path), f"is a folder: {_HINT}", Remedy.RECORD)
        raise


def _raise_invalid(name: str, message: str, *remedies: Remedy) -> NoReturn:
    raise Invalid(f"{name} {message}", remedies=remedies) from None
