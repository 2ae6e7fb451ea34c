"""Diagnostics on transitions that are never or always taken, and on values not measured yet."""

from collections.abc import Iterator

from argo_compiler.analysis.reachability import GuardStatus, compared_objects
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.value_regions import Scale
from argo_compiler.base.graphs import path_to, shortest_path_predecessors
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm.conditions import condition_text, conjunction_text
from argo_compiler.il import Action, Condition

_MOST_SEARCHES = 10  # objects for which a path that does not measure them is searched
_MOST_PATHS = 200  # diagnostics that show a path


def diagnose_transitions(study: Study) -> Iterator[Diagnostic]:
    """Yield diagnostics on transitions that are never or always taken, or lack a measured value.

    Tasks that can't be reached are left out.
    """
    measured = {t.object_id for t in study.mission.tasks if t.action is Action.MEASURE}
    unmeasured = _UnmeasuredPaths(study)
    for leaf, flow in enumerate(study.flow.leaves):
        if not flow.conditional or not study.with_failures.is_reached(leaf):
            continue
        reported: set[str] = set()
        guards = study.with_failures.conditional_guards(study.flow, leaf)
        for k, index in enumerate(study.conditional_indices(leaf)):
            conditions = flow.conditional[k][0]
            if k >= len(guards) or not guards[k].possible:
                # The check reports objects that no task measures.
                if compared_objects(conditions) <= measured:
                    yield _never_taken(study, leaf, k, index)
                continue
            if _is_always_taken(study, leaf, k):
                yield _always_taken(study, leaf, k, index)
            for o in sorted((compared_objects(conditions) & measured) - reported):
                diagnostic = unmeasured.diagnostic(leaf, k, index, o)
                if diagnostic is not None:
                    reported.add(o)
                    yield diagnostic


def reason_never_taken(study: Study, leaf: int, k: int) -> str:
    """Return the reason why conditional transition `k` of a reached leaf is never taken.

    `k` counts the leaf's conditional transitions from 0.
    """
    guards = study.with_failures.conditional_guards(study.flow, leaf)
    if k >= len(guards):
        return Message("a transition before it is always taken")
    taken = guards[k].state
    for condition in study.flow.leaves[leaf].conditional[k][0]:
        why = _why_not(study, condition, taken, guards[k].state)
        if why is not None:
            return why
        scale, readings = _possible_readings(study, condition, taken)
        regions = readings & scale.satisfying_bits(condition)
        taken = study.with_failures.fields.set(taken, condition.object_id, regions)
    return Message("its conditions exclude each other")


def _why_not(study: Study, condition: Condition, taken: int, before: int) -> str | None:
    scale, readings = _possible_readings(study, condition, taken)
    satisfying = scale.satisfying_bits(condition)
    if readings & satisfying:
        return None
    name = study.object_text(condition.object_id)
    if condition.type.compares and not scale.possible & satisfying:
        return Message(
            "{name} shows {regions}, so {condition} never holds",
            name=name,
            regions=scale.regions_text(scale.possible),
            condition=condition_text(condition),
        )
    _, at_first = _possible_readings(study, condition, before)
    if condition.type.compares and not at_first & (scale.missing_bit - 1):
        possible = study.with_failures.fields.scales[condition.object_id].possible
        if condition.object_id in study.with_failures.fields.shift and possible:
            return Message(
                "{name} has no value here: no path measures it before, or only where a "
                "transition that is evaluated earlier covers all its values",
                name=name,
            )
    if at_first & satisfying:
        return Message("its conditions exclude each other")
    if not condition.type.compares:
        return Message(
            "the reading of {name} is never such that {condition} here",
            name=name,
            condition=condition_text(condition),
        )
    values = scale.regions_text(at_first & (scale.missing_bit - 1))
    return Message(
        "the value of {name} can only be {values} here, so {condition} never holds",
        name=name,
        values=values,
        condition=condition_text(condition),
    )


def _possible_readings(study: Study, condition: Condition, state: int) -> tuple[Scale, int]:
    fields = study.with_failures.fields
    return fields.scales[condition.object_id], fields.get(state, condition.object_id)


def _first_state(study: Study, leaf: int) -> int | None:
    """Return the possible readings when a leaf's first transition is evaluated; None if none is."""
    guards: tuple[GuardStatus, ...] = study.with_failures.guards[leaf]
    return guards[0].state if guards else None


def _is_never_measured(study: Study, leaf: int, object_id: str) -> bool:
    """Return True if no path to a leaf measures an object, the leaf's own action included."""
    state = _first_state(study, leaf)
    fields = study.with_failures.fields
    if state is None or object_id not in fields.shift:
        return False
    return not fields.get(state, object_id) & ~fields.scales[object_id].missing_bit


def _never_taken(study: Study, leaf: int, k: int, index: int) -> Diagnostic:
    task = study.leaf_task(leaf)
    target = task.transitions[index].target
    start = Message(
        "the transition from task '{task}' to '{target}' is never taken: ",
        task=task.name,
        target=target,
    )
    for condition in task.transitions[index].conditions:
        if _is_never_measured(study, leaf, condition.object_id):
            name = study.object_text(condition.object_id)
            return study.diagnostic(
                "never-measured",
                Message(
                    "{start}no path to '{task}' measures {name} before",
                    start=start,
                    task=task.name,
                    name=name,
                ),
                Message("measure {name} earlier, or compare another checkpoint", name=name),
                leaf,
                index,
            )
    return study.diagnostic(
        "transition-never",
        start + reason_never_taken(study, leaf, k),
        "correct its bounds, move it before the transition that covers them, or remove it",
        leaf,
        index,
    )


def _is_always_taken(study: Study, leaf: int, k: int) -> bool:
    """Return True if conditional transition `k` of a leaf is taken whatever was measured.

    `k` counts the leaf's conditional transitions from 0. A transition that is always taken only
    because earlier ones leave no other values does not count.
    """
    guards = study.nominal.conditional_guards(study.flow, leaf)
    if not study.nominal.is_reached(leaf) or k >= len(guards) or not guards[k].certain:
        return False
    fields = study.nominal.fields
    fresh = study.flow.leaves[leaf].measures
    for condition in study.flow.leaves[leaf].conditional[k][0]:
        o = condition.object_id
        readings = fields.get(guards[0].state, o)
        if o == fresh:
            readings &= ~fields.scales[o].without_value_bits
        if readings & ~fields.scales[o].satisfying_bits(condition):
            return False
    return True


def _always_taken(study: Study, leaf: int, k: int, index: int) -> Diagnostic:
    task = study.leaf_task(leaf)
    held = conjunction_text(task.transitions[index].conditions)
    after = len(task.transitions) > 1
    return study.diagnostic(
        "transition-always",
        Message(
            "the transition from task '{task}' to '{target}' is always taken{part}: "
            "{held} holds for every possible value",
            task=task.name,
            target=task.transitions[index].target,
            part=Message(" if it is evaluated") if k else "",
            held=held,
        )
        + (Message("; only a failed measurement leads elsewhere") if after else ""),
        "correct its bounds, or make it unconditional if that is intended",
        leaf,
        index,
    )


class _UnmeasuredPaths:
    """Search for paths that compare a value before it was measured; caches its results."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.predecessors: dict[str, list[int | None]] = {}
        self.count = 0

    def diagnostic(self, leaf: int, k: int, index: int, object_id: str) -> Diagnostic | None:
        """Return a diagnostic if a transition may compare an object that is not measured yet.

        The path to it has no failures. `k` counts the leaf's conditional transitions, `index` all
        of them. Returns None if every path measures the object, or if that is not known.
        """
        study = self.study
        fields = study.nominal.fields
        guards = study.nominal.conditional_guards(study.flow, leaf)
        if object_id == study.flow.leaves[leaf].measures or object_id not in fields.shift:
            return None
        if k >= len(guards) or not study.nominal.is_reached(leaf):
            return None
        readings = fields.get(guards[k].state, object_id)
        if not readings & fields.scales[object_id].missing_bit:
            return None
        task = study.leaf_task(leaf)
        name = study.object_text(object_id)
        path = self._path(leaf, object_id)
        return study.diagnostic(
            "maybe-unmeasured",
            Message(
                "a transition from task '{task}' to '{target}' compares {name}, which has "
                "no value yet on some paths, so it is not taken there",
                task=task.name,
                target=task.transitions[index].target,
                name=name,
            )
            + (Message(", such as {path}", path=path) if path else ""),
            Message(
                "measure {name} on every path to '{task}', or keep it if that is intended: "
                "without a value the condition is false",
                name=name,
                task=task.name,
            ),
            leaf,
            index,
        )

    def _path(self, leaf: int, object_id: str) -> str:
        """Return the text of an execution path to a leaf on which no task measures the object.

        Returns an empty text if there is none, or if too many were requested already.
        """
        study = self.study
        flow = study.flow
        self.count += 1
        if self.count > _MOST_PATHS:
            return ""
        if object_id not in self.predecessors:
            if len(self.predecessors) >= _MOST_SEARCHES:
                return ""

            def passable(node: int, target: int) -> bool:
                if not flow.is_leaf(node):
                    return True
                here = flow.leaves[node]
                if here.measures == object_id:
                    return False
                without = here.unconditional == target or (
                    here.parent >= 0
                    and flow.timed[here.parent]
                    and target == flow.time_up_node(here.parent)
                )
                return without or any(
                    target == t and object_id not in compared_objects(conditions)
                    for conditions, t in here.conditional
                )

            self.predecessors[object_id] = shortest_path_predecessors(
                study.successors, flow.initial, passable
            )
        path = path_to(self.predecessors[object_id], flow.initial, leaf)
        return "" if path is None else study.path_text(path)
