"""Journal of a run: a file from which the run can continue after its process has died.

Each line of the file holds a checksum and JSON. The first line is the header with the spec of the
run; the file is never without a complete header. Each further line is an entry; only the last line
can be incomplete, and is cut off then. One process at a time can open a journal.
"""

import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NoReturn, Self, TypeVar

from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound, Remedy, Unavailable
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import OPEN_FLAGS, sync_folder, try_lock
from argo_compiler.base.version import __version__
from argo_env.closing import Closing
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    truncate_if_possible,
    write_all,
)
from argo_env.files.yaml_messages import error_message
from argo_env.planning.opening import OpenedSite
from argo_env.run.extensions import packages_of_run
from argo_env.run.log import Entry
from argo_env.run.observer import Observer
from argo_env.run.spec import RunSpec

VERSION = 4
"""version of the journal's format"""
MAX_BYTES = 1_000_000_000  # size of a journal; the longest run takes some 20 MB
_MARK = "argo journal"
_FLAGS = os.O_RDWR | os.O_APPEND | OPEN_FLAGS

ModelT = TypeVar("ModelT", bound=Model)


class Header(Model):
    """Header of a journal, its first line: what the run is made from."""

    format: Literal["argo journal"] = "argo journal"
    version: Literal[4] = 4
    spec: RunSpec
    fingerprints: dict[str, str]
    """digests of all that must be the same when the run continues, by names such as `mission`"""

    @classmethod
    def from_run(cls, site: OpenedSite, spec: RunSpec) -> Self:
        """Return the header of the journal of a run of the spec on the site.

        Raises ArgoError if the mission's file can't be read.
        """
        return cls(spec=spec, fingerprints=fingerprints(site, spec))


class Journal(Observer, Closing):
    """Open journal, which writes the entries of the run that it observes.

    It holds the file and its lock: close it, or use it as a context manager.
    """

    def __init__(self, path: Path, file: int, header: Header, entries: Sequence[Entry], size: int):
        self.path = path
        self.header = header
        self.entries = tuple(entries)
        """the entries in the file when it was opened"""
        self._file = file
        self._size = size
        self._lines = 1 + len(entries)

    @property
    def had_ended_when_opened(self) -> bool:
        """True if the run had ended when the journal was opened."""
        return bool(self.entries) and self.entries[-1].ended

    def on_entry(self, entry: Entry) -> None:
        """Write an entry to the file.

        When this returns, the entry survives the death of the process, and one with
        `must_survive_power_loss` a power failure too. Raises ArgoError if it can't be written;
        earlier entries stay.
        """
        line = _line(self._lines, entry)
        try:
            write_all(self._file, line)
            if entry.must_survive_power_loss:
                os.fsync(self._file)
        except OSError as error:
            truncate_if_possible(self._file, self._size)
            raise Unavailable(
                f"{self.path}: the journal can't be written any further: {error.strerror}; what "
                "was written stays, and the run can be resumed from there",
                remedies=(Remedy.RESUME,),
                about=str(self.path),
            ) from error
        self._size += len(line)
        self._lines += 1

    def require_not_ended(self) -> None:
        """Raise ArgoError if the run had ended when the journal was opened: no event can follow."""
        if self.had_ended_when_opened:
            raise Conflict(
                f"{self.path}: the run has ended, at {self.entries[-1].t:g} s: nothing more can "
                "occur in it; begin a new run with all events",
                remedies=(Remedy.RUN_ANEW,),
            )

    def require_inputs_unchanged(self, site: OpenedSite) -> None:
        """Raise ArgoError if anything that the run depends on has changed since it began.

        A file of the mission that has been removed is no change: the journal has the mission.
        """
        recorded = self.header.fingerprints
        source = self.header.spec.source
        now = fingerprints(site, self.header.spec)
        if source is not None and not os.path.isfile(source):
            now["mission file"] = recorded.get("mission file", "")
        changed = [
            f"{name} (was {recorded.get(name, 'absent')}, is {now.get(name, 'absent')})"
            for name in sorted(recorded.keys() | now.keys())
            if recorded.get(name) != now.get(name)
        ]
        if changed:
            raise Conflict(
                f"{self.path}: the run can't continue, because something has changed since it "
                f"began: {', '.join(changed)}. Restore it, or begin a new run",
                remedies=(Remedy.RUN_ANEW,),
            )

    def close(self) -> None:
        os.close(self._file)


def fingerprints(site: OpenedSite, spec: RunSpec) -> dict[str, str]:
    """Return short digests of all that a run depends on, by names such as `mission`."""
    digests = {"Argo": __version__, "mission": _digest(spec.mission.model_dump_json())}
    digests |= dict.fromkeys(packages_of_run(spec), "used")
    for name, model in (("site", site.site.spec), ("robot", site.robot)):
        for field, value in model.model_dump(mode="json").items():
            digests[f"{name}'s {field}"] = _digest(json.dumps(value))
    if site.site.altered is not None:
        digests["site's alterations"] = _digest(repr(site.site.altered))
    source = None if spec.source is None else Path(spec.source)
    if source is not None and os.path.isfile(source):  # a pipe can't be read twice
        try:
            digests["mission file"] = _digest(source.read_bytes())
        except OSError as error:
            raise Unavailable(f"{source} can't be read: {error.strerror}") from error
    return digests


def check_journal_path(path: Path, replace: bool = False) -> None:
    """Raise ArgoError if no new journal can be written at this path.

    An existing file is refused, or, with `replace`, only one that another process has open.
    """
    if replace and os.path.isfile(path):
        file = _open(path)
        try:
            _lock(file, path)
        finally:
            os.close(file)
    elif os.path.exists(path):
        raise Conflict(
            f"{path} already exists: resume that run, or choose another path",
            remedies=(Remedy.RESUME,),
            about=str(path),
        )
    if not os.path.isdir(path.parent):
        _refuse(
            path, "is in a folder that does not exist: make it, or choose another", kind=NotFound
        )
    if not os.access(path.parent, os.W_OK):
        _refuse(path, "is in a folder that can't be written to: choose another", kind=Unavailable)


def create_journal(path: Path, header: Header, replace: bool = False) -> Journal:
    """Create a journal, write its header to disk and lock the file.

    Raises ArgoError if the file can't be written, or exists already and `replace` is False or
    another process has it open.
    """
    check_journal_path(path, replace)
    # The header is first written to a draft, so that a journal is never without its header.
    draft = path.with_name(path.name + ".new")
    line = _line(0, header)
    try:
        file = os.open(draft, os.O_CREAT | _FLAGS, 0o644)
    except OSError as error:
        _refuse_writing(path, error)
    try:
        _lock(file, path)
        if os.path.exists(path) and not replace:
            # Another process was faster; its draft has become the journal.
            draft.unlink(missing_ok=True)
            check_journal_path(path)
        os.ftruncate(file, 0)
        write_all(file, line)
        os.fsync(file)
        draft.rename(path)
        sync_folder(path.parent)
    except OSError as error:
        os.close(file)
        draft.unlink(missing_ok=True)
        _refuse_writing(path, error)
    except ArgoError:
        os.close(file)
        raise
    return Journal(path, file, header, (), len(line))


def open_journal(path: Path) -> Journal:
    """Open and lock the journal of an earlier run; cut off an incomplete last line.

    Raises ArgoError if the file is no journal, is damaged, or another process has it open.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        _refuse(path, "is not a file: name a journal that a run has written", Remedy.KEEP_JOURNAL)
    file = _open(path)
    try:
        _lock(file, path)
        content = _read(file, path)
        header, entries, size = _parse(path, content)
        if size < len(content):
            os.ftruncate(file, size)
            os.fsync(file)
    except OSError as error:
        os.close(file)
        _refuse(path, f"can't be read: {error.strerror}", kind=Unavailable)
    except ArgoError:
        os.close(file)
        raise
    return Journal(path, file, header, entries, size)


def _parse(path: Path, content: bytes) -> tuple[Header, list[Entry], int]:
    """Return a journal's header and entries, and how many bytes of `content` these take together.

    The rest is an incomplete or damaged last line. Raises ArgoError for anything else.
    """
    lines = content.split(b"\n")
    # After the last line end there is nothing, or an incomplete line.
    complete = lines[:-1]
    first = checked_object(complete[0]) if complete else None
    if complete and complete[0].endswith(b"\r") and checked_object(complete[0][:-1]) is not None:
        _refuse(
            path,
            "has line ends of another system (CR LF): copy it again, with its line ends unchanged",
        )
    if first is None or first.get("format") != _MARK:
        _refuse(path, "is not a journal, or its first line is damaged: no run can continue from it")
    if first.get("version") != VERSION:
        _refuse(
            path,
            f"has version {json.dumps(first.get('version'))} of the journal's format, and this "
            f"Argo reads {VERSION}: resume it with the version of Argo that wrote it",
        )
    header = _model(Header, first, path, 0)
    entries: list[Entry] = []
    size = len(complete[0]) + 1
    for number, line in enumerate(complete[1:], start=1):
        data = checked_object(line)
        if data is None or data.pop("n", None) != number:
            if number + 1 < len(complete) or lines[-1]:
                _refuse(
                    path,
                    f"is damaged from line {number + 1} on, and this is not only an incomplete "
                    "last line: restore it from a copy",
                )
            break
        entries.append(_model(Entry, data, path, number))
        size += len(line) + 1
    return header, entries, size


def _model(cls: type[ModelT], data: dict[str, object], path: Path, number: int) -> ModelT:
    try:
        return cls.model_validate({k: v for k, v in data.items() if k != "n"})
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in fault["loc"])
        message = error_message(fault, fault["loc"])
        _refuse(path, f"has an error in line {number + 1}, {field}: {message}")


def _line(number: int, model: Model) -> bytes:
    data = {"n": number} | model.model_dump(mode="json", exclude_defaults=True)
    if isinstance(model, Header):
        data |= {"format": model.format, "version": model.version}
    return checked_line(data)


def _open(path: Path) -> int:
    try:
        return os.open(path, _FLAGS)
    except FileNotFoundError:
        raise NotFound(
            f"{path}: there is no such journal: a run writes one", remedies=(Remedy.KEEP_JOURNAL,)
        ) from None
    except OSError as error:
        _refuse(path, f"can't be opened: {error.strerror}", kind=Unavailable)


def _lock(file: int, path: Path) -> None:
    if not try_lock(file):
        _refuse(
            path,
            "is in use: another process continues this run; wait until it has ended",
            kind=Conflict,
        )


def _read(file: int, path: Path) -> bytes:
    if os.fstat(file).st_size > MAX_BYTES:
        _refuse(path, f"is larger than {MAX_BYTES // 1_000_000} MB, the maximum for a journal")
    parts = []
    while part := os.read(file, 1 << 20):
        parts.append(part)
    return b"".join(parts)


def _digest(content: str | bytes) -> str:
    data = content.encode() if isinstance(content, str) else content
    return hashlib.sha256(data).hexdigest()[:12]


def _refuse(
    path: Path, message: str, *remedies: Remedy, kind: type[ArgoError] = Invalid
) -> NoReturn:
    raise kind(f"{path} {message}", remedies=remedies) from None


def _refuse_writing(path: Path, error: OSError) -> NoReturn:
    _refuse(path, f"can't be written: {error.strerror}; choose another place", kind=Unavailable)
