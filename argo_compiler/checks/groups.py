"""Whether the groups of a mission are well formed: names, ranges, nesting, and a way out of each.

The names of the groups and the ranges of their tasks have to tell the same story: a group lies in
another one if and only if its name says so.
"""

from bisect import bisect_left
from collections.abc import Iterator, Mapping

from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.checks.about import About
from argo_compiler.checks.instant_loops import MIN_TIME_S
from argo_compiler.checks.timing import has_timing_or_branch
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, Group, Mission, Stop, Task
from argo_compiler.il.grouping import (
    GroupNesting,
    GroupRange,
    group_ranges,
    parent_name,
    task_positions,
)
from argo_compiler.il.subjects import Subjects
from argo_compiler.il.transitions import default_target, failure_targets

MIN_PERIOD_S = 1.0
"""Rounds that are late are made up for at once, so not too many may come to be late in a pause."""

_MOST_HINTS = 20
"""missing names for which a similar one is looked up"""


def check_groups(mission: Mission) -> tuple[Diagnostic, ...]:
    """All that is wrong with a mission's groups.

    Whether an endless group is ever left is looked at only where nothing else is wrong.
    """
    if not mission.groups:
        return ()
    ranges = group_ranges(mission)
    subjects = Subjects(mission)
    diagnostics = [
        *_check_names(mission.groups, subjects),
        *_check_ends(mission, subjects),
        *_check_nesting(ranges, subjects),
        *_check_starts(mission, ranges, subjects),
    ]
    if not diagnostics and ranges:
        layout = GroupNesting.from_mission(mission)
        diagnostics += _check_endless(mission, layout, subjects)
        diagnostics += _check_leaving(mission, layout, subjects)
    return (*diagnostics, *_check_unused(mission.groups, subjects))


def _check_names(groups: tuple[Group, ...], subjects: Subjects) -> Iterator[Diagnostic]:
    names = {group.name for group in groups}
    seen: set[str] = set()
    for i, group in enumerate(groups):
        about = About(subjects.group(i), group.source)
        if group.name in seen:
            yield about.diagnostic(
                "il.duplicate-group",
                f"more than one group is named '{group.name}'",
                "give each group a name of its own",
                ".name",
            )
        seen.add(group.name)
        parent = parent_name(group.name)
        if not all(group.name.split("/")):
            yield about.diagnostic(
                "il.group-name",
                f"the group name '{group.name}' has an empty part",
                "separate the names of nested groups by one '/', as in 'Alpha/Beta'",
                ".name",
            )
        elif parent is not None and parent not in names:
            yield about.diagnostic(
                "il.group-parent",
                f"group '{group.name}' is to lie in group '{parent}', which does not exist",
                f"add a group '{parent}' around it or take the '/' out of its name",
                ".name",
            )


def _check_ends(mission: Mission, subjects: Subjects) -> Iterator[Diagnostic]:
    position = task_positions(mission)
    hints = 0
    for i, group in enumerate(mission.groups):
        about = About(subjects.group(i), group.source)
        unknown = {group.end: ".end", group.start: ".start"}
        unknown = {name: field for name, field in unknown.items() if name not in position}
        for name, field in reversed(unknown.items()):
            hints += 1
            near = nearest_name(name, position) if hints <= _MOST_HINTS else None
            yield about.diagnostic(
                "il.unknown-group-task",
                f"group '{group.name}' begins or ends with '{name}', which is no task of the "
                "mission",
                f"is '{near}' meant?" if near else "a group's start and end are names of tasks",
                field,
            )
        if not unknown and position[group.start] > position[group.end]:
            yield about.diagnostic(
                "il.group-order",
                f"group '{group.name}' starts with task '{group.start}', which comes after its "
                f"end '{group.end}' in the list of tasks",
                "swap its start and end or reorder the tasks",
                ".start",
            )
        if group.stop is Stop.HARD and 0 < group.max_repeat_duration < MIN_TIME_S:
            yield about.diagnostic(
                "il.group-duration",
                f"the time of group '{group.name}' is up after {group.max_repeat_duration:g} s, "
                "before any action could be carried out",
                f"allow it at least {MIN_TIME_S:g} s, or 0 for no limit",
                ".max_repeat_duration",
            )
        if 0 < group.every < MIN_PERIOD_S:
            yield about.diagnostic(
                "il.group-period",
                f"the rounds of group '{group.name}' are to begin every {group.every:g} s, before "
                "any of them could be over",
                f"allow at least {MIN_PERIOD_S:g} s, or 0 for rounds without a pause",
                ".every",
            )


def _check_nesting(ranges: tuple[GroupRange, ...], subjects: Subjects) -> Iterator[Diagnostic]:
    by_name = {r.group.name: r for r in ranges}
    around: list[GroupRange] = []
    for r in ranges:
        name = r.group.name
        parent = by_name.get(parent_name(name) or "")
        if parent and not (parent.contains(r.first) and parent.contains(r.last)):
            yield About(subjects.group(r.index), r.group.source).diagnostic(
                "il.group-outside-parent",
                f"group '{name}' reaches beyond group '{parent.group.name}', in which it is to lie",
                f"keep its tasks between '{parent.group.start}' and '{parent.group.end}'",
            )
        while around and around[-1].last < r.first:
            around.pop()
        if around and not name.startswith(around[-1].group.name + "/"):
            other = around[-1]
            same = (other.first, other.last) == (r.first, r.last)
            yield About(subjects.group(r.index), r.group.source).diagnostic(
                "il.group-same-range" if same else "il.group-overlap",
                f"groups '{other.group.name}' and '{name}' "
                + ("have the same tasks" if same else f"both contain task '{r.group.start}'")
                + ", and neither name says that one lies in the other",
                f"name the inner one '{other.group.name}/{name.rpartition('/')[2]}' if it is to "
                "lie in the other, else separate their tasks",
            )
        around.append(r)


def _check_starts(
    mission: Mission, ranges: tuple[GroupRange, ...], subjects: Subjects
) -> Iterator[Diagnostic]:
    starts = [i for i, task in enumerate(mission.tasks) if task.action is Action.START]
    for r in ranges:
        i = bisect_left(starts, r.first)
        if i < len(starts) and r.contains(starts[i]):
            yield About(subjects.group(r.index), r.group.source).diagnostic(
                "il.start-in-group",
                f"the START task '{mission.tasks[starts[i]].name}' lies in group '{r.group.name}'",
                "move START before the group: it is not repeated",
            )


def _check_unused(groups: tuple[Group, ...], subjects: Subjects) -> Iterator[Diagnostic]:
    for i, group in enumerate(groups):
        about = About(subjects.group(i), group.source)
        if group.count_interruptions and not group.max_repeat_duration:
            yield about.diagnostic(
                "il.unused-field",
                f"group '{group.name}' has no duration that interruptions could count as part of",
                "give it max_repeat_duration, or remove count_interruptions",
                ".count_interruptions",
            )
        if group.max_repeat_count == 1:
            for field in (f for f in ("every", "until") if getattr(group, f)):
                yield about.diagnostic(
                    "il.unused-field",
                    f"group '{group.name}' has one round only, so its `{field}` has no effect",
                    "remove it, or allow more rounds",
                    f".{field}",
                )


def _check_leaving(
    mission: Mission, layout: GroupNesting, subjects: Subjects
) -> Iterator[Diagnostic]:
    """Each way that leaves a repeated group before the end of its round (G14).

    Endless groups have no other way out, and groups of one round nothing to lose.
    """
    position = task_positions(mission)
    for i, task in enumerate(mission.tasks):
        innermost = layout.innermost[i]
        if innermost is None or _stays(task, layout.ranges[innermost], position):
            continue
        for field, target in _ways_out(task):
            to = position.get(target)
            inside: int | None = innermost
            left = None
            unconditional = field is None
            while inside is not None and to is not None and not layout.ranges[inside].contains(to):
                r = layout.ranges[inside]
                ends = unconditional and r.last == i
                if not ends and r.group.max_repeat_count != 1 and not _endless(r.group):
                    left = r.group
                inside = layout.parent[inside]
            if left is None:
                continue
            yield About(subjects.task(i), task.source).diagnostic(
                "il.leaves-round",
                f"the way from task '{task.name}' to '{target}' leaves the rounds of group "
                f"'{left.name}' before they are over",
                f"lead it to '{left.end}' if the round is to be completed",
                field or ".transitions",
            )


def _stays(task: Task, around: GroupRange, position: Mapping[str, int]) -> bool:
    """Whether it is seen at a glance that all ways from a task lead to the range around it."""
    if len(task.transitions) != 1 or has_timing_or_branch(task):
        return False
    to = position.get(task.transitions[0].target)
    return to is not None and around.contains(to)


def _ways_out(task: Task) -> Iterator[tuple[str | None, str]]:
    """The targets of a task's ways with their fields; None for the unconditional one."""
    for k, transition in enumerate(task.transitions):
        yield f".transitions[{k}].target" if transition.conditions else None, transition.target
    for field, target in failure_targets(task).items():
        yield f".{field}", target


def _endless(group: Group) -> bool:
    return not (group.max_repeat_count or group.max_repeat_duration or group.until)


def _check_endless(
    mission: Mission, layout: GroupNesting, subjects: Subjects
) -> Iterator[Diagnostic]:
    """Endless groups that no transition leaves, and no time-out of a group around them.

    A transition leaves a group if its target lies outside the group's range. So the lowest and the
    highest target of all members decide; they are gathered from the innermost groups outward.
    """
    if not any(_endless(r.group) for r in layout.ranges):
        return
    lowest, highest = _target_bounds(mission, layout)
    bounded = [False] * len(layout.ranges)
    for i, r in enumerate(layout.ranges):
        parent = layout.parent[i]
        bounded[i] = r.group.ends_at_once or (parent is not None and bounded[parent])
    for i in reversed(range(len(layout.ranges))):
        parent = layout.parent[i]
        if parent is not None:
            lowest[parent] = min(lowest[parent], lowest[i])
            highest[parent] = max(highest[parent], highest[i])
    for i, r in enumerate(layout.ranges):
        left = lowest[i] < r.first or highest[i] > r.last
        if _endless(r.group) and not left and not bounded[i]:
            yield About(subjects.group(r.index), r.group.source).diagnostic(
                "il.endless-group",
                f"group '{r.group.name}' is repeated for ever: it has neither a count nor a "
                "duration, and no transition that can be taken leaves it",
                "give it max_repeat_count or max_repeat_duration, or a conditional transition to "
                "a task outside",
            )


def _target_bounds(mission: Mission, layout: GroupNesting) -> tuple[list[int], list[int]]:
    """For each group, the lowest and highest target of the tasks of which it is the innermost.

    The end of the mission counts as a target behind the last task.
    """
    position = task_positions(mission)
    end = len(mission.tasks)
    lowest = [end] * len(layout.ranges)
    highest = [-1] * len(layout.ranges)
    for i, task in enumerate(mission.tasks):
        innermost = layout.innermost[i]
        if innermost is None:
            continue
        targets = [position.get(target, i) for field, target in _ways_out(task) if field]
        if _goes_on(layout, i):
            default = default_target(task)
            targets.append(end if default is None else position.get(default, i))
        for target in targets:
            lowest[innermost] = min(lowest[innermost], target)
            highest[innermost] = max(highest[innermost], target)
    return lowest, highest


def _goes_on(layout: GroupNesting, task: int) -> bool:
    """Whether the unconditional transition of a task can be taken at all.

    It can't where an endless group ends with the task, unless the time of a group further out that
    ends there too can be up.
    """
    for i in reversed(layout.ending[task]):
        if layout.ranges[i].group.ends_at_once:
            return True
        if _endless(layout.ranges[i].group):
            return False
    return True
