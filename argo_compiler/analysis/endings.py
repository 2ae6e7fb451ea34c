"""Diagnostics on the end of a mission: whether it can end, loops without limit, and the dock."""

from collections.abc import Collection, Iterable, Iterator

from argo_compiler.analysis.docking import is_docked_after
from argo_compiler.analysis.non_terminating_loops import NonTerminatingLoop
from argo_compiler.analysis.study import Study
from argo_compiler.base.listing import brief_quoted_list, listed
from argo_compiler.base.message import Listing, Message
from argo_compiler.base.quantity_text import limit_text
from argo_compiler.diagnostics import Diagnostic, Severity

_MOST_PATHS = 200  # diagnostics that show a path
_REMEDY = Message(
    "lead a transition out of it, or make it a group with max_repeat_count or max_repeat_duration"
)


def diagnose_endings(
    study: Study, loops: Iterable[NonTerminatingLoop] = ()
) -> Iterator[Diagnostic]:
    """Yield diagnostics on loops without end or limit, and on where the mission ends.

    `loops` are the loops that some reading keeps going.
    """
    if not study.mission.tasks:
        return
    yield from _endless_loops(study)
    yield from _non_terminating_loops(study, loops)
    yield from _unbounded_loops(study, {leaf for trap in study.trap_leaves for leaf in trap})
    yield from _ends_elsewhere(study)


def _endless_loops(study: Study) -> Iterator[Diagnostic]:
    """Yield diagnostics on loops that go on as planned, or one on a mission without an end.

    A loop that the time limit of a task ends has its diagnostic there, as has a mission.
    """
    severity = Severity.WARNING if study.may_end_by_reaction else Severity.ERROR
    kept = [nodes for nodes in study.trap_nodes if study.is_kept_as_planned(nodes)]
    kept = [nodes for nodes in kept if any(map(study.flow.is_leaf, nodes))]
    never_ends = not study.reached_as_planned[study.flow.end_node]
    after_failure = study.with_failures.is_reached(study.flow.end_node)
    for nodes in kept:
        trap = tuple(filter(study.flow.is_leaf, nodes))
        so = ""
        if never_ends and len(kept) == 1:
            so = Message(", and so the mission")
            if after_failure and not study.leads_out_if_failing(nodes):
                so += Message(" unless an action fails before")
        yield study.diagnostic(
            "endless-loop",
            Message(
                "{tasks} {follow} for ever: nothing but {what_ends} ends the loop{so} "
                "(path: {shortest_path})",
                tasks=study.tasks_text(trap),
                follow=_follow(trap),
                what_ends=_what_ends(study, nodes),
                so=so,
                shortest_path=study.shortest_path_text(trap[0]),
            ),
            _REMEDY,
            trap[0],
            severity=severity,
        )
    if never_ends and len(kept) != 1 and not study.ends_by_time_up:
        why = (
            Message("each execution path runs into a loop that no transition leaves")
            if kept
            else Message("no execution path leads to its end")
        )
        unless = [
            *([Message("an action fails")] if after_failure else []),
            *([Message("a reaction ends it")] if study.may_end_by_reaction else []),
        ]
        if unless:
            why += Message(", unless {unless:or}", unless=Listing(unless))
        yield study.diagnostic(
            "no-end",
            Message("the mission never ends: {why}", why=why),
            "let a task on each execution path have no unconditional transition, or leave the loop",
            subject="tasks",
            severity=severity,
        )


def _what_ends(study: Study, nodes: Collection[int]) -> str:
    """Return what may end a loop that no transition leaves, in words."""
    if study.ends_by_time_up:
        assert study.mission.max_duration is not None
        limit = limit_text(study.mission.max_duration)
        by_reaction = [Message("the reaction to time_up, after {limit},", limit=limit)]
    else:
        by_reaction = [Message("a reaction")] if study.may_end_by_reaction else []
    by_failure = [Message("a failure")] if study.leads_out_if_failing(nodes) else []
    *others, last = [*by_failure, *by_reaction, Message("a person")]
    return Message("{others} or {last}", others=Listing(others), last=last) if others else last


def _non_terminating_loops(
    study: Study, loops: Iterable[NonTerminatingLoop]
) -> Iterator[Diagnostic]:
    for loop in loops:
        if not study.is_closed_as_planned(loop.nodes):
            continue  # a time limit ends it
        leaves = tuple(sorted(filter(study.flow.is_leaf, loop.nodes)))
        name = study.object_text(loop.object_id)
        values = loop.readings & (loop.scale.missing_bit - 1)
        shown = [
            *(
                [Message("shows {regions}", regions=loop.scale.regions_text(values))]
                if values
                else []
            ),
            *([Message("has no value")] if loop.readings & loop.scale.without_value_bits else []),
        ]
        yield study.diagnostic(
            "kept-loop",
            Message(
                "{tasks} {follow} for ever if {name} {shown:or} when '{task}' is reached: "
                "nothing in the loop measures it, so nothing but a value that others "
                "report, {what_ends} ends the loop",
                tasks=study.tasks_text(leaves),
                follow=_follow(leaves),
                name=name,
                shown=Listing(shown),
                task=study.name(loop.leaf),
                what_ends=_what_ends(study, loop.nodes),
            ),
            Message("measure {name} in the loop, or make it a group with a limit", name=name),
            loop.leaf,
        )


def _follow(leaves: tuple[int, ...]) -> str:
    return Message("follows itself") if len(leaves) == 1 else Message("follow each other")


def _unbounded_loops(study: Study, trapped: set[int]) -> Iterator[Diagnostic]:
    """Yield diagnostics on loops that may be repeated without limit.

    Loops that begin with one of the leaves `trapped` are left out: these can't be left at all and
    have a diagnostic already.
    """
    bounds = study.bounds_if_computable
    if bounds is None:
        return
    for loop in bounds.loops:
        first = min([*loop.leaves, *(study.flow.groups[g].first for g in loop.groups)])
        if first in trapped:
            continue
        nodes = study.nodes_within(loop.leaves, loop.groups)
        if not study.repeats_as_planned(nodes):
            continue  # a time limit ends it
        groups = [study.flow.groups[g].name for g in loop.groups]
        parts = [
            *([study.tasks_text(loop.leaves)] if loop.leaves else []),
            *(
                [
                    Message("groups {groups}", groups=brief_quoted_list(groups))
                    if len(groups) > 1
                    else Message("group '{group}'", group=groups[0])
                ]
                if groups
                else []
            ),
        ]
        if not study.repeats_when_late(nodes):
            yield _loop_until_window(study, listed(parts), nodes, first)
            continue
        single = len(loop.leaves) + len(loop.groups) == 1
        remark = (
            (
                Message("it can be left, but no count and no duration limits the repetitions")
                if single
                else Message(
                    "they can be left, but no count and no duration limits the repetitions"
                )
            )
            if loop.has_exit
            else (
                Message("the transitions out of it come too late for a hard stop")
                if single
                else Message("the transitions out of them come too late for a hard stop")
            )
        )
        yield study.diagnostic(
            "unbounded-loop",
            Message(
                "{parts:and} may be repeated without limit: {remark}, so the duration of "
                "the mission has no upper bound",
                parts=Listing(parts),
                remark=remark,
            ),
            "make it a group with max_repeat_count or max_repeat_duration that always ends",
            first,
        )


def _loop_until_window(study: Study, what: str, nodes: Collection[int], first: int) -> Diagnostic:
    """Return the diagnostic on a loop in which no round is complete after hard windows closed."""
    leaves = study.flow.leaves
    closing = sorted(n for n in nodes if study.flow.is_leaf(n) and leaves[n].deadline is not None)
    last = max(leaves[n].deadline or 0.0 for n in closing)
    closed = (
        Message("the window of {tasks} closes", tasks=study.tasks_text(closing))
        if len(closing) == 1
        else Message("the windows of {tasks} have closed", tasks=study.tasks_text(closing))
    )
    return study.diagnostic(
        "loop-until-window",
        Message(
            "{what} may be repeated until {closed}, {limit} after the mission's start: no count "
            "and no other duration limits the repetitions",
            what=what,
            closed=closed,
            limit=limit_text(last),
        ),
        "make it a group with max_repeat_count or max_repeat_duration that always ends",
        first,
    )


def _ends_elsewhere(study: Study) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each task after which the mission may end away from its dock.

    The dock is that of the mission's end area; without one, there are no diagnostics.
    """
    area = study.mission.end_area
    if area is None:
        return
    known = None if study.catalog is None else study.catalog.area(area)
    dock = study.mission.dock if known is None else known.dock
    if dock is None:
        return
    flow = study.flow
    last_elsewhere: dict[int, str] = {}
    for leaf in range(len(flow.leaves)):
        if not study.nominal.is_reached(leaf):
            continue
        if any(
            _leads_to_end(study, target) for target in study.nominal.targets_when_missed(flow, leaf)
        ):
            where = Message(
                "wherever the robot is when the window of task '{task}' has closed",
                task=study.name(leaf),
            )
            last_elsewhere[leaf] = where
        elif not is_docked_after(study, leaf, dock) and any(
            _leads_to_end(study, target) for target in study.nominal.targets(flow, leaf)
        ):
            last_elsewhere[leaf] = Message("after task '{task}'", task=study.name(leaf))
    for number, group in enumerate(flow.groups):
        if (
            group.hard
            and study.nominal.is_reached(flow.time_up_node(number))
            and _leads_to_end(study, group.successor)
        ):
            last_elsewhere.setdefault(
                group.last,
                Message(
                    "wherever the robot is when the time of group '{group}' is up", group=group.name
                ),
            )
    for k, (leaf, place) in enumerate(sorted(last_elsewhere.items())):
        shown: str = (
            Message(" (path: {shortest_path})", shortest_path=study.shortest_path_text(leaf))
            if k < _MOST_PATHS
            else ""
        )
        yield study.diagnostic(
            "end-elsewhere",
            Message(
                "the mission must end docked in starting area {area}, but it can end {where}{path}",
                area=area,
                where=place,
                path=shown,
            ),
            Message(
                "let each execution path end with a WAYPOINT task at the dock of starting "
                "area {area}",
                area=area,
            ),
            leaf,
        )


def _leads_to_end(study: Study, node: int) -> bool:
    """Return True if a node is the end of the mission, or may lead there without another task."""
    flow = study.flow
    group = flow.group_of_round_end(node)
    while group is not None:
        if not flow.groups[group].has_limit_or_until:
            return False
        node = flow.groups[group].successor
        group = flow.group_of_round_end(node)
    return node == flow.end_node
