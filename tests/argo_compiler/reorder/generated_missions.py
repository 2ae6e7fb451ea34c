"""Random missions as people write them: sequences, detours, loops, early ends, and groups."""

from dataclasses import dataclass
from itertools import count, cycle

import numpy as np
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.hfsm import ActionFailed, ActionSucceeded
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Group,
    Mission,
    OnFailure,
    Order,
    Stop,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)
from argo_compiler.reorder.travel_matrix import TravelMatrix
from argo_compiler.route import Tour, evaluate
from tests.argo_compiler.hfsm import play
from tests.mission_writing import drive, measure

START_POSE, DOCK = Pose(x=0, y=0, z=0), Pose(x=9, y=9, z=0)
OBJECTS = ("1", "2", "3", "4")
NEVER_ABOVE = 100.0
ROUND_COUNTS = st.integers(0, 4)
"""numbers of rounds; 0 means no limit but the duration"""


@dataclass
class Item:
    """Part of a mission: some tasks, or a group with its parts."""

    kind: str
    name: str
    parts: tuple
    """names of the tasks; the items of a group"""
    condition: Condition | None = None
    count: int = 1
    duration: float = 0.0
    stop: Stop = Stop.SOFT

    @property
    def entry(self):
        return self.parts[0].entry if self.kind == "group" else self.parts[0]


def new_name(draw, numbers):
    number, measures = next(numbers), draw(st.booleans())
    return f"M{draw(st.sampled_from(OBJECTS))} {number}" if measures else f"W{number}"


def conditions(rising):
    """Return a strategy for conditions; with `rising`, those that no measured value satisfies."""
    return st.builds(
        Condition,
        type=st.sampled_from([ConditionType.LESS, ConditionType.GREATER])
        if not rising
        else st.just(ConditionType.GREATER),
        object_id=st.sampled_from(OBJECTS),
        param1=st.just(NEVER_ABOVE) if rising else st.integers(1, 8).map(float),
    )


@st.composite
def item_lists(draw, numbers, kinds, depth, most, docked, calm):
    """Draw a sequence of items whose last one is a task or group."""
    result = []
    for _ in range(draw(st.integers(1, most))):
        kind = draw(st.sampled_from(kinds))
        if kind == "home" and not docked:
            kind = "task"
        if kind == "group":
            if depth == 0:
                continue
            inside = tuple(draw(item_lists(numbers, kinds, depth - 1, 3, docked, calm)))
            result.append(
                Item(
                    "group",
                    f"G{new_name(draw, numbers)[1:]}".replace(" ", "-"),
                    inside,
                    count=draw(st.integers(1, 3)),
                )
            )
            continue
        size = {"task": 1, "home": 1, "again": 1, "detour": 2, "skip": 2, "back": 2}[kind]
        parts = tuple(new_name(draw, numbers) for _ in range(size))
        rising = calm and kind in {"again", "back", "home"}
        result.append(Item(kind, parts[0], parts, draw(conditions(rising))))
    if not result or result[-1].kind not in {"task", "group"}:
        name = new_name(draw, numbers)
        result.append(Item("task", name, (name,)))
    return result


def _task(name, *ways):
    ways = [way for way in ways if way is not None]
    return measure(name, *ways, object_id=name[1]) if name[0] == "M" else drive(name, *ways)


def _add_tasks(row, after, outer, tasks, groups):
    for k, item in enumerate(row):
        following = row[k + 1].entry if k + 1 < len(row) else after
        onward = None if following is None else Transition(target=following)
        if item.kind == "group":
            name = f"{outer}/{item.name}" if outer else item.name
            first_index = len(tasks)
            _add_tasks(item.parts, following, name, tasks, groups)
            groups.append(
                Group(
                    name=name,
                    start=tasks[first_index].name,
                    end=tasks[-1].name,
                    max_repeat_count=item.count,
                    max_repeat_duration=item.duration,
                    stop=item.stop,
                )
            )
            continue
        first, *rest = item.parts
        guard = (item.condition,)
        inner = Transition(target=rest[0]) if rest else None
        if item.kind == "task":
            tasks.append(_task(first, onward))
        elif item.kind == "home":
            tasks.append(_task(first, Transition(target="DOCK", conditions=guard), onward))
        elif item.kind == "again":
            tasks.append(_task(first, Transition(target=first, conditions=guard), onward))
        elif item.kind == "detour":
            way = Transition(target=rest[0], conditions=guard)
            tasks += [_task(first, way, onward), _task(rest[0], onward)]
        elif item.kind == "skip":
            skip = Transition(target=following, conditions=guard)
            tasks += [_task(first, inner, skip), _task(rest[0], onward)]
        else:
            back = Transition(target=first, conditions=guard)
            tasks += [_task(first, inner), _task(rest[0], onward, back)]


ALL = ("task", "task", "task", "detour", "skip", "again", "back", "home", "group")


@st.composite
def missions(draw, kinds=ALL, most=5, calm=False, lasting=False):
    """Draw a mission in any order.

    With `calm`, the conditions of loops and early ends are never satisfied. With `lasting`, some
    groups have a duration and end with a whole round.
    """
    docked = draw(st.booleans())
    row = draw(item_lists(count(1), kinds, 2, most, docked, calm))
    if lasting:
        for item in row:
            if item.kind == "group" and draw(st.booleans()):
                item.duration, item.count = draw(st.integers(1, 90).map(float)), draw(ROUND_COUNTS)
    tasks, groups = [], []
    _add_tasks(row, "DOCK" if docked else None, "", tasks, groups)
    if draw(st.booleans()):
        ways = (Transition(target=row[0].entry),)
        tasks.insert(0, Task(name="START", action=Action.START, pose=START_POSE, transitions=ways))
    if docked:
        tasks.append(Task(name="DOCK", action=Action.WAYPOINT, pose=DOCK))
    return Mission(order=Order.ANY, tasks=tuple(tasks), groups=tuple(groups), dock=DOCK)


def random_matrix(mission, rng, most=20):
    """Return random times between the tasks, which differ by direction."""
    names = tuple(t.name for t in mission.tasks if t.action is not Action.START)
    n = len(names)
    work = np.array([float(rng.integers(0, 3)) if name.startswith("M") else 0.0 for name in names])
    time = rng.integers(1, most, (n + 1, n)) + work
    return TravelMatrix(names, time, time / 10.0, work, unit=1.0)


@st.composite
def with_waits(draw, mission):
    """Draw the mission with WAITs after some of its tasks."""
    tasks, groups = [], list(mission.groups)
    for task in mission.tasks:
        if task.action is Action.START or task.name == "DOCK" or draw(st.booleans()):
            tasks.append(task)
            continue
        name = f"P{len(tasks)}"
        onward = tuple(way for way in task.transitions if not way.conditions)
        others = tuple(way for way in task.transitions if way.conditions)
        tasks.append(task.model_copy(update={"transitions": (*others, Transition(target=name))}))
        wait = WaitRule(duration=draw(st.sampled_from([0, 0, 3, 11])))
        tasks.append(Task(name=name, action=Action.WAIT, wait=wait, transitions=onward))
        groups = [g.model_copy(update={"end": name}) if g.end == task.name else g for g in groups]
    return mission.model_copy(update={"tasks": tuple(tasks), "groups": tuple(groups)})


@st.composite
def with_branches(draw, mission):
    """Draw the mission with failures that lead to later tasks."""
    names = [task.name for task in mission.tasks if task.action is not Action.START]
    tasks = []
    for task in mission.tasks:
        ahead = names[names.index(task.name) + 1 :] if task.name in names else []
        if ahead and task.action is not Action.WAIT and draw(st.booleans()):
            target = draw(st.sampled_from(ahead))
            policy = {"on_failure": OnFailure.BRANCH, "failure_target": target}
            task = task.model_copy(update=policy)
        tasks.append(task)
    return mission.model_copy(update={"tasks": tuple(tasks)})


@st.composite
def with_windows(draw, mission):
    """Draw the mission with hard windows outside of groups, wide enough for some orders."""
    inside, outer = set(), None
    ends = {g.start: g.end for g in mission.groups if "/" not in g.name}
    tasks = []
    for task in mission.tasks:
        outer = outer or ends.get(task.name)
        inside |= {task.name} if outer else set()
        outer = None if outer == task.name else outer
        plain = task.action in (Action.MEASURE, Action.WAYPOINT) and task.name != "DOCK"
        if plain and task.name not in inside and draw(st.booleans()):
            earliest = draw(st.sampled_from([0, 0, 20, 70]))
            latest = draw(st.sampled_from([None, earliest + 25, earliest + 90]))
            window = TimeWindow(earliest=earliest, latest=latest)
            task = task.model_copy(update={"window": window})
        tasks.append(task)
    return mission.model_copy(update={"tasks": tuple(tasks)})


@dataclass
class Run:
    """Result of a run: tasks in the order of execution, and the time of its end."""

    tasks: list
    time: float
    finished: bool
    outcome: object = None


def run_mission(mission, matrix, values, steps=400, fails=frozenset()):
    """Execute a mission with a robot that takes the times of the matrix and keeps windows.

    `values` are the measured values of each checkpoint, used in turn and then again from the first.
    `fails` are the names of tasks whose actions fail.
    """
    number = {name: k for k, name in enumerate(matrix.tasks)}
    readings = {object_id: cycle(sequence) for object_id, sequence in values.items()}
    visited = []

    def execute_action(command, now):
        task, to = command.task, number[command.task.name]
        origin = number[visited[-1]] if visited else len(matrix.tasks)
        work = matrix.work[to]
        arrival = now + (matrix.time[origin, to] - work) * matrix.unit

        def action_event():
            visited.append(task.name)
            if task.name in fails:
                return ActionFailed(task.name, "failed")
            measures = task.action is Action.MEASURE
            return ActionSucceeded(
                task.name, float(next(readings[task.object_id])) if measures else None
            )

        return max(arrival, command.not_before or 0.0) + work * matrix.unit, action_event

    executor, _, now = play.run_mission(mission, execute_action, steps)
    return Run(visited, now, executor.finished, executor.outcome)


def random_order(planned, rng, swaps=30):
    """Return a random feasible order, made from the written one by feasible exchanges of units."""
    order = list(planned.written.order)
    levels = [planned.visits.chain.units, *(c.inside for c, _ in planned.visits.group_units)]
    levels = [level for level in levels if len(level) > 1]
    for _ in range(swaps if levels else 0):
        level = levels[rng.integers(len(levels))]
        blocks = [sorted(order.index(k) for k in planned.visits.visits_in((u,))) for u in level]
        blocks.sort()
        k = int(rng.integers(len(blocks) - 1))
        a, b = blocks[k], blocks[k + 1]
        swapped = order[: a[0]] + order[b[0] : b[-1] + 1] + order[a[0] : a[-1] + 1]
        swapped += order[b[-1] + 1 :]
        if evaluate(planned.problem, Tour(tuple(swapped))).feasible:
            order = swapped
    return Tour(tuple(order))
