"""What is recorded as JSON, beside Foxglove's own messages and the parts of the run record."""

from argo_compiler.base.model import Model
from argo_compiler.il import Action, EventKind
from argo_env.run.machine import Machine


class MissionState(Model):
    """How the mission stands."""

    task: str | None = None
    """whose action is under way; absent: none is"""
    action: Action | None = None
    object_id: str | None = None
    states: tuple[str, ...]
    """ids of the active states, from the mission to the leaf, then the reaction's"""
    groups: tuple[str, ...]
    """names of the active groups, the outermost first"""
    rounds: tuple[int, ...]
    """which round, from 1, each of these groups is in"""
    paused: bool
    reaction: EventKind | None = None
    """the event whose reaction is active"""
    outcome: str | None = None
    """how the mission has ended"""
    done: int
    """actions that have ended as planned"""
    readings: int
    abnormal: int
    """readings outside the nominal range"""


class BatteryState(Model):
    """How the battery stands."""

    charge: float
    """0 to 1"""
    voltage: float
    """V, under the present load"""
    current: float
    """A; less than 0 while it is charged"""


def mission_state(machine: Machine, done: int, readings: int, abnormal: int) -> MissionState:
    """How the mission stands, as its machine tells it, with what has been done."""
    running = machine.running
    return MissionState(
        task=running.name if running else None,
        action=running.action if running else None,
        object_id=running.object_id if running else None,
        states=machine.configuration,
        groups=tuple(machine.rounds),
        rounds=tuple(machine.rounds.values()),
        paused=machine.paused,
        reaction=machine.reaction,
        outcome=machine.outcome,
        done=done,
        readings=readings,
        abnormal=abnormal,
    )
