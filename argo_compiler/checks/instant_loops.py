"""Check for cycles of visits that take no time (rule W7)."""

from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter

from argo_compiler.base.message import Listing, Message
from argo_compiler.checks.checked_item import CheckedItem
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, Mission, OnFailure, Task
from argo_compiler.il.grouping import GroupRange, valid_ranges_parents_first
from argo_compiler.il.subjects import Subjects

MIN_TIME_S = 1e-3
"""shorter durations count as no time: the machine might take endless steps at one time"""

MOST_ROUNDS = 1000
"""how many rounds may follow each other without taking time, those of nested groups multiplied"""

_SHOWN = 8  # tasks of a cycle that a message names


def check_instant_loops(mission: Mission) -> Iterator[Diagnostic]:
    """Yield one diagnostic if there is a cycle of tasks that may all end as soon as entered."""
    instant = {
        task.name
        for task in mission.tasks
        if _ends_at_once(task) or _fails_at_once(task) or _may_be_missed(task)
    }
    if not instant:
        return
    graph = {task.name: set(_instant_successors(task)) & instant for task in mission.tasks
             if task.name in instant}  # fmt: skip
    for around in _unlimited_groups(mission):
        if around.group.end in instant and around.group.start in instant:
            graph[around.group.end].add(around.group.start)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        # The error lists each task before its predecessor, and the first one again at the end.
        cycle = error.args[1][::-1]
        position = next(i for i, t in enumerate(mission.tasks) if t.name == cycle[0])
        shown = Listing(cycle if len(cycle) <= _SHOWN else [*cycle[:_SHOWN], "..."])
        yield CheckedItem(
            Subjects(mission).task_subject(position), mission.tasks[position].source
        ).diagnostic(
            "il.instant-loop",
            Message(
                "the tasks {shown:>} form a loop in which nothing takes time, so the mission "
                "might never leave it",
                shown=shown,
            ),
            Message(
                "give a WAIT in it a duration, give the group `every` or at most "
                "{most_rounds} rounds, or remove a hard window",
                most_rounds=MOST_ROUNDS,
            ),
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


def _instant_successors(task: Task) -> Iterator[str]:
    """Yield the names of the tasks that may follow at the moment when `task` is entered."""
    continues = _ends_at_once(task)
    fails = _fails_at_once(task)
    if _may_be_missed(task) and task.window is not None:
        if task.window.missed_target is not None:
            yield task.window.missed_target
        else:
            fails = True
    if fails and task.on_failure is OnFailure.BRANCH and task.failure_target is not None:
        yield task.failure_target
    elif fails and task.on_failure is OnFailure.CONTINUE:
        continues = True
    if continues:
        yield from (transition.target for transition in task.transitions)


def _unlimited_groups(mission: Mission) -> Iterator[GroupRange]:
    """Yield the groups whose rounds may follow each other at once too often.

    Too often is without limit, or more than MOST_ROUNDS times, multiplied by the rounds of the
    groups around.
    """
    around: list[tuple[GroupRange, int]] = []
    for inner in valid_ranges_parents_first(mission):
        while around and around[-1][0].last < inner.first:
            around.pop()
        count = inner.group.max_repeat_count
        outer = around[-1][1] if around else 1
        rounds = count * max(outer, 1)
        around.append((inner, rounds))
        if not inner.group.every and (count == 0 or rounds > MOST_ROUNDS):
            yield inner
