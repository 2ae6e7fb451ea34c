"""The runs of a service on disk: a folder each, with its order, its journal, its report, and the
requests to it, each of which is there before the run's process hears of it."""

import asyncio
import os
import re
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from argo_compiler.base.errors import NotFound, Unavailable
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_env.files.checked_lines import (
    checked_line,
    checked_object,
    sync_folder,
    truncate_if_possible,
    write_all,
)
from argo_env.run.journal import open_journal
from argo_env.run.log import Entry
from argo_planner.service.runs.requests import RequestState, RunOrder
from argo_planner.service.runs.state import RunState
from argo_planner.service.runs.worker import entries_of, journals

T = TypeVar("T")
RUN_ID = r"[0-9]{8}-[0-9]{6}-[0-9a-f]{4}"
"""what a run's id looks like: when it was begun, in UTC, and something that tells it from others"""
_KEPT = "run.json"
_REQUESTS = "requests"
_FLAGS = os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC


class KeptRun(Model):
    """A run as it is kept: what was ordered, and how it stood when that last changed much."""

    order: RunOrder
    state: RunState


class RequestFile:
    """Lines with checksums, each a request and how far it was; the last one of an id counts."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def keep(self, requests: Sequence[RequestState]) -> None:
        """Writes down how far requests are, all at once. Raises Unavailable; then none is kept."""
        lines = b"".join(checked_line(request.model_dump(mode="json")) for request in requests)
        try:
            file = os.open(self._path, _FLAGS, 0o644)
            try:
                size = os.fstat(file).st_size
                if size > 0 and os.pread(file, 1, size - 1) != b"\n":
                    lines = b"\n" + lines  # a process was killed before it had ended its line
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
                f"{self._path}: can't be written: {error.strerror}; nothing was passed on to the "
                "run: ask again when there is room"
            ) from error

    def all(self) -> list[RequestState]:
        """How far the requests were when that was kept last, in the order in which they came. What
        is damaged is passed over. Raises Unavailable if the file can't be read."""
        try:
            content = self._path.read_bytes()
        except FileNotFoundError:
            return []
        except OSError as error:
            raise Unavailable(f"{self._path}: can't be read: {error.strerror}") from error
        found: dict[str, RequestState] = {}
        for line in content.split(b"\n"):
            if (data := checked_object(line)) is not None:
                try:
                    request = RequestState.model_validate(data)
                except ValidationError:
                    continue
                found[request.id] = request
        return [*found.values()]


class RunFolder:
    """The folder of all runs."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def make(self, kept: KeptRun) -> Path:
        """The folder of a new run. Raises Unavailable if it can't be made."""
        folder = self._path / kept.state.id
        try:
            folder.mkdir(parents=True)
            sync_folder(self._path)
        except OSError as error:
            raise Unavailable(f"{folder}: can't be made: {error.strerror}") from error
        self.keep(kept)
        return folder

    def keep(self, kept: KeptRun) -> None:
        """Writes down how a run stands. Raises Unavailable."""
        path = self.path(kept.state.id) / _KEPT
        try:
            write_atomically(path, kept.model_dump_json())
            sync_folder(path.parent)
        except OSError as error:
            raise Unavailable(f"{path}: can't be written: {error.strerror}") from error

    def all(self) -> list[KeptRun]:
        """The runs, the newest first."""
        found: list[KeptRun] = []
        with suppress(FileNotFoundError):
            for name in os.listdir(self._path):
                if re.fullmatch(RUN_ID, name):
                    with suppress(NotFound):
                        found.append(self.kept(name))
        # More than one may have been begun within a second.
        return sorted(found, key=lambda kept: kept.state.begun, reverse=True)

    def kept(self, id: str) -> KeptRun:
        """How a run stands. Raises NotFound if there is none, or that can't be read."""
        try:
            content = (self.path(id) / _KEPT).read_bytes()
            return KeptRun.model_validate_json(content)
        except (OSError, ValidationError):
            raise NotFound(f"there is no run {id}, or what is kept of it is damaged") from None

    def path(self, id: str) -> Path:
        """The folder of a run. Raises NotFound for what can't be a run's id, or is a link."""
        path = self._path / id
        if not re.fullmatch(RUN_ID, id) or os.path.islink(path):
            raise NotFound(f"there is no run {id[:40]!r}")
        return path

    def entries(self, id: str) -> tuple[Entry, ...]:
        """What has happened in a run whose process has ended. Raises NotFound if there is no such
        run, ArgoError if a journal of it can't be read."""
        self.kept(id)
        return entries_of(self.path(id))

    def requests(self, id: str) -> RequestFile:
        """Where the requests to a run are kept."""
        return RequestFile(self.path(id) / _REQUESTS)

    def report(self, id: str, file: str) -> bytes | None:
        """A file of the report of a run; None if it is not there. Raises NotFound if there is no
        such run, Unavailable if the file can't be read."""
        self.kept(id)
        path = self.path(id) / file
        try:
            return path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            raise Unavailable(f"{path}: can't be read: {error.strerror}") from error

    def last_journal(self, id: str) -> Path | None:
        """The journal of the last plan of a run; None if it ended before there was one."""
        return next(reversed(journals(self.path(id))), None)

    def has_ended(self, id: str) -> bool:
        """Whether the last plan of a run has come to its end. Raises ArgoError likewise."""
        last = self.last_journal(id)
        if last is None:
            return False
        with open_journal(last) as journal:
            return journal.ended


class DiskThread:
    """Does work on the disk beside the event loop, one after the other. Holds the thread."""

    def __init__(self) -> None:
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="runs-disk")

    async def do(self, work: Callable[..., T], *arguments: Any) -> T:
        """What comes of the work, once all that was to be done before it has been."""
        loop = asyncio.get_running_loop()
        return await loop.run_in_executor(self._thread, partial(work, *arguments))

    def close(self) -> None:
        """Nothing more is to be done; what was is done first."""
        self._thread.shutdown()
