"""The jobs of a service: begun, watched, cancelled."""

import asyncio
from collections.abc import Callable
from contextlib import suppress
from datetime import datetime
from enum import StrEnum

from argo_compiler.errors import ArgoError, Conflict, NotFound
from argo_compiler.il import Mission
from argo_compiler.model import Model
from argo_compiler.reorder.requirements import Requirements
from argo_planner.service.jobs.order import OrderFound, OrderProgress, search_order
from argo_planner.service.jobs.process import JobProcess

MOST_RUNNING = 2
MOST_KEPT = 200
MOST_PROGRESS = 1_000
"""steps of a search that are kept of a job"""


class JobState(StrEnum):
    """How far a job is."""

    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"


class OrderJob(Model):
    """The search for the best order of a mission."""

    id: str
    mission: str
    """id of the mission"""
    revision: int
    """that it was begun on"""
    author: str
    begun: datetime
    state: JobState = JobState.RUNNING
    progress: tuple[OrderProgress, ...] = ()
    found: OrderFound | None = None
    problem: str | None = None
    """why it failed"""


class Jobs:
    """The jobs of a service. Holds their processes."""

    def __init__(
        self,
        site: str,
        new_id: Callable[[], str],
        clock: Callable[[], datetime],
        tell: Callable[[OrderJob], None],
    ) -> None:
        """`tell` hears of each change of a job."""
        self._site = site
        self._new_id = new_id
        self._clock = clock
        self._tell = tell
        self._jobs: dict[str, OrderJob] = {}
        self._running: dict[str, tuple[JobProcess[OrderFound], asyncio.Task[None]]] = {}

    def all(self) -> tuple[OrderJob, ...]:
        """The jobs that are known, the newest ones first."""
        return tuple(reversed(self._jobs.values()))

    def job(self, id: str) -> OrderJob:
        """Raises NotFound."""
        if id not in self._jobs:
            raise NotFound(f"there is no job {id[:40]!r}")
        return self._jobs[id]

    def suggest_order(
        self,
        plan: str,
        revision: int,
        mission: Mission,
        requirements: Requirements,
        time_limit: float,
        author: str,
    ) -> OrderJob:
        """Begins a search of at most the time (s). Raises Conflict if too many are under way."""
        if len(self._running) >= MOST_RUNNING:
            raise Conflict(
                f"{MOST_RUNNING} searches are under way: wait for one of them, or cancel it"
            )
        job = OrderJob(
            id=self._new_id(), mission=plan, revision=revision, author=author, begun=self._clock()
        )
        work = JobProcess(search_order, self._site, mission, requirements, time_limit)
        task = asyncio.get_running_loop().create_task(self._watch(job.id, work))
        self._running[job.id] = work, task
        self._keep(job)
        return job

    def cancel(self, id: str) -> OrderJob:
        """Ends a job. Raises NotFound, Conflict if it is over."""
        job = self.job(id)
        if job.state is not JobState.RUNNING:
            raise Conflict(f"job {id} is over: it is {job.state}")
        work, task = self._running.pop(id)
        task.cancel()
        work.end()
        return self._change(id, {"state": JobState.CANCELLED})

    async def close(self) -> None:
        """Ends all jobs."""
        running, self._running = [*self._running.values()], {}
        for work, task in running:
            task.cancel()
            work.end()
            with suppress(asyncio.CancelledError):
                await task

    async def _watch(self, id: str, work: JobProcess[OrderFound]) -> None:
        def heard(progress: OrderProgress) -> None:
            known = self._jobs[id].progress
            if id in self._running and len(known) < MOST_PROGRESS:
                self._change(id, {"progress": (*known, progress)})

        try:
            found = await work.result(heard)
            change = {"state": JobState.DONE, "found": found}
        except ArgoError as error:
            change = {"state": JobState.FAILED, "problem": str(error)}
        if self._running.pop(id, None) is not None:
            self._change(id, change)
            await asyncio.to_thread(work.end)

    def _change(self, id: str, update: dict[str, object]) -> OrderJob:
        return self._keep(self._jobs[id].model_copy(update=update))

    def _keep(self, job: OrderJob) -> OrderJob:
        self._jobs[job.id] = job
        over = [id for id, known in self._jobs.items() if known.state is not JobState.RUNNING]
        for id in over[: max(0, len(self._jobs) - MOST_KEPT)]:
            del self._jobs[id]
        self._tell(job)
        return job
