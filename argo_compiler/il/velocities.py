"""The two conventions for velocities: of the way to a task, and of the way on to the next one.

A mission has that of the way to the task (rule T6). The thesis, its ROS messages, and mission files
of versions 1 and 2 have that of the way to the next task, whichever it is.
"""

from collections.abc import Iterator, Mapping

from argo_compiler.il.grouping import group_ranges
from argo_compiler.il.mission import Action, Mission, Task
from argo_compiler.il.ways import beginning, branches, default_target, start_task

Velocity = float | None
"""m/s; None: the robot's planning speed"""

BEGINNING = ""
"""stands for where the robot begins, if a mission has no START; no task has an empty name"""


def ways(mission: Mission) -> Iterator[tuple[str, str]]:
    """Each way from one task to another, those after a time-out included, by their names; some
    more than once. The first way comes from START, or from `BEGINNING`."""
    tasks = mission.tasks
    start = start_task(mission)
    if (first := beginning(mission)) is not None:
        yield BEGINNING if start is None else start.name, first
    for task in tasks:
        if task.action is not Action.START:
            for transition in task.transitions:
                yield task.name, transition.target
        for target in branches(task).values():
            yield task.name, target
    onward: dict[str, list[str]] = {task.name: [] for task in tasks}
    for task in tasks:
        if (following := default_target(task)) is not None:
            onward[task.name].append(following)
    for around in group_ranges(mission):  # the outer ones before those that lie in them
        group = around.group
        if group.ends_at_once:
            for task in tasks[around.first : around.last + 1]:
                for target in onward[group.end]:
                    yield task.name, target
        yield group.end, group.start
        onward[group.end].append(group.start)


def of_ways_there(mission: Mission) -> tuple[Mission, tuple[str, ...]]:
    """A mission whose velocities are those of the way on, with those of the way to each task.

    Also the names of the tasks that are come to at different velocities: these have the slowest one
    that was given.
    """
    on: Mapping[str, Velocity] = {task.name: task.velocity for task in mission.tasks}
    there: dict[str, set[Velocity]] = {}
    for source, target in ways(mission):
        there.setdefault(target, set()).add(on.get(source))
    differ = tuple(task.name for task in mission.tasks if len(there.get(task.name, ())) > 1)
    tasks = tuple(_with(task, _slowest(there.get(task.name, set()))) for task in mission.tasks)
    return mission.model_copy(update={"tasks": tasks}), differ


def of_ways_on(mission: Mission) -> tuple[Mission, tuple[str, ...]]:
    """The opposite: a mission with the velocities of the way on from each task.

    Also the names of the tasks from which ways of different velocities lead on, which have the
    slowest one, and `BEGINNING` if the first way has a velocity and no START: neither has a
    counterpart.
    """
    there: Mapping[str, Velocity] = {task.name: task.velocity for task in mission.tasks}
    on: dict[str, set[Velocity]] = {}
    for source, target in ways(mission):
        on.setdefault(source, set()).add(there.get(target))
    differ = tuple(
        name for name, found in on.items() if len(found) > 1 or (name == BEGINNING and any(found))
    )
    tasks = tuple(_with(task, _slowest(on.get(task.name, set()))) for task in mission.tasks)
    return mission.model_copy(update={"tasks": tasks}), differ


def _with(task: Task, velocity: Velocity) -> Task:
    return task if task.velocity == velocity else task.model_copy(update={"velocity": velocity})


def _slowest(velocities: set[Velocity]) -> Velocity:
    return min((v for v in velocities if v is not None), default=None)
