"""Searches of a service for the best orders of missions."""

import asyncio
import logging
import os
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import Conflict, NotFound, Unavailable
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.il import Mission
from argo_compiler.reorder.requirements import Requirements
from argo_env.files.checked_files import checked_json, read_checked
from argo_env.files.folders import make_private_folder
from argo_planner.service.jobs.job import Job, OrderJob
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.order_search import search_order
from argo_planner.service.processes.job_process import JobProcess

_log = logging.getLogger(__name__)
MOST_SEARCHES = 2
"""searches that run at the same time"""
MOST_STORED = 100
"""found orders that are stored; the oldest ones are deleted"""


class OrderFolder:
    """Folder with the searches that have found an order, which can be accepted later."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def store(self, job: OrderJob) -> None:
        """Store a search; a failure is only logged, as the order can be searched again."""
        try:
            make_private_folder(self._path)
            content = checked_json(job.model_dump_json())
            write_atomically(self._path / f"{job.id}.json", content, private=True)
            for path in self._paths()[:-MOST_STORED]:
                path.unlink(missing_ok=True)
        except OSError as error:
            _log.warning("%s: the found order can't be stored: %s", self._path, error.strerror)

    def load_orders(self) -> list[OrderJob]:
        """Return the stored searches, the oldest first, without those that can't be read."""
        jobs = []
        for path in self._paths():
            try:
                jobs.append(read_checked(OrderJob, path.read_bytes(), path, "search again"))
            except (OSError, ValidationError, Unavailable) as error:
                _log.warning("%s can't be read: %s", path, error)
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

    async def open(self) -> None:
        """Load the stored searches, and add them to the jobs."""
        self._jobs.add_past(await asyncio.to_thread(self._folder.load_orders))

    async def delete_for_mission(self, plan: str) -> None:
        """Delete the stored searches of a mission."""
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
                f"{MOST_SEARCHES} searches are running: wait for one of them, or cancel it"
            )
        job = OrderJob(
            id=self._new_id(), mission=plan, revision=revision, author=author, begun=self._clock()
        )

        async def keep(ended: Job) -> None:
            if isinstance(ended, OrderJob) and ended.found is not None:
                await asyncio.to_thread(self._folder.store, ended)

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
            raise NotFound(f"job {id} is not a search for an order")
        if job.found is None or job.found.mission is None:
            raise Conflict(f"job {id} is {job.state}, and has found no order")
        return job, job.found.mission
