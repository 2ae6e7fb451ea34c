"""Diagnostics about tasks that no path leads to, and why."""

from collections.abc import Iterator

from argo_compiler.analysis.study import Study
from argo_compiler.analysis.transitions import why_never
from argo_compiler.base.listing import quoted
from argo_compiler.diagnostics import Diagnostic

_REASONS = 3  # ways to a task that a message speaks of


def unreachable_tasks(study: Study) -> Iterator[Diagnostic]:
    """One for each task that can't be reached, whatever is measured and whatever fails."""
    lost = [
        i
        for i in range(len(study.flow.leaves))
        if not study.with_failures.reached(i) and study.is_own(i)
    ]
    reasons = _ways_in(study, lost)
    for leaf in lost:
        yield study.diagnostic(
            "unreachable-task",
            f"task '{study.name(leaf)}' can't be reached: {_why(*reasons[leaf])}",
            "lead a transition to it that can be taken, or remove the task",
            leaf,
        )


Ways = tuple[list[str], list[str]]


def _ways_in(study: Study, lost: list[int]) -> dict[int, Ways]:
    """For each lost leaf, why the transitions that lead to it from reached tasks aren't taken, and
    the names of the lost tasks that lead to it. Linear time."""
    flow = study.flow
    found: dict[int, Ways] = {leaf: ([], []) for leaf in lost}
    for i, leaf in enumerate(flow.leaves):
        for k, (_, target) in enumerate(leaf.conditional):
            if target in found and target != i:
                _note(study, found[target], i, k)
        if leaf.tail in found and leaf.tail != i:
            _note(study, found[leaf.tail], i, None)
        for way in (leaf.failure, leaf.missed):
            if way in found and way != i and not study.with_failures.reached(i):
                found[way][1].append(study.name(i))
    for number, group in enumerate(flow.groups):
        if group.onward not in found:
            continue
        if study.with_failures.reached(flow.round_end(number)):
            if len(found[group.onward][0]) < _REASONS:
                found[group.onward][0].append(
                    f"group '{group.name}', after which it would come, is repeated without limit"
                )
        else:
            _note(study, found[group.onward], group.last, None)
    return found


def _note(study: Study, ways: Ways, source: int, conditional: int | None) -> None:
    reasons, lost = ways
    if not study.with_failures.reached(source):
        lost.append(study.name(source))
    elif len(reasons) < _REASONS:
        if conditional is None:
            before = "a transition before its unconditional one is always taken"
            reasons.append(f"it would come after '{study.name(source)}', where {before}")
        else:
            why = why_never(study, source, conditional)
            reasons.append(f"the transition from '{study.name(source)}' is never taken, as {why}")


def _why(reasons: list[str], lost: list[str]) -> str:
    names = list(dict.fromkeys(lost))
    if names and reasons:
        reasons = [*reasons, f"{quoted(names)} can't be reached either"]
    elif len(names) == 1:
        reasons = [f"only {quoted(names)} leads to it, and that task can't be reached either"]
    elif names:
        reasons = [f"only {quoted(names)} lead to it, and those tasks can't be reached either"]
    return "; ".join(reasons) or "no transition leads to it"
