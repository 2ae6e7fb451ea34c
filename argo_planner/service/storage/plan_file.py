"""The file of one plan: a line with the plan as it was once, and a line for each record since.

A record that has been written and synced survives the process and the machine. From time to time
the file is written anew with fewer records; the one before is kept beside it.
"""

import os
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

from pydantic import TypeAdapter, ValidationError

from argo_compiler.base.errors import Invalid, NotFound, Unavailable
from argo_compiler.base.model import Model
from argo_compiler.base.version import __version__
from argo_compiler.il import Mission
from argo_env.closing import Closing
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    cut_off,
    sync_folder,
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
"""of the file's format"""
MAX_BYTES = 1_000_000_000
MOST_RECORDS = 400
"""after which the file is written anew"""
MOST_GROWN = 16_000_000
"""bytes of records after which it is, too, or as many as its first line has where that is more"""
KEPT_RECORDS = 100
"""revisions that can still be undone then; fewer, where they have more than half of those bytes"""
_FLAGS = os.O_RDWR | os.O_APPEND | os.O_CLOEXEC | os.O_NOFOLLOW
_RECORD: TypeAdapter[PlanRecord] = TypeAdapter(PlanRecord)


class PlanBase(Model):
    """The first line: the plan as it was before the records that follow."""

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
    """What was lost of a damaged file."""

    message: str
    kept_as: str
    """name of the damaged file, beside the plan's"""


@dataclass(frozen=True)
class PlanExtent:
    """How large a file is."""

    first: int
    """bytes of its first line"""
    size: int
    """bytes"""
    lines: int

    @property
    def has_grown(self) -> bool:
        """Whether it is time to write it anew."""
        grown = self.size - self.first
        return self.lines > MOST_RECORDS or grown > max(MOST_GROWN, self.first)


class PlanFile(Closing):
    """An open file of a plan. Holds the file and the plan as it is on disk; one thread at a time
    may use it."""

    def __init__(self, path: Path, file: int, document: PlanDocument, extent: PlanExtent) -> None:
        self.path = path
        self.document = document
        self.recovery: Recovery | None = None
        """what was lost when it was opened, if anything was"""
        self._file = file
        self._extent = extent

    def append(self, document: PlanDocument, record: PlanRecord) -> None:
        """Writes a record, after which the plan is the document. When this returns, it is on disk.

        Raises Unavailable if it can't be written, PlanTooLarge if it could not be opened again; the
        file is as it was then.
        """
        data = record.model_dump(mode="json")
        line = checked_line({"n": self._extent.lines} | data)
        if self._extent.size + len(line) > MAX_BYTES:
            self._write_anew()
            line = checked_line({"n": self._extent.lines} | data)
        extent = self._extent
        if extent.size + len(line) > MAX_BYTES:
            raise PlanTooLarge(
                f"the mission's file would have more than {MAX_BYTES // 1_000_000} MB: drop some "
                "of its versions, or go on with a copy"
            )
        try:
            write_all(self._file, line)
            os.fdatasync(self._file)
        except OSError as error:
            cut_off(self._file, extent.size)
            raise _unwritten(self.path, error) from error
        self._extent = PlanExtent(extent.first, extent.size + len(line), extent.lines + 1)
        self.document = document
        if self._extent.has_grown:
            self._write_anew()

    def close(self) -> None:
        os.close(self._file)

    def _write_anew(self) -> None:
        """Writes the plan with its last revisions; the file before stays beside it."""
        try:
            written = _written(self.path, self.document, KEPT_RECORDS)
        except Unavailable:
            return  # all is in the file that there is
        os.close(self._file)
        self._file, self._extent = written


def create_plan_file(path: Path, document: PlanDocument) -> PlanFile:
    """A new file with the plan. Raises Unavailable if it can't be written."""
    file, extent = _written(path, document, 0)
    return PlanFile(path, file, document, extent)


def open_plan_file(path: Path) -> PlanFile:
    """The file of a plan, ready for more. What was not written to its end is cut off. Of a damaged
    one the last good state is opened, and `recovery` says what was lost; the damaged file is kept.

    Raises:
        NotFound: there is no such file.
        Invalid: nothing of it can be read.
        Unavailable: it can't be opened or written.
    """
    content = plan_content(path)
    read = _read(content)
    earlier = earlier_file(path)
    if read is None and os.path.exists(earlier):
        before = _read(plan_content(earlier))
        if before is not None:
            lost = "its first line is damaged: this is how the mission was some time before"
            return _recovered(path, before, lost)
    if read is None:
        raise Invalid(
            f"{path.name}: is damaged from its first line on, and nothing of it can be read: "
            "take it from a copy"
        )
    if read.lost:
        lost = (
            f"{read.lost} of {read.lost + read.extent.lines} lines are damaged or follow a damaged "
            f"one: this is the mission at revision {read.document.plan.revision}"
        )
        return _recovered(path, read, lost)
    file = _open(path)
    if read.extent.size < len(content):
        os.ftruncate(file, read.extent.size)  # what nobody was told was written
        os.fsync(file)
    return PlanFile(path, file, read.document, read.extent)


@dataclass(frozen=True)
class _Read:
    document: PlanDocument
    extent: PlanExtent
    """as far as it is good"""
    lost: int
    """lines, which were whole once"""


def _read(content: bytes) -> _Read | None:
    """The plan in a file as far as it is good; None if its first line is not."""
    whole = content.split(b"\n")[:-1]  # what is behind the last of them was torn off
    base = base_object(whole[0]) if whole else None
    if base is None:
        return None
    base.pop("n", None)
    try:
        document = _document(PlanBase.model_validate(base))
    except ValidationError:
        return None
    first = size = len(whole[0]) + 1
    for number, line in enumerate(whole[1:], start=1):
        following = _following(document, line, number)
        if following is None:
            return _Read(document, PlanExtent(first, size, number), len(whole) - number)
        document = following
        size += len(line) + 1
    return _Read(document, PlanExtent(first, size, len(whole)), 0)


def base_object(line: bytes) -> dict[str, Any] | None:
    """What the first line of a plan's file has; None if it is none. Raises Invalid if another
    version of Argo has written it."""
    base = checked_object(line)
    if base is None or base.get("format") != "argo plan":
        return None
    if base.get("version") != VERSION:
        raise Invalid(
            f"the plan has version {base.get('version')} of its format, and this Argo reads "
            f"{VERSION}: open it with the Argo that wrote it"
        )
    return base


def _following(document: PlanDocument, line: bytes, number: int) -> PlanDocument | None:
    """The document after the record in a line; None if there is no such record."""
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


def _recovered(path: Path, read: _Read, lost: str) -> PlanFile:
    """The file with what is good of it, the damaged one kept beside it."""
    aside = next(
        name
        for k in range(1, 10_000)
        if not os.path.lexists(name := path.with_name(f"{path.name}.damaged-{k}"))
    )
    try:
        os.link(path, aside, follow_symlinks=False)
    except OSError as error:
        raise _unwritten(path, error) from error
    kept = len(read.document.plan.history)
    file, extent = _written(path, read.document, kept, keep_before=False)
    opened = PlanFile(path, file, read.document, extent)
    opened.recovery = Recovery(f"{lost}; the damaged file is kept as {aside.name}", aside.name)
    return opened


def _written(
    path: Path, document: PlanDocument, records: int, keep_before: bool = True
) -> tuple[int, PlanExtent]:
    """Writes the whole file, with the last revisions as records, under another name, then gives it
    its own. Returns the open file, and how large it is."""
    plan = document.plan
    made = _last_made(plan, records)
    begins = plan.plan_before(made[0].revision.number) if made else plan
    base = PlanBase.model_construct(
        id=document.id,
        name=document.name,
        created=document.created,
        changed=document.changed,
        revision=begins.revision,
        mission=begins.mission,
        versions=document.versions,
    )
    lines = [
        checked_line({"n": number} | record.model_dump(mode="json"))
        for number, record in enumerate((base, *made))
    ]
    content = b"".join(lines)
    draft = path.with_name(f"{path.name}.new")
    try:
        draft.unlink(missing_ok=True)
        file = os.open(draft, os.O_CREAT | os.O_EXCL | _FLAGS, 0o600)
    except OSError as error:
        raise _unwritten(path, error) from error
    try:
        write_all(file, content)
        os.fsync(file)
        if keep_before and os.path.exists(path):
            earlier_file(path).unlink(missing_ok=True)
            os.link(path, earlier_file(path), follow_symlinks=False)
        draft.replace(path)
        sync_folder(path.parent)
    except OSError as error:
        os.close(file)
        draft.unlink(missing_ok=True)
        raise _unwritten(path, error) from error
    return file, PlanExtent(len(lines[0]), len(content), len(lines))


def _last_made(plan: MissionPlan, most: int) -> list[RevisionMade]:
    """The last revisions as records: at most so many, and not too large together."""
    found: list[RevisionMade] = []
    size = 0
    for revision in reversed(plan.history[-most:] if most else ()):
        made = RevisionMade.model_construct(revision=revision)
        size += len(made.model_dump_json())
        if found and size > MOST_GROWN // 2:
            break
        found.append(made)
    return found[::-1]


def earlier_file(path: Path) -> Path:
    """Where the file is kept that a plan's file took the place of."""
    return path.with_name(f"{path.name}.before")


def _open(path: Path, flags: int = _FLAGS) -> int:
    try:
        return os.open(path, flags)
    except FileNotFoundError:
        raise NotFound(f"{path.name}: there is no such mission") from None
    except OSError as error:
        raise Unavailable(f"{path.name}: can't be opened: {error.strerror}") from error


def plan_content(path: Path) -> bytes:
    """The bytes of a plan's file. Raises NotFound, Unavailable, Invalid if it is too large."""
    file = _open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW)
    try:
        if os.fstat(file).st_size > MAX_BYTES:
            raise Invalid(f"{path.name}: is larger than {MAX_BYTES // 1_000_000} MB: no plan is")
        parts = []
        while part := os.read(file, 1 << 20):
            parts.append(part)
    except OSError as error:
        raise Unavailable(f"{path.name}: can't be read: {error.strerror}") from error
    finally:
        os.close(file)
    return b"".join(parts)


def _unwritten(path: Path, error: OSError) -> Unavailable:
    return Unavailable(
        f"{path.name}: can't be written: {error.strerror}; nothing was changed. Make room, or "
        "choose another folder"
    )
