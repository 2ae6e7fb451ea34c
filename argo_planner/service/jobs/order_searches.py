"""Searches of a service for the best orders of missions."""

import asyncio
import logging
import os
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.il import Mission
from argo_compiler.reorder.requirements import Requirements
from argo_env.files.checked_files import checked_json
from argo_env.files.folders import make_private_folder
from argo_planner.service.jobs.job import Job, OrderJob
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_search import search_order
from argo_planner.service.jobs.retried_storage import RetriedStorage
from argo_planner.service.processes.job_process import JobProcess
from argo_planner.service.storage.stored_files import (
    read_stored,
    remove_if_empty,
    require_own_id,
)

_log = logging.getLogger(__name__)
MOST_SEARCHES = 2
"""searches that run at the same time"""
MOST_STORED = 100
"""found orders that are stored; the oldest ones are deleted"""
_REMEDY = Message("delete it, and search again")


class OrderFolder:
    """Folder with the searches that have found an order, which can be accepted later."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def store(self, job: OrderJob) -> None:
        """Store a search; raises Unavailable if that fails."""
        path = self._path / f"{job.id}.json"
        try:
            make_private_folder(self._path)
            write_atomically(path, checked_json(job.model_dump_json()), private=True)
            for old in self._paths()[:-MOST_STORED]:
                old.unlink(missing_ok=True)
        except OSError as error:
            remove_if_empty(self._path)
            raise Unavailable(
                Message(
                    "the found order can't be stored: {path}: {reason}; accept it, or free "
                    "disk space, as it is lost if the service ends before",
                    path=path,
                    reason=reason_text(error),
                )
            ) from error

    def load_orders(self) -> list[OrderJob]:
        """Return the stored searches, the oldest first, without those that can't be read."""
        jobs = []
        for path in self._paths():
            try:
                job = read_stored(OrderJob, path, _REMEDY)
                require_own_id(path, job.id, path.stem, _REMEDY)
                jobs.append(job)
            except ArgoError as error:
                _log.warning("%s; the order is left out", error)
        return sorted(jobs, key=lambda job: job.begun)

    def delete_for_mission(self, plan: str) -> None:
        """Delete the stored searches of a mission."""
        for job in self.load_orders():
            if job.mission == plan:
                with suppress(OSError):
                    (self._path / f"{job.id}.json").unlink()

    def _paths(self) -> list[Path]:
        """Return the paths of the stored searches, the oldest first."""
        with suppress(OSError):
            return sorted(self._path.glob("*.json"), key=os.path.getmtime)
        return []


class OrderSearches:
    """Searches for the best orders of missions on one site, as jobs."""

    def __init__(
        self,
        site: str,
        path: Path,
        jobs: Jobs,
        new_id: Callable[[], str],
        clock: Callable[[], datetime],
    ) -> None:
        """Create a collection of searches on the site that the reference `site` opens.

        Found orders are stored in the folder `path`, so that they can be accepted after a restart.
        """
        self._site = site
        self._folder = OrderFolder(path)
        self._jobs = jobs
        self._new_id = new_id
        self._clock = clock
        self._turn = asyncio.Lock()
        """held while found orders are stored or deleted"""
        self._orders = RetriedStorage(
            self._folder.store, self._turn, on_late_success=jobs.replace_unless_discarded
        )

    async def open(self) -> None:
        """Load the stored searches, and add them to the jobs."""
        self._jobs.add_past(await asyncio.to_thread(self._folder.load_orders))

    async def close(self) -> None:
        """Store the orders that could not be stored yet, if that is possible now."""
        await self._orders.close()

    async def delete_for_mission(self, plan: str) -> None:
        """Delete the stored searches of a mission."""
        async with self._turn:
            self._orders.discard_pending(lambda job: job.mission == plan)
            await asyncio.to_thread(self._folder.delete_for_mission, plan)

    def start(
        self,
        plan: str,
        revision: int,
        mission: Mission,
        requirements: Requirements,
        time_limit: float,
        author: str,
        solvers: tuple[str, ...] = (),
    ) -> OrderJob:
        """Start a search of at most `time_limit` s, and return its job.

        `solvers` of installed packages take part besides Argo's own.

        Raises Conflict if MOST_SEARCHES searches are running.
        """
        if len(self._jobs.running(OrderJob)) >= MOST_SEARCHES:
            raise Conflict(
                Message(
                    "{most_searches} searches are running: wait for one of them, or cancel it",
                    most_searches=MOST_SEARCHES,
                )
            )
        job = OrderJob(
            id=self._new_id(), mission=plan, revision=revision, author=author, begun=self._clock()
        )

        async def keep(ended: Job) -> Job:
            if not isinstance(ended, OrderJob) or ended.found is None:
                return ended
            async with self._turn:
                error = await self._orders.store_or_retry_later(ended.id, ended)
            return ended if error is None else ended.model_copy(update={"problem": str(error)})

        work = JobProcess(search_order, self._site, mission, requirements, time_limit, solvers)
        self._jobs.start(job, work, keep=keep)
        return job

    def job_and_new_mission(self, id: str) -> tuple[OrderJob, Mission]:
        """Return the job of a search, and the mission in the order that it has found.

        Raises NotFound if there is no such job or it is no search, Conflict if it has found no
        order.
        """
        job = self._jobs.job(id)
        if not isinstance(job, OrderJob):
            raise NotFound(Message("job {id} is not a search for an order", id=id))
        if job.found is None or job.found.mission is None:
            raise Conflict(
                Message("job {id} is {state}, and has found no order", id=id, state=job.state)
            )
        return job, job.found.mission
