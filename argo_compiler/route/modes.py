"""Rounds as single steps: in which ways a round can be made, and what each takes from anywhere.

A round is left where it was entered to leave, and nothing comes between its members. So for the
rest of the route it is one step with some modes: an order of its members, the time and energy that
all of its rounds take from each place that it may be entered from, and where it ends.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.problem import NEVER, Round, RouteProblem

Vector = NDArray[np.int64]

MOST_MEMBERS = 9
"""of a round, those inside others counted as one, up to which all orders are weighed"""
MOST_TIMED = 6
"""the same where a round inside lasts for a time"""


@dataclass(frozen=True, eq=False)
class StepMode:
    """One way to make a visit or a round, where it ends in one way."""

    first: int
    """the visit that it begins with"""
    exit: tuple[int, ...]
    """the visits where the robot may then be; it is reckoned with the worst"""
    order: tuple[int, ...]
    service: int = 0
    """of a single visit"""
    entries: Vector | None = None
    """of a round: the times of drives to `first`, sorted; None: a single visit"""
    time: Vector | None = None
    """after a drive of each of these times, until the end, the drive included; NEVER: it does not
    end in this way then"""
    energy: Vector | None = None
    """likewise, the drive's own not included"""

    def enter(self, drive: Vector, energy: Vector) -> tuple[Vector, Vector]:
        """Time and energy until the end after drives to `first` that take so much."""
        if self.entries is None or self.time is None or self.energy is None:
            return plus(drive, self.service), energy
        place = np.minimum(np.searchsorted(self.entries, drive), len(self.entries) - 1)
        known = self.entries[place] == drive
        time = np.where(known, self.time[place], NEVER)
        return time, plus(energy, self.energy[place])


@dataclass
class Step:
    """A visit, or a round with what lies directly in it. A node of the tree of rounds."""

    visits: frozenset[int]
    round: Round | None = None
    parts: list["Step"] = field(default_factory=list)


def steps(problem: RouteProblem) -> list[Step]:
    """The visits and outermost rounds, in the order of their first visits."""
    top = [Step(frozenset([visit])) for visit in range(problem.size)]
    # From the innermost round outwards; of equal ones the last is inside.
    numbers = sorted(range(len(problem.rounds)), key=lambda k: (len(problem.rounds[k].members), -k))
    for number in numbers:
        one = problem.rounds[number]
        inside = [step for step in top if step.visits <= set(one.members)]
        around = Step(frozenset(one.members), one, inside)
        top = [step for step in top if not step.visits <= around.visits] + [around]
    return sorted(top, key=lambda step: min(step.visits))


def modes(
    problem: RouteProblem, step: Step, order_of: Callable[[Step], tuple[Step, ...]]
) -> tuple[list[StepMode], bool]:
    """The ways to make a step that may be the best, and whether they are all of those.

    A round of more than MOST_MEMBERS parts, or of more than MOST_TIMED with a duration among them,
    is made in the cyclic order that `order_of` gives.
    """
    if step.round is None:
        (visit,) = step.visits
        return [StepMode(visit, (visit,), (visit,), problem.visits[visit].service)], True
    ways, exact = _ways(problem, step, order_of)
    return [mode for way in ways for mode in _modes(problem, way)], exact


def plus(times: Vector, more: int | Vector) -> Vector:
    """A sum of times that is NEVER where a part is."""
    total: Vector = np.minimum(times + more, NEVER)
    return total


class StepPlan(Protocol):
    """How a visit or a round is made, its order decided."""

    @property
    def first(self) -> int:
        """The visit that it begins with."""
        ...

    @property
    def order(self) -> tuple[int, ...]:
        """Its visits in the first round."""
        ...

    def run(self, drive: int, energy: int) -> "StepOutcome":
        """What it takes after a drive to `first` of that time and energy."""
        ...


@dataclass(frozen=True)
class StepOutcome:
    """What a way takes, the drive to it included, and where the robot may then be."""

    time: int
    energy: int
    exit: tuple[int, ...]


@dataclass(frozen=True)
class _Single:
    first: int
    service: int

    @property
    def order(self) -> tuple[int, ...]:
        return (self.first,)

    def run(self, drive: int, energy: int) -> StepOutcome:
        return StepOutcome(min(drive + self.service, NEVER), energy, (self.first,))


@dataclass(frozen=True, eq=False)
class _Rounds:
    """A round with its parts in an order."""

    problem: RouteProblem
    round: Round
    parts: tuple[StepPlan, ...]

    @property
    def first(self) -> int:
        return self.parts[0].first

    @property
    def order(self) -> tuple[int, ...]:
        return tuple(visit for part in self.parts for visit in part.order)

    def once(self, drive: int, energy: int) -> StepOutcome:
        """A single round."""
        done = self.parts[0].run(drive, energy)
        for part in self.parts[1:]:
            done = _onward(self.problem, done, part)
        return done

    def again(self) -> int:
        """The time of a round that follows another."""
        begun = StepOutcome(0, 0, (self.first,))
        once = _onward(self.problem, begun, self.parts[0])
        for part in self.parts[1:]:
            once = _onward(self.problem, once, part)
        return self._next(StepOutcome(0, 0, once.exit)).time

    def _next(self, done: StepOutcome) -> StepOutcome:
        for part in self.parts:
            done = _onward(self.problem, done, part)
        return done

    def run(self, drive: int, energy: int) -> StepOutcome:
        asked = self.round
        done, count = self.once(drive, energy), 1
        while done.time < NEVER and (not asked.repeat or count < asked.repeat):
            if asked.duration and done.time >= asked.duration:
                break
            following = self._next(done)
            count += 1
            same = following.exit == done.exit
            step, used = following.time - done.time, following.energy - done.energy
            done = following
            if asked.duration and step == 0:
                break  # rounds that take no time would never fill it
            if same:  # all that follow are like this one
                more = asked.repeat - count if asked.repeat else NEVER
                if asked.duration:
                    more = min(more, -(-max(0, asked.duration - done.time) // step))
                done = StepOutcome(
                    min(done.time + more * step, NEVER),
                    min(done.energy + more * used, NEVER),
                    done.exit,
                )
                break
        if asked.duration and not asked.soft and asked.duration < done.time < NEVER:
            return StepOutcome(asked.duration, done.energy, tuple(sorted(self.order)))
        return done


def _onward(problem: RouteProblem, done: StepOutcome, way: StepPlan) -> StepOutcome:
    """A way after what was done, from the worst of the places where the robot may be."""
    places = list(done.exit)
    drive = int(problem.travel[places, way.first].max())
    energy = 0
    if problem.battery is not None:
        energy = int(problem.battery.energy[places, way.first].max())
    after = way.run(drive, energy)
    time = NEVER if drive >= NEVER else min(done.time + after.time, NEVER)
    return StepOutcome(time, min(done.energy + after.energy, NEVER), after.exit)


def _ways(
    problem: RouteProblem, step: Step, order_of: Callable[[Step], tuple[Step, ...]]
) -> tuple[list[StepPlan], bool]:
    """The ways to make a step among which the best is, and whether that is so."""
    if step.round is None:
        (visit,) = step.visits
        return [_Single(visit, problem.visits[visit].service)], True
    exact, choices = True, []
    for part in step.parts:
        some, all_of_them = _ways(problem, part, order_of)
        choices.append(some)
        exact &= all_of_them
    waits = _waits(problem, step.parts)
    timed = any(_timed(part) for part in step.parts)
    if len(step.parts) <= (MOST_TIMED if timed else MOST_MEMBERS):
        orders = _all_orders(choices, waits) if timed else _best_orders(problem, choices, waits)
    else:
        exact = False
        orders = _rotations(choices, waits, [step.parts.index(part) for part in order_of(step)])
    found = [_Rounds(problem, step.round, order) for order in orders]
    if step.round.duration:
        times = [way.again() for way in found]
        found = [w for w, time in zip(found, times, strict=True) if time == min(times)]
    return list(found), exact


def _timed(step: Step) -> bool:
    """Whether there is a duration in it: then to be there sooner may take longer in the end."""
    inside = any(_timed(part) for part in step.parts)
    return inside or (step.round is not None and step.round.duration > 0)


def _waits(problem: RouteProblem, parts: list[Step]) -> list[int]:
    """For each part, as bits, the parts that must come before it."""
    waits = [0] * len(parts)
    home = {visit: k for k, part in enumerate(parts) for visit in part.visits}
    for precedence in problem.precedences:
        there = [home[visit] for visit in precedence.sequence if visit in home]
        for later, part in enumerate(there):
            for earlier in there[:later]:
                if earlier != part:
                    waits[part] |= 1 << earlier
    return waits


def _free(choices: list[list[StepPlan]], waits: list[int], done: int) -> list[tuple[int, StepPlan]]:
    return [
        (part, way)
        for part, some in enumerate(choices)
        if not done >> part & 1 and waits[part] & ~done == 0
        for way in some
    ]


def _all_orders(choices: list[list[StepPlan]], waits: list[int]) -> list[tuple[StepPlan, ...]]:
    orders: list[tuple[int, tuple[StepPlan, ...]]] = [(0, ())]
    for _ in choices:
        orders = [
            (done | 1 << part, (*order, way))
            for done, order in orders
            for part, way in _free(choices, waits, done)
        ]
    return [order for _, order in orders]


@dataclass(frozen=True)
class _Label:
    done: StepOutcome
    order: tuple[StepPlan, ...]


def _best_orders(
    problem: RouteProblem, choices: list[list[StepPlan]], waits: list[int]
) -> list[tuple[StepPlan, ...]]:
    """Dynamic programming over the parts done, from each first way to each last one, with the
    labels of time and energy of which neither is the smaller."""
    found: list[tuple[StepPlan, ...]] = []
    for k, first in _free(choices, waits, 0):
        layer = {(1 << k, id(first)): [_Label(first.run(0, 0), (first,))]}
        for _ in range(len(choices) - 1):
            following: dict[tuple[int, int], list[_Label]] = {}
            for (done, _), labels in layer.items():
                for part, way in _free(choices, waits, done):
                    some = following.setdefault((done | 1 << part, id(way)), [])
                    for label in labels:
                        after = _onward(problem, label.done, way)
                        _add(some, _Label(after, (*label.order, way)))
            layer = following
        found += [label.order for labels in layer.values() for label in labels]
    return found


def _add(labels: list[_Label], new: _Label) -> None:
    time, energy = new.done.time, new.done.energy
    if time >= NEVER or any(one.done.time <= time and one.done.energy <= energy for one in labels):
        return
    labels[:] = [one for one in labels if one.done.time < time or one.done.energy < energy]
    labels.append(new)


def _rotations(
    choices: list[list[StepPlan]], waits: list[int], cycle: list[int]
) -> list[tuple[StepPlan, ...]]:
    """A cyclic order of the parts, entered at each part that may be the first."""
    found = []
    for k in range(len(cycle)):
        order, done = cycle[k:] + cycle[:k], 0
        for part in order:
            if waits[part] & ~done:
                break
            done |= 1 << part
        else:
            found.append(tuple(choices[part][0] for part in order))
    return found


def _modes(problem: RouteProblem, way: StepPlan) -> list[StepMode]:
    """A way as modes: one for each of the ends that it has after the drives that there are."""
    entries = np.unique(problem.travel[:, way.first])
    entries = entries[entries < NEVER]
    outcomes = [way.run(int(drive), 0) for drive in entries]
    ends = sorted({outcome.exit for outcome in outcomes if outcome.time < NEVER})
    found = []
    for end in ends:
        here = np.array([outcome.exit == end for outcome in outcomes])
        time = np.array([outcome.time for outcome in outcomes], np.int64)
        energy = np.array([outcome.energy for outcome in outcomes], np.int64)
        time = np.where(here, time, NEVER)
        found.append(StepMode(way.first, end, way.order, 0, entries, time, energy))
    return found
