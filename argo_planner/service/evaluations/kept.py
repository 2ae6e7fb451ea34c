"""The evaluations of a service on disk: a folder each, with what was asked, its rows and its
report."""

import logging
import os
import re
import shutil
from pathlib import Path

from pydantic import ValidationError

from argo_compiler.base.errors import ArgoError, NotFound, Unavailable
from argo_compiler.base.model import Model
from argo_compiler.files.reading import FileError, read_bytes
from argo_compiler.files.writing import write_whole
from argo_env.evaluation.folder import REPORT
from argo_env.files.folders import make_folder
from argo_planner.service.jobs.evaluation import EvaluationOrder, cut_short
from argo_planner.service.jobs.job import JOB_ID, EvaluationJob, JobState

_KEPT = "job.json"
_MAX_BYTES = 100_000_000
_log = logging.getLogger(__name__)


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
        write_whole(folder / _KEPT, kept.model_dump_json().encode())

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
