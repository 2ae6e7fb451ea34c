"""State of jobs, as the service sends it to clients."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Discriminator

from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_planner.service.jobs.evaluation import EvaluationAsked
from argo_planner.service.jobs.evaluation_status import EvaluationStanding
from argo_planner.service.jobs.order_search import OrderFound, OrderProgress

JOB_ID = r"[0-9a-f]{12}"
"""regular expression for the id of a job"""
MOST_PROGRESS = 1_000
"""progress reports that are stored for a search"""


class JobState(StrEnum):
    """State of a job."""

    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"
    """its process or the service has died; an evaluation can continue from its rows"""


class _Job(Worded):
    """Fields that all jobs have."""

    id: str
    mission: str
    """id of the mission plan"""
    revision: int
    """revision that the job was started on"""
    author: str
    begun: datetime
    state: JobState = JobState.RUNNING
    problem: Text | None = None
    """why the job failed or was interrupted, or its result can't be stored; None: nothing"""
    problem_wording: Wording | None = wording_field("problem")


class OrderJob(_Job):
    """Search for the best order of a mission."""

    kind: Literal["order"] = "order"
    progress: tuple[OrderProgress, ...] = ()
    found: OrderFound | None = None

    def with_progress(self, progress: OrderProgress) -> "OrderJob":
        """Return a copy with one more progress report.

        If the job has MOST_PROGRESS reports already, return the job itself: the new one is dropped.
        """
        if len(self.progress) == MOST_PROGRESS:
            return self
        return self.model_copy(update={"progress": (*self.progress, progress)})

    def with_result(self, found: OrderFound) -> "OrderJob":
        """Return a copy of the job with its result, in the state `done`."""
        return self.model_copy(update={"state": JobState.DONE, "found": found})

    def without_new_mission(self) -> "OrderJob":
        """Return a copy without the new mission, which members of the mission's room are sent."""
        found = self.found and self.found.model_copy(update={"mission": None})
        return self.model_copy(update={"found": found})

    def without_result(self) -> "OrderJob":
        """Return a copy of the job without its result."""
        return self.model_copy(update={"found": None})


class EvaluationJob(_Job):
    """Evaluation of a mission in many worlds."""

    kind: Literal["evaluation"] = "evaluation"
    name: str = ""
    """name of the mission when the job was started"""
    asked: EvaluationAsked
    standing: EvaluationStanding | None = None
    """progress and interim results; None: no run has ended yet"""

    def with_progress(self, standing: EvaluationStanding) -> "EvaluationJob":
        """Return a copy of the job with newer progress and interim results."""
        return self.model_copy(update={"standing": standing})

    def with_result(self, standing: EvaluationStanding) -> "EvaluationJob":
        """Return a copy of the job with its final results, in the state `done`."""
        return self.model_copy(update={"state": JobState.DONE, "standing": standing})

    def without_new_mission(self) -> "EvaluationJob":
        """Return the job itself: it has no new mission. Members of the room are sent it."""
        return self

    def without_result(self) -> "EvaluationJob":
        """Return a copy of the job without `standing`: its progress and results so far."""
        return self.model_copy(update={"standing": None})


Job = OrderJob | EvaluationJob
AnyJob = Annotated[Job, Discriminator("kind")]
