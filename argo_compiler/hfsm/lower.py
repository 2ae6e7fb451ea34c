"""Lowering: from the tasks and groups of a mission to the states of a machine.

What a mission means is decided here and, for what depends on time and values, in `step`:

Tasks
    When a task has ended, its conditional transitions are considered in list order, and the first
    one whose conditions all hold is taken; if there is none, the unconditional one is, wherever it
    stands in the list. Without that the mission ends. START is passed over: the machine begins with
    the target of START's unconditional transition or, without one, with the first other task. A
    mission of START alone has ended as soon as it is started.
Members
    The members of a group are the tasks from its `start` to its `end` in the mission's list, both
    included. A transition from outside to any member enters the group: round 1 begins, and so does
    its clock. A transition to a task that is not a member leaves it; the next entry starts anew. A
    transition between members is a jump inside and changes neither round nor clock.
Rounds
    A round ends when the group's `end` task has ended and none of its conditional transitions is
    taken. If the group wants another round, it goes on with `start`. Otherwise the unconditional
    transition of the `end` task is taken, which leaves the group even if it leads to a member: the
    group is then entered anew. If several groups end with the same task, the innermost one decides
    first, and only when it wants no other round does the next one outward. A new round of the outer
    group enters the inner ones anew.
Limits
    A group wants another round if fewer than `max_repeat_count` rounds have been completed and less
    than `max_repeat_duration` has passed since it was entered; a limit of 0 does not count.
    `stop=soft` looks at the time at the end of a round only. With `stop=hard` the round ends as
    soon as the time is up: the running action is cancelled, and the machine goes on as after the
    last round, with the decisions of the groups further out that end with the same task.
"""

from argo_compiler.check import check
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.grouping import Layout
from argo_compiler.hfsm.model import (
    DONE,
    MISSION,
    Composite,
    Hfsm,
    Leaf,
    Repeat,
    Transition,
    TransitionKind,
    group_id,
    task_id,
)
from argo_compiler.il import Action, Group, Mission, Stop, Task


def lower(mission: Mission, source_name: str = "mission") -> Hfsm:
    """The machine of a mission, in time linear in the number of tasks.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
    """
    findings = check(mission)
    if any(finding.severity is Severity.ERROR for finding in findings):
        raise DiagnosticError(source_name, findings)
    return _Lowering(mission).machine()


class _Lowering:
    """The tables over one mission that its states are made from."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.layout = Layout.of(mission)
        self.position = {task.name: i for i, task in enumerate(mission.tasks)}
        self.group_ids = [group_id(r.group.name) for r in self.layout.ranges]

    def machine(self) -> Hfsm:
        children = self._children()
        initial = self._initial()
        root = Composite(
            id=MISSION,
            name=self.mission.designation,
            parent=None,
            children=(*children[None], DONE),
            initial=initial,
        )
        groups = (self._composite(i, tuple(children[i])) for i in range(len(self.group_ids)))
        leaves = (
            self._leaf(i, task)
            for i, task in enumerate(self.mission.tasks)
            if task.action is not Action.START
        )
        return Hfsm(composites=(root, *groups), leaves=tuple(leaves))

    def _initial(self) -> str:
        tasks = self.mission.tasks
        start = next((task for task in tasks if task.action is Action.START), None)
        target = None if start is None else _unconditional_target(start)
        if target is None:
            target = next((t.name for t in tasks if t.action is not Action.START), None)
        return DONE if target is None else task_id(target)

    def _children(self) -> dict[int | None, list[str]]:
        """The direct children of the mission (None) and of each group, in the mission's order."""
        children: dict[int | None, list[str]] = {None: []}
        opened = 0
        for i, task in enumerate(self.mission.tasks):
            while opened < len(self.group_ids) and self.layout.ranges[opened].first == i:
                children[opened] = []
                children[self.layout.parent[opened]].append(self.group_ids[opened])
                opened += 1
            if task.action is not Action.START:
                children[self.layout.innermost[i]].append(task_id(task.name))
        return children

    def _composite(self, index: int, children: tuple[str, ...]) -> Composite:
        r = self.layout.ranges[index]
        parent = self.layout.parent[index]
        repeat = Transition(
            kind=TransitionKind.REPEAT,
            target=task_id(r.group.start),
            domain=self.group_ids[index],
        )
        if parent is not None and self.layout.ranges[parent].last == r.last:
            onward = Transition(kind=TransitionKind.DEFAULT, completes=self.group_ids[parent])
        else:
            onward = self._default(parent, self.mission.tasks[r.last])
        return Composite(
            id=self.group_ids[index],
            name=r.group.name,
            parent=self._composite_id(parent),
            children=children,
            initial=task_id(r.group.start),
            repeat=Repeat(
                count=r.group.max_repeat_count,
                duration=r.group.max_repeat_duration,
                stop=r.group.stop,
                count_interruptions=r.group.count_interruptions,
            ),
            transitions=(repeat, onward),
            timeout=_timeout(r.group),
            source=r.group.source,
        )

    def _leaf(self, index: int, task: Task) -> Leaf:
        parent = self.layout.innermost[index]
        conditional = (
            Transition(
                kind=TransitionKind.CONDITIONAL,
                target=task_id(t.target),
                domain=self._domain(parent, t.target),
                conditions=t.conditions,
            )
            for t in task.transitions
            if t.conditions
        )
        ending = self.layout.ending[index]
        if ending:
            last = Transition(kind=TransitionKind.DEFAULT, completes=self.group_ids[ending[0]])
        else:
            last = self._default(parent, task)
        return Leaf(
            id=task_id(task.name),
            parent=self._composite_id(parent),
            task=task,
            transitions=(*conditional, last),
        )

    def _default(self, inside: int | None, task: Task) -> Transition:
        """The unconditional transition of a task, taken by a state that lies in `inside`."""
        target = _unconditional_target(task)
        if target is None:
            return Transition(kind=TransitionKind.DEFAULT, target=DONE, domain=MISSION)
        return Transition(
            kind=TransitionKind.DEFAULT,
            target=task_id(target),
            domain=self._domain(inside, target),
        )

    def _domain(self, inside: int | None, target: str) -> str:
        return self._composite_id(self.layout.common(inside, self.position[target]))

    def _composite_id(self, index: int | None) -> str:
        return MISSION if index is None else self.group_ids[index]


def _unconditional_target(task: Task) -> str | None:
    return next((t.target for t in task.transitions if not t.conditions), None)


def _timeout(group: Group) -> Transition | None:
    if group.stop is Stop.SOFT or not group.max_repeat_duration:
        return None
    return Transition(kind=TransitionKind.TIMEOUT, completes=group_id(group.name))
