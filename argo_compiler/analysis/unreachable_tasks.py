"""Diagnostics on tasks that no path leads to, with the reasons."""

from collections.abc import Iterator

from argo_compiler.analysis.study import Study
from argo_compiler.analysis.transitions import reason_never_taken
from argo_compiler.base.listing import brief_quoted_list
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic

_MOST_REASONS = 3  # transitions to a task that a message mentions


def diagnose_unreachable_tasks(study: Study) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each task that can't be reached, whatever is measured or fails."""
    unreachable = [
        i
        for i in range(len(study.flow.leaves))
        if not study.with_failures.is_reached(i) and study.is_mission_task(i)
    ]
    reasons = _find_reasons(study, unreachable)
    for leaf in unreachable:
        yield study.diagnostic(
            "unreachable-task",
            Message(
                "task '{task}' can't be reached: {why}",
                task=study.name(leaf),
                why=_why(*reasons[leaf]),
            ),
            "lead a transition to it that can be taken, or remove the task",
            leaf,
        )


_Reasons = tuple[list[str], list[str]]
"""reasons why transitions to a task aren't taken, and names of the unreachable tasks before it"""


def _find_reasons(study: Study, unreachable: list[int]) -> dict[int, _Reasons]:
    """Return for each unreachable leaf the reasons why no transition leads to it.

    The first list says why the transitions from reached tasks are not taken, the second one names
    the unreachable tasks that lead to the leaf. Linear time.
    """
    flow = study.flow
    reasons_for: dict[int, _Reasons] = {leaf: ([], []) for leaf in unreachable}
    for i, leaf in enumerate(flow.leaves):
        for k, (_, target) in enumerate(leaf.conditional):
            if target in reasons_for and target != i:
                _add_reason(study, reasons_for[target], i, k)
        if leaf.unconditional in reasons_for and leaf.unconditional != i:
            _add_reason(study, reasons_for[leaf.unconditional], i, None)
        for fallback in (leaf.failure, leaf.missed):
            if fallback in reasons_for and fallback != i and not study.with_failures.is_reached(i):
                reasons_for[fallback][1].append(study.name(i))
    for number, group in enumerate(flow.groups):
        if group.successor not in reasons_for:
            continue
        if study.with_failures.is_reached(flow.round_end_node(number)):
            if len(reasons_for[group.successor][0]) < _MOST_REASONS:
                reasons_for[group.successor][0].append(
                    Message(
                        "group '{group}', after which it would come, is repeated without limit",
                        group=group.name,
                    )
                )
        else:
            _add_reason(study, reasons_for[group.successor], group.last, None)
    return reasons_for


def _add_reason(
    study: Study, reasons_for_task: _Reasons, source: int, conditional: int | None
) -> None:
    reasons, unreachable = reasons_for_task
    if not study.with_failures.is_reached(source):
        unreachable.append(study.name(source))
    elif len(reasons) < _MOST_REASONS:
        if conditional is None:
            earlier = Message("a transition before its unconditional one is always taken")
            reasons.append(
                Message(
                    "it would come after '{task}', where {earlier}",
                    task=study.name(source),
                    earlier=earlier,
                )
            )
        else:
            why = reason_never_taken(study, source, conditional)
            reasons.append(
                Message(
                    "the transition from '{task}' is never taken, as {why}",
                    task=study.name(source),
                    why=why,
                )
            )


def _why(reasons: list[str], unreachable: list[str]) -> str:
    names = list(dict.fromkeys(unreachable))
    if names and reasons:
        reasons = [
            *reasons,
            Message("{names} can't be reached either", names=brief_quoted_list(names)),
        ]
    elif len(names) == 1:
        reasons = [
            Message(
                "only {names} leads to it, and that task can't be reached either",
                names=brief_quoted_list(names),
            )
        ]
    elif names:
        reasons = [
            Message(
                "only {names} lead to it, and those tasks can't be reached either",
                names=brief_quoted_list(names),
            )
        ]
    if not reasons:
        return Message("no transition leads to it")
    return Message("{reasons:;}", reasons=tuple(reasons))
