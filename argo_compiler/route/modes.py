"""Rounds as single steps with modes: orders of their members, with times, energies and exits.

No other visit comes between the members of a round. So for the rest of the route a round is one
step with some modes. A mode is an order of the members, with the time and energy of all repetitions
after each possible drive to the first member, and the possible locations of the robot at the end.

An order that ends earlier, with less energy and at fewer possible locations, is never worse for
the rest of the route, with one exception: inside a round with a duration. There an earlier end may
lead to one more repetition. So inside such rounds an order is dropped only for one that takes the
same time.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.problem import NEVER, Round, RouteProblem

Vector = NDArray[np.int64]

MOST_MEMBERS = 9
"""highest number of a round's parts (members and inner rounds) for which its best orders are
computed"""
MOST_ORDERS = 5040
"""highest number of orders of a round with a duration in it or around it, which are all compared:
those of seven members"""
_FEW = 3
"""number of orders that are compared even if the time is up"""


@dataclass(frozen=True, eq=False)
class StepMode:
    """Mode of a step: one order of its visits, with one set of locations at the end."""

    first: int
    """first visit of the order"""
    exit: tuple[int, ...]
    """visits where the robot may be at the end; the worst one counts for the next drive"""
    order: tuple[int, ...]
    service: int = 0
    """service time of a single visit; 0 for a round"""
    entries: Vector | None = None
    """possible times of the drive to the first visit of a round, sorted; None: a single visit"""
    time: Vector | None = None
    """time of the round after each of these drives, with the drive; NEVER: the round has another
    exit after that drive"""
    energy: Vector | None = None
    """energy of the round after each of these drives, without the drive"""

    def add_to_drives(self, times: Vector, energies: Vector) -> tuple[Vector, Vector]:
        """Return the times and energies of drives to the step, with those of the step added.

        `times` and `energies` are those of several drives to the first visit. A resulting time is
        NEVER if its drive's time is none of a round's `entries`, or if after that drive the round
        ends at other visits than `exit`.
        """
        if self.entries is None or self.time is None or self.energy is None:
            return add_capped_at_never(times, self.service), energies
        index = np.minimum(np.searchsorted(self.entries, times), len(self.entries) - 1)
        known = self.entries[index] == times
        time = np.where(known, self.time[index], NEVER)
        return time, add_capped_at_never(energies, self.energy[index])


@dataclass
class Step:
    """Visit, or round with its direct parts: a node of the tree of rounds."""

    visits: frozenset[int]
    round: Round | None = None
    parts: list["Step"] = field(default_factory=list)


def outermost_steps(problem: RouteProblem) -> list[Step]:
    """Return the visits and outermost rounds, sorted by their lowest visits."""
    top = [Step(frozenset([visit])) for visit in range(problem.size)]
    # From the innermost round outwards; of equal ones the last is the inner one.
    numbers = sorted(range(len(problem.rounds)), key=lambda k: (len(problem.rounds[k].members), -k))
    for number in numbers:
        round_ = problem.rounds[number]
        inner = [step for step in top if step.visits <= set(round_.members)]
        outer = Step(frozenset(round_.members), round_, inner)
        top = [step for step in top if not step.visits <= outer.visits] + [outer]
    return sorted(top, key=lambda step: min(step.visits))


def candidate_modes(
    problem: RouteProblem,
    step: Step,
    cyclic_order: Callable[[Step], tuple[Step, ...]],
    is_time_up: Callable[[], bool] = lambda: False,
) -> tuple[list[StepMode], bool]:
    """Return the modes of a step that may be optimal, and whether they are complete.

    A round of more than MOST_MEMBERS parts, or with a duration and of more than MOST_ORDERS orders,
    is made in the cyclic order that `cyclic_order` returns. If the time is up, only some modes are
    returned.
    """
    if step.round is None:
        (visit,) = step.visits
        return [StepMode(visit, (visit,), (visit,), problem.visits[visit].service)], True
    drives = _Drives(problem)
    orders, exact = _candidate_orders(
        problem, step, cyclic_order, drives, is_time_up, within_timed=False
    )
    return [
        m for order in orders if isinstance(order, _RoundOrder) for m in _modes(order, drives)
    ], exact


def add_capped_at_never(times: Vector, more: int | Vector) -> Vector:
    """Return the sum of times, at most NEVER."""
    total: Vector = np.minimum(times + more, NEVER)
    return total


class StepOrder(Protocol):
    """Visit, or round with a decided order of its members."""

    @property
    def first(self) -> int:
        """First visit of the order."""
        ...

    @property
    def order(self) -> tuple[int, ...]:
        """Visits in the order of their first repetition."""
        ...

    def outcome_after_drive(self, drive_time_units: int) -> "StepOutcome":
        """Return the outcome of all repetitions after a drive to `first` of this time (units).

        The time includes the drive; the energy does not.
        """
        ...


@dataclass(frozen=True)
class StepOutcome:
    """Time of a step with the drive to it, its energy, and the robot's possible locations."""

    time: int
    energy: int
    exit: tuple[int, ...]


@dataclass(frozen=True)
class _SingleVisit:
    first: int
    service: int

    @property
    def order(self) -> tuple[int, ...]:
        return (self.first,)

    def outcome_after_drive(self, drive_time_units: int) -> StepOutcome:
        return StepOutcome(min(drive_time_units + self.service, NEVER), 0, (self.first,))


class _RoundOrder:
    """Round with its parts in a given order, which caches the outcomes of repetitions."""

    def __init__(self, drives: "_Drives", round_: Round, parts: tuple[StepOrder, ...]) -> None:
        self._drives, self._round, self._parts = drives, round_, parts
        self.first = parts[0].first
        self.order = tuple(visit for part in parts for visit in part.order)
        self._next_by_exit: dict[tuple[int, ...], StepOutcome] = {}
        # If the time of the first part does not depend on the drive to it, neither does that of a
        # repetition: this is its outcome without the drive.
        self._without_drive = (
            parts[0].outcome_after_drive(0) if isinstance(parts[0], _SingleVisit) else None
        )
        if self._without_drive is not None:
            self._without_drive = self._add_other_parts(self._without_drive)

    def first_repetition(self, drive: int) -> StepOutcome:
        """Return the outcome of the first repetition after a drive of a given time.

        The time includes the drive; the energy does not.
        """
        if self._without_drive is None:
            return self._add_other_parts(self._parts[0].outcome_after_drive(drive))
        outcome = self._without_drive
        return StepOutcome(min(drive + outcome.time, NEVER), outcome.energy, outcome.exit)

    def _add_other_parts(self, outcome: StepOutcome) -> StepOutcome:
        for part in self._parts[1:]:
            outcome = self._drives.after(outcome, part)
        return outcome

    def _next_repetition(self, exit: tuple[int, ...]) -> StepOutcome:
        """Return the outcome of a further repetition, from the locations after the last one."""
        if exit not in self._next_by_exit:
            first_part = self._drives.after(StepOutcome(0, 0, exit), self._parts[0])
            self._next_by_exit[exit] = self._add_other_parts(first_part)
        return self._next_by_exit[exit]

    def outcomes_after_drives(
        self, drives: Vector
    ) -> tuple[Vector, Vector, list[tuple[int, ...]], Vector]:
        """Return times and energies of all repetitions after drives of given times, and the exits.

        With the exits, which are sets of possible locations, comes the index of the exit after each
        drive. The times include the drives; the energies do not.
        """
        round_, once = self._round, self._without_drive
        more = None if once is None else self._next_repetition(once.exit)
        if once is None or more is None or more.exit != once.exit or more.time == 0:
            outcomes = [self.outcome_after_drive(drive) for drive in drives.tolist()]
            exits = sorted({outcome.exit for outcome in outcomes})
            rows = [(end.time, end.energy, exits.index(end.exit)) for end in outcomes]
            time, energy, exit_index = np.array(rows, np.int64).reshape(-1, 3).T
            return time, energy, exits, exit_index
        time = add_capped_at_never(drives, once.time)
        repetitions = np.full(len(time), round_.repeat - 1 if round_.repeat else NEVER)
        if round_.duration:
            until_duration = -((time - round_.duration) // more.time)
            repetitions = np.minimum(repetitions, np.maximum(until_duration, 0))
        time, energy = (
            add_capped_at_never(time, repetitions * more.time),
            np.minimum(once.energy + repetitions * more.energy, NEVER),
        )
        interrupted = (
            (time > round_.duration) & (time < NEVER) & (round_.duration > 0) & (not round_.soft)
        )
        time[interrupted] = round_.duration
        return time, energy, [once.exit, tuple(sorted(self.order))], interrupted.astype(np.int64)

    def outcome_after_drive(self, drive_time_units: int) -> StepOutcome:
        round_ = self._round
        outcome, count = self.first_repetition(drive_time_units), 1
        while outcome.time < NEVER and (not round_.repeat or count < round_.repeat):
            if round_.duration and outcome.time >= round_.duration:
                break
            more, repetitions = self._next_repetition(outcome.exit), 1
            if round_.duration and more.time == 0:
                # Repetitions that take no time would never fill the duration.
                return _sum(outcome, more, 1)
            if more.exit == outcome.exit:  # all further repetitions are equal
                repetitions = round_.repeat - count if round_.repeat else NEVER
                if round_.duration:
                    repetitions = min(
                        repetitions, -(-(round_.duration - outcome.time) // more.time)
                    )
            outcome = _sum(outcome, more, repetitions)
            count += repetitions
        if round_.duration and not round_.soft and round_.duration < outcome.time < NEVER:
            return StepOutcome(round_.duration, outcome.energy, tuple(sorted(self.order)))
        return outcome


def _sum(outcome: StepOutcome, more: StepOutcome, times: int) -> StepOutcome:
    time = min(outcome.time + times * more.time, NEVER)
    return StepOutcome(time, min(outcome.energy + times * more.energy, NEVER), more.exit)


class _Drives:
    """Drives between locations, which caches the worst ones and the entries of steps."""

    def __init__(self, problem: RouteProblem) -> None:
        self._travel, self._battery = problem.travel, problem.battery
        self._entries: dict[int, Vector] = {}
        self._worst: dict[tuple[tuple[int, ...], int], tuple[int, int]] = {}

    def entries(self, first: int) -> Vector:
        """Return the different times of all drives to a visit, sorted.

        A step that begins with the visit is entered after one of these drives.
        """
        if first not in self._entries:
            drives = np.unique(self._travel[:, first])
            self._entries[first] = drives[drives < NEVER]
        return self._entries[first]

    def after(self, outcome: StepOutcome, part: StepOrder) -> StepOutcome:
        """Return the outcome after a further part, with the drive to it.

        Its time and its energy are each the highest from any exit of `outcome`.
        """
        if (outcome.exit, part.first) not in self._worst:
            origins = list(outcome.exit)
            drive, energy = int(self._travel[origins, part.first].max()), 0
            if self._battery is not None:
                energy = int(self._battery.energy[origins, part.first].max())
            self._worst[outcome.exit, part.first] = drive, energy
        drive, energy = self._worst[outcome.exit, part.first]
        added = part.outcome_after_drive(drive)
        time = NEVER if drive >= NEVER else min(outcome.time + added.time, NEVER)
        return StepOutcome(time, min(outcome.energy + energy + added.energy, NEVER), added.exit)


def _candidate_orders(
    problem: RouteProblem,
    step: Step,
    cyclic_order: Callable[[Step], tuple[Step, ...]],
    drives: _Drives,
    is_time_up: Callable[[], bool],
    *,
    within_timed: bool,
) -> tuple[list[StepOrder], bool]:
    """Return orders of a step, and whether an optimal one is certainly among them.

    `within_timed`: a round around the step has a duration.
    """
    if step.round is None:
        (visit,) = step.visits
        return [_SingleVisit(visit, problem.visits[visit].service)], True
    is_timed = within_timed or step.round.duration > 0
    exact, choices = True, []
    for part in step.parts:
        part_orders, part_exact = _candidate_orders(
            problem, part, cyclic_order, drives, is_time_up, within_timed=is_timed
        )
        choices.append(part_orders)
        exact &= part_exact
    predecessors = _predecessors(problem, step.parts)
    orders: list[tuple[StepOrder, ...]] | None = None
    if is_timed or _has_duration(step):
        orders = _all_orders(choices, predecessors)
    elif len(step.parts) <= MOST_MEMBERS:
        orders = _best_orders(drives, choices, predecessors, is_time_up)
        if orders is not None:
            return [_RoundOrder(drives, step.round, order) for order in orders], exact
    if orders is None or is_time_up():
        exact = False
        cycle = step.parts if is_time_up() else cyclic_order(step)
        orders = _rotations(choices, predecessors, [step.parts.index(part) for part in cycle])
    candidates = [_RoundOrder(drives, step.round, order) for order in orders]
    best = _undominated(candidates, drives, is_time_up, by_time=not within_timed)
    return best, exact and not is_time_up()


def _undominated(
    candidates: list[_RoundOrder],
    drives: _Drives,
    is_time_up: Callable[[], bool],
    *,
    by_time: bool,
) -> list[StepOrder]:
    """Return the orders that no other order dominates after every drive.

    An order dominates another with the same first visit if it needs no more energy, its exits are
    among those of the other, and it takes no more time (`by_time`), or else the same time. Returns
    only some orders if the time is up.
    """
    numbers: dict[tuple[int, ...], int] = {}
    by_first_visit: dict[int, list[tuple[_RoundOrder, Vector]]] = {}
    for k, order in enumerate(candidates):
        if k >= _FEW and is_time_up():
            break
        if not len(drives.entries(order.first)):
            continue  # the first visit can't be reached
        time, energy, exits, exit_index = order.outcomes_after_drives(drives.entries(order.first))
        number = np.array([numbers.setdefault(exit, len(numbers)) for exit in exits], np.int64)
        row = np.stack([time, energy, number[exit_index]])
        by_first_visit.setdefault(order.first, []).append((order, row))
    is_subset = np.array([[set(one) <= set(other) for other in numbers] for one in numbers])
    return [
        order
        for group in by_first_visit.values()
        for order in _undominated_in_group(group, is_subset, is_time_up, by_time)
    ]


def _undominated_in_group(
    group: list[tuple[_RoundOrder, Vector]],
    is_subset: NDArray[np.bool_],
    is_time_up: Callable[[], bool],
    by_time: bool,
) -> list[StepOrder]:
    """Return the undominated orders of a group, whose orders have the same first visit.

    Each order has an array of times, energies and numbers of exits, shape (3, entries).
    `is_subset`: whether the locations of exit `row` are among those of exit `column`. `by_time`: as
    in `_undominated`.
    """
    undominated: list[StepOrder] = []
    table = np.empty((len(group), *group[0][1].shape), np.int64)
    for order, row in sorted(group, key=lambda item: tuple(item[1][:2].sum(axis=1))):
        if undominated and is_time_up():
            break
        others, time = table[: len(undominated)], row[0]
        not_later = others[:, 0] <= time if by_time else others[:, 0] == time
        as_good = not_later & (others[:, 1] <= row[1]) & is_subset[others[:, 2], row[2]]
        if (time < NEVER).any() and not (as_good | (time >= NEVER)).all(axis=1).any():
            table[len(undominated)] = row
            undominated.append(order)
    return undominated


def _has_duration(step: Step) -> bool:
    """Return True if a round of the step has a duration: then an earlier start may end later."""
    inside = any(_has_duration(part) for part in step.parts)
    return inside or (step.round is not None and step.round.duration > 0)


def _predecessors(problem: RouteProblem, parts: list[Step]) -> list[int]:
    """Return, for each part, the set of parts that must come before it, as bits."""
    predecessors = [0] * len(parts)
    part_of_visit = {visit: k for k, part in enumerate(parts) for visit in part.visits}
    for precedence in problem.precedences:
        sequence = [part_of_visit[visit] for visit in precedence.sequence if visit in part_of_visit]
        for later, part in enumerate(sequence):
            for earlier in sequence[:later]:
                if earlier != part:
                    predecessors[part] |= 1 << earlier
    return predecessors


def _available(
    choices: list[list[StepOrder]], predecessors: list[int], made: int
) -> list[tuple[int, StepOrder]]:
    return [
        (part, choice)
        for part, part_choices in enumerate(choices)
        if not made >> part & 1 and predecessors[part] & ~made == 0
        for choice in part_choices
    ]


def _all_orders(
    choices: list[list[StepOrder]], predecessors: list[int]
) -> list[tuple[StepOrder, ...]] | None:
    """Return all orders of the parts, or None if there are more than MOST_ORDERS."""
    orders: list[tuple[int, tuple[StepOrder, ...]]] = [(0, ())]
    for _ in choices:
        orders = [
            (made | 1 << part, (*order, choice))
            for made, order in orders
            for part, choice in _available(choices, predecessors, made)
        ]
        if len(orders) > MOST_ORDERS:
            return None
    return [order for _, order in orders]


@dataclass(frozen=True)
class _Label:
    outcome: StepOutcome
    order: tuple[StepOrder, ...]


def _best_orders(
    drives: _Drives,
    choices: list[list[StepOrder]],
    predecessors: list[int],
    is_time_up: Callable[[], bool],
) -> list[tuple[StepOrder, ...]] | None:
    """Compute the undominated orders for each first and last part; None if the time is up.

    This is dynamic programming. The states are the parts made and the last one, for each first
    part; the labels of a state do not dominate each other in time and energy.
    """
    orders: list[tuple[StepOrder, ...]] = []
    for k, first in _available(choices, predecessors, 0):
        layer = {(1 << k, id(first)): [_Label(first.outcome_after_drive(0), (first,))]}
        for _ in range(len(choices) - 1):
            if is_time_up():
                return None
            following: dict[tuple[int, int], list[_Label]] = {}
            for (made, _), labels in layer.items():
                for part, choice in _available(choices, predecessors, made):
                    next_labels = following.setdefault((made | 1 << part, id(choice)), [])
                    for label in labels:
                        outcome = drives.after(label.outcome, choice)
                        _add(next_labels, _Label(outcome, (*label.order, choice)))
            layer = following
        orders += [label.order for labels in layer.values() for label in labels]
    return orders


def _add(labels: list[_Label], new: _Label) -> None:
    time, energy = new.outcome.time, new.outcome.energy
    if time >= NEVER or any(
        other.outcome.time <= time and other.outcome.energy <= energy for other in labels
    ):
        return
    labels[:] = [
        other for other in labels if other.outcome.time < time or other.outcome.energy < energy
    ]
    labels.append(new)


def _rotations(
    choices: list[list[StepOrder]], predecessors: list[int], cycle: list[int]
) -> list[tuple[StepOrder, ...]]:
    """Return the rotations of a cyclic order of the parts that start with a possible first part.

    A part that a rotation has before its predecessors is moved to just after the last of these.
    """
    rotations = []
    for k in range(len(cycle)):
        rest, made, order = cycle[k:] + cycle[:k], 0, list[int]()
        while rest:
            part = next((p for p in rest if choices[p] and not predecessors[p] & ~made), None)
            if part is None or (not order and part != cycle[k]):
                break
            rest.remove(part)
            order.append(part)
            made |= 1 << part
        else:
            rotations.append(tuple(choices[part][0] for part in order))
    return rotations


def _modes(order: _RoundOrder, drives: _Drives) -> list[StepMode]:
    """Return the modes of an order: one for each exit that it has after the possible drives."""
    entries = drives.entries(order.first)
    time, energy, exits, exit_index = order.outcomes_after_drives(entries)
    modes_by_exit = []
    for number, exit in enumerate(exits):
        exit_time = np.where(exit_index == number, time, NEVER)
        if (exit_time < NEVER).any():
            modes_by_exit.append(
                StepMode(order.first, exit, order.order, 0, entries, exit_time, energy)
            )
    return modes_by_exit
