"""Route problem as plain data, without any solver.

Times are whole numbers of the problem's `unit`. Energy is measured in the time that it takes to
charge it, in the same unit: a charge lasts as long as the energy used since the last one. The
meaning and the cost of a route are defined in `argo_compiler.route.evaluation`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message

NEVER = 1 << 40
"""travel time between two locations without a path"""
_LONGEST = 1 << 30
"""longest time allowed, in units: sums of some hundred of them stay below NEVER"""
_MOST_ROUNDS = 1 << 20
_MOST_PRIZE = 1 << 40
"""highest sum of all visits' prizes"""


class Objective(StrEnum):
    """Cost that is minimised among the routes with the highest prize."""

    DURATION = "duration"
    """time when the robot reaches the end, waiting and charging included"""
    TRAVEL = "travel"
    """the duration without waiting"""
    PRIZE = "prize"
    """always 0: only the prize counts, and time only against the maximum duration"""


@dataclass(frozen=True)
class Visit:
    """Visit to one location, made once unless a round repeats it."""

    name: str
    """name in the mission's words: `checkpoint 4`"""
    service: int = 0
    """service time at the location"""
    mandatory: bool = True
    prize: int = 0
    """prize of the visit; the prizes of mandatory visits count as well"""
    earliest: int = 0
    """earliest time to begin the service; a robot that arrives before it waits"""
    latest: int | None = None
    """latest time to begin the service; None: no limit; before `earliest`: no route can make it"""


@dataclass(frozen=True)
class Precedence:
    """Order of some visits, with any other visits between them.

    A visit that is twice in the sequence would have to come before itself: no route can make it.
    """

    sequence: tuple[int, ...]
    words: str
    """the precedence in the mission's words: `checkpoint 8 before checkpoint 4`"""
    needed: bool = False
    """true if a visit requires that all visits before it in the sequence are made; if false, only
    the order of the visits that are made counts"""


@dataclass(frozen=True)
class Round:
    """Visits that are made one after the other, with nothing between them, and repeated.

    Either all members are visited, in the same order each time, or none. From the last member the
    robot continues to the first again; a single member is repeated at the travel time of its own
    entry on the matrix's diagonal. Rounds may be nested; of two with the same members, the one that
    comes first in the problem is the outer one.

    With both `repeat` and `duration`, the limit that is reached first ends the repetition: another
    round starts only while the duration has not passed. The clock of `duration` starts when the
    visit before the round ends, before the drive to the round; after a charge, when the robot
    leaves the charger. If there is a duration, a repetition that takes no time is the last one.
    """

    name: str
    members: tuple[int, ...]
    repeat: int = 1
    """number of repetitions; 0: until the duration has passed"""
    duration: int = 0
    """time limit of all repetitions; 0: no limit"""
    soft: bool = False
    """true if a repetition that has started is completed after the duration has passed. If false,
    it is interrupted at that moment: the next drive takes the longest time, and the highest energy,
    from any member. The energy of an interrupted repetition counts in full, and all travel times in
    it must be below NEVER. A repetition that ends exactly when the duration does is left from its
    last member."""


@dataclass(frozen=True)
class EnergyBudget:
    """Battery and energy use, measured in the time that charging the energy takes."""

    energy: NDArray[np.int64]
    """energy from the end of the service at one location to the end of the service at the next,
    shape of `RouteProblem.travel`"""
    capacity: int
    """energy that may be used of a full battery"""
    used: int = 0
    """energy already used when the robot starts"""
    overhead: int = 0
    """time that a charge takes in addition to charging: docking, undocking"""


@dataclass(frozen=True, eq=False)
class RouteProblem:
    """Visits, the travel times between them, and the constraints of a route.

    The robot may charge, always until the battery is full, at a charger between two visits, before
    the first and after the last, once each; not within a round.
    """

    visits: tuple[Visit, ...]
    travel: NDArray[np.int64]
    """travel times from row to column, shape (n + 1 + c, n + 1 + c) with n visits and c chargers.
    Row n is the start, column n the end; rows and columns from n + 1 are the chargers. NEVER: there
    is no path. The time of actions that follow a visit only sometimes, in the worst case or on
    average, is part of that visit's row."""
    precedences: tuple[Precedence, ...] = ()
    rounds: tuple[Round, ...] = ()
    max_duration: int | None = None
    """latest time to reach the end; None: no limit"""
    battery: EnergyBudget | None = None
    chargers: tuple[str, ...] = ()
    """names of the chargers"""
    objective: Objective = Objective.DURATION
    unit: float = 1.0
    """s"""
    words: Mapping[str, str] = field(default_factory=dict)
    """the mission's words for `max_duration`, `battery` and the windows of visits (`window 0`), for
    messages"""

    def __post_init__(self) -> None:
        """Raise Invalid if the parts do not fit together."""
        for flaw in _flaws(self):
            raise Invalid(Message("the route problem has a mistake: {flaw}; correct it", flaw=flaw))
        self.travel.setflags(write=False)
        if self.battery is not None:
            self.battery.energy.setflags(write=False)

    @property
    def size(self) -> int:
        """Number of visits, which is also the row of the start and the column of the end."""
        return len(self.visits)

    @property
    def end(self) -> int:
        return len(self.visits)

    def charger(self, number: int) -> int:
        """Return the row and column of the charger with this number, from 0."""
        return len(self.visits) + 1 + number

    @property
    def selective(self) -> bool:
        """True if a route may leave out some visit."""
        return not all(visit.mandatory for visit in self.visits)

    @property
    def has_free_waiting(self) -> bool:
        """True if the robot may have to wait for a visit and waiting costs nothing."""
        return self.objective is Objective.TRAVEL and any(v.earliest > 0 for v in self.visits)


@dataclass(frozen=True)
class Tour:
    """Order of visits, each listed once even if a round repeats it, with charges between them."""

    order: tuple[int, ...]
    charges: Mapping[int, int] = field(default_factory=dict)
    """number of the charger by the position in `order` before which the robot charges. No position
    is within a round, even one with a single repetition; `len(order)`: before the end"""

    def left_out(self, size: int) -> tuple[int, ...]:
        """Return which of the visits 0 to `size` - 1 are not in the order."""
        return tuple(sorted({*range(size)} - {*self.order}))


def _flaws(problem: RouteProblem) -> Iterator[str]:
    n = problem.size
    side = n + 1 + len(problem.chargers)
    yield from _matrix_flaws(problem.travel, Message("travel times"), side)
    for visit in problem.visits:
        if visit.service < 0 or visit.prize < 0 or visit.earliest < 0:
            yield Message(
                "{visit} has a negative service time, prize or earliest time", visit=visit.name
            )
        if max(visit.service, visit.earliest, visit.latest or 0) > _LONGEST:
            yield Message(
                "a time of {visit} is above {longest}: use a larger unit",
                visit=visit.name,
                longest=_LONGEST,
            )
    if sum(visit.prize for visit in problem.visits) > _MOST_PRIZE:
        yield Message("its prizes add up to more than {most_prize}", most_prize=_MOST_PRIZE)
    if problem.max_duration is not None and not 0 <= problem.max_duration < NEVER:
        yield Message("the maximum duration is negative, or too long")
    if problem.unit <= 0.0:
        yield Message("the unit of time is not positive")
    for precedence in problem.precedences:
        if not set(precedence.sequence) <= set(range(n)):
            yield Message(
                "{words}: there are only the visits 0 to {n}", words=precedence.words, n=n - 1
            )
    if problem.battery is not None:
        yield from _matrix_flaws(problem.battery.energy, "energies", side)
        battery = problem.battery
        if min(battery.capacity, battery.used, battery.overhead) < 0:
            yield Message("the battery's capacity, its used energy or its overhead is negative")
    elif problem.chargers:
        yield Message("it has chargers and no battery")
    yield from _round_flaws(problem)


def _matrix_flaws(matrix: NDArray[np.int64], quantity: str, side: int) -> Iterator[str]:
    if matrix.shape != (side, side):
        yield Message(
            "its {quantity} have the shape {shape}, not {value}",
            quantity=quantity,
            shape=str(matrix.shape),
            value=str((side, side)),
        )
    elif matrix.dtype != np.int64:
        yield Message(
            "its {quantity} are {dtype}, not int64", quantity=quantity, dtype=matrix.dtype
        )
    elif matrix.min(initial=0) < 0 or (matrix[matrix != NEVER] > _LONGEST).any():
        yield Message(
            "its {quantity} are not from 0 to {longest}, or NEVER (else use a larger unit)",
            quantity=quantity,
            longest=_LONGEST,
        )


def _round_flaws(problem: RouteProblem) -> Iterator[str]:
    for number, round_ in enumerate(problem.rounds):
        members = set(round_.members)
        if (
            not members
            or len(members) < len(round_.members)
            or not members <= set(range(problem.size))
        ):
            yield Message(
                "the round {round} has no members, one twice, or one that is not a visit",
                round=round_.name,
            )
            continue
        if round_.repeat < 0 or round_.duration < 0 or round_.repeat == round_.duration == 0:
            yield Message(
                "the round {round} needs a number of rounds or a duration", round=round_.name
            )
        if round_.repeat > _MOST_ROUNDS or round_.duration > _LONGEST:
            yield Message(
                "the round {round} is repeated too often, or lasts too long", round=round_.name
            )
        for member in (problem.visits[m] for m in round_.members):
            if member.earliest > 0 or member.latest is not None:
                yield (
                    Message(
                        "{member} has a time window and lies in the round {round}: the window does "
                        "not say in which repetition",
                        member=member.name,
                        round=round_.name,
                    )
                )
        for other in problem.rounds[:number]:
            if not (members <= set(other.members) or members >= set(other.members)) and (
                members & set(other.members)
            ):
                yield (
                    Message(
                        "the rounds {other} and {round} overlap, and neither is in the other",
                        other=other.name,
                        round=round_.name,
                    )
                )
