"""Journal of a run: a file from which the run can continue after its process has died.

Each line of the file holds a checksum and JSON. The first line is the header with the spec of the
run; the file is never without a complete header. Each further line is an entry, or a mark that the
file was synced (see `checked_lines`). If the process is killed, only the last line can be
incomplete. After a loss of power, lines after the last synced one can be damaged. A run that
continues cuts off both, with all that follows. One process at a time can open a journal.
"""

import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Literal, NoReturn, Self, TypeVar

from pydantic import ValidationError

from argo_compiler.base.errors import (
    ArgoError,
    Conflict,
    Invalid,
    NotFound,
    Remedy,
    Unavailable,
    reason_text,
)
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import OPEN_FLAGS, sync_folder, try_lock
from argo_compiler.base.quantity_text import counted_text
from argo_compiler.base.version import __version__
from argo_env.closing import Closing
from argo_env.files.checked_lines import (
    LineWriter,
    StoredLines,
    checked_object,
    complete_lines,
    parse_lines,
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

    def __init__(
        self, path: Path, file: int, header: Header, entries: Sequence[Entry], stored: StoredLines
    ):
        self.path = path
        self.header = header
        self.entries = tuple(entries)
        """the entries in the file when it was opened"""
        self.loss = _loss(path, entries, stored) if stored.damaged else ""
        """what was lost when the file was opened, as by a loss of power; empty: nothing"""
        self._file = file
        self._stored = stored
        self._lines: LineWriter | None = None
        """writer of further entries; the first one cuts off what is damaged"""

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
        data = entry.model_dump(mode="json", exclude_defaults=True)
        try:
            if self._lines is None:
                self._lines = LineWriter(self._file, self._stored)
            if entry.must_survive_power_loss:
                self._lines.append_and_sync(data)
            else:
                self._lines.append(data)
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path}: the journal can't be written any further: {reason}; what was "
                    "written stays, and the run can be resumed from there",
                    path=self.path,
                    reason=reason_text(error),
                ),
                remedies=(Remedy.RESUME,),
                about=str(self.path),
            ) from error

    def require_not_ended(self) -> None:
        """Raise ArgoError if the run had ended when the journal was opened: no event can follow."""
        if self.had_ended_when_opened:
            raise Conflict(
                Message(
                    "{path}: the run has ended, at {t:g} s: nothing more can occur in it; "
                    "begin a new run with all events",
                    path=self.path,
                    t=self.entries[-1].t,
                ),
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
            Message(
                "{name} (was {get}, is {get_2})",
                name=name,
                get=recorded.get(name, "absent"),
                get_2=now.get(name, "absent"),
            )
            for name in sorted(recorded.keys() | now.keys())
            if recorded.get(name) != now.get(name)
        ]
        if changed:
            raise Conflict(
                Message(
                    "{path}: the run can't continue, because something has changed since it "
                    "began: {changed}. Restore it, or begin a new run",
                    path=self.path,
                    changed=Listing(changed),
                ),
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
            raise Unavailable(
                Message(
                    "{source} can't be read: {reason}", source=source, reason=reason_text(error)
                )
            ) from error
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
            Message("{path} already exists: resume that run, or choose another path", path=path),
            remedies=(Remedy.RESUME,),
            about=str(path),
        )
    if not os.path.isdir(path.parent):
        _refuse(
            path,
            Message("is in a folder that does not exist: make it, or choose another"),
            kind=NotFound,
        )
    if not os.access(path.parent, os.W_OK):
        _refuse(
            path,
            Message("is in a folder that can't be written to: choose another"),
            kind=Unavailable,
        )


def create_journal(path: Path, header: Header, replace: bool = False) -> Journal:
    """Create a journal, write its header to disk and lock the file.

    Raises ArgoError if the file can't be written, or exists already and `replace` is False or
    another process has it open.
    """
    check_journal_path(path, replace)
    # The header is first written to a draft, so that a journal is never without its header.
    draft = path.with_name(path.name + ".new")
    fields = header.model_dump(mode="json", exclude_defaults=True)
    fields |= {"format": header.format, "version": header.version}
    content = b"".join(complete_lines([fields]))
    try:
        file = os.open(draft, os.O_CREAT | _FLAGS, 0o600)
    except OSError as error:
        _refuse_writing(path, error)
    try:
        _lock(file, path)
        if os.path.exists(path) and not replace:
            # Another process was faster; its draft has become the journal.
            draft.unlink(missing_ok=True)
            check_journal_path(path)
        os.ftruncate(file, 0)
        write_all(file, content)
        os.fsync(file)
        draft.rename(path)
        sync_folder(path.parent)
        return Journal(path, file, header, (), parse_lines(content))
    except OSError as error:
        os.close(file)
        draft.unlink(missing_ok=True)
        _refuse_writing(path, error)
    except ArgoError:
        os.close(file)
        raise


def open_journal(path: Path) -> Journal:
    """Open and lock the journal of an earlier run.

    Its entries are those before what a loss of power has damaged, which its `loss` tells. The file
    is changed only when an entry is written.

    Raises ArgoError if the file is no journal, is damaged, or another process has it open.
    """
    if os.path.exists(path) and not os.path.isfile(path):
        _refuse(
            path,
            Message("is not a file: name a journal that a run has written"),
            Remedy.KEEP_JOURNAL,
        )
    file = _open(path)
    try:
        _lock(file, path)
        return Journal(path, file, *_parse(path, _read(file, path)))
    except OSError as error:
        os.close(file)
        _refuse(
            path, Message("can't be read: {reason}", reason=reason_text(error)), kind=Unavailable
        )
    except ArgoError:
        os.close(file)
        raise


def _parse(path: Path, content: bytes) -> tuple[Header, list[Entry], StoredLines]:
    """Return a journal's header, its entries before the first damaged line, and all its lines.

    Raises ArgoError if a line is damaged that was synced, or the file is no journal.
    """
    stored = parse_lines(content)
    lines = stored.objects
    first = lines[0].data if lines and lines[0].number == 0 else None
    start = content[: content.find(b"\n")]
    if start.endswith(b"\r") and checked_object(start[:-1]) is not None:
        _refuse(
            path,
            Message(
                "has line ends of another system (CR LF): copy it again, with its line "
                "ends unchanged"
            ),
        )
    if first is None or first.get("format") != _MARK:
        _refuse(
            path,
            Message("is not a journal, or its first line is damaged: no run can continue from it"),
        )
    if first.get("version") != VERSION:
        _refuse(
            path,
            Message(
                "has version {dumps} of the journal's format, and this Argo reads "
                "{version}: resume it with the version of Argo that wrote it",
                dumps=json.dumps(first.get("version")),
                version=VERSION,
            ),
        )
    header = _model(Header, first, path, 0)
    if stored.was_synced:
        _refuse(
            path,
            Message(
                "is damaged from line {count} on, though {synced} lines were on disk: this "
                "is no loss of power, and no run can continue from it: restore it from a "
                "copy",
                count=len(stored.lines) + 1,
                synced=stored.synced,
            ),
        )
    return header, [_model(Entry, line.data, path, line.number) for line in lines[1:]], stored


def _loss(path: Path, entries: Sequence[Entry], stored: StoredLines) -> str:
    """Return what a loss of power has damaged in a journal, and where its run continues."""
    at = entries[-1].t if entries else 0.0
    then = Message(
        "the run {part} at {at:g} s",
        part=Message("had ended") if entries and entries[-1].ended else Message("continues"),
        at=at,
    )
    times = [line.data["t"] for line in stored.later if isinstance(line.data.get("t"), float | int)]
    until = Message(", with what the run did until {max:g} s", max=max(times)) if times else ""
    return Message(
        "{path}: damaged from line {count} on, as by a loss of power: the loss is "
        "at least {counted}, not known to be on disk{until}. All lines before are "
        "whole: {then}",
        path=path,
        count=len(stored.lines) + 1,
        counted=counted_text(stored.count_after, "line"),
        until=until,
        then=then,
    )


def _model(cls: type[ModelT], data: dict[str, object], path: Path, number: int) -> ModelT:
    try:
        return cls.model_validate(data)
    except ValidationError as error:
        fault = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in fault["loc"])
        message = error_message(fault, fault["loc"])
        _refuse(
            path,
            Message(
                "has an error in line {number}, {field}: {message}",
                number=number + 1,
                field=field,
                message=message,
            ),
        )


def _open(path: Path) -> int:
    try:
        return os.open(path, _FLAGS)
    except FileNotFoundError:
        raise NotFound(
            Message("{path}: there is no such journal: a run writes one", path=path),
            remedies=(Remedy.KEEP_JOURNAL,),
        ) from None
    except OSError as error:
        _refuse(
            path, Message("can't be opened: {reason}", reason=reason_text(error)), kind=Unavailable
        )


def _lock(file: int, path: Path) -> None:
    if not try_lock(file):
        _refuse(
            path,
            Message("is in use: another process continues this run; wait until it has ended"),
            kind=Conflict,
        )


def _read(file: int, path: Path) -> bytes:
    if os.fstat(file).st_size > MAX_BYTES:
        _refuse(
            path,
            Message(
                "is larger than {max_bytes} MB, the maximum for a journal",
                max_bytes=MAX_BYTES // 1000000,
            ),
        )
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
    raise kind(Message("{path} {message}", path=path, message=message), remedies=remedies) from None


def _refuse_writing(path: Path, error: OSError) -> NoReturn:
    _refuse(
        path,
        Message("can't be written: {reason}; choose another place", reason=reason_text(error)),
        kind=Unavailable,
    )
