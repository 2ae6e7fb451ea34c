"""Checks of groups: names, ranges, nesting, and whether an endless group can be left.

The names of the groups must agree with the ranges of their tasks: a group lies in another one if
and only if its name says so.
"""

from bisect import bisect_left
from collections.abc import Iterator, Mapping

from argo_compiler.base.message import Message, identifier
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.checks.checked_item import CheckedItem
from argo_compiler.checks.instant_loops import MIN_TIME_S
from argo_compiler.checks.timing import has_failure_branch_or_time_rule
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, Group, Mission, OnFailure, Stop, Task
from argo_compiler.il.grouping import (
    GroupNesting,
    GroupRange,
    parent_name,
    task_positions,
    valid_ranges_parents_first,
)
from argo_compiler.il.subjects import Subjects
from argo_compiler.il.transitions import default_target, failure_targets_by_field

MIN_PERIOD_S = 1.0
"""least `every`: late rounds are made up for at once, so a pause must not make too many of them
late"""

_MOST_HINTS = 20
"""number of unknown names for which a similar name is searched"""


def check_groups(mission: Mission) -> tuple[Diagnostic, ...]:
    """Return the diagnostics of a mission's groups.

    Whether an endless group is ever left is checked only if its other checks give no diagnostics.
    """
    if not mission.groups:
        return ()
    ranges = valid_ranges_parents_first(mission)
    subjects = Subjects(mission)
    diagnostics = [
        *_check_names(mission.groups, subjects),
        *_check_fields(mission, subjects),
        *_check_nesting(ranges, subjects),
        *_check_starts(mission, ranges, subjects),
    ]
    if not diagnostics and ranges:
        nesting = GroupNesting.from_mission(mission)
        diagnostics += _check_endless(mission, nesting, subjects)
        diagnostics += _check_leaving_rounds(mission, nesting, subjects)
    return (*diagnostics, *_check_unused(mission.groups, subjects))


def _check_names(groups: tuple[Group, ...], subjects: Subjects) -> Iterator[Diagnostic]:
    names = {group.name for group in groups}
    seen: set[str] = set()
    for i, group in enumerate(groups):
        item = CheckedItem(subjects.group_subject(i), group.source)
        if group.name in seen:
            yield item.diagnostic(
                "il.duplicate-group",
                Message("more than one group is named '{group}'", group=group.name),
                "give each group a name of its own",
                ".name",
            )
        seen.add(group.name)
        parent = parent_name(group.name)
        if not all(group.name.split("/")):
            yield item.diagnostic(
                "il.group-name",
                Message("the group name '{group}' has an empty part", group=group.name),
                "separate the names of nested groups by one '/', as in 'Alpha/Beta'",
                ".name",
            )
        elif parent is not None and parent not in names:
            yield item.diagnostic(
                "il.group-parent",
                Message(
                    "group '{group}' should lie in group '{parent}', which does not exist",
                    group=group.name,
                    parent=parent,
                ),
                Message(
                    "add a group '{parent}' around it or remove the '/' from its name",
                    parent=parent,
                ),
                ".name",
            )


def _check_fields(mission: Mission, subjects: Subjects) -> Iterator[Diagnostic]:
    position = task_positions(mission)
    hints = 0
    for i, group in enumerate(mission.groups):
        item = CheckedItem(subjects.group_subject(i), group.source)
        unknown = {group.end: ".end", group.start: ".start"}
        unknown = {name: field for name, field in unknown.items() if name not in position}
        for name, field in reversed(unknown.items()):
            hints += 1
            near = nearest_name(name, position) if hints <= _MOST_HINTS else None
            yield item.diagnostic(
                "il.unknown-group-task",
                Message(
                    "group '{group}' starts or ends with '{name}', which is not a task of the "
                    "mission",
                    group=group.name,
                    name=name,
                ),
                Message("is '{near}' meant?", near=near)
                if near
                else Message("a group's start and end are names of tasks"),
                field,
            )
        if not unknown and position[group.start] > position[group.end]:
            yield item.diagnostic(
                "il.group-order",
                Message(
                    "group '{group}' starts with task '{start}', which comes after its end "
                    "'{end}' in the list of tasks",
                    group=group.name,
                    start=group.start,
                    end=group.end,
                ),
                "swap its start and end or reorder the tasks",
                ".start",
            )
        if group.stop is Stop.HARD and 0 < group.max_repeat_duration < MIN_TIME_S:
            yield item.diagnostic(
                "il.group-duration",
                Message(
                    "the time of group '{group}' is up after {max_repeat_duration:g} s, before "
                    "any action could be executed",
                    group=group.name,
                    max_repeat_duration=group.max_repeat_duration,
                ),
                Message(
                    "allow it at least {min_time_s:g} s, or 0 for no limit", min_time_s=MIN_TIME_S
                ),
                ".max_repeat_duration",
            )
        if 0 < group.every < MIN_PERIOD_S:
            yield item.diagnostic(
                "il.group-period",
                Message(
                    "the rounds of group '{group}' would start every {every:g} s, before any "
                    "of them could be over",
                    group=group.name,
                    every=group.every,
                ),
                Message(
                    "allow at least {min_period_s:g} s, or 0 for rounds without a pause",
                    min_period_s=MIN_PERIOD_S,
                ),
                ".every",
            )


def _check_nesting(ranges: tuple[GroupRange, ...], subjects: Subjects) -> Iterator[Diagnostic]:
    by_name = {r.group.name: r for r in ranges}
    around: list[GroupRange] = []
    for r in ranges:
        name = r.group.name
        parent = by_name.get(parent_name(name) or "")
        if parent and not (parent.contains(r.first) and parent.contains(r.last)):
            yield CheckedItem(subjects.group_subject(r.index), r.group.source).diagnostic(
                "il.group-outside-parent",
                Message(
                    "group '{name}' reaches beyond group '{group}', in which it must lie",
                    name=name,
                    group=parent.group.name,
                ),
                Message(
                    "keep its tasks between '{start}' and '{end}'",
                    start=parent.group.start,
                    end=parent.group.end,
                ),
            )
        while around and around[-1].last < r.first:
            around.pop()
        if around and not name.startswith(around[-1].group.name + "/"):
            other = around[-1]
            same = (other.first, other.last) == (r.first, r.last)
            yield CheckedItem(subjects.group_subject(r.index), r.group.source).diagnostic(
                "il.group-same-range" if same else "il.group-overlap",
                Message("groups '{group}' and '{name}' ", group=other.group.name, name=name)
                + (
                    Message("have the same tasks")
                    if same
                    else Message("both contain task '{start}'", start=r.group.start)
                )
                + Message(", and neither name says that one lies in the other"),
                Message(
                    "name the inner one '{group}/{rpartition}' if it has to lie in the other, "
                    "else separate their tasks",
                    group=other.group.name,
                    rpartition=name.rpartition("/")[2],
                ),
            )
        around.append(r)


def _check_starts(
    mission: Mission, ranges: tuple[GroupRange, ...], subjects: Subjects
) -> Iterator[Diagnostic]:
    starts = [i for i, task in enumerate(mission.tasks) if task.action is Action.START]
    for r in ranges:
        i = bisect_left(starts, r.first)
        if i < len(starts) and r.contains(starts[i]):
            yield CheckedItem(subjects.group_subject(r.index), r.group.source).diagnostic(
                "il.start-in-group",
                Message(
                    "the START task '{task}' lies in group '{group}'",
                    task=mission.tasks[starts[i]].name,
                    group=r.group.name,
                ),
                "move START before the group: it is not repeated",
            )


def _check_unused(groups: tuple[Group, ...], subjects: Subjects) -> Iterator[Diagnostic]:
    for i, group in enumerate(groups):
        item = CheckedItem(subjects.group_subject(i), group.source)
        if group.count_interruptions and not group.max_repeat_duration:
            yield item.diagnostic(
                "il.unused-field",
                Message(
                    "group '{group}' has no duration, so `count_interruptions` has no effect",
                    group=group.name,
                ),
                "give it max_repeat_duration, or remove count_interruptions",
                ".count_interruptions",
            )
        if group.max_repeat_count == 1:
            for field in (f for f in ("every", "until") if getattr(group, f)):
                yield item.diagnostic(
                    "il.unused-field",
                    Message(
                        "group '{group}' has one round only, so its `{field}` has no effect",
                        group=group.name,
                        field=identifier(field),
                    ),
                    "remove it, or allow more rounds",
                    f".{field}",
                )


def _check_leaving_rounds(
    mission: Mission, nesting: GroupNesting, subjects: Subjects
) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each transition that leaves a repeated group amid a round (G14).

    Endless groups are exempt, as they can't be left in another way, and so are groups of one round,
    as no further rounds are lost.
    """
    position = task_positions(mission)
    for i, task in enumerate(mission.tasks):
        innermost = nesting.innermost[i]
        if innermost is None or _stays_inside(task, nesting.ranges[innermost], position):
            continue
        for field, target in _targets_by_field(task):
            to = position.get(target)
            inside: int | None = innermost
            group = None
            unconditional = field is None
            while inside is not None and to is not None and not nesting.ranges[inside].contains(to):
                r = nesting.ranges[inside]
                ends = unconditional and r.last == i
                if not ends and r.group.max_repeat_count != 1 and not _is_endless(r.group):
                    group = r.group
                inside = nesting.parent[inside]
            if group is None:
                continue
            yield CheckedItem(subjects.task_subject(i), task.source).diagnostic(
                "il.leaves-round",
                Message(
                    "the transition from task '{task}' to '{target}' leaves the rounds of "
                    "group '{group}' before they are over",
                    task=task.name,
                    target=target,
                    group=group.name,
                ),
                Message("lead it to '{end}' if the round has to be completed", end=group.end),
                field or ".transitions",
            )


def _stays_inside(task: Task, around: GroupRange, position: Mapping[str, int]) -> bool:
    """Return True if the only transition of a task leads to a task in the range `around`.

    This is a quick test: it returns False for any task with more than one transition.
    """
    if len(task.transitions) != 1 or has_failure_branch_or_time_rule(task):
        return False
    to = position.get(task.transitions[0].target)
    return to is not None and around.contains(to)


def _targets_by_field(task: Task) -> Iterator[tuple[str | None, str]]:
    """Yield the field and the target of each transition, also of those after failures.

    The field is a path within the task, or None for the unconditional transition.
    """
    for k, transition in enumerate(task.transitions):
        yield f".transitions[{k}].target" if transition.conditions else None, transition.target
    for field, target in failure_targets_by_field(task).items():
        yield f".{field}", target


def _is_endless(group: Group) -> bool:
    return not (group.max_repeat_count or group.max_repeat_duration or group.until)


def _check_endless(
    mission: Mission, nesting: GroupNesting, subjects: Subjects
) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each endless group that no transition or outer time-out can end.

    A transition leaves a group if the position of its target lies outside the group's range. So the
    lowest and the highest target position of all tasks of the group decide; they are collected from
    the innermost groups outward. An outer time-out is that of a group around the endless one.
    """
    if not any(_is_endless(r.group) for r in nesting.ranges):
        return
    lowest, highest = _target_bounds(mission, nesting)
    bounded = [False] * len(nesting.ranges)
    for i, r in enumerate(nesting.ranges):
        parent = nesting.parent[i]
        bounded[i] = r.group.has_hard_stop or (parent is not None and bounded[parent])
    for i in reversed(range(len(nesting.ranges))):
        parent = nesting.parent[i]
        if parent is not None:
            lowest[parent] = min(lowest[parent], lowest[i])
            highest[parent] = max(highest[parent], highest[i])
    for i, r in enumerate(nesting.ranges):
        left = lowest[i] < r.first or highest[i] > r.last
        if _is_endless(r.group) and not left and not bounded[i]:
            ending = any(
                task.on_failure in (OnFailure.ABORT, OnFailure.RETURN)
                for task in mission.tasks[r.first : r.last + 1]
            )
            yield CheckedItem(subjects.group_subject(r.index), r.group.source).diagnostic(
                "il.endless-group",
                Message(
                    "group '{group}' is repeated without end{part}: it has neither a count nor "
                    "a duration, and no transition that can be taken leaves it",
                    group=r.group.name,
                    part=Message(" unless a task fails") if ending else "",
                ),
                "give it max_repeat_count or max_repeat_duration, or a conditional transition to "
                "a task outside",
            )


def _target_bounds(mission: Mission, nesting: GroupNesting) -> tuple[list[int], list[int]]:
    """Return, for each group, the lowest and the highest target position of its own tasks.

    A group's own tasks are those of which it is the innermost group. The first list has the lowest
    positions, the second the highest ones; without own tasks they are the end and -1. The end of
    the mission counts as a target behind the last task.
    """
    position = task_positions(mission)
    end = len(mission.tasks)
    lowest = [end] * len(nesting.ranges)
    highest = [-1] * len(nesting.ranges)
    for i, task in enumerate(mission.tasks):
        innermost = nesting.innermost[i]
        if innermost is None:
            continue
        targets = [position.get(target, i) for field, target in _targets_by_field(task) if field]
        if _can_continue(nesting, i):
            default = default_target(task)
            targets.append(end if default is None else position.get(default, i))
        for target in targets:
            lowest[innermost] = min(lowest[innermost], target)
            highest[innermost] = max(highest[innermost], target)
    return lowest, highest


def _can_continue(nesting: GroupNesting, task: int) -> bool:
    """Return True if the unconditional transition of a task can ever be taken.

    `task` is a position. The transition can't be taken if an endless group ends with the task,
    unless a group around that one ends with the task too and has a time-out.
    """
    for i in reversed(nesting.ending[task]):
        if nesting.ranges[i].group.has_hard_stop:
            return True
        if _is_endless(nesting.ranges[i].group):
            return False
    return True
