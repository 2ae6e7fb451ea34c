"""Interface of a run to the robot that carries out its actions.

`Vehicle` is the simulated robot, `argo_env.remote.RemoteRobot` a real one in another place.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    AwaitedCharge,
    StartAction,
)
from argo_compiler.il import EventKind, Task
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
    """Result of one time step: the end of the action, a reading and anomalies, if any."""

    end: ActionEnd | None = None
    """end of the action, if it has ended"""
    reading: Reading | None = None
    found: tuple[Anomaly, ...] = ()


class RobotAction(Protocol):
    """Protocol of the action of a task, from its start to its end."""

    arrival_path: Path | None
    """the path by which the robot reached its pose, if known"""

    @property
    def task(self) -> Task: ...
    @property
    def path(self) -> Path | None:
        """Path to the pose of the task, if known."""

    def cancel(self, reason: str, is_interruption: bool) -> None:
        """Cancel the action: it cleans up, and a following step reports its end.

        With `is_interruption`, as for a pause or a reaction, its outcome is `interrupted`, else
        `cancelled`.
        """

    def detour_if_blocked(self, setup: RunSetup) -> None:
        """Continue with `setup`, whose navigator knows of a new blockage, and avoid that."""

    def to_task_run(
        self, end: ActionEnd, now: float, total_distance: float, total_climbed: float
    ) -> TaskRun:
        """Return the action, which ended at `now` (s), in the form of the run's record.

        `total_distance` and `total_climbed` (m) are those of the robot since the mission's start.
        """


class RobotPower(Protocol):
    """Protocol of the robot's power supply."""

    @property
    def charge(self) -> float | None:
        """Charge of the battery, 0 to 1; None: not known, or the power never ends."""

    @property
    def empty(self) -> bool: ...
    @property
    def charging(self) -> bool: ...


class AnyRobot(Protocol):
    """Protocol of a robot that carries out one action at a time.

    Times are in s since the mission's start.
    """

    odometry: Odometry
    """sums of the robot's motion"""

    @property
    def setup(self) -> RunSetup:
        """Run setup: the site as the robot knows it, the drive with its time step and pose."""

    @property
    def supply(self) -> RobotPower: ...
    @property
    def silent_since(self) -> float | None:
        """Time in s since when the robot sends nothing; its last state may be outdated then.

        None if the robot is connected.
        """

    def begin_at(self, pose: BodyPose, now: float) -> None:
        """Begin or continue a run at time `now` (s) with the robot at `pose`.

        A simulated robot is set to that pose; a real robot stays where it is.
        """

    def apply_initial_state_except_pose(self, initial: InitialState) -> None:
        """Set the robot's state at the start of a run that continues another run."""

    def restore(self, last: Entry) -> None:
        """Restore the robot's state after the last entry of a run whose process has died."""

    def restore_anomalies(self, reported: Sequence[tuple[Anomaly, BodyPose]], now: float) -> None:
        """Restore anomalies that were found before `now` (s), so that none is reported again.

        Each comes with the robot's pose then.
        """

    def set_mission_state(
        self, awaited: tuple[AwaitedCharge, ...], reaction: EventKind | None
    ) -> None:
        """Set the charges for which the mission waits now, and the event to which it reacts."""

    @property
    def expects_awaited_charge(self) -> bool:
        """True if the robot will report by itself that it has the charge that is waited for."""
        ...

    def update_faults(self, now: float) -> None:
        """Begin and end the simulated faults that are due at `now` (s)."""

    def add_blockages(self, blockages: Sequence[Blockage]) -> None:
        """Make paths planned from now on keep clear of these blockages, besides the known ones."""

    def prepare_action(
        self, command: StartAction, now: float, arrived_by: Path | None
    ) -> RobotAction:
        """Return a new action, which begins with the next `advance`; no other may be running.

        `arrived_by` is the path by which the robot reached its pose; None if it is not known.
        """

    def advance(self, step: int, now: float, action: RobotAction | None) -> Sensed:
        """Let time step number `step` pass, up to `now` (s), and return what it has led to.

        `action` is the running action, if there is one.
        """

    def state_for_entry(self) -> dict[str, Any]:
        """Return the robot's present state as fields of an `Entry` of the log, by name.

        These are its pose, distance, climb, charge and open contacts, and the mishaps and ended
        contacts that no entry has yet.
        """

    def clear_mishaps_and_ended_contacts(self) -> None:
        """Forget the mishaps and ended contacts so far, as an entry now has them."""
