"""Makes the nodes of a program."""

from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, WaitRule
from argo_compiler.script.resolve.program import Do


def start(pose: Pose | None, source: Span | None) -> Do:
    """Where the mission begins."""
    return Do("START", Action.START, source, pose)


def dock(pose: Pose, source: Span | None) -> Do:
    """The way into the docking station."""
    return Do("DOCK", Action.WAYPOINT, source, pose, docks=True)


def waypoint(pose: Pose, source: Span | None) -> Do:
    """The way to a place."""
    return Do("WAYPOINT", Action.WAYPOINT, source, pose)


def measurement(checkpoint: int, source: Span | None) -> Do:
    """One measurement."""
    return Do(f"MEASURE {checkpoint}", Action.MEASURE, source, object_id=str(checkpoint))


def wait(rule: WaitRule, source: Span | None) -> Do:
    """Standing still."""
    return Do("WAIT", Action.WAIT, source, wait=rule)


def meeting(source: Span | None) -> Do:
    """A place at which nothing is done."""
    return Do("MEET", Action.WAIT, source, wait=WaitRule(duration=0))
