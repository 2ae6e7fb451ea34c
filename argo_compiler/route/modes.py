"""Rounds as single steps: in which ways a round can be made, and what each takes from anywhere.

A round is left where it was entered to leave, and nothing comes between its members. So for the
rest of the route it is one step with some modes: an order of its members, the time and energy that
all of its rounds take from each place that it may be entered from, and where it ends.

To be done sooner, with less energy, where the robot may then be in fewer places, is never worse for
what follows, with one exception: a round around it that lasts for a time. That makes one more pass
where a shorter one ends before the time is over. So ways are dropped for better ones only where no
such round is around them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.problem import NEVER, Round, RouteProblem

Vector = NDArray[np.int64]

MOST_MEMBERS = 9
"""of a round, those inside others counted as one, up to which its best orders are known"""
MOST_ORDERS = 5040
"""of a round with a duration in it or around it, which are all weighed: those of seven members"""
_FEW = 3
"""orders that are weighed also when the time is over"""


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
    problem: RouteProblem,
    step: Step,
    order_of: Callable[[Step], tuple[Step, ...]],
    over: Callable[[], bool] = lambda: False,
) -> tuple[list[StepMode], bool]:
    """The ways to make a step that may be the best, and whether they are all of those.

    A round of more than MOST_MEMBERS parts, or with a duration and of more than MOST_ORDERS orders,
    is made in the cyclic order that `order_of` gives. When the time is `over`, some ways do.
    """
    if step.round is None:
        (visit,) = step.visits
        return [StepMode(visit, (visit,), (visit,), problem.visits[visit].service)], True
    drives = _Drives(problem)
    ways, exact = _ways(problem, step, order_of, drives, over, within_timed=False)
    return [m for way in ways if isinstance(way, _Rounds) for m in _modes(way, drives)], exact


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

    def run(self, drive: int) -> "StepOutcome":
        """What it takes after a drive to `first` of that time; the drive's energy is not in it."""
        ...


@dataclass(frozen=True)
class StepOutcome:
    """What a way takes, the time of the drive to it included, and where the robot may then be."""

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

    def run(self, drive: int) -> StepOutcome:
        return StepOutcome(min(drive + self.service, NEVER), 0, (self.first,))


class _Rounds:
    """A round with its parts in an order. Keeps what it has reckoned once."""

    def __init__(self, drives: "_Drives", asked: Round, parts: tuple[StepPlan, ...]) -> None:
        self._drives, self._round, self._parts = drives, asked, parts
        self.first = parts[0].first
        self.order = tuple(visit for part in parts for visit in part.order)
        self._after: dict[tuple[int, ...], StepOutcome] = {}
        # Where the first part takes its time whatever the drive, so does a whole pass.
        self._steady = parts[0].run(0) if isinstance(parts[0], _Single) else None
        if self._steady is not None:
            self._steady = self._on(self._steady)

    def once(self, drive: int) -> StepOutcome:
        """A single pass after a drive to `first` of that time."""
        if self._steady is None:
            return self._on(self._parts[0].run(drive))
        done = self._steady
        return StepOutcome(min(drive + done.time, NEVER), done.energy, done.exit)

    def _on(self, done: StepOutcome) -> StepOutcome:
        for part in self._parts[1:]:
            done = self._drives.onward(done, part)
        return done

    def _again(self, exit: tuple[int, ...]) -> StepOutcome:
        """A further pass, from the places where the last one ended."""
        if exit not in self._after:
            begun = self._drives.onward(StepOutcome(0, 0, exit), self._parts[0])
            self._after[exit] = self._on(begun)
        return self._after[exit]

    def runs(self, drives: Vector) -> tuple[Vector, Vector, list[tuple[int, ...]], Vector]:
        """Times and energies after some drives, the ends that there are, and which each has."""
        asked, once = self._round, self._steady
        more = None if once is None else self._again(once.exit)
        if once is None or more is None or more.exit != once.exit or more.time == 0:
            ends = [self.run(drive) for drive in drives.tolist()]
            exits = sorted({end.exit for end in ends})
            rows = [(end.time, end.energy, exits.index(end.exit)) for end in ends]
            time, energy, which = np.array(rows, np.int64).reshape(-1, 3).T
            return time, energy, exits, which
        time = plus(drives, once.time)
        passes = np.full(len(time), asked.repeat - 1 if asked.repeat else NEVER)
        if asked.duration:
            wanted = -((time - asked.duration) // more.time)
            passes = np.minimum(passes, np.maximum(wanted, 0))
        time, energy = (
            plus(time, passes * more.time),
            np.minimum(once.energy + passes * more.energy, NEVER),
        )
        left = (time > asked.duration) & (time < NEVER) & (asked.duration > 0) & (not asked.soft)
        time[left] = asked.duration
        return time, energy, [once.exit, tuple(sorted(self.order))], left.astype(np.int64)

    def run(self, drive: int) -> StepOutcome:
        asked = self._round
        done, count = self.once(drive), 1
        while done.time < NEVER and (not asked.repeat or count < asked.repeat):
            if asked.duration and done.time >= asked.duration:
                break
            more, passes = self._again(done.exit), 1
            if asked.duration and more.time == 0:
                return _sum(done, more, 1)  # passes that take no time would never fill it
            if more.exit == done.exit:  # all that follow are like this one
                passes = asked.repeat - count if asked.repeat else NEVER
                if asked.duration:
                    passes = min(passes, -(-(asked.duration - done.time) // more.time))
            done = _sum(done, more, passes)
            count += passes
        if asked.duration and not asked.soft and asked.duration < done.time < NEVER:
            return StepOutcome(asked.duration, done.energy, tuple(sorted(self.order)))
        return done


def _sum(done: StepOutcome, more: StepOutcome, times: int) -> StepOutcome:
    time = min(done.time + times * more.time, NEVER)
    return StepOutcome(time, min(done.energy + times * more.energy, NEVER), more.exit)


class _Drives:
    """The drives between places. Keeps what it has looked up once."""

    def __init__(self, problem: RouteProblem) -> None:
        self._travel, self._battery = problem.travel, problem.battery
        self._entries: dict[int, Vector] = {}
        self._worst: dict[tuple[tuple[int, ...], int], tuple[int, int]] = {}

    def entries(self, first: int) -> Vector:
        """The times of all drives to a visit, sorted: a step is entered after one of them."""
        if first not in self._entries:
            drives = np.unique(self._travel[:, first])
            self._entries[first] = drives[drives < NEVER]
        return self._entries[first]

    def onward(self, done: StepOutcome, way: StepPlan) -> StepOutcome:
        """A way after what was done, from the worst of the places where the robot may be."""
        if (done.exit, way.first) not in self._worst:
            places = list(done.exit)
            drive, energy = int(self._travel[places, way.first].max()), 0
            if self._battery is not None:
                energy = int(self._battery.energy[places, way.first].max())
            self._worst[done.exit, way.first] = drive, energy
        drive, energy = self._worst[done.exit, way.first]
        after = way.run(drive)
        time = NEVER if drive >= NEVER else min(done.time + after.time, NEVER)
        return StepOutcome(time, min(done.energy + energy + after.energy, NEVER), after.exit)


def _ways(
    problem: RouteProblem,
    step: Step,
    order_of: Callable[[Step], tuple[Step, ...]],
    drives: _Drives,
    over: Callable[[], bool],
    *,
    within_timed: bool,
) -> tuple[list[StepPlan], bool]:
    """The ways to make a step among which the best is, and whether that is so. `within_timed`:
    whether a round around it lasts for a time."""
    if step.round is None:
        (visit,) = step.visits
        return [_Single(visit, problem.visits[visit].service)], True
    lasts = within_timed or step.round.duration > 0
    exact, choices = True, []
    for part in step.parts:
        some, all_of_them = _ways(problem, part, order_of, drives, over, within_timed=lasts)
        choices.append(some)
        exact &= all_of_them
    waits = _waits(problem, step.parts)
    orders: list[tuple[StepPlan, ...]] | None = None
    if lasts or _timed(step):
        orders = _all_orders(choices, waits)
    elif len(step.parts) <= MOST_MEMBERS:
        orders = _best_orders(drives, choices, waits, over)
        if orders is not None:
            return [_Rounds(drives, step.round, order) for order in orders], exact
    if orders is None or over():
        exact = False
        cycle = step.parts if over() else order_of(step)
        orders = _rotations(choices, waits, [step.parts.index(part) for part in cycle])
    ways = [_Rounds(drives, step.round, order) for order in orders]
    best = _undominated(ways, drives, over, by_time=not within_timed)
    return best, exact and not over()


def _undominated(
    ways: list[_Rounds], drives: _Drives, over: Callable[[], bool], *, by_time: bool
) -> list[StepPlan]:
    """The ways than which none is as good after every drive: in energy, and in time (`by_time`, or
    else in the same time), in places among which the robot then is. Some when the time is over."""
    numbers: dict[tuple[int, ...], int] = {}
    found: dict[int, list[tuple[_Rounds, Vector]]] = {}
    for k, way in enumerate(ways):
        if k >= _FEW and over():
            break
        if not len(drives.entries(way.first)):
            continue  # there is no way to it
        time, energy, exits, which = way.runs(drives.entries(way.first))
        number = np.array([numbers.setdefault(exit, len(numbers)) for exit in exits], np.int64)
        row = np.stack([time, energy, number[which]])
        found.setdefault(way.first, []).append((way, row))
    within = np.array([[set(one) <= set(other) for other in numbers] for one in numbers])
    return [way for some in found.values() for way in _best_of(some, within, over, by_time)]


def _best_of(
    ways: list[tuple[_Rounds, Vector]],
    within: NDArray[np.bool_],
    over: Callable[[], bool],
    by_time: bool,
) -> list[StepPlan]:
    """Those with the same first visit. Of each its times, energies and numbers of ends, shape
    (3, entries); `within`: whether the places of the end of row are among those of column."""
    kept: list[StepPlan] = []
    table = np.empty((len(ways), *ways[0][1].shape), np.int64)
    for way, row in sorted(ways, key=lambda one: tuple(one[1][:2].sum(axis=1))):
        if kept and over():
            break
        others, time = table[: len(kept)], row[0]
        soon = others[:, 0] <= time if by_time else others[:, 0] == time
        as_good = soon & (others[:, 1] <= row[1]) & within[others[:, 2], row[2]]
        if (time < NEVER).any() and not (as_good | (time >= NEVER)).all(axis=1).any():
            table[len(kept)] = row
            kept.append(way)
    return kept


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


def _all_orders(
    choices: list[list[StepPlan]], waits: list[int]
) -> list[tuple[StepPlan, ...]] | None:
    """None: there are more than MOST_ORDERS."""
    orders: list[tuple[int, tuple[StepPlan, ...]]] = [(0, ())]
    for _ in choices:
        orders = [
            (done | 1 << part, (*order, way))
            for done, order in orders
            for part, way in _free(choices, waits, done)
        ]
        if len(orders) > MOST_ORDERS:
            return None
    return [order for _, order in orders]


@dataclass(frozen=True)
class _Label:
    done: StepOutcome
    order: tuple[StepPlan, ...]


def _best_orders(
    drives: _Drives, choices: list[list[StepPlan]], waits: list[int], over: Callable[[], bool]
) -> list[tuple[StepPlan, ...]] | None:
    """Dynamic programming over the parts done, from each first way to each last one, with the
    labels of time and energy of which neither is the smaller. None: the time is over."""
    found: list[tuple[StepPlan, ...]] = []
    for k, first in _free(choices, waits, 0):
        layer = {(1 << k, id(first)): [_Label(first.run(0), (first,))]}
        for _ in range(len(choices) - 1):
            if over():
                return None
            following: dict[tuple[int, int], list[_Label]] = {}
            for (done, _), labels in layer.items():
                for part, way in _free(choices, waits, done):
                    some = following.setdefault((done | 1 << part, id(way)), [])
                    for label in labels:
                        after = drives.onward(label.done, way)
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
    """A cyclic order of the parts, entered at each part that may be the first; parts that must wait
    for others come as soon as they may."""
    found = []
    for k in range(len(cycle)):
        rest, done, order = cycle[k:] + cycle[:k], 0, list[int]()
        while rest:
            part = next((p for p in rest if choices[p] and not waits[p] & ~done), None)
            if part is None or (not order and part != cycle[k]):
                break
            rest.remove(part)
            order.append(part)
            done |= 1 << part
        else:
            found.append(tuple(choices[part][0] for part in order))
    return found


def _modes(way: _Rounds, drives: _Drives) -> list[StepMode]:
    """A way as modes: one for each of the ends that it has after the drives that there are."""
    entries = drives.entries(way.first)
    time, energy, exits, which = way.runs(entries)
    found = []
    for number, exit in enumerate(exits):
        here = np.where(which == number, time, NEVER)
        if (here < NEVER).any():
            found.append(StepMode(way.first, exit, way.order, 0, entries, here, energy))
    return found
