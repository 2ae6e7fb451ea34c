"""Precedences that an order of a mission's visits has to keep, with their reasons in words."""

from collections.abc import Iterator
from itertools import combinations, pairwise, product

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Listing, Message
from argo_compiler.il import Action
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.units import TaskUnit, Unit
from argo_compiler.reorder.visits import Visits, display_name
from argo_compiler.route.problem import Precedence

AS_WRITTEN = Message("the order as written")
"""message: the written order is kept"""


def precedences(
    visits: Visits, mission_is_precise: bool, requirements: Requirements
) -> tuple[Precedence, ...]:
    """Return all precedences of a mission's visits.

    `mission_is_precise` states that the mission itself requires the written order; then the result
    includes the precedence of all visits in that order.

    Raises ArgoError if a requirement names something that the mission does not have.
    """
    everything = tuple(range(len(visits.task_units)))
    result: list[Precedence] = []
    is_fixed = mission_is_precise or requirements.keep_order
    if is_fixed and len(everything) > 1:
        names = Listing(visits.checkpoint_number_or_name(k) for k in everything)
        words = Message("precise order {names}", names=names) if mission_is_precise else AS_WRITTEN
        result.append(Precedence(everything, words))
    result += required_precedences(visits, requirements)
    result += _mission_precedences(visits)
    # Also in a precise order: a measurement that a decision needs must not be left out.
    result += _decisions(visits)
    if not is_fixed:
        result += _initial_wait(visits)
        result += _repeated_measurements(visits)
        result += _early_ends(visits)
        result += _last_units(visits)
    return tuple(dict.fromkeys(result))


def required_last_visit(visits: Visits) -> int | None:
    """Return the visit written last if no order may leave it out; None if it need not be made.

    It must be made if some earlier unit can't come last: one that is left by several transitions,
    in a mission that does not dock.
    """
    if visits.chain.end is not None or not visits.chain.units:
        return None
    if any(_has_several_exits(unit) for unit in visits.chain.units[:-1]):
        return visits.visits_in((visits.chain.units[-1],))[-1]
    return None


def required_precedences(visits: Visits, requirements: Requirements) -> Iterator[Precedence]:
    """Yield the precedences of the requirements. Raises ArgoError as `precedences` does."""
    for sequence in requirements.before:
        members = [visits.resolve_visits(what) for what in sequence]
        words = " before ".join(map(display_name, sequence))
        for (i, one), (j, other) in combinations(enumerate(members), 2):
            if set(one) & set(other):
                raise Invalid(
                    Message(
                        "{words}: {display_name} and {display_name_2} have a task in common, which "
                        "can't come before itself",
                        words=words,
                        display_name=display_name(sequence[i]),
                        display_name_2=display_name(sequence[j]),
                    )
                )
        if all(len(one) == 1 for one in members):
            yield Precedence(tuple(one[0] for one in members), words)
            continue
        # All pairs, not only neighbours: the visits between two of them may be left out.
        for (i, one), (j, other) in combinations(enumerate(members), 2):
            words = Message(
                "{display_name} before {display_name_2}",
                display_name=display_name(sequence[i]),
                display_name_2=display_name(sequence[j]),
            )
            yield from (Precedence(pair, words) for pair in product(one, other))


def _mission_precedences(visits: Visits) -> Iterator[Precedence]:
    """Yield the precedences in the mission's `before`, except those within one visit."""
    leaves = {leaf.name: i for i, leaf in enumerate(visits.chain.flow.leaves)}
    for pair in visits.chain.before:
        one, other = (visits.visit_of_leaf.get(leaves.get(name, -1)) for name in pair)
        if one is not None and other is not None and one != other:
            yield Precedence(
                (one, other),
                Message(
                    "{name} before {name_2}", name=visits.names[one], name_2=visits.names[other]
                ),
            )


def precedence_name_pairs(
    visits: Visits, requirements: Requirements
) -> tuple[tuple[str, str], ...]:
    """Return the precedences of the requirements for `Mission.before`: pairs of first tasks."""
    names = [visits.chain.name(unit.entry) for unit in visits.task_units]
    return tuple(
        dict.fromkeys(
            (names[i], names[j])
            for precedence in required_precedences(visits, requirements)
            for i, j in pairwise(precedence.sequence)
        )
    )


def _initial_wait(visits: Visits) -> Iterator[Precedence]:
    """Yield precedences that keep an initial WAIT first: it takes place at the start pose."""
    first = visits.leaf_task(visits.task_units[0].entry) if visits.task_units else None
    if first is not None and first.action is Action.WAIT:
        words = Message("'{first}' is done before the robot sets off", first=first.name)
        yield from (Precedence((0, k), words) for k in range(1, len(visits.task_units)))


def _repeated_measurements(visits: Visits) -> Iterator[Precedence]:
    """Yield precedences that keep the order of several measurements of one checkpoint."""
    objects = dict.fromkeys(leaf.measures for leaf in visits.chain.flow.leaves if leaf.measures)
    for object_id in objects:
        measurements = visits.visits_measuring(object_id)
        if len(measurements) > 1:
            yield Precedence(
                tuple(measurements),
                Message(
                    "the measurements of checkpoint {object_id} keep their order",
                    object_id=object_id,
                ),
            )


def _decisions(visits: Visits) -> Iterator[Precedence]:
    """Yield precedences that keep measurements before or after the conditions that compare them."""
    flow = visits.chain.flow
    for number, unit in enumerate(visits.task_units):
        own = flow.leaves[unit.entry].measures
        compared = dict.fromkeys(
            condition.object_id
            for leaf in unit.leaves
            for condition in visits.chain.conditions_checked_after[leaf]
        )
        for object_id in compared:
            if object_id == own:
                continue
            measurements = visits.visits_measuring(object_id)
            earlier = [k for k in measurements if k < number]
            for k in earlier:
                words = Message(
                    "checkpoint {object_id} is measured before {name} decides",
                    object_id=object_id,
                    name=visits.names[number],
                )
                yield Precedence(
                    (k, number), Message("{words} on it", words=words), needed=k == earlier[-1]
                )
            for k in measurements:
                if k > number:
                    words = Message(
                        "{name} decides on checkpoint {object_id} before",
                        name=visits.names[number],
                        object_id=object_id,
                    )
                    yield Precedence(
                        (number, k), Message("{words} it is measured again", words=words)
                    )


def _early_ends(visits: Visits) -> Iterator[Precedence]:
    """Yield precedences around each task that may end the mission before its usual end.

    What is written before the task stays before it, and what is written after it stays after it.
    """
    leaves = {leaf for leaf, _ in visits.chain.early_exits}
    exits = sorted({visits.visit_of_leaf[leaf] for leaf in leaves if leaf in visits.visit_of_leaf})
    for exit_, low, high in zip(
        exits, [-1, *exits], [*exits[1:], len(visits.task_units)], strict=False
    ):
        name = visits.names[exit_]
        before = Message(
            "{name} may end the mission: what is written before it stays before it", name=name
        )
        after = Message(
            "{name} may end the mission: what is written after it stays after it", name=name
        )
        yield from (Precedence((k, exit_), before) for k in range(low + 1, exit_))
        until = high + 1 if high < len(visits.task_units) else high
        yield from (Precedence((exit_, k), after) for k in range(exit_ + 1, until))


def _last_units(visits: Visits) -> Iterator[Precedence]:
    """Yield precedences that keep units from coming last in the mission or in a group's round.

    These are the units that are left by several transitions: a round can only end with one task,
    and so can a mission that does not dock.
    """
    if visits.chain.end is None:
        yield from _before_last(visits, visits.chain.units, Message("the mission"))
    for group_unit, _ in visits.group_units:
        name = visits.chain.flow.groups[group_unit.group].name
        yield from _before_last(
            visits, group_unit.inside, Message("a round of '{name}'", name=name)
        )


def _before_last(visits: Visits, units: tuple[Unit, ...], whole: str) -> Iterator[Precedence]:
    """Yield precedences that put units which are left by several transitions before the last unit.

    `whole` names what the units are part of, for the message.
    """
    for unit in units[:-1]:
        if isinstance(unit, TaskUnit) and _has_several_exits(unit):
            here, last = visits.visit_of_leaf[unit.entry], visits.visits_in((units[-1],))[-1]
            words = Message(
                "{whole} can't end with {name}, which can lead to different tasks",
                whole=whole,
                name=visits.names[here],
            )
            yield Precedence((here, last), words)


def _has_several_exits(unit: Unit) -> bool:
    return isinstance(unit, TaskUnit) and unit.final is None
