"""Small random route problems of all kinds, above all odd ones.

A mission would hardly lead to these, and solvers tend to make false assumptions about them.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route import (
    NEVER,
    EnergyBudget,
    Objective,
    Precedence,
    Round,
    RouteProblem,
    Tour,
    Visit,
)
from tests.argo_compiler.route.reference import Reference


def odd_problem(rng: np.random.Generator, timed: bool = False) -> RouteProblem:
    """Return a problem of 1 to 6 visits, with more rounds with a duration if `timed`."""
    return OddProblem(rng, timed).problem()


def odd_tour(rng: np.random.Generator, problem: RouteProblem) -> Tour:
    """Return a random tour of a problem, which usually does not split rounds.

    A random order would split almost all of them.
    """
    order = [int(v) for v in rng.permutation(problem.size)]
    for round_ in sorted(problem.rounds, key=lambda round_: len(round_.members)):
        if rng.random() < 0.95:
            first = next(v for v in order if v in round_.members)
            members = [v for v in order if v in round_.members]
            at = order.index(first)
            before = [v for v in order[:at] if v not in round_.members]
            order = [*before, *members, *(v for v in order[at:] if v not in round_.members)]
    if problem.selective and rng.random() < 0.8:
        left_out = {
            k for k, v in enumerate(problem.visits) if not v.mandatory and rng.random() < 0.4
        }
        for round_ in problem.rounds:
            if left_out & set(round_.members) and rng.random() < 0.9:
                left_out |= set(round_.members)
        order = [v for v in order if v not in left_out]
    within_rounds = {
        position
        for round_ in problem.rounds
        for position in range(1, len(order))
        if {order[position - 1], order[position]} <= set(round_.members)
    }
    charges = {
        position: int(rng.integers(len(problem.chargers)))
        for position in range(len(order) + 1)
        if problem.chargers and rng.random() < (0.03 if position in within_rounds else 0.4)
    }
    return Tour(tuple(order), charges)


class OddProblem:
    """Builder of one random problem."""

    def __init__(self, rng: np.random.Generator, timed: bool) -> None:
        self.rng = rng
        self.timed = timed
        sizes = [0.06, 0.14, 0.35, 0.35, 0.1, 0.0] if timed else [0.06, 0.1, 0.16, 0.2, 0.24, 0.24]
        self.size = 1 + int(rng.choice(6, p=sizes))
        self.longest = int(rng.choice([1, 3, 10, 100]))
        """longest travel or service time"""
        self.likely = [int(visit) for visit in rng.permutation(self.size)]
        """order that meets most precedences and splits few rounds"""

    def often(self, chance: float) -> bool:
        return bool(self.rng.random() < chance)

    def up_to(self, most: int) -> int:
        return int(self.rng.integers(0, most + 1))

    def problem(self) -> RouteProblem:
        rounds = self.rounds() if self.timed or self.often(0.4) else ()
        n = self.size
        battery = self.often(0.15 if self.timed else 0.3)
        chargers = self.up_to(2 if n <= 4 else 1) if battery else 0
        side = n + 1 + chargers
        unlimited = RouteProblem(
            visits=self.visits({member for round_ in rounds for member in round_.members}),
            travel=self.matrix(side, 0.2),
            precedences=tuple(self.precedence(k) for k in range(self.few(0.4))),
            rounds=rounds,
            battery=self.battery(side) if battery else None,
            chargers=tuple(f"charger {k}" for k in range(chargers)),
            objective=list(Objective)[self.up_to(2)],
        )
        return (
            replace(unlimited, max_duration=self.max_duration(unlimited))
            if self.often(0.4)
            else unlimited
        )

    def max_duration(self, problem: RouteProblem) -> int:
        """Return about the duration of some tour, so that some tours are too long."""
        reference = Reference(problem)
        ends = [reference.evaluate(odd_tour(self.rng, problem)) for _ in range(12)]
        times = sorted(end.time for end in ends if end is not None)
        most = times[self.up_to(len(times) - 1)] if times else self.up_to(8 * self.longest)
        return max(0, most - self.up_to(1))

    def few(self, chance: float) -> int:
        return 1 + self.up_to(2) if self.often(chance) else 0

    def matrix(self, side: int, one_way: float) -> NDArray[np.int64]:
        """Return times or energies, with many zeros and ties and without the triangle inequality.

        With the probability `one_way`, some connections exist only in one direction.
        """
        times = self.rng.integers(0, self.longest + 1, (side, side))
        if self.often(0.3):
            times[self.rng.random((side, side)) < 0.4] = 0
        if self.often(0.15):
            times = np.minimum(times, times.T)
        if self.often(one_way):
            times[self.rng.random((side, side)) < self.rng.choice([0.1, 0.3])] = NEVER
        if self.often(0.3):
            # The time from a location to itself is not defined.
            np.fill_diagonal(times, 0 if self.often(0.6) else NEVER)
        return times.astype(np.int64)

    def visits(self, in_rounds: set[int]) -> tuple[Visit, ...]:
        optional = self.rng.choice([0.0, 0.5, 1.0], p=[0.5, 0.35, 0.15])
        windows = self.often(0.5)
        most = int(self.rng.choice([0, 1, 5]))
        visits = list[Visit]()
        for k in range(self.size):
            earliest, latest = 0, None
            horizon = self.longest * (self.likely.index(k) + 1)
            if windows and k not in in_rounds:
                if self.often(0.5):
                    earliest = self.up_to(horizon)
                if self.often(0.5):
                    latest = max(0, earliest + self.up_to(horizon) - self.up_to(2))
            visits.append(
                Visit(
                    name=f"visit {k}",
                    service=0 if self.often(0.3) else self.up_to(self.longest),
                    mandatory=not self.often(optional),
                    prize=self.up_to(most),
                    earliest=earliest,
                    latest=latest,
                )
            )
        return tuple(visits)

    def precedence(self, number: int) -> Precedence:
        """Return a precedence, mostly of two or three visits, rarely of none, one, or one twice."""
        length = int(self.rng.choice([0, 1, 2, 3, 4], p=[0.02, 0.04, 0.6, 0.24, 0.1]))
        if self.often(0.05):
            sequence = [self.up_to(self.size - 1) for _ in range(length)]
        else:
            sequence = [int(visit) for visit in self.rng.permutation(self.size)[:length]]
            if self.often(0.8):
                sequence.sort(key=self.likely.index)
        return Precedence(tuple(sequence), f"precedence {number}", self.often(0.4))

    def rounds(self) -> tuple[Round, ...]:
        """Return nested and separate rounds, in any order."""
        groups, members = [tuple(self.likely)], list[tuple[int, ...]]()
        for _ in range(2 + self.up_to(1) if self.timed else 1 + self.up_to(2)):
            group = max(groups, key=len) if self.often(0.6) else groups[self.up_to(len(groups) - 1)]
            cut = len(group) if self.often(0.3) else 1 + self.up_to(len(group) - 1)
            groups.remove(group)
            groups += [part for part in (group[:cut], group[cut:]) if part]
            members.append(tuple(int(visit) for visit in self.rng.permutation(group[:cut])))
        return tuple(
            self.round(f"round {k}", members[int(number)])
            for k, number in enumerate(self.rng.permutation(len(members)))
        )

    def round(self, name: str, members: tuple[int, ...]) -> Round:
        repeat = int(self.rng.choice([0, 1, 2, 3, 5]))
        duration = 0
        if repeat == 0 or self.often(0.7 if self.timed else 0.3):
            duration = 1 + self.up_to(int(self.rng.choice([2, 4, 10])) * self.longest)
        return Round(name, members, repeat, duration, self.often(0.5))

    def battery(self, side: int) -> EnergyBudget:
        energy = self.matrix(side, 0.1)
        capacity = int(self.rng.choice([1, 2, 3, 8])) * self.longest + self.up_to(self.longest)
        used = 0 if self.often(0.5) else self.up_to(capacity)
        return EnergyBudget(energy, capacity, used, self.up_to(2))
