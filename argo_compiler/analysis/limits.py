"""Diagnostics on duration, battery, ages of values, and locations that can't be reached."""

import heapq
import math
from collections.abc import Callable, Iterator

from argo_compiler.analysis.bounds import MissionBounds
from argo_compiler.analysis.charging import diagnose_charging
from argo_compiler.analysis.reachability import objects_that_others_may_report
from argo_compiler.analysis.results import Bound, Bounds, Stretch
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.travel import NoPath, Travel
from argo_compiler.analysis.windows import diagnose_task_time_limits, diagnose_windows
from argo_compiler.base.listing import brief_quoted_list
from argo_compiler.base.message import Message
from argo_compiler.base.model import Pose
from argo_compiler.base.quantity_text import (
    energy_text,
    exceeding_duration_text,
    least_duration_text,
    least_energy_text,
    limit_text,
    most_duration_text,
    most_energy_text,
)
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.hfsm.charging import LOW
from argo_compiler.hfsm.conditions import condition_text
from argo_compiler.il import (
    Action,
    Afterwards,
    ConditionType,
    EventKind,
    OnFailure,
    Reaction,
    Response,
    Task,
)

AGE_WORK = 3_000_000
"""greatest effort of the search for ages: number of objects times number of steps"""
_SHOWN = 8  # parts of a path that a message lists


def diagnose_limits_and_missing_paths(
    study: Study, travel: Travel, worst_case_duration: Bound | None = None
) -> Iterator[Diagnostic]:
    """Yield diagnostics on poses without a path, time limits, windows, duration and battery.

    `worst_case_duration` is the upper bound on the duration whatever fails and whatever events
    occur; None if it could not be computed.
    """
    yield from _blocked_tasks(study)
    yield from _blocked_retreats(study, travel)
    yield from diagnose_task_time_limits(study)
    yield from diagnose_charging(study, travel)
    bounds = study.bounds_if_computable
    if bounds is None or bounds.duration is None or bounds.energy is None:
        return
    if study.mission.max_duration is not None:
        if any(
            r.event is EventKind.TIME_UP and always_ends_mission_or_holds(r)
            for r in study.mission.reactions
        ):
            yield from _cut_short(study, bounds, study.mission.max_duration, worst_case_duration)
        else:
            yield from _too_long(study, bounds.duration, study.mission.max_duration)
    yield from diagnose_windows(study, bounds)
    if travel.battery is not None:
        yield from _battery_exceeded(study, bounds.energy, travel.battery)
        yield from _no_way_back(study, bounds.energy, travel)


def _blocked_tasks(study: Study) -> Iterator[Diagnostic]:
    for leaf, reason in sorted(study.costs.blocked.items()):
        yield study.diagnostic(
            "unreachable-place",
            Message(
                "the robot can't execute task '{task}': {reason}",
                task=study.name(leaf),
                reason=reason,
            ),
            "choose another pose or checkpoint, or remove the task",
            leaf,
        )


def _blocked_retreats(study: Study, travel: Travel) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each pose of a reaction, and the dock, that the robot can't drive to.

    The dock counts only if a reaction or a failure sends the robot there. The drive begins where
    the mission starts.
    """
    mission = study.mission
    retreats: list[tuple[Pose, str, str]] = []
    aim: str
    back = any(r.response is Response.RETURN and r.pose is None for r in mission.reactions) or any(
        t.on_failure is OnFailure.RETURN for t in mission.tasks
    )
    if back and mission.dock is not None:
        retreats.append((mission.dock, "dock", Message("return to the dock")))
    for reaction in mission.reactions:
        if reaction.response.drives and reaction.pose is not None:
            where = (
                Message("dock") if reaction.response is Response.RETURN else Message("safe area")
            )
            aim = Message(
                "go to the {where} of the reaction to {event}", where=where, event=reaction.event
            )
            retreats.append((reaction.pose, subject_of("reactions", reaction.event, ".pose"), aim))
    start = travel.start_pose(mission)
    for pose, subject, aim in retreats:
        drive = Task(name="retreat", action=Action.WAYPOINT, pose=pose)
        leg = travel.leg_with_action(start, drive, None)
        if isinstance(leg, NoPath):
            yield study.diagnostic(
                "unreachable-place",
                Message("the robot can't {aim}: {reason}", aim=aim, reason=leg.reason),
                "choose a pose that it can reach",
                subject=subject,
            )


def _too_long(study: Study, duration: Bounds, limit: float) -> Iterator[Diagnostic]:
    least, most = duration.least.value, duration.most.value
    if least is not None and least > limit:
        yield study.diagnostic(
            "too-long",
            Message(
                "the mission takes at least {exceeding_duration} if nothing fails, longer "
                "than its maximum duration of {limit} (shortest: {bound_path})",
                exceeding_duration=exceeding_duration_text(least, limit),
                limit=limit_text(limit),
                bound_path=bound_path_text(duration.least, least_duration_text),
            ),
            "leave out tasks, shorten groups, or allow more time",
            subject="max_duration",
        )
    elif most is not None and most > limit:
        yield study.diagnostic(
            "maybe-too-long",
            Message(
                "the mission may take up to {most_duration}, longer than its maximum "
                "duration of {limit} (longest: {bound_path})",
                most_duration=most_duration_text(most),
                limit=limit_text(limit),
                bound_path=bound_path_text(duration.most, most_duration_text),
            ),
            "leave out tasks, shorten groups, or add a reaction to time_up",
            subject="max_duration",
        )
    elif most is None:
        yield study.diagnostic(
            "maybe-too-long",
            Message(
                "the mission may take longer than its maximum duration of {limit}, as "
                "{without_limit} (shortest: {bound_path})",
                limit=limit_text(limit),
                without_limit=_without_limit(study),
                bound_path=bound_path_text(duration.least, least_duration_text),
            ),
            "limit what is repeated, or add a reaction to time_up",
            subject="max_duration",
        )


def _without_limit(study: Study) -> str:
    """Return why a duration or energy has no upper bound, in words."""
    return (
        Message("no upper bound is known")
        if study.all_loops_end
        else Message("something in it has no limit")
    )


def _cut_short(
    study: Study, bounds: MissionBounds, limit: float, longest: Bound | None
) -> Iterator[Diagnostic]:
    """Yield one diagnostic on what may not be done as the reaction to TIME_UP ends the mission.

    There is none if the mission always ends within `limit` (s) when nothing fails. `longest` is the
    upper bound on the duration with failures and reactions; None if it could not be computed.
    """
    assert bounds.duration is not None
    most = bounds.duration.most.value
    if most is not None and most <= limit:
        return
    own = [
        i
        for i in range(len(study.flow.leaves))
        if study.is_mission_task(i) and study.nominal.is_reached(i)
    ]
    lost = [study.name(i) for i in own if limit < bounds.task_end_bounds[i].soonest < math.inf]
    unsure = [
        study.name(i)
        for i in own
        if bounds.task_end_bounds[i].soonest <= limit < bounds.task_end_bounds[i].latest
    ]
    up_to: str = (
        Message("up to {most_duration}, ", most_duration=most_duration_text(most))
        if most is not None
        else Message("without limit, ")
    )
    up_to = "" if most is None and study.all_loops_end else up_to
    ends = Message("the reaction to time_up then ends it")
    if longest is not None and longest.value is not None:
        ends += Message(
            ", after {most_duration} at most", most_duration=most_duration_text(longest.value)
        )
    yield study.diagnostic(
        "cut-short",
        Message(
            "the mission may take {up_to}longer than its maximum duration of {limit}: {ends}",
            up_to=up_to,
            limit=limit_text(limit),
            ends=ends,
        )
        + (
            Message(
                "; if nothing fails, {lost} will not be done in time", lost=brief_quoted_list(lost)
            )
            if lost
            else ""
        )
        + (
            Message(
                "; {unsure} may not be done, or not in all rounds", unsure=brief_quoted_list(unsure)
            )
            if unsure
            else ""
        ),
        "leave out tasks, shorten groups, or allow more time",
        subject="max_duration",
    )


def _battery_exceeded(study: Study, energy: Bounds, battery: float) -> Iterator[Diagnostic]:
    least, most = energy.least.value, energy.most.value
    if least is not None and least > battery and not _may_need_less_energy(study):
        yield study.diagnostic(
            "battery-exceeded",
            Message(
                "the mission needs at least {least_energy} if nothing fails, and the "
                "battery gives {energy} (least: {bound_path})",
                least_energy=least_energy_text(least),
                energy=energy_text(battery),
                bound_path=bound_path_text(energy.least, least_energy_text),
            ),
            "leave out tasks or rounds, or charge in between",
            subject="tasks",
        )
    elif most is None or most > battery:
        need = (
            Message("without limit")
            if most is None
            else Message("up to {most_energy}", most_energy=most_energy_text(most))
        )
        if most is None and study.all_loops_end:
            need = Message(
                "above {energy}, as {without_limit}",
                energy=energy_text(battery),
                without_limit=_without_limit(study),
            )
        path = (
            Message(
                "least: {bound_path}", bound_path=bound_path_text(energy.least, least_energy_text)
            )
            if most is None
            else Message(
                "most: {bound_path}", bound_path=bound_path_text(energy.most, most_energy_text)
            )
        )
        yield study.diagnostic(
            "battery-maybe-exceeded",
            Message(
                "the mission may need energy {need}, and the battery gives {energy} ({path})",
                need=need,
                energy=energy_text(battery),
                path=path,
            ),
            "limit what is repeated, or react to low_battery",
            subject="tasks",
        )


def _may_need_less_energy(study: Study) -> bool:
    """Return True if a run may take less from the battery than the least energy of the analysis.

    The robot may stand at a dock for a while, which charges it, or the mission may end early
    because its time is up.
    """
    waits = any(leaf.wait is not None or leaf.earliest for leaf in study.flow.leaves)
    return (
        waits
        or any(group.every for group in study.flow.groups)
        or any(
            (r.response is Response.RETURN and r.afterwards is not Afterwards.END)
            or (
                r.event is EventKind.TIME_UP
                and study.mission.max_duration
                and always_ends_mission_or_holds(r)
            )
            for r in study.mission.reactions
        )
    )


def _no_way_back(study: Study, energy: Bounds, travel: Travel) -> Iterator[Diagnostic]:
    """Yield a diagnostic on the first task after which the battery may not suffice to return.

    The drive leads to the mission's dock, where LOW of the battery must remain. Only the
    execution path that needs the most energy is considered.
    """
    dock, battery, most = study.mission.dock, travel.battery, energy.most.value
    if dock is None or battery is None or most is None or most > battery:
        return
    home = Task(name="home", action=Action.WAYPOINT, pose=dock)
    leaves = {leaf.name: i for i, leaf in enumerate(study.flow.leaves)}
    members = {g.name: range(g.first, g.last + 1) for g in study.flow.groups}
    for stretch in energy.most.path:
        after = [leaves[stretch.task]] if stretch.task is not None else members[stretch.group or ""]
        back = 0.0
        for leaf in after:
            cost = study.costs.task_cost_after_leaf(leaf, home)
            if not isinstance(cost, NoPath):
                back = max(back, cost.energy.most)
        if stretch.until + back + LOW * battery > battery:
            yield study.diagnostic(
                "no-way-back",
                Message(
                    "after {stretch} the battery may not suffice for the way back "
                    "to the dock with a reserve of {low:.0%}: up to {most_energy} are used "
                    "until then, the way back needs up to {most_energy_2}, and the battery "
                    "gives {energy}",
                    stretch=stretch.task_or_rounds_text,
                    low=LOW,
                    most_energy=most_energy_text(stretch.until),
                    most_energy_2=most_energy_text(back),
                    energy=energy_text(battery),
                ),
                "leave out tasks or rounds, charge in between, or react to low_battery",
                after[0],
            )
            return


def always_ends_mission_or_holds(reaction: Reaction) -> bool:
    """Return True if a reaction always ends the mission or else holds the robot for ever."""
    limited = reaction.hold_limit is not None
    match reaction.response:
        case Response.ABORT:
            return True
        case Response.RETURN | Response.SAFE_AREA:
            pauses = limited and reaction.until and reaction.on_limit is Afterwards.WAIT
            return reaction.afterwards is Afterwards.END and not pauses
        case Response.PAUSE:
            return limited and not reaction.until and reaction.on_limit is Afterwards.END
    return False


def stale_value_diagnostics_if_computable(study: Study) -> Iterator[Diagnostic] | None:
    """Return diagnostics on conditions whose value is always older than their `max_age`.

    Returns None if the search would take too long.
    """
    flow = study.flow
    comparisons: dict[str, list[tuple[int, int, int]]] = {}
    reported = objects_that_others_may_report(flow)
    for i, leaf in enumerate(flow.leaves):
        for k, (conditions, _) in enumerate(leaf.conditional):
            for c, condition in enumerate(conditions):
                o = condition.object_id
                aged = condition.max_age is not None and o != leaf.measures and o not in reported
                if condition.type is ConditionType.STALE:
                    continue
                if aged and study.nominal.is_reached(i):
                    comparisons.setdefault(o, []).append((i, k, c))
    steps = study.costs.least_times_to_successors()
    if len(comparisons) * sum(len(s) for s in steps.values()) > AGE_WORK:
        return None
    return _stale_conditions(study, comparisons, steps)


def _stale_conditions(
    study: Study,
    comparisons: dict[str, list[tuple[int, int, int]]],
    steps: dict[object, list[tuple[object, float]]],
) -> Iterator[Diagnostic]:
    for o, uses in comparisons.items():
        sources = [i for i, leaf in enumerate(study.flow.leaves) if leaf.measures == o]
        age = _youngest_ages(sources, steps)
        for leaf, k, c in uses:
            condition = study.flow.leaves[leaf].conditional[k][0][c]
            youngest = age.get(leaf, math.inf)
            assert condition.max_age is not None
            if math.isfinite(youngest) and youngest > condition.max_age:
                yield study.diagnostic(
                    "always-stale",
                    Message(
                        "a condition of task '{task}' never holds if nothing fails: {condition}, "
                        "but it takes at least {exceeding_duration} from the measurement to this "
                        "task",
                        task=study.name(leaf),
                        condition=condition_text(condition),
                        exceeding_duration=exceeding_duration_text(youngest, condition.max_age),
                    ),
                    Message(
                        "measure checkpoint {o} again before this task, or allow a greater age", o=o
                    ),
                    leaf,
                    study.conditional_indices(leaf)[k],
                )


def _youngest_ages(
    sources: list[int], steps: dict[object, list[tuple[object, float]]]
) -> dict[object, float]:
    """Return by leaf or time-out the least age in s that a value has at its end.

    A leaf in `sources` measures the value, which has the age 0 when that leaf ends. `steps` has
    what can follow each leaf or time-out, with the least time in s. Ends that follow no source are
    left out.
    """
    age: dict[object, float] = {}
    heap: list[tuple[float, int, object]] = [(0.0, k, s) for k, s in enumerate(sources)]
    count = len(heap)
    heapq.heapify(heap)
    visited: set[object] = set()
    while heap:
        here, _, node = heapq.heappop(heap)
        if node in visited:
            continue
        visited.add(node)
        for target, taken in steps.get(node, ()):
            there = here + taken
            if there < age.get(target, math.inf):
                age[target] = there
                count += 1
                heapq.heappush(heap, (there, count, target))
    return age


def bound_path_text(bound: Bound, quantity_words: Callable[[float], str]) -> str:
    """Return the text of the execution path that attains a bound, such as `A (5 s) > B (2 min)`.

    Each part has the time or energy from the mission's start to its end. The middle of a long path
    is left out.
    """

    def stretch_words(stretch: Stretch) -> Message:
        return Message(
            "{stretch} ({until})",
            stretch=stretch.task_or_rounds_text,
            until=quantity_words(stretch.until),
        )

    path = bound.path
    if len(path) <= _SHOWN:
        if not path:
            return Message("no task")
        return Message("{path:>}", path=tuple(map(stretch_words, path)))
    half = _SHOWN // 2
    shown = [
        *map(stretch_words, path[:half]),
        Message("({count} more)", count=len(path) - 2 * half),
        *map(stretch_words, path[-half:]),
    ]
    return Message("{path:>}", path=tuple(shown))
