"""From laid-out tasks to those of a mission: names, transitions, speeds, groups."""

from collections import Counter
from collections.abc import Sequence

from argo_compiler.il import Action, Group, OnFailure, Stop, Task, TimeWindow, Transition
from argo_compiler.script.documents.source import Diagnostics
from argo_compiler.script.resolve.lowering import Item, Lowered, Point, Range
from argo_compiler.script.resolve.program import own_names


def assemble(
    lowered: Lowered, diagnostics: Diagnostics
) -> tuple[tuple[Task, ...], tuple[Group, ...], dict[int, str]]:
    """The tasks, the groups, and the tasks' names by the identity of what they were made from."""
    items = lowered.items
    names = _name_tasks(items, diagnostics)
    by_item = {id(item): name for item, name in zip(items, names, strict=True)}
    groups = _name_groups(lowered.ranges)
    shown = [""] * len(items)
    for r in lowered.ranges:  # the inner ones come later
        shown[r.first : r.last + 1] = [groups[id(r.round)]] * (r.last + 1 - r.first)
    speeds = _speeds(lowered, names, diagnostics)
    tasks = tuple(
        _task(item, name, group, speed, by_item, diagnostics)
        for item, name, group, speed in zip(items, names, shown, speeds, strict=True)
    )
    made = tuple(
        Group(
            name=groups[id(r.round)],
            start=names[r.first],
            end=names[r.last],
            max_repeat_count=r.round.limits.count,
            max_repeat_duration=r.round.limits.duration,
            count_interruptions=r.round.limits.count_interruptions,
            stop=Stop.SOFT if r.round.limits.soft else Stop.HARD,
            every=r.round.limits.every,
            until=r.round.limits.until,
            source=r.round.span,
        )
        for r in sorted(lowered.ranges, key=lambda r: r.round.order)
    )
    return tasks, made, {id(item.do): by_item[id(item)] for item in items}


def _task(
    item: Item,
    name: str,
    group: str,
    speed: float | None,
    names: dict[int, str],
    diagnostics: Diagnostics,
) -> Task:
    do = item.do
    return Task(
        name=name,
        action=do.action,
        group=group if do.shown_in is None else do.shown_in,
        object_id=do.object_id,
        pose=do.pose,
        wait=do.wait,
        velocity=speed,
        joint_states=do.joints,
        retries=do.retries,
        on_failure=OnFailure.BRANCH if item.failure is not None else do.on_failure,
        failure_target=_name(item.failure, names),
        time_limit=do.time_limit,
        reading_limit=do.reading_limit,
        optional=do.optional,
        priority=do.priority,
        window=_window(do.window, _name(item.missed, names)),
        transitions=_transitions(item, names, diagnostics),
        source=do.source,
    )


def _window(window: TimeWindow | None, missed: str | None) -> TimeWindow | None:
    if window is None or missed is None:
        return window
    return window.model_copy(update={"missed_target": missed})


def _name(point: Point | None, names: dict[int, str]) -> str | None:
    item = None if point is None else point.reached()
    return None if item is None else names[id(item)]


def _transitions(
    item: Item, names: dict[int, str], diagnostics: Diagnostics
) -> tuple[Transition, ...]:
    found: list[Transition] = []
    decided = False
    for conditions, point in item.ways:
        target = _name(point, names)
        if not conditions:
            if decided:
                message = "only one transition can be without a condition"
                hint = "remove one of the two, or give it a condition"
                diagnostics.error("second-route", message, item.do.source, hint)
            decided = True
        if target is not None:
            found.append(Transition(target=target, conditions=conditions))
    following = None if decided else _name(item.next, names)
    if following is not None:
        found.append(Transition(target=following))
    return tuple(found)


def _speeds(lowered: Lowered, names: Sequence[str], diagnostics: Diagnostics) -> list[float | None]:
    """The speed of the way to each task: what is said of it, or of leaving a task before it."""
    items = lowered.items
    speeds = [item.do.velocity for item in items]
    if all(item.do.leaving is None for item in items):
        return speeds
    at = {id(item): i for i, item in enumerate(items)}
    sources: list[dict[int, None]] = [{} for _ in items]
    for i, item in enumerate(items):
        points = [point for _, point in item.ways]
        if all(conditions for conditions, _ in item.ways) and item.next is not None:
            points.append(item.next)
        for point in points:
            reached = point.reached()
            if reached is not None:
                sources[at[id(reached)]][i] = None
    for r in lowered.ranges:
        if r.round.limits.count != 1:
            sources[r.first][r.last] = None
    leaving = _passed_on(items, sources)
    left = {j for froms in sources for j in froms}
    for i, item in enumerate(items):
        if item.do.leaving is not None and i not in left:
            message = (
                "the mission ends with this task, so the speed of the drive after it has no effect"
            )
            hint = "remove it, or give the drive to a task its speed, as in `at 0.3 m/s`"
            diagnostics.warning("speed-unused", message, item.do.source, hint)
        if item.do.action is Action.WAIT:
            continue
        others = [j for j in sources[i] if leaving[j] is None]
        for j in sources[i]:
            value = leaving[j]
            if value is None:
                continue
            said, speeds[i] = speeds[i], value
            if said is not None and said != value:
                message = f"this path has two speeds: {value:g} and {said:g} m/s"
                diagnostics.error("two-speeds", message, items[j].do.source, "remove one of them")
            if others and item.do.velocity is None:
                elsewhere = ", ".join(f"'{names[o]}'" for o in others[:3])
                message = f"{value:g} m/s will be the speed on all paths to '{names[i]}', "
                message += f"including those from {elsewhere}"
                hint = f"plan a waypoint before '{names[i]}' if these should be slower or faster"
                diagnostics.warning("speed-shared", message, items[j].do.source, hint)
    return speeds


def _passed_on(items: Sequence[Item], sources: Sequence[dict[int, None]]) -> list[float | None]:
    """The speed at which each is left; places that take no time, at that of the task before."""
    leaving = [item.do.leaving for item in items]
    targets: list[list[int]] = [[] for _ in items]
    for i, froms in enumerate(sources):
        for j in froms:
            targets[j].append(i)
    work = [i for i, value in enumerate(leaving) if value is not None]
    while work:
        j = work.pop()
        for i in targets[j]:
            if items[i].do.action is Action.WAIT and leaving[i] is None:
                leaving[i] = leaving[j]
                work.append(i)
    return leaving


def _name_tasks(items: Sequence[Item], diagnostics: Diagnostics) -> list[str]:
    """A name for each task. Waypoints are numbered through; of others the second is
    `MEASURE 4 (2)`."""
    own: set[str] = set()
    for item in items:
        name = item.do.name
        if name is None:
            continue
        if name in own:
            message = f"more than one task is named `{name}`"
            hint = "give each task a different name"
            diagnostics.error("repeated-name", message, item.do.source, hint)
        own.add(name)
    return own_names([item.do for item in items])


def _name_groups(ranges: Sequence[Range]) -> dict[int, str]:
    """The name of each round, by the round's identity: `Alpha/Beta` lies in `Alpha`."""
    own = {r.round.name for r in ranges if r.round.name is not None}
    used: Counter[str] = Counter()
    bases: dict[int, str] = {}
    for r in sorted(ranges, key=lambda r: r.round.order):
        base = r.round.name
        while base is None:
            used[r.round.base] += 1
            count = used[r.round.base]
            found = r.round.base if count == 1 else f"{r.round.base} ({count})"
            base = None if found in own else found
        bases[id(r.round)] = base
    names: dict[int, str] = {}
    around: list[Range] = []
    for r in ranges:
        while around and around[-1].last < r.first:
            around.pop()
        base = bases[id(r.round)]
        parent = names[id(around[-1].round)] if around else None
        inside = parent is None or base.startswith(f"{parent}/")
        names[id(r.round)] = base if inside else f"{parent}/{base}"
        around.append(r)
    return names
