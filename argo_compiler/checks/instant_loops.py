"""Circles of visits none of which takes time (rule W7)."""

from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter

from argo_compiler.checks.about import About
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, Mission, OnFailure, Task
from argo_compiler.il.grouping import GroupRange, group_ranges
from argo_compiler.il.subjects import Subjects

MIN_TIME_S = 1e-3
"""What lasts shorter takes no time: the machine might take steps for ever in one moment."""

MOST_ROUNDS = 1000
"""that may follow each other in one moment, those of nested groups multiplied"""

_SHOWN = 8  # tasks of a circle that a message names


def check_instant_loops(mission: Mission) -> Iterator[Diagnostic]:
    """A circle of tasks each of which may be over as soon as it is come to."""
    instant = {
        task.name
        for task in mission.tasks
        if _ends_at_once(task) or _fails_at_once(task) or _may_be_missed(task)
    }
    if not instant:
        return
    graph = {task.name: set(_onward(task)) & instant for task in mission.tasks
             if task.name in instant}  # fmt: skip
    for around in _unlimited(mission):
        if around.group.end in instant and around.group.start in instant:
            graph[around.group.end].add(around.group.start)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        # It names each task with the one before it, the first one again at the end.
        circle = error.args[1][::-1]
        position = next(i for i, t in enumerate(mission.tasks) if t.name == circle[0])
        shown = " > ".join(circle if len(circle) <= _SHOWN else [*circle[:_SHOWN], "..."])
        yield About(Subjects(mission).task(position), mission.tasks[position].source).diagnostic(
            "il.instant-loop",
            f"nothing takes time on the way {shown}, so the mission might go round for ever in one "
            "moment",
            "let a WAIT on it last, give the group `every` or at most "
            f"{MOST_ROUNDS} rounds, or take a hard window away",
        )


def _ends_at_once(task: Task) -> bool:
    rule = task.wait
    if rule is None or task.action is not Action.WAIT:
        return False
    return bool(rule.conditions) if rule.duration is None else rule.duration < MIN_TIME_S


def _fails_at_once(task: Task) -> bool:
    limit = task.wait.limit if task.wait is not None else None
    return limit is not None and limit < MIN_TIME_S and task.action is Action.WAIT


def _may_be_missed(task: Task) -> bool:
    return task.window is not None and task.window.hard and task.window.latest is not None


def _onward(task: Task) -> Iterator[str]:
    """The tasks that may follow one that took no time."""
    goes_on = _ends_at_once(task)
    fails = _fails_at_once(task)
    if _may_be_missed(task) and task.window is not None:
        if task.window.missed_target is not None:
            yield task.window.missed_target
        else:
            fails = True
    if fails and task.on_failure is OnFailure.BRANCH and task.failure_target is not None:
        yield task.failure_target
    elif fails and task.on_failure is OnFailure.CONTINUE:
        goes_on = True
    if goes_on:
        yield from (transition.target for transition in task.transitions)


def _unlimited(mission: Mission) -> Iterator[GroupRange]:
    """The groups whose rounds may follow each other at once, and too often."""
    around: list[tuple[GroupRange, int]] = []
    for inner in group_ranges(mission):
        while around and around[-1][0].last < inner.first:
            around.pop()
        count = inner.group.max_repeat_count
        outer = around[-1][1] if around else 1
        rounds = count * max(outer, 1)
        around.append((inner, rounds))
        if not inner.group.every and (count == 0 or rounds > MOST_ROUNDS):
            yield inner
