"""A recording read back: what a report is made from, or what is left of a run cut short."""

import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from pydantic import ValidationError

from argo_compiler.errors import ArgoError
from argo_env.record import Reading, RunRecord, TaskRun
from argo_env.recording.files import MAGIC, VERSION, require_libraries
from argo_env.site import Site, make_site
from argo_env.site.spec import SiteSpec

if TYPE_CHECKING:  # what the extra brings
    from mcap.records import McapRecord

_HINT = "name a file that `argo run --record` has written"


@dataclass(frozen=True)
class Recording:
    """What a recording holds beside its pictures of the run."""

    path: Path
    facts: dict[str, str]
    """site, robot, drive, sensor and seed of the run, as texts"""
    site: Site
    record: RunRecord | None
    """None: the run did not come to its end"""
    whole: bool
    """whether the file has its end; else its process was killed, or the rest was lost"""
    until: float
    """s of simulated time that it reaches to"""
    messages: dict[str, int]
    """how many there are, by topic"""
    readings: tuple[Reading, ...]
    tasks: tuple[TaskRun, ...]

    def require_record(self) -> RunRecord:
        """The run's record; ArgoError if the run did not come to its end."""
        if self.record is None:
            raise ArgoError(
                f"{self.path}: has no record of the run, which is written at its end: {self.loss}. "
                "No report and no film can be made of it; without options `argo replay` shows "
                "what is there"
            )
        return self.record

    @property
    def loss(self) -> str:
        """What is missing of a run without a record, in words."""
        if self.whole:
            return f"the run failed after {self.until:g} s"
        return f"the recording breaks off after {self.until:g} s, as if its process had been killed"


def read_recording(path: Path) -> Recording:
    """Reads a recording, also one that breaks off.

    Raises ArgoError if it can't be read, is damaged, is no .mcap file or none of Argo's.
    """
    require_libraries()
    content = _content(path)
    parts = _Parts(path)
    whole = _read(path, content, parts)
    if parts.facts is None:
        _refuse(path, f"is no recording of Argo's: {_HINT}")
    if parts.facts.get("version") != VERSION:
        _refuse(
            path,
            f"has version {parts.facts.get('version')} of Argo's recordings, and this Argo reads "
            f"{VERSION}: replay it with the Argo that made it",
        )
    if "site.json" not in parts.attachments:
        _refuse(path, "breaks off before the run's first step: there is nothing to replay")
    try:
        record = parts.attachments.get("record.json")
        return Recording(
            path,
            parts.facts,
            make_site(SiteSpec.model_validate_json(parts.attachments["site.json"])),
            None if record is None else RunRecord.model_validate_json(record),
            whole,
            parts.until / 1e9,
            dict(parts.messages),
            tuple(Reading.model_validate_json(text) for text in parts.readings),
            tuple(TaskRun.model_validate_json(text) for text in parts.tasks),
        )
    except ValidationError as error:
        place = ".".join(str(part) for part in error.errors()[0]["loc"])
        _refuse(path, f"does not fit this Argo: {place}: {error.errors()[0]['msg']}")


class _Parts:
    """What has been read of a file so far."""

    def __init__(self, path: Path) -> None:
        self.path = path
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


def _read(path: Path, content: bytes, parts: _Parts) -> bool:
    """Reads as far as there is anything; whether the file has its end."""
    if not content:
        _refuse(path, f"is empty: {_HINT}")
    if not MAGIC.startswith(content[: len(MAGIC)]):
        _refuse(path, f"is no .mcap file: {_HINT}")
    whole = len(content) > len(MAGIC) and content.endswith(MAGIC)
    try:
        for record in _records(content):
            parts.add(record)
    # What the libraries raise for bytes that make no sense; of a file that breaks off, those are
    # the last ones.
    except _unreadable() as error:
        if whole:
            _refuse(
                path,
                f"is damaged after {parts.until / 1e9:g} s ({error or type(error).__name__}): "
                "take it from a copy",
            )
    return whole


def _records(content: bytes) -> "Iterator[McapRecord]":
    from mcap.stream_reader import StreamReader

    limit = len(content)  # a longer part can't be in it
    return StreamReader(BytesIO(content), validate_crcs=True, record_size_limit=limit).records


def _unreadable() -> tuple[type[Exception], ...]:
    from mcap.exceptions import McapError
    from zstandard import ZstdError

    return McapError, ZstdError, struct.error, ValueError, OverflowError, MemoryError


def _content(path: Path) -> bytes:
    if path.is_dir():
        _refuse(path, f"is a folder: {_HINT}")
    try:
        return path.read_bytes()
    except FileNotFoundError:
        _refuse(path, "there is no such recording: `argo run --record` makes one")
    except OSError as error:
        _refuse(path, f"can't be read: {error.strerror}")


def _refuse(path: Path, message: str) -> NoReturn:
    raise ArgoError(f"{path}: {message}") from None
