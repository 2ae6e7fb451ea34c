"""Jobs as the service tells of them."""

from datetime import datetime
from enum import StrEnum
from typing import Annotated, Literal

from pydantic import Discriminator

from argo_compiler.base.model import Model
from argo_planner.service.jobs.evaluation import EvaluationAsked
from argo_planner.service.jobs.order import OrderFound, OrderProgress
from argo_planner.service.jobs.standing import EvaluationStanding

JOB_ID = r"[0-9a-f]{12}"
"""what a job's id looks like"""
MOST_PROGRESS = 1_000
"""steps of a search that are kept of a job"""


class JobState(StrEnum):
    """How far a job is."""

    RUNNING = "running"
    DONE = "done"
    FAILED = "failed"
    CANCELLED = "cancelled"
    INTERRUPTED = "interrupted"
    """its process has died, or that of the service; an evaluation can go on from its rows"""


class _Job(Model):
    """What all jobs have."""

    id: str
    mission: str
    """id of the mission"""
    revision: int
    """that it was begun on"""
    author: str
    begun: datetime
    state: JobState = JobState.RUNNING
    problem: str | None = None
    """why it failed or was interrupted"""


class OrderJob(_Job):
    """The search for the best order of a mission."""

    kind: Literal["order"] = "order"
    progress: tuple[OrderProgress, ...] = ()
    found: OrderFound | None = None

    def heard(self, progress: OrderProgress) -> "OrderJob":
        """It has come further."""
        if len(self.progress) == MOST_PROGRESS:
            return self
        return self.model_copy(update={"progress": (*self.progress, progress)})

    def done(self, found: OrderFound) -> "OrderJob":
        """It has come to its end."""
        return self.model_copy(update={"state": JobState.DONE, "found": found})

    def told(self) -> "OrderJob":
        """As those hear who have the mission open: without the mission in its new order."""
        found = self.found and self.found.model_copy(update={"mission": None})
        return self.model_copy(update={"found": found})

    def summary(self) -> "OrderJob":
        """Without what came of it."""
        return self.model_copy(update={"found": None})


class EvaluationJob(_Job):
    """The evaluation of a mission in many worlds."""

    kind: Literal["evaluation"] = "evaluation"
    name: str = ""
    """of the mission when it was begun"""
    asked: EvaluationAsked
    standing: EvaluationStanding | None = None
    """None: no run has ended yet"""

    def heard(self, standing: EvaluationStanding) -> "EvaluationJob":
        """It has come further."""
        return self.model_copy(update={"standing": standing})

    def done(self, standing: EvaluationStanding) -> "EvaluationJob":
        """It has come to its end."""
        return self.model_copy(update={"state": JobState.DONE, "standing": standing})

    def told(self) -> "EvaluationJob":
        """As those hear who have the mission open."""
        return self

    def summary(self) -> "EvaluationJob":
        """Without what came of it."""
        return self.model_copy(update={"standing": None})


Job = OrderJob | EvaluationJob
AnyJob = Annotated[Job, Discriminator("kind")]
