"""What the analysis has to know of a site and a robot: how long ways take, and what they use."""

from collections.abc import Hashable
from dataclasses import dataclass
from typing import Protocol

from argo_compiler.il import Mission, Task

RobotPose = Hashable
"""Where the robot stands, as the `Travel` names it; equal where it makes no difference."""


@dataclass(frozen=True, slots=True)
class Leg:
    """The way to a task's place and its action there."""

    duration: float
    """s"""
    energy: float
    """Wh"""
    arrival: RobotPose
    """where the robot stands when the action has ended"""
    work: float = 0.0
    """s of the duration that the action takes even if the robot is there already"""
    work_energy: float = 0.0
    """Wh of the energy, likewise"""


@dataclass(frozen=True, slots=True)
class NoPath:
    """The task can't be carried out."""

    reason: str
    """in words, as the end of a sentence such as `task 'A' can't be carried out: ...`"""


class Travel(Protocol):
    """Durations and energy of a robot on a site, as planned."""

    @property
    def battery(self) -> float | None:
        """Wh that may be used on one charge; None: not known."""
        ...

    @property
    def clean_up(self) -> float:
        """s at most from the cancellation of an action until the next one can start."""
        ...

    @property
    def standing_power(self) -> float:
        """W that the robot draws while it stands and waits."""
        ...

    def start(self, mission: Mission) -> RobotPose:
        """Where the robot stands when the mission begins. Raises ArgoError if it can't."""
        ...

    def leg(self, origin: RobotPose, task: Task, velocity: float | None) -> Leg | NoPath:
        """From a standing to the task's place at `velocity` (m/s; None: the robot's planning
        speed), and the task's action there. Called often with the same arguments."""
        ...
