"""Folder with the mission plans of a service, and a bin for deleted ones."""

import os
import re
import stat
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import Conflict, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.operating_system import NO_LINK_FLAGS, sync_folder, try_lock
from argo_compiler.il import Mission
from argo_env.closing import Closing
from argo_env.files.folders import make_private_folder
from argo_planner.service.core.document import PlanDocument
from argo_planner.service.core.plan import MissionPlan
from argo_planner.service.core.plan_limits import require_displayable_name
from argo_planner.service.storage.outline import (
    PlanSummary,
    measured_checkpoints,
    read_plan_summary,
)
from argo_planner.service.storage.plan_file import PlanFile, open_plan_file, write_plan_file

MOST_PLANS = 2_000
"""plans in a folder, and as many in its bin"""
PLAN_ID = r"[0-9a-f]{12}"
"""regular expression for the id of a plan"""
_BIN = "bin"
_SUBFOLDERS = (_BIN, "drafts", "evaluations", "notes", "orders", "runs")
_SUFFIX = ".plan"


@dataclass(frozen=True)
class _CachedSummary:
    """Summary of a plan's file, and the file's state when it was read."""

    state: tuple[int, int, int]
    """modification time in ns, size in bytes, and inode"""
    summary: PlanSummary


class PlanFolder(Closing):
    """Folder with mission plans. Holds a lock, so that only one service at a time uses it.

    Only one thread at a time may use it. It does not follow links.
    """

    def __init__(self, path: Path, new_id: Callable[[], str]) -> None:
        """Open the folder, and create it if needed.

        Raises Conflict if another service uses it, Unavailable if it can't be written to, or a
        link or a file is in the place of one of its folders.
        """
        self.path = path
        self._new_id = new_id
        self._cache: dict[Path, _CachedSummary] = {}
        for name in _SUBFOLDERS:
            if os.path.lexists(path / name) and (
                os.path.islink(path / name) or not os.path.isdir(path / name)
            ):
                raise Unavailable(
                    Message(
                        "{path} is not a folder, or a link, which is not followed: move it away",
                        path=path / name,
                    )
                )
        try:
            make_private_folder(path / _BIN)
            self._lock = os.open(path / ".lock", os.O_RDWR | os.O_CREAT | NO_LINK_FLAGS, 0o600)
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path} can't be used as a folder of missions: {reason}; choose another",
                    path=path,
                    reason=reason_text(error),
                )
            ) from error
        if not try_lock(self._lock):
            os.close(self._lock)
            raise Conflict(
                Message(
                    "{path}: another service uses this folder: stop it, or choose another folder",
                    path=path,
                )
            )

    def close(self) -> None:
        os.close(self._lock)

    def list_plans(self, open_plans: Mapping[str, PlanSummary] | None = None) -> list[PlanSummary]:
        """Return summaries of all plans, the last changed ones first.

        `open_plans` has the summaries of open plans by their ids; their files are not read.
        """
        return self._summaries(self.path, open_plans or {})

    def list_deleted(self) -> list[PlanSummary]:
        """Return summaries of the deleted plans, which are in the bin, the last changed ones first.

        The time at which a plan was deleted does not count as a change.
        """
        return self._summaries(self.path / _BIN, {})

    def create(self, name: str, mission: Mission, at: datetime, folder: str = "") -> PlanFile:
        """Create a plan with a new id, and return its open file.

        `folder` is that of the list of missions. Raises Invalid if the text can't be its name,
        Conflict if the folder on disk has MOST_PLANS plans (those in the bin don't count),
        Unavailable if the file can't be written.
        """
        require_displayable_name(name, Message("the mission"))
        if sum(1 for _ in _files(self.path)) >= MOST_PLANS:
            raise Conflict(
                Message(
                    "there are {most_plans} missions: delete some of them first",
                    most_plans=MOST_PLANS,
                )
            )
        id = self._free_id()
        document = PlanDocument(id, name, at, at, MissionPlan(mission), folder=folder)
        return write_plan_file(self._path(id), document)

    def open(self, id: str) -> PlanFile:
        """Open the file of a plan; raises NotFound, or the other errors of `open_plan_file`."""
        path = self._path(id)
        _require_file(path, id)
        return open_plan_file(path)

    def delete(self, id: str) -> None:
        """Move a plan to the bin.

        Raises NotFound if there is no such plan, Conflict if the bin is full or has it already,
        Unavailable if the file can't be moved.
        """
        if sum(1 for _ in _files(self.path / _BIN)) >= MOST_PLANS:
            raise Conflict(
                Message(
                    "there are {most_plans} missions in the bin: empty it first",
                    most_plans=MOST_PLANS,
                )
            )
        self._move(self._path(id), self._deleted_path(id), id)

    def restore(self, id: str) -> None:
        """Move a plan out of the bin, even if the folder then has more than MOST_PLANS plans.

        Raises NotFound if the bin does not have it, Conflict if the folder has it as well,
        Unavailable if it can't be opened or moved; nothing is moved then.
        """
        path = self._deleted_path(id)
        _require_file(path, id)
        if problem := read_plan_summary(path).problem:
            raise Unavailable(problem)
        self._move(path, self._path(id), id)

    def delete_from_bin(self, id: str) -> None:
        """Delete a plan in the bin permanently; raises NotFound if the bin does not have it."""
        path = self._deleted_path(id)
        _require_file(path, id)
        for other in (path, *_companion_files(path)):
            other.unlink(missing_ok=True)

    def _move(self, source: Path, target: Path, id: str) -> None:
        _require_file(source, id)
        if os.path.lexists(target):
            raise Conflict(
                Message(
                    "{target} exists already: move it away, or {source}",
                    target=target,
                    source=source,
                )
            )
        try:
            for other in _companion_files(source):
                other.replace(target.parent / other.name)
            source.replace(target)
            sync_folder(source.parent)
            sync_folder(target.parent)
        except OSError as error:
            raise Unavailable(
                Message("mission {id} can't be moved: {reason}", id=id, reason=reason_text(error))
            ) from error

    def _summaries(self, folder: Path, open_plans: Mapping[str, PlanSummary]) -> list[PlanSummary]:
        paths = {*_files(folder)}
        for removed in [p for p in self._cache if p.parent == folder and p not in paths]:
            del self._cache[removed]
        summaries = (open_plans.get(path.stem) or self._summary(path) for path in paths)
        existing = [summary for summary in summaries if summary is not None]
        return sorted(
            existing, key=lambda s: (s.changed is not None, s.changed, s.id), reverse=True
        )

    def _summary(self, path: Path) -> PlanSummary | None:
        """Return the summary, or None if the file was removed in the meantime."""
        try:
            status = path.lstat()
            state = (status.st_mtime_ns, status.st_size, status.st_ino)
            cached = self._cache.get(path)
            if cached is None or cached.state != state:
                cached = _CachedSummary(state, read_plan_summary(path))
                self._cache[path] = cached
        except (FileNotFoundError, NotFound):
            return None
        return cached.summary

    def _free_id(self) -> str:
        while True:
            id = self._new_id()
            if not any(map(os.path.lexists, (self._path(id), self._deleted_path(id)))):
                return id

    def _path(self, id: str) -> Path:
        return self.path / (_require_id(id) + _SUFFIX)

    def _deleted_path(self, id: str) -> Path:
        return self.path / _BIN / (_require_id(id) + _SUFFIX)


def summarize_plan(document: PlanDocument) -> PlanSummary:
    """Return the summary of a plan for lists."""
    return PlanSummary(
        id=document.id,
        name=document.name,
        created=document.created,
        changed=document.changed,
        revision=document.plan.revision,
        tasks=len(document.plan.mission.tasks),
        checkpoints=measured_checkpoints(task.object_id for task in document.plan.mission.tasks),
        folder=document.folder,
    )


def _files(folder: Path) -> Iterator[Path]:
    with os.scandir(folder) as entries:
        for entry in entries:
            has_plan_name = re.fullmatch(PLAN_ID + re.escape(_SUFFIX), entry.name)
            if has_plan_name and _is_regular_file(entry):
                yield folder / entry.name


def _is_regular_file(entry: os.DirEntry[str]) -> bool:
    """Return True if the entry still exists and is a file, not a link to one."""
    try:
        return stat.S_ISREG(entry.stat(follow_symlinks=False).st_mode)
    except FileNotFoundError:
        return False


def _companion_files(path: Path) -> list[Path]:
    """Return the files that belong to a plan's file, such as its previous and damaged states."""
    return [other for other in path.parent.glob(f"{path.name}.*") if os.path.isfile(other)]


def _require_file(path: Path, id: str) -> None:
    if os.path.islink(path) or not os.path.isfile(path):
        raise NotFound(Message("there is no mission {id} here", id=id))


def _require_id(id: str) -> str:
    if not re.fullmatch(PLAN_ID, id):
        raise NotFound(Message("there is no mission {id} here", id=repr(id[:40])))
    return id
