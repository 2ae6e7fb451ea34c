"""Initial state of a run that continues another run, and the machine restored to that state."""

from collections.abc import Sequence

from argo_compiler.base.errors import Conflict
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.hfsm import ByHand, Executor, Progress, lower
from argo_compiler.hfsm.handover import hand_over, match_to_mission
from argo_compiler.il import Mission
from argo_env.robot.pose import BodyPose
from argo_env.run.machine import Machine
from argo_env.run.record import Anomaly


class KnownAnomaly(Model):
    """Anomaly that the robot found in the earlier run, with the pose from which it found it."""

    anomaly: Anomaly
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""


class InitialState(Model):
    """State from which a run continues: the mission's progress and the state of the robot."""

    progress: Progress
    """progress of the mission, with all times as they are when the run begins"""
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""
    charge: float | None = None
    """charge of the battery, 0 to 1; None: full"""
    distance: float = 0.0
    """m, driven since the mission's start"""
    climbed: float = 0.0
    """m, upwards since the mission's start"""
    known: tuple[KnownAnomaly, ...] = ()
    """anomalies found so far, in the order of time"""

    @property
    def mission_seconds_at_start(self) -> float:
        """Time at which the run begins, in s since the mission's start."""
        return round(self.progress.elapsed, 6)

    @property
    def body_pose(self) -> BodyPose:
        return BodyPose(*self.pose)


def make_machine(mission: Mission, beginning: InitialState | None = None) -> Executor:
    """Return a machine that a run of the mission can start, from the start or an initial state.

    Raises ArgoError if the mission has errors, or the initial state is not one of this mission.
    """
    if beginning is None:
        return Executor(lower(mission))
    progress = beginning.progress
    return Executor.restore(lower(mission, progress), progress, beginning.mission_seconds_at_start)


def progress_now(machine: Machine, now: float, by_hand: Sequence[ByHand]) -> Progress:
    """Return the machine's progress at time `now` (s), with those in `by_hand` done or skipped.

    `now` counts from the mission's start. Raises Conflict if the machine is not paused, an action
    still runs, or the mission has ended or has nothing left to do.
    """
    if machine.finished or machine.outcome is not None:
        raise Conflict("the mission has ended: there is nothing to continue")
    if machine.running is not None or not machine.paused:
        raise Conflict(
            "the mission is running: take the robot over, and let time pass until no action runs"
        )
    progress = machine.progress()
    if progress.active is None:
        raise Conflict("nothing is left of the mission: give the robot back, and it ends")
    return hand_over(progress, by_hand, max(0.0, now - progress.elapsed))


def match_progress_to_edited_mission(
    progress: Progress, mission: Mission
) -> tuple[Progress, tuple[Diagnostic, ...]]:
    """Return the progress as one of an edited mission, and diagnostics of what no longer fits.

    Raises DiagnosticError if the mission has errors, or can't continue from this progress.
    """
    lower(mission)
    matched, diagnostics = match_to_mission(progress, mission)
    if matched is None:
        raise DiagnosticError("the edited mission", diagnostics)
    return matched, diagnostics
