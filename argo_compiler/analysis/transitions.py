"""Diagnostics about transitions never or always taken, and about values not measured yet."""

from collections.abc import Iterator

from argo_compiler.analysis.regions import Scale
from argo_compiler.analysis.study import Study
from argo_compiler.analysis.values import GuardStatus, objects_of
from argo_compiler.base.graphs import first_ways, way_to
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.hfsm.conditions import all_words, words
from argo_compiler.il import Action, Condition

_SEARCHES = 10  # objects for which a path that does not measure them is looked up
_PATHS = 200  # diagnostics that come with a path


def transitions(study: Study) -> Iterator[Diagnostic]:
    """What is odd about the transitions of the tasks that can be reached."""
    measured = {t.object_id for t in study.mission.tasks if t.action is Action.MEASURE}
    paths = _Unmeasured(study)
    for leaf, flow in enumerate(study.flow.leaves):
        if not flow.conditional or not study.with_failures.reached(leaf):
            continue
        told: set[str] = set()
        looks = study.with_failures.conditional(study.flow, leaf)
        for k, index in enumerate(study.indices(leaf)):
            conditions = flow.conditional[k][0]
            if k >= len(looks) or not looks[k].possible:
                # What no task measures is a diagnostic of the check.
                if objects_of(conditions) <= measured:
                    yield _never(study, leaf, k, index)
                continue
            if _always(study, leaf, k):
                yield _always_taken(study, leaf, k, index)
            for o in sorted((objects_of(conditions) & measured) - told):
                diagnostic = paths.diagnostic(leaf, k, index, o)
                if diagnostic is not None:
                    told.add(o)
                    yield diagnostic


def why_never(study: Study, leaf: int, k: int) -> str:
    """Why conditional transition k of a leaf that is reached is never taken."""
    looks = study.with_failures.conditional(study.flow, leaf)
    if k >= len(looks):
        return "a transition before it is always taken"
    taken = looks[k].state
    for condition in study.flow.leaves[leaf].conditional[k][0]:
        why = _why_not(study, condition, taken, looks[k].state)
        if why is not None:
            return why
        scale, there = _there(study, condition, taken)
        regions = there & scale.satisfying(condition)
        taken = study.with_failures.fields.set(taken, condition.object_id, regions)
    return "its conditions exclude each other"


def _why_not(study: Study, condition: Condition, taken: int, before: int) -> str | None:
    scale, there = _there(study, condition, taken)
    satisfying = scale.satisfying(condition)
    if there & satisfying:
        return None
    name = study.object_name(condition.object_id)
    if condition.type.compares and not scale.possible & satisfying:
        return f"{name} shows {scale.words(scale.possible)}, so {words(condition)} never holds"
    _, at_first = _there(study, condition, before)
    if condition.type.compares and not at_first & (scale.missing - 1):
        looked = study.with_failures.fields.scales[condition.object_id].possible
        if condition.object_id in study.with_failures.fields.shift and looked:
            return (
                f"{name} has no value here: no path measures it before, or only where a "
                "transition that was looked at before covers all its values"
            )
    if at_first & satisfying:
        return "its conditions exclude each other"
    if not condition.type.compares:
        return f"the reading of {name} is never such that {words(condition)} here"
    values = scale.words(at_first & (scale.missing - 1))
    return f"the value of {name} can only be {values} here, so {words(condition)} never holds"


def _there(study: Study, condition: Condition, state: int) -> tuple[Scale, int]:
    fields = study.with_failures.fields
    return fields.scales[condition.object_id], fields.get(state, condition.object_id)


def _first_state(study: Study, leaf: int) -> int | None:
    """The values when the first transition of a leaf is looked at."""
    looks: tuple[GuardStatus, ...] = study.with_failures.looks[leaf]
    return looks[0].state if looks else None


def _unmeasured(study: Study, leaf: int, object_id: str) -> bool:
    """Whether no path to a leaf measures an object, its own action included."""
    state = _first_state(study, leaf)
    fields = study.with_failures.fields
    if state is None or object_id not in fields.shift:
        return False
    return not fields.get(state, object_id) & ~fields.scales[object_id].missing


def _never(study: Study, leaf: int, k: int, index: int) -> Diagnostic:
    task = study.task(leaf)
    target = task.transitions[index].target
    start = f"the transition from task '{task.name}' to '{target}' is never taken: "
    for condition in task.transitions[index].conditions:
        if _unmeasured(study, leaf, condition.object_id):
            name = study.object_name(condition.object_id)
            return study.diagnostic(
                "never-measured",
                f"{start}no path to '{task.name}' measures {name} before",
                f"measure {name} earlier, or compare another checkpoint",
                leaf,
                index,
            )
    return study.diagnostic(
        "transition-never",
        start + why_never(study, leaf, k),
        "correct its bounds, move it before the transition that covers them, or remove it",
        leaf,
        index,
    )


def _always(study: Study, leaf: int, k: int) -> bool:
    """Whether a transition is taken whatever was measured, and not just because those before it
    leave it no other values."""
    looks = study.nominal.conditional(study.flow, leaf)
    if not study.nominal.reached(leaf) or k >= len(looks) or not looks[k].certain:
        return False
    fields = study.nominal.fields
    fresh = study.flow.leaves[leaf].measures
    for condition in study.flow.leaves[leaf].conditional[k][0]:
        o = condition.object_id
        there = fields.get(looks[0].state, o)
        if o == fresh:
            there &= ~fields.scales[o].without_value
        if there & ~fields.scales[o].satisfying(condition):
            return False
    return True


def _always_taken(study: Study, leaf: int, k: int, index: int) -> Diagnostic:
    task = study.task(leaf)
    held = all_words(task.transitions[index].conditions)
    after = len(task.transitions) > 1
    return study.diagnostic(
        "transition-always",
        f"the transition from task '{task.name}' to '{task.transitions[index].target}' is always "
        f"taken{' if it is looked at' if k else ''}: {held} holds for every value that can be "
        "there" + ("; only a failed measurement leads elsewhere" if after else ""),
        "correct its bounds, or make it unconditional if that is meant",
        leaf,
        index,
    )


class _Unmeasured:
    """Looks for paths on which a value that is compared was not measured. Keeps what it found."""

    def __init__(self, study: Study) -> None:
        self.study = study
        self.before: dict[str, list[int | None]] = {}
        self.told = 0

    def diagnostic(self, leaf: int, k: int, index: int, object_id: str) -> Diagnostic | None:
        """The diagnostic where a path without a failure comes to a transition without the value."""
        study = self.study
        fields = study.nominal.fields
        looks = study.nominal.conditional(study.flow, leaf)
        if object_id == study.flow.leaves[leaf].measures or object_id not in fields.shift:
            return None
        if k >= len(looks) or not study.nominal.reached(leaf):
            return None
        there = fields.get(looks[k].state, object_id)
        if not there & fields.scales[object_id].missing:
            return None
        task = study.task(leaf)
        name = study.object_name(object_id)
        path = self._path(leaf, object_id)
        return study.diagnostic(
            "maybe-unmeasured",
            f"a transition from task '{task.name}' to '{task.transitions[index].target}' compares "
            f"{name}, which has no value yet on some paths, so it is not taken there"
            + (f", such as {path}" if path else ""),
            f"measure {name} on every path to '{task.name}', or mean it: without a value the "
            "condition is false",
            leaf,
            index,
        )

    def _path(self, leaf: int, object_id: str) -> str:
        """A path to the leaf that does not measure the object."""
        study = self.study
        flow = study.flow
        self.told += 1
        if self.told > _PATHS:
            return ""
        if object_id not in self.before:
            if len(self.before) >= _SEARCHES:
                return ""

            def passable(node: int, target: int) -> bool:
                if not flow.is_leaf(node):
                    return True
                here = flow.leaves[node]
                if here.measures == object_id:
                    return False
                without = here.tail == target or (
                    here.parent >= 0
                    and flow.timed[here.parent]
                    and target == flow.time_up(here.parent)
                )
                return without or any(
                    target == t and object_id not in objects_of(conditions)
                    for conditions, t in here.conditional
                )

            self.before[object_id] = first_ways(study.successors, flow.initial, passable)
        way = way_to(self.before[object_id], flow.initial, leaf)
        return "" if way is None else study.words(way)
