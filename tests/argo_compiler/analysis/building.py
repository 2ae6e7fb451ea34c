"""Helpers that build missions for tests of the analysis, and a travel with simple times."""

import itertools

from argo_compiler.analysis import Leg, NoPath
from argo_compiler.base.catalog import Area, Catalog
from argo_compiler.base.model import Pose
from argo_compiler.il import Condition, ConditionType, Mission, Transition
from tests.mission_writing import checkpoint, drive, measure

DOCK = Pose(x=5, y=0, z=0)
CATALOG = Catalog(
    site="made up",
    checkpoints=tuple(checkpoint(n, 0, 10) for n in (1, 2, 3)),
    areas=(Area(number=1, dock=DOCK),),
    floors=(),
)
"""Three checkpoints that show 0 to 10."""


def compare(text, max_age=None):
    """Return a condition from a text such as `1 < 5`, `1 >= 5` or `2 < 1 < 5`.

    These three compare the value of checkpoint 1.
    """
    words = text.split()
    if len(words) == 5:
        low, op, object_id, _, high = words
        kind, param1, param2 = ConditionType.WITHIN, low, high
    else:
        object_id, op, param1 = words
        kind = ConditionType.LESS if op.startswith("<") else ConditionType.GREATER
        param2 = None
    return Condition(
        type=kind,
        object_id=object_id,
        param1=float(param1),
        param2=None if param2 is None else float(param2),
        inclusive=op.endswith("="),
        max_age=max_age,
    )


def transition(target, *texts, max_age=None):
    return Transition(target=target, conditions=tuple(compare(t, max_age) for t in texts))


def task(name, *ways, **more):
    """Return a task that measures a checkpoint or drives.

    A name that ends with `m` and a number, as in `Am1`, measures the checkpoint with that number.
    """
    head, m, number = name.rpartition("m")
    if m == "m" and number.isdigit() and head != "":
        return measure(name, *ways, object_id=number, **more)
    return drive(name, *ways, **more)


def mission(*tasks, groups=(), **more):
    """Return a mission of tasks; a task that is given by its name leads to the next one."""
    names = [t if isinstance(t, str) else t.name for t in tasks]
    following = dict(itertools.pairwise(names))
    return Mission(
        tasks=tuple(
            task(t, *([following[t]] if t in following else [])) if isinstance(t, str) else t
            for t in tasks
        ),
        groups=tuple(groups),
        **more,
    )


class ConstantTravel:
    """Travel in which each leg uses 1 Wh, and a drive takes 10 s at 1 m/s.

    A drive to where the robot is takes no time; a measurement takes 2 s.
    """

    longest_cancellation_time = 1.0
    standing_power = 0.0
    charging_power = None

    def __init__(self, blocked=(), battery=100.0):
        self.blocked = blocked
        self.battery = battery

    def start_pose(self, mission):  # noqa: ARG002
        return "start"

    def leg_with_action(self, origin, task, velocity):
        place = task.object_id or task.name
        if place in self.blocked or (task.pose and task.pose.x < 0):
            return NoPath("a wall stands in the way")
        work = 2.0 if task.object_id else 0.0
        drive = 0.0 if origin == place else 10.0 / (velocity or 1.0)
        return Leg(drive + work, 1.0, place, work, 0.0)
