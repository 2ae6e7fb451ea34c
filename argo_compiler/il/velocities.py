"""Conventions for velocities: on the path to a task, or on the path to the next task.

A mission has the velocity on the path to the task (rule T6). The thesis, its ROS messages, and
mission files of versions 1 and 2 have the velocity on the path to the next task, whichever it is.
"""

from collections.abc import Iterator, Mapping

from argo_compiler.il.grouping import valid_ranges_parents_first
from argo_compiler.il.mission import Action, Mission, Task
from argo_compiler.il.transitions import (
    default_target,
    failure_targets_by_field,
    find_start_pose_task,
    initial_task,
)

Velocity = float | None
"""m/s; None: the robot's planning speed"""
TasksWithLoss = tuple[str, ...]
"""names of the tasks that lose a velocity in a conversion"""

MISSION_START = ""
"""stands for the robot's initial pose, if a mission has no START; no task has an empty name"""


def possible_successor_pairs(mission: Mission) -> Iterator[tuple[str, str]]:
    """Yield pairs of names, a task and one that may follow it; some pairs more than once.

    They come from transitions, other targets after failures, the next rounds of groups, and what
    follows a group after its time-out. The first pair is that from START, or from `MISSION_START`,
    to the first task.
    """
    tasks = mission.tasks
    start = find_start_pose_task(mission)
    if (first := initial_task(mission)) is not None:
        yield MISSION_START if start is None else start.name, first
    for task in tasks:
        if task.action is not Action.START:
            for transition in task.transitions:
                yield task.name, transition.target
        for target in failure_targets_by_field(task).values():
            yield task.name, target
    onward: dict[str, list[str]] = {task.name: [] for task in tasks}
    for task in tasks:
        if (following := default_target(task)) is not None:
            onward[task.name].append(following)
    for around in valid_ranges_parents_first(mission):  # parents before children
        group = around.group
        if group.has_hard_stop:
            for task in tasks[around.first : around.last + 1]:
                for target in onward[group.end]:
                    yield task.name, target
        yield group.end, group.start
        onward[group.end].append(group.start)


def departure_to_approach_velocities(mission: Mission) -> tuple[Mission, TasksWithLoss]:
    """Convert velocities on the path to the next task into velocities on the path to the task.

    Also returns the names of the tasks for which this loses something, because transitions to them
    have different velocities. Such a task gets the lowest velocity that was given.
    """
    on: Mapping[str, Velocity] = {task.name: task.velocity for task in mission.tasks}
    there: dict[str, set[Velocity]] = {}
    for source, target in possible_successor_pairs(mission):
        there.setdefault(target, set()).add(on.get(source))
    differ = tuple(task.name for task in mission.tasks if len(there.get(task.name, ())) > 1)
    tasks = tuple(_with(task, _slowest(there.get(task.name, set()))) for task in mission.tasks)
    return mission.model_copy(update={"tasks": tasks}), differ


def approach_to_departure_velocities(mission: Mission) -> tuple[Mission, TasksWithLoss]:
    """Convert velocities on the path to the task into velocities on the path to the next task.

    Also returns the names of the tasks for which this loses something, because transitions from
    them have different velocities. Such a task gets the lowest one that was given. `MISSION_START`
    is among the names if the path to the first task has a velocity, but the mission has no task
    with the action START that could have it: that velocity is left out.
    """
    there: Mapping[str, Velocity] = {task.name: task.velocity for task in mission.tasks}
    on: dict[str, set[Velocity]] = {}
    for source, target in possible_successor_pairs(mission):
        on.setdefault(source, set()).add(there.get(target))
    differ = tuple(
        name
        for name, velocities in on.items()
        if len(velocities) > 1 or (name == MISSION_START and any(velocities))
    )
    tasks = tuple(_with(task, _slowest(on.get(task.name, set()))) for task in mission.tasks)
    return mission.model_copy(update={"tasks": tasks}), differ


def _with(task: Task, velocity: Velocity) -> Task:
    return task if task.velocity == velocity else task.model_copy(update={"velocity": velocity})


def _slowest(velocities: set[Velocity]) -> Velocity:
    return min((v for v in velocities if v is not None), default=None)
