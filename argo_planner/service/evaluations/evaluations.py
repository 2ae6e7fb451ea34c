"""Evaluations of a service: starting, resuming and deleting them, and replaying their runs.

Each evaluation has a folder on disk with its request, its rows and its report.
"""

import asyncio
import logging
import os
import re
import shutil
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, NotFound, Unavailable, reason_text
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.files.atomic_write import write_atomically
from argo_env.evaluation.folder import REPORT
from argo_env.files.checked_files import check_page, checked_json
from argo_env.files.folders import make_private_folder
from argo_planner.service.evaluations.replay import ReplayedRun, ReplayRequest, replay_run
from argo_planner.service.jobs.evaluation import (
    EvaluationSpec,
    evaluate_mission,
    read_partial_results,
    write_partial_report,
)
from argo_planner.service.jobs.job import JOB_ID, EvaluationJob, Job, JobState
from argo_planner.service.jobs.jobs import Jobs
from argo_planner.service.jobs.retried_storage import RetriedStorage
from argo_planner.service.processes.job_process import JobProcess
from argo_planner.service.storage.stored_files import (
    read_stored,
    read_stored_bytes,
    remove_if_empty,
    require_own_id,
    require_regular_files,
)

MOST_REPLAYED = 2
"""runs that are replayed at the same time"""
LONGEST_REPLAY = 120.0
"""longest time of a replay, in s of wall time"""
_log = logging.getLogger(__name__)
_JOB_FILE = "job.json"


class StoredEvaluation(Model):
    """Evaluation as stored on disk: what it depends on, and its last stored job state."""

    order: EvaluationSpec
    job: EvaluationJob


class EvaluationFolder:
    """Folder of all evaluations."""

    def __init__(self, path: Path) -> None:
        self._path = path

    def unchecked_evaluation_path(self, id: str) -> Path:
        """Return the path of an evaluation's folder, which need not exist; `id` is not checked."""
        return self._path / id

    def store(self, evaluation: StoredEvaluation) -> None:
        """Write an evaluation to its folder, which is made if needed.

        Raises Unavailable if that fails; a new folder is then removed again.
        """
        folder = self.unchecked_evaluation_path(evaluation.job.id)
        is_new = not os.path.exists(folder)
        try:
            make_private_folder(self._path)
            make_private_folder(folder)
            content = checked_json(evaluation.model_dump_json())
            write_atomically(folder / _JOB_FILE, content, private=True)
        except OSError as error:
            if is_new:
                shutil.rmtree(folder, ignore_errors=True)
                remove_if_empty(self._path)
            raise Unavailable(
                Message(
                    "evaluation {id} can't be stored: {folder}: {reason}; free disk space, "
                    "and try again",
                    id=evaluation.job.id,
                    folder=folder,
                    reason=reason_text(error),
                )
            ) from error

    def load_all(self) -> list[StoredEvaluation]:
        """Return all stored evaluations, the oldest first; damaged ones are left out.

        An evaluation that is stored as running is returned as interrupted; its file stays the same.
        """
        evaluations = []
        names = os.listdir(self._path) if os.path.isdir(self._path) else []
        for name in names:
            if re.fullmatch(JOB_ID, name):
                try:
                    evaluations.append(self._read(name))
                except ArgoError as error:
                    _log.warning("%s; the evaluation is left out", error)
        return sorted(evaluations, key=lambda evaluation: evaluation.job.begun)

    def with_stored_results(self, job: EvaluationJob) -> EvaluationJob:
        """Return an evaluation that was ended early, with the results of its rows on disk.

        Returns the job unchanged if there are no rows or they can't be read.
        """
        try:
            partial_results = read_partial_results(self.unchecked_evaluation_path(job.id))
        except ArgoError as error:
            _log.warning("evaluation %s: its rows can't be read: %s", job.id, error)
            return job
        return job if partial_results is None else job.with_progress(partial_results[0])

    def delete(self, id: str) -> None:
        """Delete the folder of an evaluation; raises Unavailable if that fails or it is missing."""
        try:
            shutil.rmtree(self.unchecked_evaluation_path(id))
        except OSError as error:
            raise Unavailable(
                Message(
                    "{unchecked_evaluation_path} can't be deleted: {reason}",
                    unchecked_evaluation_path=self.unchecked_evaluation_path(id),
                    reason=reason_text(error),
                )
            ) from error

    def load_evaluation(self, id: str) -> StoredEvaluation:
        """Return a stored evaluation; raises NotFound if it is missing, Unavailable if damaged.

        An evaluation that is stored as running is returned as interrupted.
        """
        return self._read(id)

    def read_report(self, id: str) -> bytes:
        """Return the report of an evaluation as HTML.

        Raises NotFound if there is none yet, Unavailable if it is damaged.
        """
        path = self.unchecked_evaluation_path(id) / REPORT
        try:
            content = read_stored_bytes(path)
        except FileNotFoundError:
            raise NotFound(Message("{path} does not exist", path=path)) from None
        except OSError as error:
            raise Unavailable(
                Message(
                    "{path} can't be read: {reason}; evaluate again",
                    path=path,
                    reason=reason_text(error),
                )
            ) from None
        check_page(content, path, Message("evaluate again"))
        return content

    def _read(self, id: str) -> StoredEvaluation:
        folder = self.unchecked_evaluation_path(id)
        require_regular_files(folder)
        path = folder / _JOB_FILE
        remedy = Message("restore it from a copy, or delete its folder and evaluate again")
        evaluation = read_stored(StoredEvaluation, path, remedy)
        require_own_id(folder, evaluation.job.id, id, Message("move it out of this folder"))
        if evaluation.job.state is not JobState.RUNNING:
            return evaluation
        why = Message("the service ended before the end of this evaluation was stored")
        job = evaluation.job.model_copy(update={"state": JobState.INTERRUPTED, "problem": why})
        return evaluation.model_copy(update={"job": self.with_stored_results(job)})


class Evaluations:
    """Evaluations of a service, each one stored in its own folder."""

    def __init__(
        self, path: Path, jobs: Jobs, new_id: Callable[[], str], clock: Callable[[], datetime]
    ) -> None:
        self._folder = EvaluationFolder(path)
        self._jobs = jobs
        self._new_id = new_id
        self._clock = clock
        self._turn = asyncio.Lock()
        """held while an evaluation is started, resumed or deleted, and while the end of one is
        stored, so that this can't overwrite the state of an evaluation that was resumed"""
        self._replays = asyncio.Semaphore(MOST_REPLAYED)
        self._ends = RetriedStorage(self._folder.store, self._turn)

    async def open(self) -> None:
        """Load the stored evaluations, and add them to the jobs."""
        stored = await asyncio.to_thread(self._folder.load_all)
        self._jobs.add_past(evaluation.job for evaluation in stored)

    async def close(self) -> None:
        """Store the ends that could not be stored yet, if that is possible now."""
        await self._ends.close()

    async def start(
        self, plan: str, revision: int, spec: EvaluationSpec, author: str
    ) -> EvaluationJob:
        """Start an evaluation of a mission plan's revision, and return its job.

        Raises Conflict if any evaluation is running, Unavailable if it can't be stored; nothing is
        left on disk then.
        """
        # If the client leaves now, an evaluation that is on disk must also run.
        return await asyncio.shield(self._start(plan, revision, spec, author))

    async def _start(
        self, plan: str, revision: int, spec: EvaluationSpec, author: str
    ) -> EvaluationJob:
        async with self._turn:
            self._require_none_running()
            job = EvaluationJob(
                id=self._new_id(),
                mission=plan,
                revision=revision,
                author=author,
                begun=self._clock(),
                name=spec.name,
                asked=spec.asked,
            )
            return await self._start_job(StoredEvaluation(order=spec, job=job))

    async def resume(self, id: str) -> EvaluationJob:
        """Resume an evaluation that was interrupted or cancelled; its stored runs are not repeated.

        Raises NotFound if there is none, Conflict if it is in another state or another evaluation
        is running.
        """
        return await asyncio.shield(self._resume(id))

    async def _resume(self, id: str) -> EvaluationJob:
        async with self._turn:
            job = self.find(id)
            if job.state not in (JobState.INTERRUPTED, JobState.CANCELLED):
                raise Conflict(
                    Message(
                        "evaluation {id} can't be resumed: it is {state}", id=id, state=job.state
                    )
                )
            self._require_none_running()
            stored = await asyncio.to_thread(self._folder.load_evaluation, id)
            job = job.model_copy(update={"state": JobState.RUNNING, "problem": None})
            return await self._start_job(StoredEvaluation(order=stored.order, job=job))

    def find(self, id: str) -> EvaluationJob:
        """Return an evaluation; raises NotFound if there is no such job or it is no evaluation."""
        job = self._jobs.job(id)
        if not isinstance(job, EvaluationJob):
            raise NotFound(Message("job {id} is not an evaluation", id=id))
        return job

    async def cancel_for_mission(self, plan: str) -> None:
        """Cancel the running evaluation of a mission, if there is one."""
        for job in self._jobs.running(EvaluationJob):
            if job.mission == plan:
                await self._jobs.cancel_running(job.id)

    async def delete(self, id: str) -> None:
        """Delete an evaluation that has ended, with its folder and all its rows.

        Raises NotFound if there is none, Conflict if it is running, Unavailable if its folder can't
        be deleted.
        """
        async with self._turn:
            job = self.find(id)
            if job.state is JobState.RUNNING:
                raise Conflict(Message("evaluation {id} is running: cancel it first", id=id))
            self._jobs.discard_if_present(id)
            self._ends.discard_pending(lambda end: end.job.id == id)
            await asyncio.to_thread(self._folder.delete, id)

    async def delete_for_mission(self, plan: str) -> None:
        """Delete all evaluations of a mission; a running one is cancelled first."""
        await self.cancel_for_mission(plan)
        for job in self._jobs.all():
            if isinstance(job, EvaluationJob) and job.mission == plan:
                await self.delete(job.id)

    async def report(self, id: str) -> bytes:
        """Return the report of an evaluation as HTML.

        After an early end, a report of the stored runs is written first. Raises NotFound if there
        is no such evaluation, it has no report, or it is running, even if it has an earlier report.
        """
        job = self.find(id)
        if job.state is JobState.RUNNING:  # an earlier report would lack the new runs
            raise NotFound(Message("evaluation {id} has no report yet: it is running", id=id))
        if job.state in (JobState.CANCELLED, JobState.INTERRUPTED):
            work = JobProcess(write_partial_report, self._folder.unchecked_evaluation_path(id))
            try:
                await work.start_and_wait(lambda _: None)
            finally:
                await work.end()
        try:
            return await asyncio.to_thread(self._folder.read_report, id)
        except NotFound:
            raise NotFound(
                Message(
                    "evaluation {id} has no report: it is {state}, and the report is written "
                    "when all runs are complete",
                    id=id,
                    state=job.state,
                )
            ) from None

    async def replay(self, id: str, key: str) -> ReplayedRun:
        """Execute the run of an evaluation with this key again, and return all its entries.

        Raises NotFound if there is no such evaluation or run, Unavailable if the replay takes
        longer than LONGEST_REPLAY.
        """
        job = self.find(id)
        stored = await asyncio.to_thread(self._folder.load_evaluation, id)
        request = ReplayRequest(
            key=key,
            plan=job.mission,
            revision=job.revision,
            by=job.author,
            begun=job.begun,
            evaluation=stored.order,
        )
        async with self._replays:
            work = JobProcess(replay_run, request, self._folder.unchecked_evaluation_path(id))
            try:
                async with asyncio.timeout(LONGEST_REPLAY):
                    return await work.start_and_wait(lambda _: None)
            except TimeoutError:
                raise Unavailable(
                    Message(
                        "the replay of the run takes longer than {longest_replay:.0f} s: the "
                        "report of the evaluation has a command that replays it on the machine of "
                        "the service",
                        longest_replay=LONGEST_REPLAY,
                    )
                ) from None
            finally:
                await work.end()

    def _require_none_running(self) -> None:
        for job in self._jobs.running(EvaluationJob):
            assert isinstance(job, EvaluationJob)
            raise Conflict(
                Message(
                    "{author} has started an evaluation of mission {job}: wait for it, or "
                    "cancel it",
                    author=job.author,
                    job=repr(job.name),
                )
            )

    async def _start_job(self, evaluation: StoredEvaluation) -> EvaluationJob:
        await asyncio.to_thread(self._folder.store, evaluation)
        self._ends.discard_pending(lambda end: end.job.id == evaluation.job.id)
        work = JobProcess(
            evaluate_mission,
            evaluation.order,
            self._folder.unchecked_evaluation_path(evaluation.job.id),
            parent=True,
        )

        async def on_end(job: Job) -> None:
            assert isinstance(job, EvaluationJob)
            async with self._turn:
                if job.state in (JobState.CANCELLED, JobState.INTERRUPTED):
                    job = await asyncio.to_thread(self._folder.with_stored_results, job)
                    self._jobs.replace_unless_discarded(job)
                ended = StoredEvaluation(order=evaluation.order, job=job)
                await self._ends.store_or_retry_later(job.id, ended)

        self._jobs.start(evaluation.job, work, on_end)
        return evaluation.job
