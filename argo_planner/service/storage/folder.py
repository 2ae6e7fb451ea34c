"""A folder with the plans of a service, and a bin for those that were deleted."""

import fcntl
import os
import re
import stat
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_compiler.il import Mission
from argo_env.closing import Closing
from argo_env.files.checked_lines import sync_folder
from argo_planner.service.core.document import PlanDocument
from argo_planner.service.core.plan import MissionPlan
from argo_planner.service.core.plan_limits import require_name
from argo_planner.service.storage.outline import PlanSummary, read_outline
from argo_planner.service.storage.plan_file import PlanFile, create_plan_file, open_plan_file

MOST_PLANS = 2_000
"""in a folder, and in its bin"""
PLAN_ID = r"[0-9a-f]{12}"
"""what a plan's id looks like, as a regular expression"""
_BIN = "bin"
_SUFFIX = ".plan"


@dataclass(frozen=True)
class _Known:
    """What was read of a file, and the state that it was in."""

    state: tuple[int, int, int]
    summary: PlanSummary


class PlanFolder(Closing):
    """A folder with plans. Holds a lock, so that one service at a time has it; one thread at a
    time may use it. Links in it are not followed."""

    def __init__(self, path: Path, new_id: Callable[[], str]) -> None:
        """Opens the folder, or makes it. Raises Conflict if another service has it, Unavailable if
        it can't be written to."""
        self.path = path
        self._new_id = new_id
        self._known: dict[Path, _Known] = {}
        try:
            (path / _BIN).mkdir(parents=True, exist_ok=True)
            self._lock = os.open(
                path / ".lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW, 0o600
            )
        except OSError as error:
            raise Unavailable(
                f"{path}: can't be used as a folder of missions: {error.strerror}; choose another"
            ) from error
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(self._lock)
            raise Conflict(
                f"{path}: another service has this folder: end that one, or choose another folder"
            ) from None

    def close(self) -> None:
        os.close(self._lock)

    def plans(self, opened: Mapping[str, PlanSummary] | None = None) -> list[PlanSummary]:
        """All of them, the newest ones first. Files of those that are open are not read."""
        return self._listed(self.path, opened or {})

    def deleted(self) -> list[PlanSummary]:
        """Those in the bin, the newest ones first."""
        return self._listed(self.path / _BIN, {})

    def create(self, name: str, mission: Mission, at: datetime) -> PlanFile:
        """A new plan. Raises Invalid for what can't be its name, Conflict if the folder is full."""
        require_name(name, "the mission")
        if sum(1 for _ in _files(self.path)) >= MOST_PLANS:
            raise Conflict(f"there are {MOST_PLANS} missions: delete some of them first")
        id = self._free_id()
        document = PlanDocument(id, name, at, at, MissionPlan(mission))
        return create_plan_file(self._path(id), document)

    def open(self, id: str) -> PlanFile:
        """The plan with that id. Raises NotFound, or what `open_plan_file` raises."""
        path = self._path(id)
        _require_file(path, id)
        return open_plan_file(path)

    def delete(self, id: str) -> None:
        """Moves a plan to the bin. Raises NotFound, Conflict if the bin
        is full."""
        if sum(1 for _ in _files(self.path / _BIN)) >= MOST_PLANS:
            raise Conflict(f"there are {MOST_PLANS} missions in the bin: empty it first")
        self._move(self._path(id), self._deleted_path(id), id)

    def restore(self, id: str) -> None:
        """Takes a plan out of the bin. Raises NotFound."""
        self._move(self._deleted_path(id), self._path(id), id)

    def destroy(self, id: str) -> None:
        """Deletes a plan in the bin for good. Raises NotFound."""
        path = self._deleted_path(id)
        _require_file(path, id)
        for other in (path, *_beside(path)):
            other.unlink(missing_ok=True)

    def _move(self, source: Path, target: Path, id: str) -> None:
        _require_file(source, id)
        try:
            for other in _beside(source):
                other.replace(target.parent / other.name)
            source.replace(target)
            sync_folder(source.parent)
            sync_folder(target.parent)
        except OSError as error:
            raise Unavailable(f"mission {id} can't be moved: {error.strerror}") from error

    def _listed(self, folder: Path, opened: Mapping[str, PlanSummary]) -> list[PlanSummary]:
        paths = {*_files(folder)}
        for gone in [p for p in self._known if p.parent == folder and p not in paths]:
            del self._known[gone]
        summaries = (opened.get(path.stem) or self._summary(path) for path in paths)
        found = [summary for summary in summaries if summary is not None]
        return sorted(found, key=lambda s: (s.changed is not None, s.changed, s.id), reverse=True)

    def _summary(self, path: Path) -> PlanSummary | None:
        """None: it has gone meanwhile."""
        try:
            status = path.lstat()
            state = (status.st_mtime_ns, status.st_size, status.st_ino)
            known = self._known.get(path)
            if known is None or known.state != state:
                known = _Known(state, read_outline(path))
                self._known[path] = known
        except (FileNotFoundError, NotFound):
            return None
        return known.summary

    def _free_id(self) -> str:
        while True:
            id = self._new_id()
            if not any(map(os.path.lexists, (self._path(id), self._deleted_path(id)))):
                return id

    def _path(self, id: str) -> Path:
        return self.path / (_checked(id) + _SUFFIX)

    def _deleted_path(self, id: str) -> Path:
        return self.path / _BIN / (_checked(id) + _SUFFIX)


def summary_of(document: PlanDocument) -> PlanSummary:
    """What a list shows of a plan."""
    return PlanSummary(
        id=document.id,
        name=document.name,
        created=document.created,
        changed=document.changed,
        revision=document.plan.revision,
        tasks=len(document.plan.mission.tasks),
    )


def _files(folder: Path) -> Iterator[Path]:
    with os.scandir(folder) as entries:
        for entry in entries:
            named = re.fullmatch(PLAN_ID + re.escape(_SUFFIX), entry.name)
            if named and _is_own(entry):
                yield folder / entry.name


def _is_own(entry: os.DirEntry[str]) -> bool:
    """Whether it is a file that is still there, and no link to one."""
    try:
        return stat.S_ISREG(entry.stat(follow_symlinks=False).st_mode)
    except FileNotFoundError:
        return False


def _beside(path: Path) -> list[Path]:
    """What belongs to a plan's file besides itself."""
    return [other for other in path.parent.glob(f"{path.name}.*") if os.path.isfile(other)]


def _require_file(path: Path, id: str) -> None:
    if os.path.islink(path) or not os.path.isfile(path):
        raise NotFound(f"there is no mission {id} here")


def _checked(id: str) -> str:
    if not re.fullmatch(PLAN_ID, id):
        raise NotFound(f"there is no mission {id[:40]!r} here")
    return id
