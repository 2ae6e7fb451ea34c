"""Rewriting of a mission in another order: tasks and groups move, everything else stays."""

from collections.abc import Sequence

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.il import Action, Group, Mission, Task, Transition
from argo_compiler.reorder.mission_problem import MissionProblem
from argo_compiler.reorder.units import GroupUnit, TaskUnit, Unit
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import Tour


def apply_route(planned: MissionProblem, route: Tour) -> Mission:
    """Return the mission with its tasks in the order of the route.

    Visits that the route leaves out are removed with all their tasks, and named in `left_out`.
    Transitions, the borders of groups and START are adapted to the new order. The time limit that
    the order was chosen for becomes the maximum duration; required precedences are added to
    `before`. Names, conditions, sources and everything else stay unchanged. A wait of the route for
    a window needs no task: the window of the task has this effect.

    Raises ArgoError if the route breaks a rule other than a time limit, or charges: no task of a
    mission charges.
    """
    _require_possible(planned, route)
    return _Rewriting(planned, route).mission()


def _require_possible(planned: MissionProblem, route: Tour) -> None:
    problem = planned.problem
    if route.charges:
        first = min(route.charges)
        charger = problem.chargers[route.charges[first]]
        after = (
            Message("sets off")
            if not first
            else Message("has done {name}", name=planned.visits.names[route.order[first - 1]])
        )
        raise Invalid(
            Message(
                "this order charges at {charger} when the robot {after}, and no task of a "
                "mission charges: make two missions of it, or let the mission react to "
                "low_battery",
                charger=charger,
                after=after,
            )
        )
    if not route.order and planned.visits.chain.end is None:
        raise Invalid("this order leaves out every task: allow more time")
    for violation in evaluate(problem, route).violations:
        if not violation.startswith("it takes "):
            raise Invalid(
                Message("no mission can be written in this order: {violation}", violation=violation)
            )


class _Rewriting:
    """Rewriting of one mission. Collects its tasks and its groups' borders in the new order."""

    def __init__(self, planned: MissionProblem, route: Tour) -> None:
        self.original = planned.mission
        self.limit = planned.limit
        self.required_before = planned.before
        self.visits = planned.visits
        self.chain = planned.visits.chain
        self.position = {visit: k for k, visit in enumerate(route.order)}
        self.tasks_before = {task.name: task for task in planned.mission.tasks}
        self.tasks: list[Task] = []
        self.new_borders: dict[str, tuple[str, str]] = {}
        """first and last task of each group that was written"""

    def mission(self) -> Mission:
        chain = self.chain
        end = None if chain.end is None else chain.name(chain.end)
        units = self._in_new_order(chain.units)
        self._write(units, end)
        unmoved = [
            task for i, task in self._tasks_by_leaf() if i in chain.detached or i == chain.end
        ]
        first = self._entry(units[0]) if units else end
        before = self.original
        starts = [
            self._start_leading_to(task, first)
            for task in before.tasks
            if task.action is Action.START
        ]
        tasks = (*starts, *self.tasks, *unmoved)
        names = {task.name for task in tasks}
        return before.model_copy(
            update={
                "tasks": tasks,
                "groups": tuple(self._group(g) for g in before.groups if self._remains(g, names)),
                "current": before.current if before.current in names else None,
                "max_duration": self.limit,
                "before": tuple(dict.fromkeys((*before.before, *self.required_before))),
                "left_out": (
                    *before.left_out,
                    *(task.name for task in before.tasks if task.name not in names),
                ),
            }
        )

    def _tasks_by_leaf(self) -> list[tuple[int, Task]]:
        """Return pairs of a leaf's number and its task, for all tasks of the mission but START."""
        leaves = self.chain.flow.leaves
        return [
            (i, self.tasks_before[leaf.name])
            for i, leaf in enumerate(leaves)
            if leaf.name in self.tasks_before
        ]

    def _start_leading_to(self, start: Task, first: str | None) -> Task:
        """Return START with its unconditional transition to `first`, the new order's first task.

        Without a first task, the transition is removed.
        """
        transitions = tuple(
            t if t.conditions else t.model_copy(update={"target": first})
            for t in start.transitions
            if t.conditions or first is not None
        )
        return start.model_copy(update={"transitions": transitions})

    # ---- order

    def _in_new_order(self, units: Sequence[Unit]) -> list[Unit]:
        """Return the units that the route visits, in their new order."""

        def position(unit: Unit) -> int:
            visited = [
                self.position[k] for k in self.visits.visits_in((unit,)) if k in self.position
            ]
            return min(visited, default=-1)

        return sorted((unit for unit in units if position(unit) >= 0), key=position)

    def _entry(self, unit: Unit) -> str:
        while isinstance(unit, GroupUnit):
            unit = self._in_new_order(unit.inside)[0]
        return self.chain.name(unit.entry)

    def _write(self, units: Sequence[Unit], after: str | None) -> None:
        """Append the tasks of consecutive units; `after` is the task that follows the last one."""
        for k, unit in enumerate(units):
            following = self._entry(units[k + 1]) if k + 1 < len(units) else after
            if isinstance(unit, TaskUnit):
                self._write_unit(unit, following)
                continue
            first = len(self.tasks)
            self._write(self._in_new_order(unit.inside), following)
            name = self.chain.flow.groups[unit.group].name
            self.new_borders[name] = self.tasks[first].name, self.tasks[-1].name

    def _write_unit(self, unit: TaskUnit, following: str | None) -> None:
        inside = {self.chain.name(leaf) for leaf in unit.leaves}
        for leaf in unit.leaves:
            task = self.tasks_before[self.chain.name(leaf)]
            transitions: list[Transition] = []
            for transition in task.transitions:
                if self._keeps_target(leaf, transition, inside):
                    transitions.append(transition)
                elif following is not None:
                    transitions.append(transition.model_copy(update={"target": following}))
                else:
                    # No condition leads to the end of a mission: precedences forbid such orders.
                    assert not transition.conditions
            if following is not None and self._needs_transition(leaf, task):
                transitions.append(Transition(target=following))
            changed = self._branch_targets(leaf, task, inside, following)
            self.tasks.append(
                task.model_copy(update={"transitions": tuple(transitions), **changed})
            )

    def _branch_targets(
        self, leaf: int, task: Task, inside: set[str], following: str | None
    ) -> dict[str, object]:
        """Return the fields of a task with new targets of its failure and missed window.

        Fields that do not change are left out.
        """

        def new_target(target: str | None) -> str | None:
            if target is None or target in inside or target in self._early_end_tasks(leaf, True):
                return target
            return following

        changed: dict[str, object] = {}
        if new_target(task.failure_target) != task.failure_target:
            changed["failure_target"] = new_target(task.failure_target)
        if (
            task.window is not None
            and new_target(task.window.missed_target) != task.window.missed_target
        ):
            target = new_target(task.window.missed_target)
            changed["window"] = task.window.model_copy(update={"missed_target": target})
        return changed

    def _keeps_target(self, leaf: int, transition: Transition, inside: set[str]) -> bool:
        """Return True if a transition keeps its target.

        That is so if it stays in its unit, or ends the mission early: before its usual end.
        """
        if transition.target in inside:
            return bool(transition.conditions) or not self._ends_round_of_level(leaf)
        return transition.target in self._early_end_tasks(leaf, bool(transition.conditions))

    def _early_end_tasks(self, leaf: int, conditional: bool) -> set[str]:
        """Return the tasks through which a leaf ends the mission early.

        The drive into the docking station is one of them only for a conditional transition.
        """
        chain = self.chain
        return {
            chain.name(node)
            for from_, node in chain.early_exits
            if from_ == leaf and chain.flow.is_leaf(node) and (conditional or node != chain.end)
        }

    def _ends_round_of_level(self, leaf: int) -> bool:
        """Return True if a leaf's unconditional transition ends a round of its unit's group.

        In the mission, this transition leads to what follows after the last round.
        """
        unit = self.visits.task_units[self.visits.visit_of_leaf[leaf]]
        node = self.chain.flow.leaves[leaf].unconditional
        group = self.chain.flow.group_of_round_end(node)
        while group is not None and group != unit.level:
            node = self.chain.flow.groups[group].successor
            group = self.chain.flow.group_of_round_end(node)
        return group is not None

    def _needs_transition(self, leaf: int, task: Task) -> bool:
        """Return True if a leaf needs a new transition to the task that follows now.

        This is so if it had no unconditional transition and so ended the mission in the usual way.
        """
        if any(not transition.conditions for transition in task.transitions):
            return False
        return (leaf, self.chain.flow.end_node) not in self.chain.early_exits

    # ---- groups

    def _remains(self, group: Group, names: set[str]) -> bool:
        return group.start in names or group.name in self.new_borders

    def _group(self, group: Group) -> Group:
        start, end = self.new_borders.get(group.name, (group.start, group.end))
        return group.model_copy(update={"start": start, "end": end})
