"""Whether what tasks say about time, waiting and failing makes sense."""

from collections.abc import Iterator

from argo_compiler.checks.about import About
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, OnFailure, Task

_PLAIN = Task(name="any", action=Action.WAYPOINT)

# What has an effect on these actions only; the fields that all actions have are not listed.
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


def has_timing_or_branch(task: Task) -> bool:
    """Whether a task says something that this module looks at: most of a large mission do not."""
    return (
        task.wait is not None
        or task.window is not None
        or task.failure_target is not None
        or task.on_failure is OnFailure.BRANCH
        or task.reading_limit is not None
    )


def check_unused_fields(about: About, task: Task) -> Iterator[Diagnostic]:
    """What a task says that has no effect on its action."""
    for field, actions in _USED_BY.items():
        if task.action not in actions and getattr(task, field) != _DEFAULTS[field]:
            yield about.diagnostic(
                "il.unused-field",
                f"the {task.action} task '{task.name}' has `{field}`, which has no effect on it",
                "remove it",
                f".{field}",
            )


def check_wait(about: About, task: Task) -> Iterator[Diagnostic]:
    """What is wrong with how long a WAIT lasts, its conditions apart."""
    rule = task.wait
    happens = rule is not None and (rule.event is not None or bool(rule.conditions))
    if rule is None or (rule.duration is None) == (not happens):
        says = "does not say how long it lasts"
        if rule is not None and rule.duration is not None:
            says = "has both a duration and something that it waits for"
        yield about.diagnostic(
            "il.wait-rule",
            f"the WAIT task '{task.name}' {says}",
            "give its `wait` a `duration`, or else an `event`, `conditions` or both",
            ".wait" if rule else "",
        )
    elif happens and rule.limit is None and (task.window is None or task.window.latest is None):
        yield about.diagnostic(
            "il.wait-without-limit",
            f"the WAIT task '{task.name}' has no limit: it may last for ever",
            "give its `wait` a `limit` in seconds",
            ".wait",
        )
    elif rule.duration is not None and rule.limit is not None:
        yield about.diagnostic(
            "il.unused-field",
            f"the WAIT task '{task.name}' lasts for a time, so its `limit` has no effect",
            "remove it",
            ".wait.limit",
        )


def check_failure(about: About, task: Task) -> Iterator[Diagnostic]:
    """Whether a failure branch and its policy belong together; the target itself apart."""
    branches = task.on_failure is OnFailure.BRANCH
    if branches and task.failure_target is None:
        yield about.diagnostic(
            "il.branch-without-target",
            f"task '{task.name}' is to go on elsewhere when it has failed, and does not say where",
            "give it a `failure_target`",
            ".on_failure",
        )
    elif not branches and task.failure_target is not None:
        yield about.diagnostic(
            "il.unused-field",
            f"task '{task.name}' has a `failure_target`, but its `on_failure` is {task.on_failure}",
            "set `on_failure` to branch, or remove the target",
            ".failure_target",
        )


def check_window(about: About, task: Task) -> Iterator[Diagnostic]:
    """What is wrong with a task's time window."""
    window = task.window
    if window is None:
        return
    if window.latest is not None and window.latest <= window.earliest:
        yield about.diagnostic(
            "il.window-order",
            f"task '{task.name}' is to be done between {window.earliest:g} s and "
            f"{window.latest:g} s, which leaves no time",
            "give `latest` a time after `earliest`, in s since the mission's start",
            ".window",
        )
    if window.missed_target is not None and (window.latest is None or not window.hard):
        why = "has no `latest`" if window.latest is None else "is not hard"
        yield about.diagnostic(
            "il.unused-field",
            f"the window of task '{task.name}' {why}, so it is never missed and its "
            "`missed_target` has no effect",
            "remove it, or give the window a hard `latest`",
            ".window.missed_target",
        )
