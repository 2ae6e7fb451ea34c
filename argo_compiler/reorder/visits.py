"""The visits of a mission: its stops by number, and their names in the mission's words."""

from dataclasses import dataclass
from functools import cached_property

from argo_compiler.analysis.flow import NOWHERE
from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.nearest_name import nearest_name
from argo_compiler.il import Action, Task
from argo_compiler.reorder.requirements import What
from argo_compiler.reorder.units import Circuit, Spine, TaskUnit, Unit, stops_of


@dataclass(frozen=True)
class Visits:
    """The stops of a spine, each with its number in the order in which they are written."""

    spine: Spine

    @cached_property
    def stops(self) -> tuple[TaskUnit, ...]:
        return tuple(stops_of(self.spine.units))

    @cached_property
    def of_leaf(self) -> dict[int, int]:
        """The number of the visit that each leaf belongs to."""
        return {leaf: k for k, stop in enumerate(self.stops) for leaf in stop.leaves}

    @cached_property
    def circuits(self) -> tuple[tuple[Circuit, tuple[int, ...]], ...]:
        """All circuits with the numbers of their visits, each before those that lie in it."""
        return tuple(self._circuits(self.spine.units))

    def _circuits(self, units: tuple[Unit, ...]) -> list[tuple[Circuit, tuple[int, ...]]]:
        found = []
        for unit in units:
            if isinstance(unit, Circuit):
                found.append((unit, tuple(self.numbers((unit,)))))
                found += self._circuits(unit.inside)
        return found

    def numbers(self, units: tuple[Unit, ...]) -> list[int]:
        """Of all stops of these units."""
        return [self.of_leaf[stop.entry] for stop in stops_of(units)]

    def task(self, leaf: int) -> Task:
        return self.spine.flow.leaves[leaf].leaf.task

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the visits, in the mission's words."""
        return tuple(self.name(stop.entry) for stop in self.stops)

    def optional(self, visit: int) -> bool:
        """Whether all that is done with a visit may be left out."""
        tasks = [self.task(leaf) for leaf in self.stops[visit].leaves]
        return all(task.optional or task.action is Action.WAIT for task in tasks) and any(
            task.optional for task in tasks
        )

    def name(self, leaf: int) -> str:
        """`checkpoint 8`, with the task's name where another one measures it too; else the name of
        the task."""
        task = self.task(leaf)
        if task.action is not Action.MEASURE:
            return f"'{task.name}'"
        others = self._measuring[task.object_id or ""]
        return f"checkpoint {task.object_id}" + (f" ('{task.name}')" if len(others) > 1 else "")

    def along(self, visit: int) -> tuple[str, ...]:
        """The names of what is done with a visit, always or in some cases."""
        stop = self.stops[visit]
        others = (self.name(leaf) for leaf in stop.leaves if leaf != stop.entry)
        return tuple(dict.fromkeys(others))

    def short(self, visit: int) -> str:
        """The same, with only the number of a checkpoint."""
        return self.names[visit].removeprefix("checkpoint ")

    @cached_property
    def _measuring(self) -> dict[str, list[int]]:
        found: dict[str, list[int]] = {}
        for i, leaf in enumerate(self.spine.flow.leaves):
            if leaf.measures is not None:
                found.setdefault(leaf.measures, []).append(i)
        return found

    def measuring(self, object_id: str) -> list[int]:
        """The visits that measure a checkpoint, in the order in which they are written."""
        leaves = self._measuring.get(object_id, ())
        return sorted({self.of_leaf[i] for i in leaves if i in self.of_leaf})

    def find(self, what: What) -> list[int]:
        """The visits that a requirement means. Raises ArgoError if there are none."""
        if isinstance(what, str):
            for i, leaf in enumerate(self.spine.flow.leaves):
                if leaf.name == what:
                    if i == self.spine.end or i not in self.of_leaf:
                        raise Invalid(f"'{what}' stays where it is: it ends the mission")
                    return [self.of_leaf[i]]
            for group in self.spine.flow.groups:
                if group.name == what:
                    leaves = range(group.first, group.last + 1)
                    found = [self.of_leaf[i] for i in leaves if i in self.of_leaf]
                    return list(dict.fromkeys(found))
        found = self.measuring(str(what))
        if not found:
            known = [leaf.name for leaf in self.spine.flow.leaves]
            known += [group.name for group in self.spine.flow.groups]
            near = nearest_name(str(what), known) if isinstance(what, str) else None
            hint = f"is '{near}' meant?" if near else "name a checkpoint, a task or a group of it"
            raise NotFound(f"the mission has no {said(what)}: {hint}")
        return found

    def whole(self, visits: list[int]) -> list[int]:
        """The visits, and all of the outermost groups in which they lie: left out together."""
        found = list(visits)
        for circuit, inside in self.circuits:
            around = self.spine.flow.groups[circuit.group].parent
            if around == NOWHERE and set(inside) & set(visits):
                found += inside
        return list(dict.fromkeys(found))


def said(what: What) -> str:
    """`checkpoint 8`, or a name in quotes."""
    number = isinstance(what, int) or what.isdecimal()
    return f"checkpoint {what}" if number else f"'{what}'"
