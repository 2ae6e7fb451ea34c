"""Jobs of a service: starting, watching and cancelling them."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, Unavailable
from argo_compiler.base.message import Message
from argo_planner.service.jobs.job import EvaluationJob, Job, JobState
from argo_planner.service.processes.job_process import JobProcess

MOST_JOBS = 200
"""jobs in memory; beyond this number ended jobs are discarded, the oldest first"""

OnEnd = Callable[[Job], Awaitable[None]]
"""function that is called with a job in its last state after it has ended"""

Keep = Callable[[Job], Awaitable[Job]]
"""function that stores a job whose work is done or has failed; returns it, maybe with a problem"""


async def _do_nothing(_: Job) -> None:
    """Do nothing, as the default of `OnEnd`."""


async def _keep_nothing(job: Job) -> Job:
    """Return the job, as the default of `Keep`."""
    return job


@dataclass(frozen=True)
class _RunningJob:
    work: JobProcess[Any]
    watching: asyncio.Task[None]
    keep: Keep
    on_end: OnEnd


class Jobs:
    """Jobs of a service, running and ended. Owns the processes of the running ones."""

    def __init__(self, on_change: Callable[[Job], None]) -> None:
        """Create an empty collection; `on_change` is called with each job that changes."""
        self._on_change = on_change
        self._jobs: dict[str, Job] = {}
        self._running: dict[str, _RunningJob] = {}

    def add_past(self, jobs: Iterable[Job]) -> None:
        """Add ended jobs of an earlier service process, the oldest first."""
        self._jobs.update((job.id, job) for job in jobs)
        self._evict()

    def all(self) -> tuple[Job, ...]:
        """Return all jobs that were not discarded, running and ended, the newest first."""
        return tuple(sorted(self._jobs.values(), key=lambda job: job.begun, reverse=True))

    def job(self, id: str) -> Job:
        """Return the job with that id; raises NotFound if there is none."""
        if id not in self._jobs:
            raise NotFound(Message("there is no job {id}", id=repr(id[:40])))
        return self._jobs[id]

    def running(self, kind: type[Job]) -> list[Job]:
        """Return the running jobs of a kind, which is one of the classes in `Job`."""
        jobs = (self._jobs[id] for id in self._running)
        return [job for job in jobs if isinstance(job, kind)]

    def start(
        self,
        job: Job,
        work: JobProcess[Any],
        on_end: OnEnd = _do_nothing,
        keep: Keep = _keep_nothing,
    ) -> Job:
        """Start the work of a job, and return the job.

        `keep` is called after the work is done or has failed, before anybody sees that. `on_end` is
        called after that, also if the job was cancelled, but not after `kill_running`.
        """
        task = asyncio.get_running_loop().create_task(self._watch(job.id, work))
        self._running[job.id] = _RunningJob(work, task, keep, on_end)
        return self._store(job)

    async def cancel_running(self, id: str) -> Job:
        """Cancel a running job, and return it as cancelled.

        Raises NotFound if there is no such job, Conflict if it has already ended.
        """
        job = self.job(id)
        running = self._running.pop(id, None)
        if running is None:
            raise Conflict(
                Message("job {id} has already ended: it is {state}", id=id, state=job.state)
            )
        running.watching.cancel()
        await running.work.end()
        job = self._store(job.model_copy(update={"state": JobState.CANCELLED}))
        await running.on_end(job)
        return self._jobs.get(id, job)

    def replace_unless_discarded(self, job: Job) -> None:
        """Replace a job that has ended by `job`, which has the same id, unless it was discarded."""
        if job.id in self._jobs:
            self._store(job)

    def discard_if_present(self, id: str) -> None:
        """Remove the job with this id, which has ended, if there is one."""
        self._jobs.pop(id, None)

    async def kill_running(self) -> None:
        """End all running jobs at once; neither their state changes nor is `on_end` called."""
        all_running, self._running = [*self._running.values()], {}
        for running in all_running:
            running.watching.cancel()
            await running.work.end()
            with suppress(asyncio.CancelledError):
                await running.watching

    async def _watch(self, id: str, work: JobProcess[Any]) -> None:
        def on_progress(progress: Any) -> None:
            if id in self._running:
                self._store(self._jobs[id].with_progress(progress))

        try:
            result = await work.start_and_wait(on_progress)
            job = self.job(id).with_result(result)
        except ArgoError as error:
            job = self.job(id)
            resumable = isinstance(job, EvaluationJob) and isinstance(error, Unavailable)
            state = JobState.INTERRUPTED if resumable else JobState.FAILED
            job = job.model_copy(update={"state": state, "problem": str(error)})
        await work.end()
        if id in self._running:
            job = await self._running[id].keep(job)
        running = self._running.pop(id, None)
        if running is not None:
            self._store(job)
            await running.on_end(job)

    def _store(self, job: Job) -> Job:
        self._jobs[job.id] = job
        self._evict()
        self._on_change(job)
        return job

    def _evict(self) -> None:
        ended = [id for id in self._jobs if id not in self._running]
        for id in ended[: max(0, len(self._jobs) - MOST_JOBS)]:
            del self._jobs[id]
