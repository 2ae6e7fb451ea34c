"""A case of an evaluation: what is run again and again, and the plan that it is a case of."""

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import Field

from argo_compiler.base.model import Model
from argo_env.run.spec import RunSpec

NO_FAULTS = "none"
"""the name of the case in which nothing goes wrong"""
AS_WRITTEN = "as written"
"""the policy that keeps the mission's order"""


class EvaluationCase(Model):
    """One of the things that are run again and again, each time with another seed."""

    mission: str
    """what it is called in tables"""
    policy: str = AS_WRITTEN
    """in which order the mission's tasks are done"""
    faults: str = NO_FAULTS
    """what the faults of this case are called"""
    spec: RunSpec
    """all but the seed, and what varies from world to world"""
    digest: str = ""
    """of the site's and the robot's descriptions, which the spec only names"""
    weight: float = Field(default=1.0, gt=0)
    """how often missions are like this, beside the other cases of the same plan"""

    @property
    def plan(self) -> "PlanName":
        """What it is a case of: rates are told of plans, over all their faults and seeds."""
        spec = self.spec
        return PlanName(self.mission, self.policy, spec.site, spec.robot, spec.drive, spec.sensor)


@dataclass(frozen=True, order=True)
class PlanName:
    """What is evaluated, under whatever faults."""

    mission: str
    policy: str
    site: str
    robot: str
    drive: str
    sensor: str

    def __str__(self) -> str:
        return self.beside(())

    def beside(self, others: Sequence["PlanName"]) -> str:
        """Its name in words: the mission, and of the rest what is not the same for all."""
        parts = [self.mission]
        for name in ("policy", "site", "robot", "drive", "sensor"):
            own = getattr(self, name)
            if any(getattr(other, name) != own for other in others):
                parts.append(own)
        return ", ".join(parts)
