"""How far a mission has come, as data that can be written to a file and continued from."""

from pydantic import Field

from argo_compiler.errors import ArgoError
from argo_compiler.hfsm.conditions import Measured
from argo_compiler.hfsm.model import task_id
from argo_compiler.hfsm.step import Frame, Machine, State
from argo_compiler.model import Model


class GroupProgress(Model):
    """An active group: the round it is in, from 1, and the time (s) since it was entered."""

    group: str
    round: int = Field(ge=1)
    elapsed: float = Field(ge=0)


class ValueProgress(Model):
    """The last value measured at a checkpoint and its age (s)."""

    object_id: str
    value: float
    age: float = Field(ge=0)


class EndedTask(Model):
    """A task whose action has ended, and why it failed if it did."""

    task: str
    failure: str | None = None


class Progress(Model):
    """Where a mission stands. All times are relative, so that it can go on at any later time."""

    active: str | None
    """the task under way; None: the mission has ended"""
    groups: tuple[GroupProgress, ...] = ()
    """those that the active task lies in, outermost first"""
    values: tuple[ValueProgress, ...] = ()
    ended: tuple[EndedTask, ...] = ()
    """in order, once for each time that a task was done; a cancelled action does not count"""


def snapshot(state: State, ended: tuple[EndedTask, ...]) -> Progress:
    """The progress of a machine at the time of its last step."""
    return Progress(
        active=state.leaf.task.name if state.leaf else None,
        groups=tuple(
            GroupProgress(group=f.group.name, round=f.round, elapsed=state.time - f.entered)
            for f in state.frames
        ),
        values=tuple(
            ValueProgress(object_id=id, value=m.value, age=state.time - m.time)
            for id, m in state.values.items()
        ),
        ended=ended,
    )


def resume(machine: Machine, progress: Progress, now: float) -> State:
    """Where a machine stands that goes on from `progress` at time `now` (s).

    Raises:
        ArgoError: the progress is not one of this machine.
    """
    values = {v.object_id: Measured(v.value, now - v.age) for v in progress.values}
    if progress.active is None:
        return State(now, None, 0, (), values)
    leaf = machine.leaf(task_id(progress.active))
    if leaf is None:
        raise ArgoError(
            f"the progress is at task '{progress.active}', which the mission does not have; "
            "use the mission that it was saved from"
        )
    groups = machine.groups_around(leaf)
    if [g.name for g in groups] != [g.group for g in progress.groups]:
        raise ArgoError(
            f"the progress has task '{progress.active}' in other groups than the mission; "
            "use the mission that it was saved from"
        )
    frames = tuple(
        Frame(group, p.round, now - p.elapsed)
        for group, p in zip(groups, progress.groups, strict=True)
    )
    return State(now, leaf, 0, frames, values)
