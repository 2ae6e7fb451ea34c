"""Whether a mission makes sense: the structure of its tasks, transitions and groups.

What is found here needs no knowledge of the paths that a run may take. An error means that the
mission has no agreed meaning and can't be lowered; a warning, that it has one that may surprise.
"""

from collections.abc import Iterable, Iterator

from argo_compiler.catalog import Catalog
from argo_compiler.check_groups import check_groups
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.il import Action, Condition, ConditionType, Mission, Task


def check(mission: Mission, catalog: Catalog | None = None) -> tuple[Diagnostic, ...]:
    """All that is wrong or odd about a mission, in the order of its tasks, then of its groups.

    With a catalogue, checkpoints are looked up in it by their number. Linear time.
    """
    if not mission.tasks:
        return (
            Diagnostic(
                code="il.empty-mission",
                severity=Severity.ERROR,
                message="the mission has no tasks",
                hint="add a task; a mission that does nothing has a START task only",
            ),
        )
    names = {task.name for task in mission.tasks}
    starts = {task.name for task in mission.tasks if task.action is Action.START}
    known = None if catalog is None else {str(c.id) for c in catalog.checkpoints}
    measured = {task.object_id for task in mission.tasks if task.action is Action.MEASURE}
    findings: list[Diagnostic] = [*_duplicate_names(mission.tasks), *_extra_starts(mission.tasks)]
    for task in mission.tasks:
        findings += _check_action(task, known)
        findings += _check_transitions(task, names, starts)
        for transition in task.transitions:
            for condition in transition.conditions:
                findings += _check_condition(task, condition, measured, known)
    findings += check_groups(mission)
    return tuple(findings)


def _finding(
    task: Task, code: str, message: str, hint: str, severity: Severity = Severity.ERROR
) -> Diagnostic:
    return Diagnostic(code=code, severity=severity, message=message, span=task.source, hint=hint)


def _duplicate_names(tasks: Iterable[Task]) -> Iterator[Diagnostic]:
    seen: set[str] = set()
    for task in tasks:
        if task.name in seen:
            yield _finding(
                task,
                "il.duplicate-task",
                f"more than one task is named '{task.name}'",
                "give each task a name of its own: transitions and groups go by it",
            )
        seen.add(task.name)


def _extra_starts(tasks: Iterable[Task]) -> Iterator[Diagnostic]:
    starts = [task for task in tasks if task.action is Action.START]
    for task in starts[1:]:
        yield _finding(
            task,
            "il.many-starts",
            f"'{task.name}' is a second START task; '{starts[0].name}' is the first",
            "a mission begins at one place: remove all START tasks but one",
        )


def _check_action(task: Task, known: set[str] | None) -> Iterator[Diagnostic]:
    if task.action is Action.MEASURE:
        if task.object_id is None:
            yield _finding(
                task,
                "il.measure-without-object",
                f"the MEASURE task '{task.name}' has no object_id",
                "say which checkpoint it measures",
            )
        elif known is not None and task.object_id not in known:
            yield _unknown_object(task, task.object_id)
    elif task.action is Action.WAYPOINT and task.pose is None:
        yield _finding(
            task,
            "il.waypoint-without-pose",
            f"the WAYPOINT task '{task.name}' has no pose",
            "say where it leads",
        )


def _unknown_object(task: Task, object_id: str) -> Diagnostic:
    return _finding(
        task,
        "il.unknown-object",
        f"task '{task.name}' names checkpoint '{object_id}', which the site does not have",
        "use the number of a checkpoint in the site's catalogue",
    )


def _check_transitions(task: Task, names: set[str], starts: set[str]) -> Iterator[Diagnostic]:
    for transition in task.transitions:
        if transition.target not in names:
            yield _finding(
                task,
                "il.unknown-target",
                f"a transition of task '{task.name}' leads to '{transition.target}', "
                "which is no task of the mission",
                f"add a task '{transition.target}' or lead the transition to another one",
            )
        elif transition.target in starts:
            yield _finding(
                task,
                "il.start-as-target",
                f"a transition of task '{task.name}' leads to the START task "
                f"'{transition.target}', which is only where the mission begins",
                "lead it to the task that follows START",
            )
    unconditional = sum(not transition.conditions for transition in task.transitions)
    if unconditional > 1:
        yield _finding(
            task,
            "il.many-unconditional",
            f"task '{task.name}' has {unconditional} unconditional transitions",
            "keep one and give the others conditions",
        )
    if task.action is Action.START and unconditional < len(task.transitions):
        yield _finding(
            task,
            "il.start-condition",
            f"the START task '{task.name}' has a conditional transition, which is never taken: "
            "nothing has been measured yet",
            "remove it",
            Severity.WARNING,
        )
    elif task.transitions and not unconditional:
        yield _finding(
            task,
            "il.no-unconditional",
            f"the mission ends after task '{task.name}' if none of its conditions hold",
            "add an unconditional transition if it is to go on",
            Severity.WARNING,
        )


def _check_condition(
    task: Task, condition: Condition, measured: set[str | None], known: set[str] | None
) -> Iterator[Diagnostic]:
    if condition.type is ConditionType.WITHIN:
        if condition.param2 is None:
            yield _finding(
                task,
                "il.within-bounds",
                f"a {condition.type} condition of task '{task.name}' has no param2",
                "give it as the upper bound",
            )
        elif condition.param1 >= condition.param2:
            yield _finding(
                task,
                "il.within-bounds",
                f"a {condition.type} condition of task '{task.name}' never holds: no value lies "
                f"between {condition.param1:g} and {condition.param2:g}",
                "param1 is the lower bound, param2 the upper one",
            )
    if known is not None and condition.object_id not in known:
        yield _unknown_object(task, condition.object_id)
    elif condition.object_id not in measured:
        yield _finding(
            task,
            "il.never-measured",
            f"a condition of task '{task.name}' compares checkpoint '{condition.object_id}', "
            "which no task measures, so it never holds",
            f"measure checkpoint '{condition.object_id}' before this task",
            Severity.WARNING,
        )
