"""Puts a mission's tasks together: names them, links them and lays the groups over them."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from argo_compiler.diagnostics import Span
from argo_compiler.il import Action, Group, Stop, Task, Transition
from argo_compiler.model import Pose


@dataclass(frozen=True)
class Item:
    """One thing to do: a task, or with `repeat` a round of waypoints that is driven repeatedly."""

    name: str
    """what the task or the round is called where it is the only one of its kind"""
    action: Action
    source: Span | None
    poses: tuple[Pose, ...] = ()
    object_id: str | None = None
    repeat: "Repeat | None" = None


@dataclass(frozen=True)
class Repeat:
    """How often and how long a round is driven; 0 is no limit, as in the IL."""

    count: int
    duration: float
    """s"""


def assemble(items: Sequence[Item]) -> tuple[tuple[Task, ...], tuple[Group, ...]]:
    """The tasks, each with an unconditional transition to the next, and the groups.

    Waypoints are numbered through; of other names the second is `MEASURE 4 (2)`.
    """
    used: Counter[str] = Counter()
    tasks: list[Task] = []
    groups: list[Group] = []

    def unique(name: str) -> str:
        used[name] += 1
        if name == Action.WAYPOINT:
            return f"{name} {used[name]}"
        return name if used[name] == 1 else f"{name} ({used[name]})"

    for item in items:
        group = unique(item.name) if item.repeat else ""
        first = len(tasks)
        for pose in item.poses or (None,):
            tasks.append(
                Task(
                    name=unique(Action.WAYPOINT if item.repeat else item.name),
                    action=item.action,
                    group=group,
                    object_id=item.object_id,
                    pose=pose,
                    source=item.source,
                )
            )
        if item.repeat:
            groups.append(
                Group(
                    name=group,
                    start=tasks[first].name,
                    end=tasks[-1].name,
                    max_repeat_count=item.repeat.count,
                    max_repeat_duration=item.repeat.duration,
                    stop=Stop.HARD,
                    source=item.source,
                )
            )
    return _linked(tasks), tuple(groups)


def _linked(tasks: Sequence[Task]) -> tuple[Task, ...]:
    following = [(Transition(target=task.name),) for task in tasks[1:]]
    return tuple(
        task.model_copy(update={"transitions": to})
        for task, to in zip(tasks, [*following, ()], strict=True)
    )


def start_item(pose: Pose, source: Span | None) -> Item:
    """Where the mission begins."""
    return Item("START", Action.START, source, poses=(pose,))


def dock_item(pose: Pose, source: Span | None) -> Item:
    """The way into the docking station."""
    return Item("DOCK", Action.WAYPOINT, source, poses=(pose,))


def measure_item(checkpoint: int, source: Span | None) -> Item:
    """One measurement."""
    return Item(f"MEASURE {checkpoint}", Action.MEASURE, source, object_id=str(checkpoint))
