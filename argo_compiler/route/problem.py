"""What a route problem is: plain data that no solver is needed for.

Times are whole numbers of the problem's `unit`. Energy is measured in the time that it takes to
charge it, in the same unit: so a charge takes as long as it has to give back. What a route means,
and what it costs, is `argo_compiler.route.evaluation`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid

NEVER = 1 << 40
"""a travel time where there is no way"""
_LONGEST = 1 << 30
"""the longest time that is one, in units: so that sums of some hundred stay below NEVER"""
_MOST_ROUNDS = 1 << 20
_MOST_PRIZE = 1 << 40
"""of all visits together"""


class Objective(StrEnum):
    """What is made small when as much prize as possible is won."""

    DURATION = "duration"
    """the time when the robot is at the end, waiting and charging included"""
    TRAVEL = "travel"
    """the same less waiting"""
    PRIZE = "prize"
    """nothing, which costs 0: the prize alone counts, and time only against the maximum duration"""


@dataclass(frozen=True)
class Visit:
    """Something to be done at one place, once, unless a round repeats it."""

    name: str
    """in the mission's words: `checkpoint 4`"""
    service: int = 0
    """how long it takes there"""
    mandatory: bool = True
    prize: int = 0
    """what it is worth; that of mandatory visits counts as well"""
    earliest: int = 0
    """when it may begin: a robot that comes earlier waits"""
    latest: int | None = None
    """when it must have begun; None: whenever; before `earliest`: it can't be made"""


@dataclass(frozen=True)
class Precedence:
    """Visits that are made in this order, with whatever between them.

    A visit that is twice in the sequence would have to come before itself: it can't be made.
    """

    sequence: tuple[int, ...]
    words: str
    """in the mission's words: `checkpoint 8 before checkpoint 4`"""
    needed: bool = False
    """whether a visit may only be made if those before it in the sequence were made; else those
    that are left out don't matter"""


@dataclass(frozen=True)
class Round:
    """Visits that are made one after the other, with nothing between them, as often as is asked.

    All of them are made, in the same order each time, or none. From the last the robot goes on to
    the first again: of a single one over its own entry of the matrix. Rounds may lie in each other;
    of two with the same members, the one that comes first in the problem is around the other.

    With `repeat` and `duration`, whichever comes first ends it: another round is begun only as long
    as the duration is not over. The clock of `duration` starts when the visit before the round
    ends, on the way to it; after a charge, when the robot leaves the charger. A further round that
    takes no time at all, where there is a duration, is the last one.
    """

    name: str
    members: tuple[int, ...]
    repeat: int = 1
    """how often; 0: until the duration is over"""
    duration: int = 0
    """for how long; 0: no limit"""
    soft: bool = False
    """whether a round that has begun is completed when the duration is over; else it is left in
    the middle when that is so, and what comes next is reckoned from whichever members its time, and
    its energy, are most. The energy of a round left in the middle counts in full, and all of its
    ways must be there. One that ends just when the duration does is left from its last member"""


@dataclass(frozen=True)
class EnergyBudget:
    """Energy, in the time that it takes to charge it."""

    energy: NDArray[np.int64]
    """used from the end of what is done at one place to the end of what is done at the next, shape
    of `RouteProblem.travel`"""
    capacity: int
    """what may be used of a full battery"""
    used: int = 0
    """what has been used when the robot sets off"""
    overhead: int = 0
    """time that a charge takes beside charging: docking, undocking"""


@dataclass(frozen=True, eq=False)
class RouteProblem:
    """Visits, the times between them, and all that a route must keep to.

    The robot may be charged, always until it is full, at a charger between two visits, before the
    first and after the last, once each; not within a round.
    """

    visits: tuple[Visit, ...]
    travel: NDArray[np.int64]
    """shape (n + 1 + c, n + 1 + c) with n visits and c chargers: from row to column. Row n is the
    start, column n the end; rows and columns from n + 1 are the chargers. NEVER: no way. What is to
    be done only after some visit, in the worst case or on average, is part of that visit's row."""
    precedences: tuple[Precedence, ...] = ()
    rounds: tuple[Round, ...] = ()
    max_duration: int | None = None
    """when the robot must be at the end"""
    battery: EnergyBudget | None = None
    chargers: tuple[str, ...] = ()
    """names"""
    objective: Objective = Objective.DURATION
    unit: float = 1.0
    """s"""
    words: Mapping[str, str] = field(default_factory=dict)
    """how the mission says `max_duration`, `battery` and the windows of visits (`window 0`), for
    messages"""

    def __post_init__(self) -> None:
        """Raises ArgoError if the parts don't fit together."""
        for trouble in _troubles(self):
            raise Invalid(f"this is no route problem: {trouble}")
        self.travel.setflags(write=False)
        if self.battery is not None:
            self.battery.energy.setflags(write=False)

    @property
    def size(self) -> int:
        """The number of visits, which is the row of the start and the column of the end."""
        return len(self.visits)

    @property
    def end(self) -> int:
        return len(self.visits)

    def charger(self, number: int) -> int:
        """The row and column of the charger with that number, from 0."""
        return len(self.visits) + 1 + number

    @property
    def selective(self) -> bool:
        """Whether anything may be left out."""
        return not all(visit.mandatory for visit in self.visits)

    @property
    def waits(self) -> bool:
        """Whether the robot may have to wait for a visit, and that does not count."""
        return self.objective is Objective.TRAVEL and any(v.earliest > 0 for v in self.visits)


@dataclass(frozen=True)
class Tour:
    """Visits in their order; those of a round as in its first round."""

    order: tuple[int, ...]
    charges: Mapping[int, int] = field(default_factory=dict)
    """the number of the charger by the position in `order` before which the robot is charged, which
    is not within a round, even one that is made once; `len(order)`: before the end"""


def _troubles(problem: RouteProblem) -> Iterator[str]:
    n = problem.size
    side = n + 1 + len(problem.chargers)
    yield from _matrix_troubles(problem.travel, "travel times", side)
    for visit in problem.visits:
        if visit.service < 0 or visit.prize < 0 or visit.earliest < 0:
            yield f"{visit.name} has a negative service time, prize or earliest time"
        if max(visit.service, visit.earliest, visit.latest or 0) > _LONGEST:
            yield f"a time of {visit.name} is above {_LONGEST}: take a greater unit"
    if sum(visit.prize for visit in problem.visits) > _MOST_PRIZE:
        yield f"its prizes add up to more than {_MOST_PRIZE}"
    if problem.max_duration is not None and not 0 <= problem.max_duration < NEVER:
        yield "the maximum duration is negative, or too long"
    if problem.unit <= 0.0:
        yield "the unit of time is not positive"
    for precedence in problem.precedences:
        if not set(precedence.sequence) <= set(range(n)):
            yield f"{precedence.words}: there are only the visits 0 to {n - 1}"
    if problem.battery is not None:
        yield from _matrix_troubles(problem.battery.energy, "energies", side)
        battery = problem.battery
        if min(battery.capacity, battery.used, battery.overhead) < 0:
            yield "the battery's capacity, what is used of it or its overhead is negative"
    elif problem.chargers:
        yield "it has chargers and no battery"
    yield from _round_troubles(problem)


def _matrix_troubles(matrix: NDArray[np.int64], what: str, side: int) -> Iterator[str]:
    if matrix.shape != (side, side):
        yield f"its {what} have the shape {matrix.shape}, not {(side, side)}"
    elif matrix.dtype != np.int64:
        yield f"its {what} are {matrix.dtype}, not int64"
    elif matrix.min(initial=0) < 0 or (matrix[matrix != NEVER] > _LONGEST).any():
        yield f"its {what} are not from 0 to {_LONGEST}, or NEVER (else take a greater unit)"


def _round_troubles(problem: RouteProblem) -> Iterator[str]:
    for number, one in enumerate(problem.rounds):
        members = set(one.members)
        if (
            not members
            or len(members) < len(one.members)
            or not members <= set(range(problem.size))
        ):
            yield f"the round {one.name} has no members, one twice, or one that is no visit"
            continue
        if one.repeat < 0 or one.duration < 0 or one.repeat == one.duration == 0:
            yield f"the round {one.name} needs a number of rounds or a duration"
        if one.repeat > _MOST_ROUNDS or one.duration > _LONGEST:
            yield f"the round {one.name} is repeated too often, or lasts too long"
        for member in (problem.visits[m] for m in one.members):
            if member.earliest > 0 or member.latest is not None:
                yield (
                    f"{member.name} has a time window and lies in the round {one.name}: "
                    "it does not say in which round"
                )
        for other in problem.rounds[:number]:
            if not (members <= set(other.members) or members >= set(other.members)) and (
                members & set(other.members)
            ):
                yield f"the rounds {other.name} and {one.name} overlap, and neither is in the other"
