"""The runs of a service on disk.

Each run has a folder with its order, its journals, its report, and the requests to it. A request is
written before the run's process gets it.
"""

import asyncio
import logging
import os
import re
import shutil
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.operating_system import NO_LINK_FLAGS, sync_folder
from argo_compiler.files.atomic_write import write_atomically
from argo_env.files.checked_files import (
    check_page,
    checked_json,
    unchecked_json,
)
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    truncate_if_possible,
    write_all,
)
from argo_env.files.folders import make_private_folder
from argo_env.report.files import PAGE, RECORD
from argo_env.run.journal import open_journal
from argo_env.run.log import Entry
from argo_planner.service.runs.requests import RequestState, RunOrder
from argo_planner.service.runs.state import RunState, RunStatus, RunSummary
from argo_planner.service.runs.worker import journal_paths, load_entries
from argo_planner.service.storage.stored_files import (
    read_stored,
    read_stored_bytes,
    remove_if_empty,
    require_own_id,
)

T = TypeVar("T")
_log = logging.getLogger(__name__)
RUN_ID = r"[0-9]{8}-[0-9]{6}-[0-9a-f]{4}"
"""regular expression for the id of a run: its start in UTC, and a random part"""
_RUN_FILE = "run.json"
_REQUEST_FILE = "requests"
_REMEDY = Message(
    "restore it from a copy, or resume the newest journal in its folder with `argo resume`"
)
_REPORT_REMEDY = Message(
    "write it again, from the newest journal in its folder, with `argo resume`"
)
_FLAGS = os.O_RDWR | os.O_APPEND | os.O_CREAT | NO_LINK_FLAGS


class StoredRun(Model):
    """Run as it is stored: its order, and its state when an essential field last changed."""

    order: RunOrder
    state: RunState


class RequestFile:
    """File of lines with checksums, each the state of a request; the last line of an id counts."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def append(self, requests: Sequence[RequestState]) -> None:
        """Append states of requests and sync the file.

        Raises Unavailable if the file can't be written; it is then cut back to its old length.
        """
        lines = b"".join(checked_line(request.model_dump(mode="json")) for request in requests)
        try:
            file = os.open(self._path, _FLAGS, 0o600)
            try:
                size = os.fstat(file).st_size
                os.lseek(file, max(0, size - 1), os.SEEK_SET)
                if os.read(file, 1) not in (b"", b"\n"):
                    lines = b"\n" + lines  # a process was killed before the end of its line
                try:
                    write_all(file, lines)
                    os.fsync(file)
                except OSError:
                    truncate_if_possible(file, size)
                    raise
            finally:
                os.close(file)
            if size == 0:
                sync_folder(self._path.parent)
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path} can't be written: {reason}; nothing was passed on to the run: "
                    "try again when the disk has room",
                    path=self._path,
                    reason=reason_text(error),
                )
            ) from error

    def load_requests(self) -> list[RequestState]:
        """Return the last stored state of each request, in the order in which the requests came.

        The list is empty if there is no file. Damaged lines are left out, with a warning if more is
        wrong than the end of the last line. Raises Unavailable if the file can't be read.
        """
        try:
            content = read_stored_bytes(self._path)
        except FileNotFoundError:
            return []
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path} can't be read: {reason}", path=self._path, reason=reason_text(error)
                )
            ) from error
        requests: dict[str, RequestState] = {}
        lines = content.split(b"\n")
        for number, line in enumerate(lines, 1):
            try:
                data = checked_object(line)
                request = RequestState.model_validate(data)
                requests[request.id] = request
            except ValidationError:
                if number < len(lines) and line:
                    _log.warning(
                        "%s: line %d is damaged, and the state of a request that it told is lost: "
                        "what the run did is in its journal",
                        self._path,
                        number,
                    )
        return [*requests.values()]


class RunFolder:
    """The folder with the folders of all runs."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._summaries: dict[str, tuple[tuple[int, int, int], RunSummary | None]] = {}
        """by id: modification time in ns, size and inode of the file that was read, its summary"""

    def create_run(self, stored: StoredRun) -> Path:
        """Create the folder of a new run, store the run, and return the folder.

        Raises Unavailable if that fails; nothing is left then.
        """
        folder = self._path / stored.state.id
        try:
            make_private_folder(self._path)
            folder.mkdir(mode=0o700)
            sync_folder(self._path)
        except OSError as error:
            remove_if_empty(self._path)
            raise Unavailable(
                Message(
                    "{folder} can't be created: {reason}", folder=folder, reason=reason_text(error)
                )
            ) from error
        try:
            self.store(stored)
        except Unavailable:
            shutil.rmtree(folder, ignore_errors=True)
            remove_if_empty(self._path)
            raise
        return folder

    def store(self, stored: StoredRun) -> None:
        """Write a run's order and state to its folder; raises Unavailable if that fails."""
        path = self.run_path(stored.state.id) / _RUN_FILE
        try:
            write_atomically(path, checked_json(stored.model_dump_json()), private=True)
            sync_folder(path.parent)
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path} can't be written: {reason}; free disk space, and try again",
                    path=path,
                    reason=reason_text(error),
                )
            ) from error

    def load_runs_newest_first(self) -> list[StoredRun]:
        """Return the stored runs, the newest first; damaged ones are left out with a warning."""
        runs: list[StoredRun] = []
        with suppress(FileNotFoundError):
            for name in os.listdir(self._path):
                if re.fullmatch(RUN_ID, name):
                    try:
                        runs.append(self.load_run(name))
                    except ArgoError as error:
                        _log.warning("%s; the run is left out", error)
        # Not by id: several runs may have been started within one second.
        return sorted(runs, key=lambda run: run.state.begun, reverse=True)

    def list_summaries(self) -> list[RunSummary]:
        """Return summaries of the stored runs, the newest first, without damaged ones.

        Only files that have changed since the last call are read.
        """
        ids: set[str] = set()
        with suppress(FileNotFoundError):
            ids = {name for name in os.listdir(self._path) if re.fullmatch(RUN_ID, name)}
        for removed in self._summaries.keys() - ids:
            del self._summaries[removed]
        found = [summary for id in ids if (summary := self._summary(id)) is not None]
        return sorted(found, key=lambda run: run.begun, reverse=True)

    def _summary(self, id: str) -> RunSummary | None:
        """Return the summary of a run, or None if it is damaged or was removed."""
        try:
            status = (self._path / id / _RUN_FILE).lstat()
        except OSError:
            return None
        state = (status.st_mtime_ns, status.st_size, status.st_ino)
        known = self._summaries.get(id)
        if known is not None and known[0] == state:
            return known[1]
        summary = None
        try:
            summary = RunSummary.from_state(self.load_run(id).state)
        except ArgoError as error:
            _log.warning("%s; the run is left out", error)
        self._summaries[id] = state, summary
        return summary

    def load_run(self, id: str) -> StoredRun:
        """Return a stored run.

        Raises NotFound if there is none, Unavailable if its file can't be read or is damaged.
        """
        path = self.run_path(id) / _RUN_FILE
        try:
            stored = read_stored(StoredRun, path, _REMEDY)
        except NotFound:
            raise NotFound(Message("there is no run {id}", id=id)) from None
        require_own_id(path.parent, stored.state.id, id, Message("move it out of this folder"))
        return stored

    def run_path(self, id: str) -> Path:
        """Return the folder of a run, which need not exist.

        Raises NotFound if the id is invalid or names a link.
        """
        path = self._path / id
        if not re.fullmatch(RUN_ID, id) or os.path.islink(path):
            raise NotFound(Message("there is no run {id}", id=repr(id[:40])))
        return path

    def load_entries(self, id: str) -> tuple[Entry, ...]:
        """Return the log of a run whose process has ended.

        Raises NotFound if there is no such run, ArgoError if one of its journals is missing or
        can't be read.
        """
        state, path = self.load_run(id).state, self.run_path(id)
        entries = load_entries(path)
        if len(entries) < state.entries and (state.status is RunStatus.ENDED or not entries):
            raise Unavailable(
                Message(
                    "{path}: its journals have {count} of {entries} entries: restore the "
                    "missing journal from a copy",
                    path=path,
                    count=len(entries),
                    entries=state.entries,
                )
            )
        return entries

    def request_file(self, id: str) -> RequestFile:
        """Return the file with the requests to a run, which need not exist yet."""
        return RequestFile(self.run_path(id) / _REQUEST_FILE)

    def read_report_file(self, id: str, file: str) -> bytes | None:
        """Return the content of a file of a run's report; None if the file does not exist.

        `file` is its name in the folder of the run, which the caller has checked. Raises NotFound
        if there is no such run, Unavailable if the file can't be read or is damaged.
        """
        self.load_run(id)
        path = self.run_path(id) / file
        try:
            content = read_stored_bytes(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise Unavailable(
                Message("{path} can't be read: {reason}", path=path, reason=reason_text(error))
            ) from error
        if file == RECORD:
            unchecked_json(content, path, _REPORT_REMEDY)
        elif file == PAGE:
            check_page(content, path, _REPORT_REMEDY)
        return content

    def last_journal(self, id: str) -> Path | None:
        """Return the path of the newest journal of a run; None if the run has no journal."""
        return next(reversed(journal_paths(self.run_path(id))), None)

    def has_ended(self, id: str) -> bool:
        """Return True if the newest journal of a run has the run's end; False without a journal.

        Raises ArgoError if the journal can't be read.
        """
        last = self.last_journal(id)
        if last is None:
            return False
        with open_journal(last) as journal:
            return journal.had_ended_when_opened


class DiskThread:
    """A thread that does disk work outside the event loop, one call after the other."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="runs-disk")

    async def run(self, work: Callable[..., T], *arguments: Any) -> T:
        """Call `work` in the thread, after all earlier calls, and return its result."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._thread, partial(work, *arguments))

    def close(self) -> None:
        """Finish the calls that were already requested, and end the thread."""
        self._thread.shutdown()
