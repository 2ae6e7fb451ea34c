"""Interface through which the analysis gets travel times and energy of a robot on a site."""

from collections.abc import Hashable
from typing import Protocol

from argo_compiler.base.records import dataclass
from argo_compiler.il import Mission, Task

RobotPose = Hashable
"""Pose of the robot in the form that a `Travel` uses; equal poses have the same travel times."""


@dataclass(frozen=True, slots=True)
class Leg:
    """Cost of driving to a task and of its action there."""

    duration: float
    """s, the action included"""
    energy: float
    """Wh, the action included"""
    arrival: RobotPose
    """pose of the robot when the action has ended"""
    work: float = 0.0
    """s of `duration` that the action takes even if the robot is there already"""
    work_energy: float = 0.0
    """Wh of `energy` that the action needs even if the robot is there already"""


@dataclass(frozen=True, slots=True)
class NoPath:
    """Result for a task that the robot can't execute."""

    reason: str
    """text that completes a sentence such as `the robot can't execute task 'A': ...`"""


class Travel(Protocol):
    """Planned travel times and energy of a robot on a site."""

    @property
    def battery(self) -> float | None:
        """Energy of one battery charge in Wh; None if it is unknown."""
        ...

    @property
    def charging_power(self) -> float | None:
        """Power in W that charges the battery at a dock; None if it is unknown."""
        ...

    @property
    def longest_cancellation_time(self) -> float:
        """Greatest time in s from the cancellation of an action until the next one can start."""
        ...

    @property
    def standing_power(self) -> float:
        """Power in W that the robot draws while it stands and waits."""
        ...

    def start_pose(self, mission: Mission) -> RobotPose:
        """Return the pose of the robot when the mission starts.

        Raises:
            ArgoError: The robot can't stand there.
        """
        ...

    def leg_with_action(
        self, origin: RobotPose, task: Task, velocity: float | None
    ) -> Leg | NoPath:
        """Return the cost of driving from a pose to a task, and of the task's action there.

        Called often with the same arguments.

        Args:
            origin: Pose from which the robot starts.
            task: Task to execute.
            velocity: Speed in m/s, in place of the task's; None for the robot's planning speed.
        """
        ...
