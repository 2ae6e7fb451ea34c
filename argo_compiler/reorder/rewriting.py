"""A mission in another order: tasks and groups move, all else stays as it was."""

from collections.abc import Sequence

from argo_compiler.base.errors import Invalid
from argo_compiler.il import Action, Group, Mission, Task, Transition
from argo_compiler.reorder.mission import MissionRoute
from argo_compiler.reorder.units import Circuit, TaskUnit, Unit
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import Tour


def apply_route(planned: MissionRoute, route: Tour) -> Mission:
    """The mission with its tasks in the order of the route.

    What the route leaves out is taken away, with what is done only after it, and named in
    `left_out`. Transitions, the groups' first and last tasks and START lead to what comes next now;
    the limit that the order was chosen for is the maximum duration, what was asked to come before
    what is in `before`; names, conditions, sources and
    everything else are kept.

    Raises ArgoError if the route breaks a rule other than a limit of time, or a mission can't say
    it: it has no task that charges. Where the route waits for a window, the task's own does.
    """
    _require_possible(planned, route)
    return _Rewriting(planned, route).mission()


def _require_possible(planned: MissionRoute, route: Tour) -> None:
    problem = planned.problem
    if route.charges:
        first = min(route.charges)
        place = problem.chargers[route.charges[first]]
        after = (
            "sets off" if not first else f"has done {planned.visits.names[route.order[first - 1]]}"
        )
        raise Invalid(
            f"this order charges at {place} when the robot {after}, and no task of a mission does "
            "that: make two missions of it, or let the mission react to low_battery"
        )
    if not route.order and planned.visits.spine.end is None:
        raise Invalid("this order leaves out every task: allow more time")
    for violation in evaluate(problem, route).violations:
        if not violation.startswith("it takes "):
            raise Invalid(f"no mission can be written in this order: {violation}")


class _Rewriting:
    """The tables over one mission. Collects its tasks and groups in their new order."""

    def __init__(self, planned: MissionRoute, route: Tour) -> None:
        self.mission_before = planned.mission
        self.limit = planned.limit
        self.asked = planned.before
        self.visits = planned.visits
        self.spine = planned.visits.spine
        self.position = {visit: k for k, visit in enumerate(route.order)}
        self.tasks_before = {task.name: task for task in planned.mission.tasks}
        self.tasks: list[Task] = []
        self.limits: dict[str, tuple[str, str]] = {}
        """first and last task of each group that has them anew"""

    def mission(self) -> Mission:
        spine = self.spine
        end = None if spine.end is None else spine.name(spine.end)
        units = self._ordered(spine.units)
        self._write(units, end)
        kept = [task for i, task in self._own() if i in spine.apart or i == spine.end]
        first = self._entry(units[0]) if units else end
        before = self.mission_before
        starts = [
            self._leading_to(task, first) for task in before.tasks if task.action is Action.START
        ]
        tasks = (*starts, *self.tasks, *kept)
        names = {task.name for task in tasks}
        return before.model_copy(
            update={
                "tasks": tasks,
                "groups": tuple(self._group(g) for g in before.groups if self._stays(g, names)),
                "current": before.current if before.current in names else None,
                "max_duration": self.limit,
                "before": tuple(dict.fromkeys((*before.before, *self.asked))),
                "left_out": (
                    *before.left_out,
                    *(task.name for task in before.tasks if task.name not in names),
                ),
            }
        )

    def _own(self) -> list[tuple[int, Task]]:
        """The tasks with the numbers of their leaves."""
        leaves = self.spine.flow.leaves
        return [
            (i, self.tasks_before[leaf.name])
            for i, leaf in enumerate(leaves)
            if leaf.name in self.tasks_before
        ]

    def _leading_to(self, start: Task, first: str | None) -> Task:
        """START, whose way without conditions leads to the first task."""
        ways = tuple(
            t if t.conditions else t.model_copy(update={"target": first})
            for t in start.transitions
            if t.conditions or first is not None
        )
        return start.model_copy(update={"transitions": ways})

    # ---- order

    def _ordered(self, units: Sequence[Unit]) -> list[Unit]:
        """The units that are left, in their new order."""

        def place(unit: Unit) -> int:
            made = [self.position[k] for k in self.visits.numbers((unit,)) if k in self.position]
            return min(made, default=-1)

        return sorted((unit for unit in units if place(unit) >= 0), key=place)

    def _entry(self, unit: Unit) -> str:
        while isinstance(unit, Circuit):
            unit = self._ordered(unit.inside)[0]
        return self.spine.name(unit.entry)

    def _write(self, units: Sequence[Unit], after: str | None) -> None:
        """Appends the tasks of units that follow each other; `after` is what follows the last."""
        for k, unit in enumerate(units):
            following = self._entry(units[k + 1]) if k + 1 < len(units) else after
            if isinstance(unit, TaskUnit):
                self._write_stop(unit, following)
                continue
            begun = len(self.tasks)
            self._write(self._ordered(unit.inside), following)
            name = self.spine.flow.groups[unit.group].name
            self.limits[name] = self.tasks[begun].name, self.tasks[-1].name

    def _write_stop(self, stop: TaskUnit, following: str | None) -> None:
        inside = {self.spine.name(leaf) for leaf in stop.leaves}
        for leaf in stop.leaves:
            task = self.tasks_before[self.spine.name(leaf)]
            ways: list[Transition] = []
            for transition in task.transitions:
                if self._stays_put(leaf, transition, inside):
                    ways.append(transition)
                elif following is not None:
                    ways.append(transition.model_copy(update={"target": following}))
                else:
                    # A condition can't lead to the end of a mission: `rules` keeps such out of it.
                    assert not transition.conditions
            if following is not None and self._ends_here(leaf, task):
                ways.append(Transition(target=following))
            led = self._leading_in_trouble(leaf, task, inside, following)
            self.tasks.append(task.model_copy(update={"transitions": tuple(ways), **led}))

    def _leading_in_trouble(
        self, leaf: int, task: Task, inside: set[str], following: str | None
    ) -> dict[str, object]:
        """Where a failure and a missed window lead, as far as that is not the same as before."""

        def led(target: str | None) -> str | None:
            if target is None or target in inside or target in self._early(leaf, True):
                return target
            return following

        changed: dict[str, object] = {}
        if led(task.failure_target) != task.failure_target:
            changed["failure_target"] = led(task.failure_target)
        if task.window is not None and led(task.window.missed_target) != task.window.missed_target:
            target = led(task.window.missed_target)
            changed["window"] = task.window.model_copy(update={"missed_target": target})
        return changed

    def _stays_put(self, leaf: int, transition: Transition, inside: set[str]) -> bool:
        """Whether a transition stays within its unit, or ends the mission early."""
        if transition.target in inside:
            return bool(transition.conditions) or not self._completes_level(leaf)
        return transition.target in self._early(leaf, bool(transition.conditions))

    def _early(self, leaf: int, conditional: bool) -> set[str]:
        """The tasks with which the mission ends early from a leaf: the way to the docking station
        does by a condition only."""
        spine = self.spine
        return {
            spine.name(node)
            for from_, node in spine.gates
            if from_ == leaf and spine.flow.is_leaf(node) and (conditional or node != spine.end)
        }

    def _completes_level(self, leaf: int) -> bool:
        """Whether the unconditional way from a leaf is that after the last round around its unit,
        or the mission's end."""
        stop = self.visits.stops[self.visits.of_leaf[leaf]]
        node = self.spine.flow.leaves[leaf].tail
        group = self.spine.flow.group_of_round_end(node)
        while group is not None and group != stop.level:
            node = self.spine.flow.groups[group].onward
            group = self.spine.flow.group_of_round_end(node)
        return group is not None

    def _ends_here(self, leaf: int, task: Task) -> bool:
        """Whether the mission went to its end from a leaf by having no unconditional transition."""
        if any(not transition.conditions for transition in task.transitions):
            return False
        return (leaf, self.spine.flow.done) not in self.spine.gates

    # ---- groups

    def _stays(self, group: Group, names: set[str]) -> bool:
        return group.start in names or group.name in self.limits

    def _group(self, group: Group) -> Group:
        start, end = self.limits.get(group.name, (group.start, group.end))
        return group.model_copy(update={"start": start, "end": end})
