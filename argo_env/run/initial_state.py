"""Where a run begins that goes on from where another one stood."""

from collections.abc import Sequence

from argo_compiler.base.errors import Conflict
from argo_compiler.base.model import Model
from argo_compiler.diagnostics import Diagnostic, DiagnosticError
from argo_compiler.hfsm import ByHand, Executor, Progress, lower
from argo_compiler.hfsm.handover import hand_over, match
from argo_compiler.il import Mission
from argo_env.robot.pose import BodyPose
from argo_env.run.machine import Machine
from argo_env.run.record import Anomaly


class KnownAnomaly(Model):
    """What the robot had found before, and where it stood then."""

    anomaly: Anomaly
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""


class InitialState(Model):
    """What a run goes on from: how far its mission has come, and where the robot stands."""

    progress: Progress
    """of the mission, with all times as they are when the run begins"""
    pose: tuple[float, float, float, float, float]
    """x, y, z (m), yaw, pitch (rad)"""
    charge: float | None = None
    """of the battery, 0 to 1; None: full"""
    distance: float = 0.0
    """m, driven since the mission's start"""
    climbed: float = 0.0
    """m, upwards since the mission's start"""
    known: tuple[KnownAnomaly, ...] = ()
    """what was found, in the order of time"""

    @property
    def at(self) -> float:
        """s of the mission's time at which the run begins."""
        return round(self.progress.elapsed, 6)

    @property
    def body_pose(self) -> BodyPose:
        return BodyPose(*self.pose)


def make_machine(mission: Mission, beginning: InitialState | None = None) -> Executor:
    """A machine for a run of the mission, from its start or from a beginning.

    Raises ArgoError if the mission has errors, or the beginning is not one of it.
    """
    if beginning is None:
        return Executor(lower(mission))
    progress = beginning.progress
    return Executor.restore(lower(mission, progress), progress, beginning.at)


def progress_now(machine: Machine, now: float, by_hand: Sequence[ByHand]) -> Progress:
    """The progress at time `now` (s of the mission's time), with what was done by hand until now.

    Raises Conflict while an action still runs, or once nothing is left of the mission.
    """
    if machine.finished or machine.outcome is not None:
        raise Conflict("the mission has ended: there is nothing that could go on")
    if machine.running is not None or not machine.paused:
        raise Conflict(
            "the mission goes on: take the robot over, and let time pass until no action runs"
        )
    progress = machine.progress()
    if progress.active is None:
        raise Conflict("nothing is left of the mission: give the robot back, and it ends")
    return hand_over(progress, by_hand, max(0.0, now - progress.elapsed))


def matched(progress: Progress, mission: Mission) -> tuple[Progress, tuple[Diagnostic, ...]]:
    """The progress as that of an edited mission, and what does not fit any more.

    Raises DiagnosticError if the mission has errors, or can't go on from there.
    """
    lower(mission)
    found, diagnostics = match(progress, mission)
    if found is None:
        raise DiagnosticError("the edited mission", diagnostics)
    return found, diagnostics
