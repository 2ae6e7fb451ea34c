"""Visits of a mission: its task units by number, and their names for messages.

A leaf is a state of the mission's state machine that executes one task; leaves are named by their
numbers in the flow (see `argo_compiler.analysis.flow`).
"""

from dataclasses import dataclass
from functools import cached_property

from argo_compiler.analysis.flow import NOWHERE
from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Message
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.il import Action, Task
from argo_compiler.reorder.requirements import MissionPart
from argo_compiler.reorder.units import GroupUnit, TaskUnit, Unit, UnitChain, task_units_in


@dataclass(frozen=True)
class Visits:
    """Task units of a chain; the number of a visit is its position in the written order."""

    chain: UnitChain

    @cached_property
    def task_units(self) -> tuple[TaskUnit, ...]:
        """All task units by visit number."""
        return tuple(task_units_in(self.chain.units))

    @cached_property
    def visit_of_leaf(self) -> dict[int, int]:
        """Number of the visit that each leaf belongs to."""
        return {leaf: k for k, unit in enumerate(self.task_units) for leaf in unit.leaves}

    @cached_property
    def group_units(self) -> tuple[tuple[GroupUnit, tuple[int, ...]], ...]:
        """All group units with the numbers of their visits, outer ones first."""
        return tuple(self._group_units(self.chain.units))

    def _group_units(self, units: tuple[Unit, ...]) -> list[tuple[GroupUnit, tuple[int, ...]]]:
        result = []
        for unit in units:
            if isinstance(unit, GroupUnit):
                result.append((unit, tuple(self.visits_in((unit,)))))
                result += self._group_units(unit.inside)
        return result

    def visits_in(self, units: tuple[Unit, ...]) -> list[int]:
        """Return the visit numbers of all task units in these units."""
        return [self.visit_of_leaf[unit.entry] for unit in task_units_in(units)]

    def leaf_task(self, leaf: int) -> Task:
        """Return the task of a leaf."""
        return self.chain.flow.leaves[leaf].leaf.task

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the visits for messages."""
        return tuple(self.leaf_display_name(unit.entry) for unit in self.task_units)

    def is_optional(self, visit: int) -> bool:
        """Return True if a visit's tasks are optional or WAITs, and at least one is optional."""
        tasks = [self.leaf_task(leaf) for leaf in self.task_units[visit].leaves]
        return all(task.optional or task.action is Action.WAIT for task in tasks) and any(
            task.optional for task in tasks
        )

    def leaf_display_name(self, leaf: int) -> str:
        """Return the name of a leaf for messages: `checkpoint 8`, or the task's name in quotes.

        The task's name is added to the checkpoint if another task measures the same one.
        """
        task = self.leaf_task(leaf)
        if task.action is not Action.MEASURE:
            return f"'{task.name}'"
        others = self._leaves_measuring[task.object_id or ""]
        return Message("checkpoint {object_id}", object_id=task.object_id) + (
            f" ('{task.name}')" if len(others) > 1 else ""
        )

    def other_task_display_names(self, visit: int) -> tuple[str, ...]:
        """Return the names of a visit's tasks except the first, done always or in some cases."""
        unit = self.task_units[visit]
        others = (self.leaf_display_name(leaf) for leaf in unit.leaves if leaf != unit.entry)
        return tuple(dict.fromkeys(others))

    def checkpoint_number_or_name(self, visit: int) -> str:
        """Return the visit's name without the word `checkpoint`."""
        return self.names[visit].removeprefix(Message("checkpoint "))

    @cached_property
    def _leaves_measuring(self) -> dict[str, list[int]]:
        result: dict[str, list[int]] = {}
        for i, leaf in enumerate(self.chain.flow.leaves):
            if leaf.measures is not None:
                result.setdefault(leaf.measures, []).append(i)
        return result

    def visits_measuring(self, object_id: str) -> list[int]:
        """Return the visits that measure a checkpoint, in the written order."""
        leaves = self._leaves_measuring.get(object_id, ())
        return sorted({self.visit_of_leaf[i] for i in leaves if i in self.visit_of_leaf})

    def resolve_visits(self, what: MissionPart) -> list[int]:
        """Return the visits of a checkpoint, task or group that a requirement on the order names.

        Raises ArgoError if there are none.
        """
        if isinstance(what, str):
            for i, leaf in enumerate(self.chain.flow.leaves):
                if leaf.name == what:
                    if i == self.chain.end or i not in self.visit_of_leaf:
                        raise Invalid(
                            Message(
                                "'{what}' ends the mission, so its place in the order is fixed: "
                                "remove the requirement that names it",
                                what=what,
                            )
                        )
                    return [self.visit_of_leaf[i]]
            for group in self.chain.flow.groups:
                if group.name == what:
                    leaves = range(group.first, group.last + 1)
                    result = [self.visit_of_leaf[i] for i in leaves if i in self.visit_of_leaf]
                    return list(dict.fromkeys(result))
        result = self.visits_measuring(str(what))
        if not result:
            known = [leaf.name for leaf in self.chain.flow.leaves]
            known += [group.name for group in self.chain.flow.groups]
            near = nearest_name(str(what), known) if isinstance(what, str) else None
            hint = (
                Message("is '{near}' meant?", near=near)
                if near
                else Message("name a checkpoint, a task or a group of it")
            )
            raise NotFound(
                Message(
                    "the mission has no {display_name}: {hint}",
                    display_name=display_name(what),
                    hint=hint,
                )
            )
        return result

    def with_whole_groups(self, visits: list[int]) -> list[int]:
        """Return the visits and all others in their outermost groups: left out only together."""
        result = list(visits)
        for group_unit, inside in self.group_units:
            around = self.chain.flow.groups[group_unit.group].parent
            if around == NOWHERE and set(inside) & set(visits):
                result += inside
        return list(dict.fromkeys(result))


def display_name(what: MissionPart) -> str:
    """Return `checkpoint 8`, or a name in quotes."""
    is_number = isinstance(what, int) or what.isdecimal()
    return Message("checkpoint {what}", what=what) if is_number else f"'{what}'"
