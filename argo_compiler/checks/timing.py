"""Checks of tasks' fields for times, waits and failures."""

from collections.abc import Iterator

from argo_compiler.base.message import Message, identifier
from argo_compiler.checks.checked_item import CheckedItem
from argo_compiler.checks.reactions import check_charging
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, OnFailure, Task

_PLAIN = Task(name="any", action=Action.WAYPOINT)

# Fields with the only actions that use them; fields that all actions use are not listed.
_USED_BY = {
    "object_id": {Action.MEASURE},
    "pose": {Action.START, Action.WAYPOINT, Action.MEASURE},
    "wait": {Action.WAIT},
    "velocity": {Action.WAYPOINT, Action.MEASURE},
    "joint_states": {Action.START, Action.WAYPOINT, Action.MEASURE},
    "retries": {Action.WAYPOINT, Action.MEASURE},
    "on_failure": {Action.WAYPOINT, Action.MEASURE, Action.WAIT},
    "time_limit": {Action.WAYPOINT, Action.MEASURE},
    "reading_limit": {Action.MEASURE},
    "optional": {Action.WAYPOINT, Action.MEASURE, Action.WAIT},
    "priority": {Action.WAYPOINT, Action.MEASURE, Action.WAIT},
    "window": {Action.WAYPOINT, Action.MEASURE, Action.WAIT},
}

_DEFAULTS = {field: getattr(_PLAIN, field) for field in _USED_BY}


def has_failure_branch_or_time_rule(task: Task) -> bool:
    """Return True if a task has a wait, window or reading limit, or a branch after its failure.

    Most tasks have none of these, and need fewer checks.
    """
    return (
        task.wait is not None
        or task.window is not None
        or task.failure_target is not None
        or task.on_failure is OnFailure.BRANCH
        or task.reading_limit is not None
    )


def check_unused_fields(item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
    """Yield a diagnostic for each set field that has no effect on the action of the task."""
    for field, actions in _USED_BY.items():
        if task.action not in actions and getattr(task, field) != _DEFAULTS[field]:
            yield item.diagnostic(
                "il.unused-field",
                Message(
                    "the {action} task '{task}' has `{field}`, which has no effect on it",
                    action=task.action,
                    task=task.name,
                    field=identifier(field),
                ),
                "remove it",
                f".{field}",
            )


def check_wait(item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
    """Yield the diagnostics of the wait rule of a WAIT task, apart from its conditions."""
    rule = task.wait
    if rule is not None:
        name = Message("the WAIT task '{task}'", task=task.name)
        yield from check_charging(item, name, rule, rule.event, rule.limit, "event", ".wait")
    waits_for_something = rule is not None and (rule.event is not None or bool(rule.conditions))
    if rule is None or (rule.duration is None) == (not waits_for_something):
        fault = Message("does not say how long it lasts")
        if rule is not None and rule.duration is not None:
            fault = Message("has both a duration and an event or conditions")
        yield item.diagnostic(
            "il.wait-rule",
            Message("the WAIT task '{task}' {fault}", task=task.name, fault=fault),
            "give its `wait` a `duration`, or else an `event`, `conditions` or both",
            ".wait" if rule else "",
        )
    elif (
        waits_for_something
        and rule.limit is None
        and not (rule.charge_for is not None and rule.charge_to is None)
        and (task.window is None or task.window.latest is None)
    ):
        yield item.diagnostic(
            "il.wait-without-limit",
            Message("the WAIT task '{task}' has no limit: it may last for ever", task=task.name),
            "give its `wait` a `limit` in seconds",
            ".wait",
        )
    elif rule.duration is not None and rule.limit is not None:
        yield item.diagnostic(
            "il.unused-field",
            Message(
                "the WAIT task '{task}' has a `duration`, so its `limit` has no effect",
                task=task.name,
            ),
            "remove it",
            ".wait.limit",
        )


def check_failure_target_fits(item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
    """Yield a diagnostic if failure policy and failure target do not fit together.

    Whether a task of the target's name exists is checked in `tasks.py`.
    """
    branches = task.on_failure is OnFailure.BRANCH
    if branches and task.failure_target is None:
        yield item.diagnostic(
            "il.branch-without-target",
            Message(
                "task '{task}' must branch when it has failed, but has no target for that",
                task=task.name,
            ),
            "give it a `failure_target`",
            ".on_failure",
        )
    elif not branches and task.failure_target is not None:
        yield item.diagnostic(
            "il.unused-field",
            Message(
                "task '{task}' has a `failure_target`, but its `on_failure` is {on_failure}",
                task=task.name,
                on_failure=task.on_failure,
            ),
            "set `on_failure` to branch, or remove the target",
            ".failure_target",
        )


def check_window(item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
    """Yield the diagnostics of a task's time window."""
    window = task.window
    if window is None:
        return
    if window.latest is not None and window.latest <= window.earliest:
        yield item.diagnostic(
            "il.window-order",
            Message(
                "task '{task}' must be done between {earliest:g} s and {latest:g} s, which "
                "leaves no time",
                task=task.name,
                earliest=window.earliest,
                latest=window.latest,
            ),
            "give `latest` a time after `earliest`, in s since the mission's start",
            ".window",
        )
    if window.missed_target is not None and (window.latest is None or not window.hard):
        why = Message("has no `latest`") if window.latest is None else Message("is not hard")
        yield item.diagnostic(
            "il.unused-field",
            Message(
                "the window of task '{task}' {why}, so it is never missed and its "
                "`missed_target` has no effect",
                task=task.name,
                why=why,
            ),
            "remove it, or give the window a hard `latest`",
            ".window.missed_target",
        )
