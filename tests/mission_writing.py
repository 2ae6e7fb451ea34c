"""Short functions to write the parts of a mission, and to compare missions without spans."""

from argo_compiler.base.catalog import CheckpointInfo, CheckpointKind, Interval
from argo_compiler.base.model import Pose
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Mission,
    Reaction,
    Task,
    Transition,
    WaitRule,
)


def way(target, *conditions):
    return Transition(target=target, conditions=conditions)


def above(object_id, value, **fields):
    """Return the condition that a reading is greater than a value."""
    return Condition(type=ConditionType.GREATER, object_id=object_id, param1=value, **fields)


def reaction(event, response, **fields):
    return Reaction(event=event, response=response, **fields)


def _task(name, ways, usual, given):
    transitions = tuple(way(one) if isinstance(one, str) else one for one in ways)
    return Task(**{"name": name, "transitions": transitions, **usual, **given})


def start(name, *ways, **fields):
    return _task(name, ways, {"action": Action.START}, fields)


def measure(name, *ways, **fields):
    """Return a task that measures the checkpoint of its own name, unless another one is given.

    A transition is given as the name of the next task, or as a `Transition`.
    """
    return _task(name, ways, {"action": Action.MEASURE, "object_id": name}, fields)


def drive(name, *ways, **fields):
    """Return a WAYPOINT, by default at the origin."""
    return _task(name, ways, {"action": Action.WAYPOINT, "pose": Pose(x=0, y=0, z=0)}, fields)


def wait(name, *ways, **fields):
    """Return a WAIT; fields of `WaitRule` among the arguments become its rule."""
    rule = {key: fields.pop(key) for key in WaitRule.model_fields if key in fields}
    return _task(name, ways, {"action": Action.WAIT, "wait": WaitRule(**rule)}, fields)


def checkpoint(number, low, high, normal_low=None, normal_high=None):
    """Return a valve with its range, all of which is nominal by default."""
    normal_low = low if normal_low is None else normal_low
    normal_high = high if normal_high is None else normal_high
    return CheckpointInfo(
        id=number,
        kind=CheckpointKind.VALVE,
        name=f"valve R{number}",
        floor=1,
        unit="deg",
        range=Interval(low=low, high=high),
        nominal=Interval(low=normal_low, high=normal_high),
    )


def unplaced(mission: Mission) -> Mission:
    """Return the mission without the spans of its source."""
    return mission.model_copy(
        update={
            name: tuple(part.model_copy(update={"source": None}) for part in getattr(mission, name))
            for name in ("tasks", "groups", "reactions")
        }
    )
