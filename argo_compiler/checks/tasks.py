"""Whether the tasks of a mission and their transitions make sense."""

from collections.abc import Iterable, Iterator

from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.checks.about import About
from argo_compiler.checks.conditions import ConditionChecks
from argo_compiler.checks.timing import (
    check_failure,
    check_unused_fields,
    check_wait,
    check_window,
    has_timing_or_branch,
)
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.il import Action, Mission, OnFailure, Task
from argo_compiler.il.reserved import RESERVED_NAMES
from argo_compiler.il.subjects import Subjects
from argo_compiler.il.transitions import failure_targets

MANY_RETRIES = 100
"""that few actions are worth; more look like a mission that hangs"""

# Looked up in the enumeration, each would take as long as the rest of a comparison.
_START, _WAYPOINT, _MEASURE, _RETURN, _WAIT = (
    Action.START,
    Action.WAYPOINT,
    Action.MEASURE,
    OnFailure.RETURN,
    Action.WAIT,
)

_TARGET = ".transitions[{}].target"

_MOST_HINTS = 20
"""missing names for which a similar one is looked up"""


class TaskChecks:
    """The sets over one mission that its tasks are checked with.

    A mission may have a hundred thousand tasks: what is sound is recognised in the loop, and a call
    is made only for what is not, or not at a glance.
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
                    yield _wrong_object(self._about(i, task), task)
            elif action is _WAYPOINT:
                if task.pose is None:
                    yield self._about(i, task).diagnostic(
                        "il.waypoint-without-pose",
                        f"the WAYPOINT task '{task.name}' has no pose",
                        "say where it leads",
                    )
            elif action is _WAIT:
                yield from check_wait(self._about(i, task), task)
                yield from check_unused_fields(self._about(i, task), task)
            else:
                starts += 1
                if starts > 1:
                    yield self._about(i, task).diagnostic(
                        "il.many-starts",
                        f"'{task.name}' is a second START task; '{self.starts[0]}' is the first",
                        "a mission begins at one place: remove all START tasks but one",
                    )
                yield from check_unused_fields(self._about(i, task), task)
            if has_timing_or_branch(task):
                yield from self._timing(self._about(i, task), task)
            transitions = task.transitions
            if len(transitions) != 1 or transitions[0].conditions:
                yield from self._branching(self._about(i, task), task)
            elif transitions[0].target not in targets:
                about = self._about(i, task)
                yield self._wrong_target(about, task, transitions[0].target, _TARGET.format(0))
            if task.retries > MANY_RETRIES:
                yield self._about(i, task).diagnostic(
                    "il.many-retries",
                    f"task '{task.name}' would be tried again {task.retries} times",
                    f"up to {MANY_RETRIES} are thought of: let on_failure say what comes then",
                    ".retries",
                )
            if task.joint_states is not None:
                yield from _check_joints(self._about(i, task), task)
        yield from _check_returns(self.mission, self.subjects)
        for i, group in enumerate(self.mission.groups):
            for n, condition in enumerate(group.until):
                about = About(self.subjects.group(i), group.source)
                yield from self.conditions.diagnostics(about, group, condition, f".until[{n}]")

    def _about(self, i: int, task: Task) -> About:
        return About(self.subjects.task(i), task.source)

    def _timing(self, about: About, task: Task) -> Iterator[Diagnostic]:
        """What a task says about failing, waiting and time windows."""
        if task.action in (_WAYPOINT, _MEASURE):
            yield from check_unused_fields(about, task)
        yield from check_failure(about, task)
        yield from check_window(about, task)
        for n, condition in enumerate(task.wait.conditions if task.wait else ()):
            field = f".wait.conditions[{n}]"
            yield from self.conditions.diagnostics(about, task, condition, field)
        for field, target in failure_targets(task).items():
            if target not in self.targets:
                yield self._wrong_target(about, task, target, f".{field}")

    def _branching(self, about: About, task: Task) -> Iterator[Diagnostic]:
        """The transitions of a task that has none, several, or a conditional one."""
        unconditional = 0
        for k, transition in enumerate(task.transitions):
            if transition.target not in self.targets:
                yield self._wrong_target(about, task, transition.target, _TARGET.format(k))
            unconditional += not transition.conditions
            for n, condition in enumerate(transition.conditions):
                field = f".transitions[{k}].conditions[{n}]"
                yield from self.conditions.diagnostics(about, task, condition, field)
        if unconditional > 1:
            yield about.diagnostic(
                "il.many-unconditional",
                f"task '{task.name}' has {unconditional} unconditional transitions",
                "keep one and give the others conditions",
                ".transitions",
            )
        if task.action is Action.START and unconditional < len(task.transitions):
            yield about.diagnostic(
                "il.start-condition",
                f"the START task '{task.name}' has a conditional transition, which is never taken: "
                "nothing has been measured yet",
                "remove it",
                ".transitions",
            )
        elif task.transitions and not unconditional:
            yield about.diagnostic(
                "il.no-unconditional",
                f"the mission ends after task '{task.name}' if none of its conditions hold",
                "add an unconditional transition if it is to go on",
                ".transitions",
            )

    def _wrong_target(self, about: About, task: Task, target: str, field: str) -> Diagnostic:
        if target in self.names:
            return about.diagnostic(
                "il.start-as-target",
                f"a transition of task '{task.name}' leads to the START task '{target}', which is "
                "only where the mission begins",
                "lead it to the task that follows START",
                field,
            )
        near = self._nearest(target)
        return about.diagnostic(
            "il.unknown-target",
            f"a transition of task '{task.name}' leads to '{target}', which is no task of the "
            "mission",
            f"is '{near}' meant?"
            if near
            else f"add a task '{target}' or lead the transition to another one",
            field,
        )

    def _nearest(self, name: str) -> str | None:
        self.hints += 1
        return nearest_name(name, self.names) if self.hints <= _MOST_HINTS else None


def _check_names(tasks: Iterable[Task], subjects: Subjects) -> Iterator[Diagnostic]:
    seen: set[str] = set()
    for i, task in enumerate(tasks):
        about = About(subjects.task(i), task.source)
        if task.name in seen:
            yield about.diagnostic(
                "il.duplicate-task",
                f"more than one task is named '{task.name}'",
                "give each task a name of its own: transitions and groups go by it",
                ".name",
            )
        if task.name in RESERVED_NAMES:
            yield about.diagnostic(
                "il.reserved-name",
                f"the machine needs the name '{task.name}' for a drive of its own",
                "give the task another name",
                ".name",
            )
        seen.add(task.name)


def _wrong_object(about: About, task: Task) -> Diagnostic:
    if task.object_id is None:
        return about.diagnostic(
            "il.measure-without-object",
            f"the MEASURE task '{task.name}' has no object_id",
            "say which checkpoint it measures",
        )
    return about.diagnostic(
        "il.unknown-object",
        f"task '{task.name}' names checkpoint '{task.object_id}', which the site does not have",
        "use the number of a checkpoint in the site's catalogue",
        ".object_id",
    )


def _check_joints(about: About, task: Task) -> Iterator[Diagnostic]:
    joints = task.joint_states
    if joints is None:
        return
    given = {
        "positions": len(joints.positions),
        "velocities": len(joints.velocities),
        "efforts": len(joints.efforts),
    }
    odd = [f"{n} {what}" for what, n in given.items() if n not in (0, len(joints.names))]
    if odd:
        fault = f"names {len(joints.names)} joints and gives {' and '.join(odd)}"
    elif not any(given.values()):
        fault = "names joints and does not say where they are to be"
    elif len(set(joints.names)) != len(joints.names):
        fault = "names a joint twice"
    else:
        return
    yield about.diagnostic(
        "il.joint-states",
        f"task '{task.name}' {fault}",
        "give one for each joint or none at all, and each joint once",
        ".joint_states",
    )


def _check_returns(mission: Mission, subjects: Subjects) -> Iterator[Diagnostic]:
    """One diagnostic for all tasks that are to return to a dock that is not there."""
    if mission.dock:
        return
    returning = [i for i, t in enumerate(mission.tasks) if t.on_failure is _RETURN]
    if returning:
        task = mission.tasks[returning[0]]
        others = f" (and {len(returning) - 1} more)" if len(returning) > 1 else ""
        yield About(subjects.task(returning[0]), task.source).diagnostic(
            "il.no-dock",
            f"task '{task.name}'{others} is to return to the dock if it fails, but the mission has "
            "no dock",
            "give the mission the pose of its docking station as `dock`",
            ".on_failure",
        )
