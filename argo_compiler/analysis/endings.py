"""Diagnostics on the end of a mission: whether it can end, loops without limit, and the dock."""

from collections.abc import Iterable, Iterator

from argo_compiler.analysis.non_terminating_loops import NonTerminatingLoop
from argo_compiler.analysis.study import Study
from argo_compiler.base.listing import brief_quoted_list
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.il import Action, Task
from argo_compiler.il.docked import is_at_dock

_MOST_PATHS = 200  # diagnostics that show a path
_REMEDY = (
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
    traps = study.trap_leaves
    yield from _endless_loops(study, traps)
    yield from _non_terminating_loops(study, loops)
    yield from _unbounded_loops(study, {leaf for trap in traps for leaf in trap})
    yield from _ends_elsewhere(study)


def _endless_loops(study: Study, traps: tuple[tuple[int, ...], ...]) -> Iterator[Diagnostic]:
    severity = Severity.WARNING if study.may_end_by_reaction else Severity.ERROR
    but = "nothing but a reaction" if study.may_end_by_reaction else "nothing but a failure"
    can_end = study.nominal.is_reached(study.flow.end_node)
    for trap in traps:
        if not trap:
            continue
        path = study.shortest_path_text(trap[0])
        yield study.diagnostic(
            "endless-loop",
            f"{_tasks(study, trap)} {_follow(trap)} for ever: {but} or a person ends the loop "
            f"(path: {path})",
            _REMEDY,
            trap[0],
            severity=severity,
        )
    if not can_end:
        why = (
            "each execution path runs into a loop that no transition leaves"
            if traps
            else "no execution path leads to its end"
        )
        if study.with_failures.is_reached(study.flow.end_node):
            why += ", unless an action fails"
        yield study.diagnostic(
            "no-end",
            f"the mission never ends: {why}",
            "let a task on each execution path have no unconditional transition, or leave the loop",
            subject="tasks",
            severity=severity,
        )


def _non_terminating_loops(
    study: Study, loops: Iterable[NonTerminatingLoop]
) -> Iterator[Diagnostic]:
    but = "nothing but a reaction" if study.may_end_by_reaction else "nothing but a failure"
    for loop in loops:
        leaves = tuple(sorted(filter(study.flow.is_leaf, loop.nodes)))
        name = study.object_text(loop.object_id)
        values = loop.readings & (loop.scale.missing_bit - 1)
        shown = [
            *([f"shows {loop.scale.regions_text(values)}"] if values else []),
            *(["has no value"] if loop.readings & loop.scale.without_value_bits else []),
        ]
        yield study.diagnostic(
            "kept-loop",
            f"{_tasks(study, leaves)} {_follow(leaves)} for ever if {name} "
            f"{' or '.join(shown)} when '{study.name(loop.leaf)}' is reached: "
            f"nothing in the loop measures it, so {but}, a person or a value that others "
            "report ends the loop",
            f"measure {name} in the loop, or make it a group with a limit",
            loop.leaf,
        )


def _follow(leaves: tuple[int, ...]) -> str:
    return "follows itself" if len(leaves) == 1 else "follow each other"


def _tasks(study: Study, leaves: tuple[int, ...]) -> str:
    return (
        f"task{'s' if len(leaves) > 1 else ''} {brief_quoted_list([study.name(i) for i in leaves])}"
    )


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
        groups = [study.flow.groups[g].name for g in loop.groups]
        parts = [
            *([_tasks(study, loop.leaves)] if loop.leaves else []),
            *(
                [f"group{'s' if len(groups) > 1 else ''} {brief_quoted_list(groups)}"]
                if groups
                else []
            ),
        ]
        single = len(loop.leaves) + len(loop.groups) == 1
        they = "it" if single else "they"
        remark = (
            f"{they} can be left, but no count and no duration limits the repetitions"
            if loop.has_exit
            else f"the transitions out of {'it' if single else 'them'} come too late for a "
            "hard stop"
        )
        yield study.diagnostic(
            "unbounded-loop",
            f"{' and '.join(parts)} may be repeated without limit: "
            f"{remark}, so the duration of the mission has no upper bound",
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
            where = f"wherever the robot is when the window of task '{study.name(leaf)}' has closed"
            last_elsewhere[leaf] = where
        elif not _is_docked_after(study, leaf, dock) and any(
            _leads_to_end(study, target) for target in study.nominal.targets(flow, leaf)
        ):
            last_elsewhere[leaf] = f"after task '{study.name(leaf)}'"
    for number, group in enumerate(flow.groups):
        if (
            group.hard
            and study.nominal.is_reached(flow.time_up_node(number))
            and _leads_to_end(study, group.successor)
        ):
            last_elsewhere.setdefault(
                group.last, f"wherever the robot is when the time of group '{group.name}' is up"
            )
    for k, (leaf, where) in enumerate(sorted(last_elsewhere.items())):
        path = f" (path: {study.shortest_path_text(leaf)})" if k < _MOST_PATHS else ""
        yield study.diagnostic(
            "end-elsewhere",
            f"the mission must end docked in starting area {area}, but it can end {where}{path}",
            f"let each execution path end with a WAYPOINT task at the dock of starting area {area}",
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


def _is_docked_after(study: Study, leaf: int, dock: Pose) -> bool:
    """Return True if the robot is certainly at the dock after a leaf; a WAIT does not move it."""
    seen = {leaf}
    pending = [leaf]
    while pending:
        node = pending.pop()
        if study.flow.is_leaf(node) and study.flow.leaves[node].wait is None:
            missed = node != leaf and study.flow.leaves[node].deadline is not None
            if missed or not _drives_to(study.leaf_task(node), dock):
                return False
            continue
        before = study.predecessors[node]
        cut = not study.flow.is_leaf(node) and study.flow.group_of_round_end(node) is None
        if cut or node == study.flow.initial or not before:
            return False
        pending += [other for other in before if other not in seen]
        seen.update(before)
    return True


def _drives_to(task: Task, dock: Pose) -> bool:
    return task.action is Action.WAYPOINT and task.pose is not None and is_at_dock(task.pose, dock)
