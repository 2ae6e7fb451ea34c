"""File of one mission plan: a line with an earlier state, and one line for each later record.

A record that was written and synced survives a crash of the process and of the machine; a mark
follows it (see `checked_lines`). From time to time the file is rewritten with fewer records; the
previous file is stored next to it.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from argo_compiler.base.errors import Invalid, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import NO_LINK_FLAGS, sync_folder
from argo_compiler.base.quantity_text import counted_text
from argo_compiler.base.version import __version__
from argo_compiler.il import Mission
from argo_env.closing import Closing
from argo_env.files.checked_lines import (
    LineWriter,
    StoredLine,
    checked_object,
    complete_lines,
    parse_lines,
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
from argo_planner.service.storage.stored_files import open_stored_file, require_own_id

VERSION = 1
"""version of the file's format"""
MAX_BYTES = 1_000_000_000
MOST_RECORDS = 400
"""number of records after which the file is rewritten, with its first line"""
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
    folder: str = ""


@dataclass(frozen=True)
class Recovery:
    """Recovery of a damaged file: what was lost, and where the damaged file is."""

    message: str
    damaged_name: str
    """name of the damaged file, in the folder of the plan's file"""


class PlanFile(Closing):
    """Open file of a mission plan. Owns the file, and holds the plan's state on disk.

    Only one thread at a time may use it.
    """

    def __init__(self, path: Path, opened: "_OpenedFile", document: PlanDocument) -> None:
        self.path = path
        self.document = document
        self.recovery: Recovery | None = None
        """what was lost when the file was opened; None: nothing"""
        self._opened = opened

    def append(self, document_after: PlanDocument, record: PlanRecord) -> None:
        """Append a record to the file and sync it; `document_after` is the plan's new state.

        Raises Unavailable if the record can't be written, PlanTooLarge if the file would be too
        large to be opened again. After an error the file has the same content as before.
        """
        data = record.model_dump(mode="json")
        if self._size_with(data) > MAX_BYTES:
            self._rewrite()
        if self._size_with(data) > MAX_BYTES:
            raise PlanTooLarge(
                Message(
                    "the mission's file would have more than {max_bytes} MB: delete some of "
                    "its versions, or continue with a copy",
                    max_bytes=MAX_BYTES // 1000000,
                )
            )
        try:
            self._opened.lines.append_and_sync(data)
        except OSError as error:
            raise _write_error(self.path, error) from error
        self._opened.records += 1
        self.document = document_after
        if self._opened.must_be_rewritten:
            self._rewrite()

    def _size_with(self, data: dict[str, Any]) -> int:
        """Return the size in bytes that the file has with one more record and its mark."""
        lines = self._opened.lines
        return lines.size + len(lines.line(data)) + len(lines.line({}))

    def close(self) -> None:
        os.close(self._opened.file)

    def _rewrite(self) -> None:
        """Rewrite the file with the plan's last revisions; keep the previous file next to it."""
        try:
            written = _write_plan(self.path, self.document, KEPT_RECORDS)
        except Unavailable:
            return  # the present file is complete
        os.close(self._opened.file)
        self._opened = written


@dataclass
class _OpenedFile:
    """Open file with a writer of its further lines."""

    file: int
    lines: LineWriter
    first: int
    """size of the first line in bytes"""
    records: int
    """number of lines that are no marks"""

    @property
    def must_be_rewritten(self) -> bool:
        """True if the file has so many records or bytes that it is to be rewritten."""
        grown = self.lines.size - self.first
        return self.records > MOST_RECORDS or grown > max(MAX_GROWTH, self.first)


def write_plan_file(path: Path, document: PlanDocument) -> PlanFile:
    """Write a plan to a file, which replaces an existing one, and return it open.

    Raises Unavailable if that fails.
    """
    return PlanFile(path, _write_plan(path, document, 0), document)


def open_plan_file(path: Path) -> PlanFile:
    """Open the file of a plan for appending.

    A last line that was not written completely is cut off. If the file is damaged, its last valid
    state is opened, `recovery` states what was lost, and the damaged file is stored next to it.

    Raises:
        NotFound: There is no such file.
        Invalid: Nothing in it can be read, or another version of Argo has written it.
        Unavailable: It can't be opened or written, or is the file of another mission.
    """
    content = read_plan_bytes_or_raise(path)
    parsed = _parse(path, content)
    previous = replaced_file_path(path)
    if parsed is None and os.path.exists(previous):
        parsed_previous = _parse(path, read_plan_bytes_or_raise(previous))
        if parsed_previous is not None:
            lost = Message("its first line is damaged: this is an earlier state of the mission")
            return _recover(path, parsed_previous.document, lost)
    if parsed is None:
        raise Invalid(
            Message(
                "{path} is damaged from its first line on, and nothing in it can be read: "
                "restore it from a copy",
                path=path.name,
            )
        )
    if parsed.lost:
        return _recover(path, parsed.document, parsed.lost)
    file = _open(path, lambda path: os.open(path, _FLAGS))
    stored = parse_lines(content)  # without a last line that was never acknowledged
    try:
        lines = LineWriter(file, stored)
    except OSError as error:
        os.close(file)
        raise _write_error(path, error) from error
    opened = _OpenedFile(file, lines, stored.lines[0].end, len(stored.objects))
    return PlanFile(path, opened, parsed.document)


@dataclass(frozen=True)
class _ParsedFile:
    document: PlanDocument
    """plan in the part before the first damaged line"""
    lost: str
    """what is lost; empty if no line is damaged but the last, which was not acknowledged"""


def _parse(path: Path, content: bytes) -> _ParsedFile | None:
    """Return the plan in the valid part of a file, or None if its first line is damaged."""
    stored = parse_lines(content)
    base = parse_first_line(path, content.partition(b"\n")[0]) if stored.lines else None
    if base is None:
        return None
    base.pop("n", None)
    try:
        document = _document(PlanBase.model_validate(base))
    except ValidationError:
        return None
    for line in stored.objects[1:]:
        next_document = _apply_line(document, line)
        if next_document is None:
            count = len(stored.lines) - line.number + stored.count_after
            return _ParsedFile(document, _lost(document, line.number, count, known=True))
        document = next_document
    if not stored.damaged:
        return _ParsedFile(document, "")
    number, known = len(stored.lines), stored.was_synced
    return _ParsedFile(document, _lost(document, number, stored.count_after, known))


def _lost(document: PlanDocument, number: int, count: int, known: bool) -> str:
    """Return what is lost from the line with this number on; `known`: it was on disk once."""
    which = Message(
        "at least {counted} after the first {number}",
        counted=counted_text(count, "line"),
        number=number,
    )
    why = "" if known else Message(", as by a loss of power, not known to be on disk")
    present = Message("this is the mission at revision {revision}", revision=document.plan.revision)
    return Message(
        "the file is damaged, and the loss is {which}{why}: {present}",
        which=which,
        why=why,
        present=present,
    )


def parse_first_line(path: Path, line: bytes) -> dict[str, Any] | None:
    """Return the fields of the first line of a mission plan's file, as parsed from its JSON.

    Returns None if the line is damaged, or is not that of a mission plan. Raises Invalid if it is
    intact and has another version of the format, Unavailable if it is of another mission than
    that whose file has this path.
    """
    base = checked_object(line)
    if base is None or base.get("format") != "argo plan":
        return None
    if base.get("version") != VERSION:
        raise Invalid(
            Message(
                "the mission's file has format version {get}, but this Argo reads version "
                "{version}: open it with the Argo that wrote it",
                get=base.get("version"),
                version=VERSION,
            )
        )
    require_own_id(path, str(base.get("id")), path.stem, Message("copy the mission in the service"))
    return base


def _apply_line(document: PlanDocument, line: StoredLine) -> PlanDocument | None:
    """Return the document after the record in a line, or None if the line has no valid record."""
    try:
        return document.apply(_RECORD.validate_python(line.data))
    except ValueError:
        return None


def _document(base: PlanBase) -> PlanDocument:
    plan = MissionPlan(base.mission, base.revision)
    return PlanDocument(
        base.id, base.name, base.created, base.changed, plan, base.versions, base.folder
    )


def _recover(path: Path, document: PlanDocument, lost: str) -> PlanFile:
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
    count = len(document.plan.history)
    opened = PlanFile(path, _write_plan(path, document, count, keep_previous=False), document)
    opened.recovery = Recovery(
        Message("{lost}; the damaged file is now {damaged}", lost=lost, damaged=damaged.name),
        damaged.name,
    )
    return opened


def _write_plan(
    path: Path, document: PlanDocument, records: int, keep_previous: bool = True
) -> _OpenedFile:
    """Write the whole file, with at most `records` last revisions as records, and return it open.

    Writes under another name and renames the file at the end.
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
        folder=document.folder,
    )
    lines = complete_lines([record.model_dump(mode="json") for record in (base, *revisions)])
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
        writer = LineWriter(file, parse_lines(content))
    except OSError as error:
        os.close(file)
        draft.unlink(missing_ok=True)
        raise _write_error(path, error) from error
    return _OpenedFile(file, writer, len(lines[0]), len(lines) - 1)


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


def _open(path: Path, open_file: Callable[[Path], int]) -> int:
    try:
        return open_file(path)
    except FileNotFoundError:
        raise NotFound(Message("{path}: there is no such mission", path=path.name)) from None
    except OSError as error:
        raise Unavailable(
            Message("{path} can't be opened: {reason}", path=path.name, reason=reason_text(error))
        ) from error


def read_plan_bytes_or_raise(path: Path) -> bytes:
    """Return the bytes of a plan's file.

    Raises NotFound if there is no such file, Unavailable if it can't be read, Invalid if it is too
    large.
    """
    file = _open(path, open_stored_file)
    try:
        if os.fstat(file).st_size > MAX_BYTES:
            raise Invalid(
                Message(
                    "{path} is larger than {max_bytes} MB, the limit for a mission",
                    path=path.name,
                    max_bytes=MAX_BYTES // 1000000,
                )
            )
        parts = []
        while part := os.read(file, 1 << 20):
            parts.append(part)
    except OSError as error:
        raise Unavailable(
            Message("{path} can't be read: {reason}", path=path.name, reason=reason_text(error))
        ) from error
    finally:
        os.close(file)
    return b"".join(parts)


def _write_error(path: Path, error: OSError) -> Unavailable:
    return Unavailable(
        Message(
            "{path} can't be written: {reason}; nothing was changed. Free disk "
            "space, or choose another folder",
            path=path.name,
            reason=reason_text(error),
        )
    )
