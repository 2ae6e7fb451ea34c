"""Lowering: from the tasks, groups and reactions of a mission to the states of a machine.

`docs/language.md` defines the meaning of a mission. All that does not depend on time and values is
decided here: START is skipped (M1, M2), the unconditional transition comes last (T3), rounds end
from the innermost group outward (G5 to G7), and each transition knows which groups it leaves (G2 to
G4).
"""

from typing import TYPE_CHECKING

from argo_compiler.base.garbage_collector import collector_held
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.hfsm.group_timeout import hard_stop_transition
from argo_compiler.hfsm.model import (
    DONE,
    MISSION,
    RETURN,
    Composite,
    Hfsm,
    Leaf,
    ReactionState,
    RepeatRule,
    StateTransition,
    TransitionKind,
    group_id,
    reaction_id,
    task_id,
)
from argo_compiler.il import (
    Action,
    Mission,
    Mode,
    OnFailure,
    Reaction,
    Response,
    Task,
)
from argo_compiler.il.grouping import GroupNesting
from argo_compiler.il.reserved import RETURN_TASK, reaction_task_name
from argo_compiler.il.transitions import default_target, initial_task

if TYPE_CHECKING:
    from argo_compiler.hfsm.progress import Progress


def lower(
    mission: Mission, progress: "Progress | None" = None, source_name: str = "mission"
) -> Hfsm:
    """Return the state machine of a mission, in time linear in the number of tasks.

    With `progress`, it is the machine of the remaining mission, which has only the states that can
    still be reached from that progress. Messages call the mission `source_name`.

    Raises:
        DiagnosticError: `check` finds errors in the mission.
        ArgoError: the mission does not have the task that the progress is at.
    """
    diagnostics = check(mission)
    if any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics):
        raise DiagnosticError(source_name, diagnostics)
    with collector_held():
        machine = _Lowering(mission).machine()
        if progress is None:
            return machine
        from argo_compiler.hfsm.remaining import remaining_machine  # imported late: rarely needed

        return remaining_machine(machine, progress)


_END = StateTransition(kind=TransitionKind.DEFAULT, target=DONE, domain=MISSION)

_FAILURES = {
    OnFailure.RETURN: StateTransition(kind=TransitionKind.FAILURE, target=RETURN, domain=MISSION),
    OnFailure.ABORT: StateTransition(kind=TransitionKind.FAILURE, target=DONE, domain=MISSION),
}


class _Lowering:
    """Lowering of one mission: look-up tables over it, from which its states are made."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.layout = GroupNesting.from_mission(mission)
        self.position = {task.name: i for i, task in enumerate(mission.tasks)}
        self.group_ids = [group_id(r.group.name) for r in self.layout.ranges]

    def machine(self) -> Hfsm:
        children = self._children()
        initial = self._initial()
        root = Composite(
            id=MISSION,
            name=self.mission.designation,
            parent=None,
            children=(*children[None], *(leaf.id for leaf in self._return_leaf()), DONE),
            initial=initial,
        )
        groups = (self._composite(i, tuple(children[i])) for i in range(len(self.group_ids)))
        leaves = (
            self._leaf(i, task)
            for i, task in enumerate(self.mission.tasks)
            if task.action is not Action.START
        )
        # The parts are validated and the references are made here; validating them again is slow.
        return Hfsm.model_construct(
            composites=(root, *groups),
            leaves=(*leaves, *self._return_leaf()),
            reactions=tuple(
                _reaction_state(reaction, self.mission)
                for reaction in sorted(
                    self.mission.reactions, key=lambda r: r.urgency_score, reverse=True
                )
            ),
            max_duration=self.mission.max_duration,
            supervised=self.mission.mode is Mode.SUPERVISORY,
        )

    def _initial(self) -> str:
        target = initial_task(self.mission)
        return DONE if target is None else task_id(target)

    def _children(self) -> dict[int | None, list[str]]:
        """Return the ids of the direct children of the mission and of each group, in mission order.

        The key is None for the mission, and the position of a group in the nesting.
        """
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
        repeat = StateTransition(
            kind=TransitionKind.REPEAT,
            target=task_id(r.group.start),
            domain=self.group_ids[index],
        )
        if parent is not None and self.layout.ranges[parent].last == r.last:
            onward = StateTransition(kind=TransitionKind.DEFAULT, completes=self.group_ids[parent])
        else:
            onward = self._default(parent, self.mission.tasks[r.last])
        return Composite(
            id=self.group_ids[index],
            name=r.group.name,
            parent=self._composite_id(parent),
            children=children,
            initial=task_id(r.group.start),
            repeat=RepeatRule(
                count=r.group.max_repeat_count,
                duration=r.group.max_repeat_duration,
                stop=r.group.stop,
                count_interruptions=r.group.count_interruptions,
                every=r.group.every,
                until=r.group.until,
            ),
            transitions=(repeat, onward),
            timeout=hard_stop_transition(r.group),
            source=r.group.source,
        )

    def _leaf(self, index: int, task: Task) -> Leaf:
        parent = self.layout.innermost[index]
        conditional = [
            StateTransition(
                kind=TransitionKind.CONDITIONAL,
                target=task_id(t.target),
                domain=self._domain(parent, t.target),
                conditions=t.conditions,
            )
            for t in task.transitions
            if t.conditions
        ]
        ending = self.layout.ending[index]
        if ending:
            last = StateTransition(kind=TransitionKind.DEFAULT, completes=self.group_ids[ending[0]])
        else:
            last = self._default(parent, task)
        return Leaf(
            id=task_id(task.name),
            parent=self._composite_id(parent),
            task=task,
            transitions=(*conditional, last),
            failure=self._failure(parent, task),
            missed=self._missed(parent, task),
        )

    def _failure(self, inside: int | None, task: Task) -> StateTransition | None:
        """Return a task's own transition after it has failed for good.

        It is None if the task continues as after a success. `inside` is the position of the
        innermost group around the task; None: no group.
        """
        if task.on_failure is not OnFailure.BRANCH or task.failure_target is None:
            return _FAILURES.get(task.on_failure)
        return StateTransition(
            kind=TransitionKind.FAILURE,
            target=task_id(task.failure_target),
            domain=self._domain(inside, task.failure_target),
        )

    def _missed(self, inside: int | None, task: Task) -> StateTransition | None:
        """Return a task's own transition after a missed hard window; None: as after a failure."""
        window = task.window
        if window is None or not window.hard or window.missed_target is None:
            return None
        return StateTransition(
            kind=TransitionKind.MISSED,
            target=task_id(window.missed_target),
            domain=self._domain(inside, window.missed_target),
        )

    def _return_leaf(self) -> tuple[Leaf, ...]:
        """Return the leaf of the drive back to the dock, or () without `on_failure` RETURN."""
        if all(task.on_failure is not OnFailure.RETURN for task in self.mission.tasks):
            return ()
        return (
            Leaf(
                id=RETURN,
                parent=MISSION,
                task=Task(name=RETURN_TASK, action=Action.WAYPOINT, pose=self.mission.dock),
                transitions=(_END,),
            ),
        )

    def _default(self, inside: int | None, task: Task) -> StateTransition:
        """Return the unconditional transition of a task, for the task itself or a group it ends.

        `inside` is the position of the group that directly contains that state; None: no group.
        """
        target = default_target(task)
        if target is None:
            return _END
        return StateTransition(
            kind=TransitionKind.DEFAULT,
            target=task_id(target),
            domain=self._domain(inside, target),
        )

    def _domain(self, inside: int | None, target: str) -> str:
        at = self.position[target]
        if self.layout.innermost[at] != inside:
            inside = self.layout.innermost_common_range(inside, at)
        return MISSION if inside is None else self.group_ids[inside]

    def _composite_id(self, index: int | None) -> str:
        return MISSION if index is None else self.group_ids[index]


def _reaction_state(reaction: Reaction, mission: Mission) -> ReactionState:
    task = None
    if reaction.response.drives:
        returns = reaction.response is Response.RETURN
        task = Task(
            name=reaction_task_name(reaction.event),
            action=Action.WAYPOINT,
            pose=(reaction.pose or mission.dock) if returns else reaction.pose,
        )
    return ReactionState(id=reaction_id(reaction.event), reaction=reaction, task=task)
