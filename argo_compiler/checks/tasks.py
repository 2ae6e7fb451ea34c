"""Checks of tasks and their transitions."""

from collections.abc import Iterable, Iterator

from argo_compiler.base.message import Listing, Message, identifier
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.checks.checked_item import CheckedItem
from argo_compiler.checks.conditions import ConditionChecks
from argo_compiler.checks.timing import (
    check_failure_target_fits,
    check_unused_fields,
    check_wait,
    check_window,
    has_failure_branch_or_time_rule,
)
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, Mission, OnFailure, Task
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_compiler.il.subjects import Subjects
from argo_compiler.il.transitions import failure_targets_by_field

MANY_RETRIES = 100
"""limit of retries without a warning; with more, the mission seems to hang"""

# Names of their own, as the look-up in an enumeration takes as long as the comparison itself.
_START, _WAYPOINT, _MEASURE, _RETURN, _WAIT = (
    Action.START,
    Action.WAYPOINT,
    Action.MEASURE,
    OnFailure.RETURN,
    Action.WAIT,
)

_TARGET = ".transitions[{}].target"

_MOST_HINTS = 20
"""number of unknown names for which a similar name is searched"""


class TaskChecks:
    """Checks of a mission's tasks, with the sets of names that they need.

    A mission may have a hundred thousand tasks: the loop itself recognises correct ones, and calls
    a function only for those that are wrong or need a closer look.
    """

    def __init__(self, mission: Mission, known: frozenset[str] | None) -> None:
        self.mission = mission
        self.subjects = Subjects(mission)
        tasks = mission.tasks
        self.names = {task.name for task in tasks}
        self.starts = [task.name for task in tasks if task.action is _START]
        self.targets = self.names.difference(self.starts)
        self.known = known
        measured = {task.object_id for task in tasks if task.action is _MEASURE}
        self.conditions = ConditionChecks(measured, known)
        self.hints = 0

    def diagnostics(self) -> Iterator[Diagnostic]:
        if len(self.names) < len(self.mission.tasks) or not RESERVED_NAMES.isdisjoint(self.names):
            yield from _check_names(self.mission.tasks, self.subjects)
        starts = 0
        targets, known = self.targets, self.known
        for i, task in enumerate(self.mission.tasks):
            action = task.action
            if action is _MEASURE:
                object_id = task.object_id
                if object_id is None or (known is not None and object_id not in known):
                    yield _object_diagnostic(self._item(i, task), task)
            elif action is _WAYPOINT:
                if task.pose is None:
                    yield self._item(i, task).diagnostic(
                        "il.waypoint-without-pose",
                        Message("the WAYPOINT task '{task}' has no pose", task=task.name),
                        "give it the pose of its target",
                    )
            elif action is _WAIT:
                yield from check_wait(self._item(i, task), task)
                yield from check_unused_fields(self._item(i, task), task)
            else:
                starts += 1
                if starts > 1:
                    yield self._item(i, task).diagnostic(
                        "il.many-starts",
                        Message(
                            "'{task}' is a second START task; '{start}' is the first",
                            task=task.name,
                            start=self.starts[0],
                        ),
                        "a mission begins at one pose: remove all START tasks but one",
                    )
                yield from check_unused_fields(self._item(i, task), task)
            if has_failure_branch_or_time_rule(task):
                yield from self._check_timing(self._item(i, task), task)
            transitions = task.transitions
            if len(transitions) != 1 or transitions[0].conditions:
                yield from self._check_branching(self._item(i, task), task)
            elif transitions[0].target not in targets:
                item = self._item(i, task)
                yield self._target_diagnostic(item, task, transitions[0].target, _TARGET.format(0))
            if task.retries > MANY_RETRIES:
                yield self._item(i, task).diagnostic(
                    "il.many-retries",
                    Message(
                        "task '{task}' would be tried again {retries} times",
                        task=task.name,
                        retries=task.retries,
                    ),
                    Message(
                        "allow at most {many_retries}, and set on_failure for what follows then",
                        many_retries=MANY_RETRIES,
                    ),
                    ".retries",
                )
            if task.joint_states is not None:
                yield from _check_joints(self._item(i, task), task)
        yield from _check_returns(self.mission, self.subjects)
        for i, group in enumerate(self.mission.groups):
            for n, condition in enumerate(group.until):
                item = CheckedItem(self.subjects.group_subject(i), group.source)
                yield from self.conditions.diagnostics(item, group, condition, f".until[{n}]")

    def _item(self, i: int, task: Task) -> CheckedItem:
        return CheckedItem(self.subjects.task_subject(i), task.source)

    def _check_timing(self, item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
        """Yield the diagnostics of a task's failure policy, wait and time window."""
        if task.action in (_WAYPOINT, _MEASURE):
            yield from check_unused_fields(item, task)
        yield from check_failure_target_fits(item, task)
        yield from check_window(item, task)
        for n, condition in enumerate(task.wait.conditions if task.wait else ()):
            field = f".wait.conditions[{n}]"
            yield from self.conditions.diagnostics(item, task, condition, field)
        for field, target in failure_targets_by_field(task).items():
            if target not in self.targets:
                yield self._target_diagnostic(item, task, target, f".{field}")

    def _check_branching(self, item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
        """Yield the diagnostics of a task's transitions.

        The caller itself checks the usual case, a single unconditional transition.
        """
        unconditional = 0
        for k, transition in enumerate(task.transitions):
            if transition.target not in self.targets:
                yield self._target_diagnostic(item, task, transition.target, _TARGET.format(k))
            unconditional += not transition.conditions
            for n, condition in enumerate(transition.conditions):
                field = f".transitions[{k}].conditions[{n}]"
                yield from self.conditions.diagnostics(item, task, condition, field)
        if unconditional > 1:
            yield item.diagnostic(
                "il.many-unconditional",
                Message(
                    "task '{task}' has {unconditional} unconditional transitions",
                    task=task.name,
                    unconditional=unconditional,
                ),
                "keep one and give the others conditions",
                ".transitions",
            )
        if task.action is Action.START and unconditional < len(task.transitions):
            yield item.diagnostic(
                "il.start-condition",
                Message(
                    "the START task '{task}' has a conditional transition, which is never "
                    "taken: nothing has been measured yet",
                    task=task.name,
                ),
                "remove it",
                ".transitions",
            )
        elif task.transitions and not unconditional:
            yield item.diagnostic(
                "il.no-unconditional",
                Message(
                    "the mission ends after task '{task}' if none of its conditions hold",
                    task=task.name,
                ),
                "add an unconditional transition if it has to continue",
                ".transitions",
            )

    def _target_diagnostic(
        self, item: CheckedItem, task: Task, target: str, field: str
    ) -> Diagnostic:
        if target in self.names:
            return item.diagnostic(
                "il.start-as-target",
                Message(
                    "a transition of task '{task}' leads to the START task '{target}', which "
                    "only defines where the mission begins",
                    task=task.name,
                    target=target,
                ),
                "lead it to the task that follows START",
                field,
            )
        near = self._nearest(target)
        return item.diagnostic(
            "il.unknown-target",
            Message(
                "a transition of task '{task}' leads to '{target}', which is not a task of "
                "the mission",
                task=task.name,
                target=target,
            ),
            Message("is '{near}' meant?", near=near)
            if near
            else Message(
                "add a task '{target}' or lead the transition to another one", target=target
            ),
            field,
        )

    def _nearest(self, name: str) -> str | None:
        self.hints += 1
        return nearest_name(name, self.names) if self.hints <= _MOST_HINTS else None


def _check_names(tasks: Iterable[Task], subjects: Subjects) -> Iterator[Diagnostic]:
    seen: set[str] = set()
    for i, task in enumerate(tasks):
        item = CheckedItem(subjects.task_subject(i), task.source)
        if task.name in seen:
            yield item.diagnostic(
                "il.duplicate-task",
                Message("more than one task is named '{task}'", task=task.name),
                "give each task a name of its own: transitions and groups refer to it",
                ".name",
            )
        if task.name in RESERVED_NAMES:
            yield item.diagnostic(
                "il.reserved-name",
                Message(
                    "the machine needs the name '{task}' for a drive of its own", task=task.name
                ),
                "give the task another name",
                ".name",
            )
        seen.add(task.name)


def _object_diagnostic(item: CheckedItem, task: Task) -> Diagnostic:
    if task.object_id is None:
        return item.diagnostic(
            "il.measure-without-object",
            Message("the MEASURE task '{task}' has no object_id", task=task.name),
            "set it to the number of the checkpoint that it measures",
        )
    return item.diagnostic(
        "il.unknown-object",
        Message(
            "task '{task}' names checkpoint '{object_id}', which the site does not have",
            task=task.name,
            object_id=task.object_id,
        ),
        "use the number of a checkpoint in the site's catalogue",
        ".object_id",
    )


def _check_joints(item: CheckedItem, task: Task) -> Iterator[Diagnostic]:
    joints = task.joint_states
    if joints is None:
        return
    lengths = {
        "positions": len(joints.positions),
        "velocities": len(joints.velocities),
        "efforts": len(joints.efforts),
    }
    mismatched = [
        Message("{count} {what}", count=n, what=identifier(what))
        for what, n in lengths.items()
        if n not in (0, len(joints.names))
    ]
    if mismatched:
        fault = Message(
            "names {count} joints and gives {mismatched:and}",
            count=len(joints.names),
            mismatched=Listing(mismatched),
        )
    elif not any(lengths.values()):
        fault = Message("names joints, but has no positions, velocities or efforts for them")
    elif len(set(joints.names)) != len(joints.names):
        fault = Message("names a joint twice")
    else:
        return
    yield item.diagnostic(
        "il.joint-states",
        Message("task '{task}' {fault}", task=task.name, fault=fault),
        "give one for each joint or none at all, and each joint once",
        ".joint_states",
    )


def _check_returns(mission: Mission, subjects: Subjects) -> Iterator[Diagnostic]:
    """Yield one diagnostic for all tasks that return to the dock, if the mission has none."""
    if mission.dock:
        return
    returning = [i for i, t in enumerate(mission.tasks) if t.on_failure is _RETURN]
    if returning:
        task = mission.tasks[returning[0]]
        others = (
            Message(" (and {count} more)", count=len(returning) - 1) if len(returning) > 1 else ""
        )
        yield CheckedItem(subjects.task_subject(returning[0]), task.source).diagnostic(
            "il.no-dock",
            Message(
                "task '{task}'{others} must return to the dock if it fails, but the "
                "mission has no dock",
                task=task.name,
                others=others,
            ),
            "give the mission the pose of its docking station as `dock`",
            ".on_failure",
        )
