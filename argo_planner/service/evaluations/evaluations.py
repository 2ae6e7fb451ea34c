"""The evaluations of a service: begun, gone on with, replayed; kept on disk in a folder each, with
what was asked, its rows and its report."""

import asyncio
import logging
import os
import re
import shutil
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, Unavailable
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.files.loading import FileError, read_bytes
from argo_env.evaluation.folder import REPORT
from argo_env.files.folders import make_folder
from argo_planner.service.evaluations.replay import ReplayedRun, ReplayOrder, replay_run
from argo_planner.service.jobs.evaluation import (
    EvaluationOrder,
    cut_short,
    evaluate_mission,
    report_so_far,
)
from argo_planner.service.jobs.job import JOB_ID, EvaluationJob, Job, JobState
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.processes.work import JobProcess

MOST_REPLAYED = 2
"""runs that are made again at once"""
LONGEST_REPLAY = 120.0
"""s of wall time"""
_log = logging.getLogger(__name__)
_KEPT = "job.json"
_MAX_BYTES = 100_000_000


class KeptEvaluation(Model):
    """An evaluation as it is kept: what was ordered, and how it stood when that last changed."""

    order: EvaluationOrder
    job: EvaluationJob


class EvaluationFolder:
    """The folder of all evaluations."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def path(self, id: str) -> Path:
        """The folder of one of them."""
        return self._path / id

    def keep(self, kept: KeptEvaluation) -> None:
        """Writes down how one stands. Raises Unavailable."""
        folder = self.path(kept.job.id)
        make_folder(folder)
        write_atomically(folder / _KEPT, kept.model_dump_json().encode())

    def all(self) -> list[KeptEvaluation]:
        """The evaluations, the oldest first. One that was under way has been interrupted."""
        found = []
        names = os.listdir(self._path) if os.path.isdir(self._path) else []
        for name in names:
            if re.fullmatch(JOB_ID, name) and not os.path.islink(self.path(name)):
                try:
                    found.append(self._read(name))
                except (FileError, ValidationError) as error:
                    _log.warning("%s: can't be read, and is left out: %s", self.path(name), error)
        return sorted(found, key=lambda kept: kept.job.begun)

    def cut_short(self, job: EvaluationJob) -> EvaluationJob:
        """An evaluation that was ended before its time, with how it stands by the rows that are
        kept, as far as they can be read."""
        try:
            found = cut_short(self.path(job.id))
        except ArgoError as error:
            _log.warning("evaluation %s: its rows can't be read: %s", job.id, error)
            return job
        return job if found is None else job.heard(found[0])

    def forget(self, id: str) -> None:
        """Deletes one of them. Raises Unavailable where that can't be done."""
        try:
            shutil.rmtree(self.path(id))
        except OSError as error:
            raise Unavailable(f"{self.path(id)}: can't be deleted: {error.strerror}") from error

    def kept(self, id: str) -> KeptEvaluation:
        """What is kept of one of them. Raises NotFound if that can't be read."""
        try:
            return self._read(id)
        except (FileError, ValidationError):
            raise NotFound(f"what is kept of evaluation {id} is gone, or damaged") from None

    def report(self, id: str) -> bytes:
        """The report of an evaluation. Raises NotFound if there is none yet."""
        return read_bytes(self.path(id) / REPORT, "report", _MAX_BYTES)

    def _read(self, id: str) -> KeptEvaluation:
        content = read_bytes(self.path(id) / _KEPT, "evaluation", _MAX_BYTES)
        kept = KeptEvaluation.model_validate_json(content)
        if kept.job.state is not JobState.RUNNING:
            return kept
        why = "the service ended before all was run"
        job = kept.job.model_copy(update={"state": JobState.INTERRUPTED, "problem": why})
        return kept.model_copy(update={"job": self.cut_short(job)})


class Evaluations:
    """The evaluations of a service, kept in a folder each."""

    def __init__(
        self, path: Path, jobs: Jobs, new_id: Callable[[], str], clock: Callable[[], datetime]
    ) -> None:
        self._folder = EvaluationFolder(path)
        self._jobs = jobs
        self._new_id = new_id
        self._clock = clock
        self._turn = asyncio.Lock()
        """held while one begins, goes on or is deleted, and while it is kept how one has ended, so
        that this does not change one that goes on already"""
        self._replays = asyncio.Semaphore(MOST_REPLAYED)

    async def open(self) -> None:
        """Finds those of before."""
        kept = await asyncio.to_thread(self._folder.all)
        self._jobs.add_past(one.job for one in kept)

    async def start(
        self, plan: str, revision: int, order: EvaluationOrder, author: str
    ) -> EvaluationJob:
        """Begins an evaluation. Raises Conflict if one is under way, Unavailable if it can't be
        kept."""
        async with self._turn:
            self._require_free()
            job = EvaluationJob(
                id=self._new_id(),
                mission=plan,
                revision=revision,
                author=author,
                begun=self._clock(),
                name=order.name,
                asked=order.asked,
            )
            return await self._begin(KeptEvaluation(order=order, job=job))

    async def go_on(self, id: str) -> EvaluationJob:
        """Goes on with one that was interrupted or cancelled: what has been run is not run again.
        Raises NotFound, Conflict if it can't go on."""
        async with self._turn:
            job = self.of(id)
            if job.state not in (JobState.INTERRUPTED, JobState.CANCELLED):
                raise Conflict(f"evaluation {id} can't go on: it is {job.state}")
            self._require_free()
            kept = await asyncio.to_thread(self._folder.kept, id)
            job = job.model_copy(update={"state": JobState.RUNNING, "problem": None})
            return await self._begin(KeptEvaluation(order=kept.order, job=job))

    def of(self, id: str) -> EvaluationJob:
        """Raises NotFound if there is no such job, or it is no evaluation."""
        job = self._jobs.job(id)
        if not isinstance(job, EvaluationJob):
            raise NotFound(f"job {id} is no evaluation")
        return job

    async def end_of(self, plan: str) -> None:
        """Ends the evaluation of a mission that is no more, if one is under way."""
        for job in self._jobs.running(EvaluationJob):
            if job.mission == plan:
                await self._jobs.cancel(job.id)

    async def forget(self, id: str) -> None:
        """Deletes an evaluation that is over, with all its rows. Raises NotFound, Conflict if it is
        under way."""
        async with self._turn:
            job = self.of(id)
            if job.state is JobState.RUNNING:
                raise Conflict(f"evaluation {id} is under way: end it first")
            self._jobs.forget(id)
            await asyncio.to_thread(self._folder.forget, id)

    async def forget_all_of(self, plan: str) -> None:
        """Deletes the evaluations of a mission that is gone for good."""
        await self.end_of(plan)
        for job in self._jobs.all():
            if isinstance(job, EvaluationJob) and job.mission == plan:
                await self.forget(job.id)

    async def report(self, id: str) -> bytes:
        """The report, as a page; of an evaluation that was cut short, of what there is. Raises
        NotFound if there is none yet."""
        job = self.of(id)
        if job.state is JobState.RUNNING:  # that of before it went on says less
            raise NotFound(f"evaluation {id} has no report yet: it is under way")
        if job.state in (JobState.CANCELLED, JobState.INTERRUPTED):
            work = JobProcess(report_so_far, self._folder.path(id))
            try:
                await work.result(lambda _: None)
            finally:
                await work.end()
        try:
            return await asyncio.to_thread(self._folder.report, id)
        except NotFound:
            raise NotFound(
                f"evaluation {id} has no report: it is {job.state}, and the report is made when "
                "all has been run"
            ) from None

    async def replay(self, id: str, key: str) -> ReplayedRun:
        """One of its runs, made once more. Raises NotFound if there is no such run, Unavailable if
        that takes too long."""
        job = self.of(id)
        kept = await asyncio.to_thread(self._folder.kept, id)
        order = ReplayOrder(
            key=key,
            plan=job.mission,
            revision=job.revision,
            by=job.author,
            begun=job.begun,
            evaluation=kept.order,
        )
        async with self._replays:
            work = JobProcess(replay_run, order, self._folder.path(id))
            try:
                async with asyncio.timeout(LONGEST_REPLAY):
                    return await work.result(lambda _: None)
            except TimeoutError:
                raise Unavailable(
                    f"the run takes longer than {LONGEST_REPLAY:.0f} s to make again here: the "
                    "report of the evaluation has a command that makes it on the machine of the "
                    "service"
                ) from None
            finally:
                await work.end()

    def _require_free(self) -> None:
        for job in self._jobs.running(EvaluationJob):
            assert isinstance(job, EvaluationJob)
            raise Conflict(
                f"mission {job.name!r} is being evaluated, begun by {job.author}: wait for it, or "
                "end it"
            )

    async def _begin(self, kept: KeptEvaluation) -> EvaluationJob:
        await asyncio.to_thread(self._folder.keep, kept)
        work = JobProcess(evaluate_mission, kept.order, self._folder.path(kept.job.id), parent=True)

        async def ended(job: Job) -> None:
            assert isinstance(job, EvaluationJob)
            async with self._turn:
                if job.state in (JobState.CANCELLED, JobState.INTERRUPTED):
                    job = await asyncio.to_thread(self._folder.cut_short, job)
                    self._jobs.tell_anew(job)
                try:
                    now = KeptEvaluation(order=kept.order, job=job)
                    await asyncio.to_thread(self._folder.keep, now)
                except ArgoError as error:
                    _log.error("evaluation %s: how it ended is not kept: %s", job.id, error)

        self._jobs.begin(kept.job, work, ended)
        return kept.job
