"""What keeps its order in a mission, and why, in the mission's words."""

from collections.abc import Iterator
from itertools import combinations, pairwise, product

from argo_compiler.base.errors import Invalid
from argo_compiler.il import Action
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.units import TaskUnit, Unit
from argo_compiler.reorder.visits import Visits, said
from argo_compiler.route.problem import Precedence

AS_WRITTEN = "the order as written"
"""in words, that this order is kept"""


def precedences(
    visits: Visits, precise: bool, requirements: Requirements
) -> tuple[Precedence, ...]:
    """All orders that have to be kept; `precise`: whether the mission asks for a precise one.

    Raises ArgoError if a requirement names something that the mission does not have.
    """
    everything = tuple(range(len(visits.stops)))
    found: list[Precedence] = []
    kept = precise or requirements.keep_order
    if kept and len(everything) > 1:
        shown = ", ".join(visits.short(k) for k in everything)
        words = f"precise order {shown}" if precise else AS_WRITTEN
        found.append(Precedence(everything, words))
    found += asked_for(visits, requirements)
    found += _planned(visits)
    # Also in a precise order: what a decision needs must not be left out.
    found += _deciding(visits)
    if not kept:
        found += _first_of_all(visits)
        found += _measured_again(visits)
        found += _early_ends(visits)
        found += _last_ones(visits)
    return tuple(dict.fromkeys(found))


def must_be_last(visits: Visits) -> int | None:
    """The visit that has to be made as another one can't come last: it branches there."""
    if visits.spine.end is not None or not visits.spine.units:
        return None
    if any(_branches(unit) for unit in visits.spine.units[:-1]):
        return visits.numbers((visits.spine.units[-1],))[-1]
    return None


def asked_for(visits: Visits, requirements: Requirements) -> Iterator[Precedence]:
    """The orders that the requirements ask for. Raises ArgoError as `precedences` does."""
    for sequence in requirements.before:
        found = [visits.find(what) for what in sequence]
        words = " before ".join(map(said, sequence))
        for (i, one), (j, other) in combinations(enumerate(found), 2):
            if set(one) & set(other):
                raise Invalid(
                    f"{words}: {said(sequence[i])} and {said(sequence[j])} have a task in common, "
                    "which can't come before itself"
                )
        if all(len(one) == 1 for one in found):
            yield Precedence(tuple(one[0] for one in found), words)
            continue
        # Also of those that are not neighbours: what is between them may be left out.
        for (i, one), (j, other) in combinations(enumerate(found), 2):
            words = f"{said(sequence[i])} before {said(sequence[j])}"
            yield from (Precedence(pair, words) for pair in product(one, other))


def _planned(visits: Visits) -> Iterator[Precedence]:
    """The orders that the mission itself asks for, of what is not always together or apart."""
    leaves = {leaf.name: i for i, leaf in enumerate(visits.spine.flow.leaves)}
    for pair in visits.spine.before:
        one, other = (visits.of_leaf.get(leaves.get(name, -1)) for name in pair)
        if one is not None and other is not None and one != other:
            yield Precedence((one, other), f"{visits.names[one]} before {visits.names[other]}")


def asked_names(visits: Visits, requirements: Requirements) -> tuple[tuple[str, str], ...]:
    """The same as pairs of tasks, as a mission has them."""
    names = [visits.spine.name(stop.entry) for stop in visits.stops]
    return tuple(
        dict.fromkeys(
            (names[i], names[j])
            for precedence in asked_for(visits, requirements)
            for i, j in pairwise(precedence.sequence)
        )
    )


def _first_of_all(visits: Visits) -> Iterator[Precedence]:
    """A WAIT that begins the mission is done where the robot stands then."""
    first = visits.task(visits.stops[0].entry) if visits.stops else None
    if first is not None and first.action is Action.WAIT:
        words = f"'{first.name}' is done before the robot sets off"
        yield from (Precedence((0, k), words) for k in range(1, len(visits.stops)))


def _measured_again(visits: Visits) -> Iterator[Precedence]:
    objects = dict.fromkeys(leaf.measures for leaf in visits.spine.flow.leaves if leaf.measures)
    for object_id in objects:
        made = visits.measuring(object_id)
        if len(made) > 1:
            yield Precedence(
                tuple(made), f"the measurements of checkpoint {object_id} keep their order"
            )


def _deciding(visits: Visits) -> Iterator[Precedence]:
    """What is measured before and after a condition asks for it."""
    flow = visits.spine.flow
    for number, stop in enumerate(visits.stops):
        own = flow.leaves[stop.entry].measures
        asked = dict.fromkeys(
            condition.object_id for leaf in stop.leaves for condition in visits.spine.asked[leaf]
        )
        for object_id in asked:
            if object_id == own:
                continue
            made = visits.measuring(object_id)
            before = [k for k in made if k < number]
            for k in before:
                words = f"checkpoint {object_id} is measured before {visits.names[number]} decides"
                yield Precedence((k, number), f"{words} on it", needed=k == before[-1])
            for k in made:
                if k > number:
                    words = f"{visits.names[number]} decides on checkpoint {object_id} before"
                    yield Precedence((number, k), f"{words} it is measured again")


def _early_ends(visits: Visits) -> Iterator[Precedence]:
    """What comes before a task that may end the mission stays before it, and what after, after."""
    leaves = {leaf for leaf, _ in visits.spine.gates}
    gates = sorted({visits.of_leaf[leaf] for leaf in leaves if leaf in visits.of_leaf})
    for gate, low, high in zip(gates, [-1, *gates], [*gates[1:], len(visits.stops)], strict=False):
        name = visits.names[gate]
        before = f"{name} may end the mission: what is written before it stays before it"
        after = f"{name} may end the mission: what is written after it stays after it"
        yield from (Precedence((k, gate), before) for k in range(low + 1, gate))
        until = high + 1 if high < len(visits.stops) else high
        yield from (Precedence((gate, k), after) for k in range(gate + 1, until))


def _last_ones(visits: Visits) -> Iterator[Precedence]:
    """A round ends with one task, and so does a mission that does not end docked: what goes on in
    several ways can't be that."""
    if visits.spine.end is None:
        yield from _before_last(visits, visits.spine.units, "the mission")
    for circuit, _ in visits.circuits:
        name = visits.spine.flow.groups[circuit.group].name
        yield from _before_last(visits, circuit.inside, f"a round of '{name}'")


def _before_last(visits: Visits, units: tuple[Unit, ...], what: str) -> Iterator[Precedence]:
    for unit in units[:-1]:
        if isinstance(unit, TaskUnit) and _branches(unit):
            here, last = visits.of_leaf[unit.entry], visits.numbers((units[-1],))[-1]
            words = f"{what} can't end with {visits.names[here]}, which goes on in several ways"
            yield Precedence((here, last), words)


def _branches(unit: Unit) -> bool:
    return isinstance(unit, TaskUnit) and unit.final is None
