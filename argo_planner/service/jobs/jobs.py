"""The jobs of a service: begun, watched, cancelled."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, Unavailable
from argo_planner.service.jobs.job import EvaluationJob, Job, JobState
from argo_planner.service.processes.work import JobProcess

MOST_KEPT = 200

Ended = Callable[[Job], Awaitable[None]]


async def _nothing(_: Job) -> None:
    """Nobody has to know that it has ended."""


@dataclass(frozen=True)
class _UnderWay:
    work: JobProcess[Any]
    watching: asyncio.Task[None]
    ended: Ended


class Jobs:
    """The jobs of a service. Holds their processes."""

    def __init__(self, tell: Callable[[Job], None]) -> None:
        """`tell` hears of each change of a job."""
        self._tell = tell
        self._jobs: dict[str, Job] = {}
        self._under_way: dict[str, _UnderWay] = {}

    def add_past(self, jobs: Iterable[Job]) -> None:
        """Jobs of before, the oldest first."""
        self._jobs.update((job.id, job) for job in jobs)
        self._forget()

    def all(self) -> tuple[Job, ...]:
        """The jobs that are known, the newest ones first."""
        return tuple(sorted(self._jobs.values(), key=lambda job: job.begun, reverse=True))

    def job(self, id: str) -> Job:
        """Raises NotFound."""
        if id not in self._jobs:
            raise NotFound(f"there is no job {id[:40]!r}")
        return self._jobs[id]

    def running(self, kind: type[Job]) -> list[Job]:
        """Those of a kind that are under way."""
        jobs = (self._jobs[id] for id in self._under_way)
        return [job for job in jobs if isinstance(job, kind)]

    def begin(self, job: Job, work: JobProcess[Any], ended: Ended = _nothing) -> Job:
        """From now on the work is watched; `ended` is told when it has ended, however."""
        task = asyncio.get_running_loop().create_task(self._watch(job.id, work))
        self._under_way[job.id] = _UnderWay(work, task, ended)
        return self._keep(job)

    async def cancel(self, id: str) -> Job:
        """Ends a job. Raises NotFound, Conflict if it is over."""
        job = self.job(id)
        under_way = self._under_way.pop(id, None)
        if under_way is None:
            raise Conflict(f"job {id} is over: it is {job.state}")
        under_way.watching.cancel()
        await under_way.work.end()
        job = self._keep(job.model_copy(update={"state": JobState.CANCELLED}))
        await under_way.ended(job)
        return self._jobs.get(id, job)

    def tell_anew(self, job: Job) -> None:
        """More is known of a job that has ended."""
        if job.id in self._jobs:
            self._keep(job)

    def forget(self, id: str) -> None:
        """A job that is over is not known any more."""
        self._jobs.pop(id, None)

    async def close(self) -> None:
        """Ends all jobs."""
        under_way, self._under_way = [*self._under_way.values()], {}
        for one in under_way:
            one.watching.cancel()
            await one.work.end()
            with suppress(asyncio.CancelledError):
                await one.watching

    async def _watch(self, id: str, work: JobProcess[Any]) -> None:
        def heard(progress: Any) -> None:
            if id in self._under_way:
                self._keep(self._jobs[id].heard(progress))

        try:
            found = await work.result(heard)
            job = self.job(id).done(found)
        except ArgoError as error:
            job = self.job(id)
            resumable = isinstance(job, EvaluationJob) and isinstance(error, Unavailable)
            state = JobState.INTERRUPTED if resumable else JobState.FAILED
            job = job.model_copy(update={"state": state, "problem": str(error)})
        await work.end()
        under_way = self._under_way.pop(id, None)
        if under_way is not None:
            self._keep(job)
            await under_way.ended(job)

    def _keep(self, job: Job) -> Job:
        self._jobs[job.id] = job
        self._forget()
        self._tell(job)
        return job

    def _forget(self) -> None:
        over = [id for id in self._jobs if id not in self._under_way]
        for id in over[: max(0, len(self._jobs) - MOST_KEPT)]:
            del self._jobs[id]
