"""Cases of an evaluation, and names of the plans that they belong to.

A plan is what an evaluation rates: a mission, an order of tasks (policy), a site, a robot, a drive
and a sensor. Its cases differ in the faults.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from pydantic import Field

from argo_compiler.base.model import Model
from argo_env.run.spec import RunSpec

NO_FAULTS = "none"
"""name of the case without faults"""
AS_WRITTEN = "as written"
"""name of the policy that keeps the mission's order of tasks"""


class EvaluationCase(Model):
    """Run specification that an evaluation repeats, each time with another seed."""

    mission: str
    """name of the mission in tables"""
    policy: str = AS_WRITTEN
    """name of the policy that orders the mission's tasks"""
    faults: str = NO_FAULTS
    """name of this case's set of faults"""
    spec: RunSpec
    """the run, except for its seed and for the values that vary from world to world"""
    digest: str = ""
    """hash of the site's and the robot's descriptions, which the spec only refers to by name"""
    weight: float = Field(default=1.0, gt=0)
    """relative frequency of this case among the cases of the same plan"""

    @property
    def plan(self) -> "PlanName":
        """Name of the case's plan; rates are given by plan, over all its faults and seeds."""
        spec = self.spec
        return PlanName(self.mission, self.policy, spec.site, spec.robot, spec.drive, spec.sensor)


@dataclass(frozen=True, order=True)
class PlanName:
    """Name of an evaluated plan: all that its cases have in common, so no faults."""

    mission: str
    policy: str
    site: str
    robot: str
    drive: str
    sensor: str

    def __str__(self) -> str:
        return self.label(())

    def label(self, others: Sequence["PlanName"]) -> str:
        """Return a readable name: the mission, and each part in which one of `others` differs.

        These parts are policy, site, robot, drive and sensor.
        """
        parts = [self.mission]
        for name in ("policy", "site", "robot", "drive", "sensor"):
            own = getattr(self, name)
            if any(getattr(other, name) != own for other in others):
                parts.append(own)
        return ", ".join(parts)
