"""The seam to the robot: all that a run asks of what carries its actions out.

`Vehicle` is the simulated robot, `argo_env.remote.RemoteRobot` one that is somewhere else.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from argo_compiler.hfsm import ActionFailed, ActionStopped, ActionSucceeded, StartAction
from argo_compiler.il import Task
from argo_env.navigation import Blockage, Path
from argo_env.robot.pose import BodyPose
from argo_env.run.initial_state import InitialState
from argo_env.run.log import Entry
from argo_env.run.odometry import Odometry
from argo_env.run.record import Anomaly, Reading, TaskRun
from argo_env.run.run_setup import RunSetup

ActionEnd = ActionSucceeded | ActionFailed | ActionStopped


@dataclass(frozen=True)
class Sensed:
    """What came of one time step."""

    end: ActionEnd | None = None
    """of the action, if it has ended"""
    reading: Reading | None = None
    found: tuple[Anomaly, ...] = ()


class RobotAction(Protocol):
    """The action of a task, from its start to its end."""

    arrival_path: Path | None
    """the path that the robot came by, where that is known"""

    @property
    def task(self) -> Task: ...
    @property
    def path(self) -> Path | None:
        """the way there, where it is known"""

    def cancel(self, reason: str, interrupted: bool) -> None:
        """Ends the action as soon as it has cleaned up, which a following step tells."""

    def detour(self, setup: RunSetup) -> None:
        """Goes on with a setup whose navigator knows of something new in the way."""

    def to_task_run(self, end: ActionEnd, now: float, distance: float, climbed: float) -> TaskRun:
        """The action as it goes into the record: it ended at `now` (s), after the robot's whole way
        of `distance` and `climbed` (m)."""


class RobotPower(Protocol):
    """What the robot lives on."""

    @property
    def charge(self) -> float | None:
        """of the battery, 0 to 1; None: not known, or without end"""

    @property
    def empty(self) -> bool: ...
    @property
    def charging(self) -> bool: ...


class AnyRobot(Protocol):
    """A robot that carries out one action at a time. Times are s of the run."""

    odometry: Odometry
    """what its way adds up to"""

    @property
    def setup(self) -> RunSetup:
        """the site as the robot knows it, its time step and its pose"""

    @property
    def supply(self) -> RobotPower: ...
    @property
    def silent_since(self) -> float | None:
        """s, since when nothing was heard of it: what it told last may not be so any more; None:
        it is heard"""

    def place(self, pose: BodyPose, now: float) -> None:
        """The run begins or goes on, at `now`; a robot that can be put somewhere stands at `pose`
        from now on."""

    def apply_initial_state(self, initial: InitialState) -> None:
        """The run goes on from where another one stood."""

    def restore(self, last: Entry) -> None:
        """The run goes on after the entry, as its process has died."""

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """These were found before `now`, with the robot at these poses."""

    def update_faults(self, now: float) -> None:
        """Lets all begin and end that is due, where faults are simulated."""

    def avoid(self, blockages: Sequence[Blockage]) -> None:
        """From now on paths keep clear of these as well."""

    def start(self, command: StartAction, now: float, arrival_path: Path | None) -> RobotAction:
        """Starts an action; no other one is under way."""

    def advance(self, step: int, now: float, action: RobotAction | None) -> Sensed:
        """Lets the time step of that number pass, up to `now`, with `action` under way."""

    def state(self) -> dict[str, Any]:
        """What an entry tells of it, from its pose to what it touches."""

    def clear_reported(self) -> None:
        """What the last `state` told of mishaps and contacts is not told again."""
