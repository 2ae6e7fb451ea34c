"""File of one mission plan: a line with an earlier state, and one line for each later record.

A record that was written and synced survives a crash of the process and of the machine. From time
to time the file is rewritten with fewer records; the previous file is stored next to it.
"""

import os
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from argo_compiler.base.errors import Invalid, NotFound, Unavailable
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import NO_LINK_FLAGS, sync_content, sync_folder
from argo_compiler.base.version import __version__
from argo_compiler.il import Mission
from argo_env.closing import Closing
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    truncate_if_possible,
    write_all,
)
from argo_planner.service.core.document import (
    PlanDocument,
    PlanRecord,
    PlanVersion,
    RevisionMade,
)
from argo_planner.service.core.plan import MissionPlan
from argo_planner.service.core.refusals import PlanTooLarge

VERSION = 1
"""version of the file's format"""
MAX_BYTES = 1_000_000_000
MOST_RECORDS = 400
"""number of lines after which the file is rewritten"""
MAX_GROWTH = 16_000_000
"""bytes of records after which the file is rewritten; the size of the first line, if larger"""
KEPT_RECORDS = 100
"""revisions that a rewritten file has; fewer if they exceed half of `MAX_GROWTH`"""
_FLAGS = os.O_RDWR | os.O_APPEND | NO_LINK_FLAGS
_RECORD: TypeAdapter[PlanRecord] = TypeAdapter(PlanRecord)


class PlanBase(Model):
    """First line of the file: the state of the plan before the records that follow."""

    format: Literal["argo plan"] = "argo plan"
    version: Literal[1] = 1
    argo: str = __version__
    id: str
    name: str
    created: datetime
    changed: datetime
    revision: int
    mission: Mission
    versions: tuple[PlanVersion, ...] = ()


@dataclass(frozen=True)
class Recovery:
    """Recovery of a damaged file: what was lost, and where the damaged file is."""

    message: str
    damaged_name: str
    """name of the damaged file, in the folder of the plan's file"""


@dataclass(frozen=True)
class PlanExtent:
    """Size of a plan's file."""

    first: int
    """size of the first line in bytes"""
    size: int
    """size of the file in bytes"""
    lines: int

    @property
    def must_be_rewritten(self) -> bool:
        """True if the file has so many lines or bytes that it is to be rewritten."""
        grown = self.size - self.first
        return self.lines > MOST_RECORDS or grown > max(MAX_GROWTH, self.first)


class PlanFile(Closing):
    """Open file of a mission plan. Owns the file, and holds the plan's state on disk.

    Only one thread at a time may use it.
    """

    def __init__(self, path: Path, file: int, document: PlanDocument, extent: PlanExtent) -> None:
        self.path = path
        self.document = document
        self.recovery: Recovery | None = None
        """what was lost when the file was opened; None: nothing"""
        self._file = file
        self._extent = extent

    def append(self, document_after: PlanDocument, record: PlanRecord) -> None:
        """Append a record to the file and sync it; `document_after` is the plan's new state.

        Raises Unavailable if the record can't be written, PlanTooLarge if the file would be too
        large to be opened again. After an error the file has the same content as before.
        """
        data = record.model_dump(mode="json")
        line = checked_line({"n": self._extent.lines} | data)
        if self._extent.size + len(line) > MAX_BYTES:
            self._rewrite()
            line = checked_line({"n": self._extent.lines} | data)
        extent = self._extent
        if extent.size + len(line) > MAX_BYTES:
            raise PlanTooLarge(
                f"the mission's file would have more than {MAX_BYTES // 1_000_000} MB: delete some "
                "of its versions, or continue with a copy"
            )
        try:
            write_all(self._file, line)
            sync_content(self._file)
        except OSError as error:
            truncate_if_possible(self._file, extent.size)
            raise _write_error(self.path, error) from error
        self._extent = PlanExtent(extent.first, extent.size + len(line), extent.lines + 1)
        self.document = document_after
        if self._extent.must_be_rewritten:
            self._rewrite()

    def close(self) -> None:
        os.close(self._file)

    def _rewrite(self) -> None:
        """Rewrite the file with the plan's last revisions; keep the previous file next to it."""
        try:
            written = _write_plan(self.path, self.document, KEPT_RECORDS)
        except Unavailable:
            return  # the present file is complete
        os.close(self._file)
        self._file, self._extent = written


def write_plan_file(path: Path, document: PlanDocument) -> PlanFile:
    """Write a plan to a file, which replaces an existing one, and return it open.

    Raises Unavailable if that fails.
    """
    file, extent = _write_plan(path, document, 0)
    return PlanFile(path, file, document, extent)


def open_plan_file(path: Path) -> PlanFile:
    """Open the file of a plan for appending.

    A last line that was not written completely is cut off. If the file is damaged, its last valid
    state is opened, `recovery` states what was lost, and the damaged file is stored next to it.

    Raises:
        NotFound: There is no such file.
        Invalid: Nothing in it can be read, or another version of Argo has written it.
        Unavailable: It can't be opened or written.
    """
    content = read_plan_bytes_or_raise(path)
    parsed = _parse(content)
    previous = replaced_file_path(path)
    if parsed is None and os.path.exists(previous):
        parsed_previous = _parse(read_plan_bytes_or_raise(previous))
        if parsed_previous is not None:
            lost = "its first line is damaged: this is an earlier state of the mission"
            return _recover(path, parsed_previous, lost)
    if parsed is None:
        raise Invalid(
            f"{path.name} is damaged from its first line on, and nothing in it can be read: "
            "restore it from a copy"
        )
    if parsed.lost:
        lost = (
            f"{parsed.lost} of {parsed.lost + parsed.extent.lines} lines are damaged or follow a "
            f"damaged one: this is the mission at revision {parsed.document.plan.revision}"
        )
        return _recover(path, parsed, lost)
    file = _open(path)
    if parsed.extent.size < len(content):
        os.ftruncate(file, parsed.extent.size)  # an incomplete line, which was never acknowledged
        os.fsync(file)
    return PlanFile(path, file, parsed.document, parsed.extent)


@dataclass(frozen=True)
class _ParsedFile:
    document: PlanDocument
    extent: PlanExtent
    """extent of the valid part"""
    lost: int
    """complete lines that are damaged or follow a damaged one"""


def _parse(content: bytes) -> _ParsedFile | None:
    """Return the plan in the valid part of a file, or None if its first line is damaged."""
    lines = content.split(b"\n")[:-1]  # the part after the last line break is incomplete
    base = parse_first_line(lines[0]) if lines else None
    if base is None:
        return None
    base.pop("n", None)
    try:
        document = _document(PlanBase.model_validate(base))
    except ValidationError:
        return None
    first = size = len(lines[0]) + 1
    for number, line in enumerate(lines[1:], start=1):
        next_document = _apply_line(document, line, number)
        if next_document is None:
            return _ParsedFile(document, PlanExtent(first, size, number), len(lines) - number)
        document = next_document
        size += len(line) + 1
    return _ParsedFile(document, PlanExtent(first, size, len(lines)), 0)


def parse_first_line(line: bytes) -> dict[str, Any] | None:
    """Return the fields of the first line of a mission plan's file, as parsed from its JSON.

    Returns None if the line is damaged, or is not that of a mission plan. Raises Invalid if it is
    intact and has another version of the format.
    """
    base = checked_object(line)
    if base is None or base.get("format") != "argo plan":
        return None
    if base.get("version") != VERSION:
        raise Invalid(
            f"the mission's file has format version {base.get('version')}, but this Argo reads "
            f"version {VERSION}: open it with the Argo that wrote it"
        )
    return base


def _apply_line(document: PlanDocument, line: bytes, number: int) -> PlanDocument | None:
    """Return the document after the record in a line, or None if the line has no valid record."""
    data = checked_object(line)
    if data is None or data.pop("n", None) != number:
        return None
    try:
        return document.apply(_RECORD.validate_python(data))
    except ValueError:
        return None


def _document(base: PlanBase) -> PlanDocument:
    plan = MissionPlan(base.mission, base.revision)
    return PlanDocument(base.id, base.name, base.created, base.changed, plan, base.versions)


def _recover(path: Path, parsed: _ParsedFile, lost: str) -> PlanFile:
    """Rewrite a damaged file with its valid part; the damaged file is stored next to it."""
    damaged = next(
        name
        for k in range(1, 10_000)
        if not os.path.lexists(name := path.with_name(f"{path.name}.damaged-{k}"))
    )
    try:
        os.link(path, damaged, follow_symlinks=False)
    except OSError as error:
        raise _write_error(path, error) from error
    count = len(parsed.document.plan.history)
    file, extent = _write_plan(path, parsed.document, count, keep_previous=False)
    opened = PlanFile(path, file, parsed.document, extent)
    opened.recovery = Recovery(f"{lost}; the damaged file is now {damaged.name}", damaged.name)
    return opened


def _write_plan(
    path: Path, document: PlanDocument, records: int, keep_previous: bool = True
) -> tuple[int, PlanExtent]:
    """Write the whole file, with at most `records` last revisions as records.

    Writes under another name and renames the file at the end. Returns the open file and its extent.
    """
    plan = document.plan
    revisions = _last_revisions(plan, records)
    start = plan.plan_before(revisions[0].revision.number) if revisions else plan
    base = PlanBase.model_construct(
        id=document.id,
        name=document.name,
        created=document.created,
        changed=document.changed,
        revision=start.revision,
        mission=start.mission,
        versions=document.versions,
    )
    lines = [
        checked_line({"n": number} | record.model_dump(mode="json"))
        for number, record in enumerate((base, *revisions))
    ]
    content = b"".join(lines)
    draft = path.with_name(f"{path.name}.new")
    try:
        draft.unlink(missing_ok=True)
        file = os.open(draft, os.O_CREAT | os.O_EXCL | _FLAGS, 0o600)
    except OSError as error:
        raise _write_error(path, error) from error
    try:
        write_all(file, content)
        os.fsync(file)
        if keep_previous and os.path.exists(path):
            replaced_file_path(path).unlink(missing_ok=True)
            os.link(path, replaced_file_path(path), follow_symlinks=False)
        draft.replace(path)
        sync_folder(path.parent)
    except OSError as error:
        os.close(file)
        draft.unlink(missing_ok=True)
        raise _write_error(path, error) from error
    return file, PlanExtent(len(lines[0]), len(content), len(lines))


def _last_revisions(plan: MissionPlan, most: int) -> list[RevisionMade]:
    """Return the last revisions as records, the oldest first.

    They are at most `most`, and together at most half of `MAX_GROWTH` bytes, but at least one if
    `most` is not 0.
    """
    records: list[RevisionMade] = []
    size = 0
    for revision in reversed(plan.history[-most:] if most else ()):
        record = RevisionMade.model_construct(revision=revision)
        size += len(record.model_dump_json())
        if records and size > MAX_GROWTH // 2:
            break
        records.append(record)
    return records[::-1]


def replaced_file_path(path: Path) -> Path:
    """Return the path of the file that a plan's file has replaced; it need not exist."""
    return path.with_name(f"{path.name}.before")


def _open(path: Path, flags: int = _FLAGS) -> int:
    try:
        return os.open(path, flags)
    except FileNotFoundError:
        raise NotFound(f"{path.name}: there is no such mission") from None
    except OSError as error:
        raise Unavailable(f"{path.name} can't be opened: {error.strerror}") from error


def read_plan_bytes_or_raise(path: Path) -> bytes:
    """Return the bytes of a plan's file.

    Raises NotFound if there is no such file, Unavailable if it can't be read, Invalid if it is too
    large.
    """
    file = _open(path, os.O_RDONLY | NO_LINK_FLAGS)
    try:
        if os.fstat(file).st_size > MAX_BYTES:
            raise Invalid(
                f"{path.name} is larger than {MAX_BYTES // 1_000_000} MB, the limit for a mission"
            )
        parts = []
        while part := os.read(file, 1 << 20):
            parts.append(part)
    except OSError as error:
        raise Unavailable(f"{path.name} can't be read: {error.strerror}") from error
    finally:
        os.close(file)
    return b"".join(parts)


def _write_error(path: Path, error: OSError) -> Unavailable:
    return Unavailable(
        f"{path.name} can't be written: {error.strerror}; nothing was changed. Free disk "
        "space, or choose another folder"
    )
