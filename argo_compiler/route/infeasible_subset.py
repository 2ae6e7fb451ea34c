"""Why there is no route: requirements of the mission that can't all be met.

A smallest set of them is found by hitting sets (A. Ignatiev et al., CP 2015): whatever can't all be
met has something in common with each set of requirements that it helps to give up. As long as a
smallest set with that property can be met, it is filled up to a largest one that can be, and what
is left out of that is one more set to hit.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from ortools.sat.python import cp_model

from argo_compiler.route.cp_solver import new_solver, run_solver
from argo_compiler.route.problem import RouteProblem

Kept = frozenset[int]


@dataclass(frozen=True)
class Requirement:
    """Something that a problem asks for and that could be given up."""

    words: str
    kind: str
    number: int = 0


@dataclass(frozen=True)
class InfeasibleSubset:
    """Requirements that can't all be met."""

    words: tuple[str, ...]
    minimal: bool
    """whether each part of them can be met"""
    smallest: bool
    """whether there is none of fewer"""


def requirements(problem: RouteProblem) -> list[Requirement]:
    """All that the problem asks for."""
    found = [
        Requirement(precedence.words, "precedence", number)
        for number, precedence in enumerate(problem.precedences)
    ]
    for number, visit in enumerate(problem.visits):
        if visit.mandatory:
            found.append(Requirement(f"{visit.name} is visited", "visit", number))
        if visit.latest is not None:
            words = f"{visit.name} by {_clock(visit.latest * problem.unit)}"
            if visit.earliest:
                begin, end = (
                    _clock(time * problem.unit) for time in (visit.earliest, visit.latest)
                )
                words = f"{visit.name} between {begin} and {end}"
            words = problem.words.get(f"window {number}", words)
            found.append(Requirement(words, "window", number))
    if problem.max_duration is not None:
        words = f"within {_clock(problem.max_duration * problem.unit)}"
        found.append(Requirement(problem.words.get("max_duration", words), "limit"))
    if problem.battery is not None:
        words = problem.words.get("battery", "with what the battery holds")
        found.append(Requirement(words, "battery"))
    found += [
        Requirement(f"{one.name} is made as one", "round", number)
        for number, one in enumerate(problem.rounds)
    ]
    return found


def _clock(seconds: float) -> str:
    minutes, rest = divmod(max(0, round(seconds)), 60)
    return f"{minutes}:{rest:02d}"


def reduced(problem: RouteProblem, wanted: list[Requirement]) -> RouteProblem:
    """The problem that asks for these requirements only. What need not be visited is left away, if
    nothing needs it."""
    kinds: dict[str, set[int]] = {}
    for requirement in wanted:
        kinds.setdefault(requirement.kind, set()).add(requirement.number)
    precedences = [problem.precedences[k] for k in sorted(kinds.get("precedence", set()))]
    rounds = [problem.rounds[k] for k in sorted(kinds.get("round", set()))]
    must = set(kinds.get("visit", set()))
    while True:
        more = {
            visit
            for precedence in precedences
            if precedence.needed
            for k, later in enumerate(precedence.sequence)
            if later in must
            for visit in precedence.sequence[:k]
        }
        more |= set(chain.from_iterable(r.members for r in rounds if must & set(r.members)))
        if more <= must:
            break
        must |= more
    kept = sorted(must)
    place = {visit: k for k, visit in enumerate(kept)}
    visits = []
    for number in kept:
        visit = replace(problem.visits[number], mandatory=True, prize=0)
        if number not in kinds.get("window", set()):
            visit = replace(visit, latest=None)
        visits.append(visit)
    n = problem.size
    rows = [*kept, n]
    battery = problem.battery if "battery" in kinds else None
    if battery is not None:
        rows += [problem.charger(k) for k in range(len(problem.chargers))]
        battery = replace(battery, energy=battery.energy[np.ix_(rows, rows)])
    return RouteProblem(
        tuple(visits),
        problem.travel[np.ix_(rows, rows)],
        tuple(
            replace(p, sequence=tuple(place[v] for v in p.sequence if v in place))
            for p in precedences
        ),
        tuple(
            replace(r, members=tuple(place[v] for v in r.members))
            for r in rounds
            if set(r.members) <= must
        ),
        problem.max_duration if "limit" in kinds else None,
        battery,
        problem.chargers if battery is not None else (),
        unit=problem.unit,
    )


def find_infeasible_subset(
    problem: RouteProblem,
    possible: Callable[[RouteProblem], bool | None],
    over: Callable[[], bool],
    most_checks: int = 200,
) -> InfeasibleSubset | None:
    """Of a problem that has no route, as few requirements as possible that can't all be met with
    all that must be visited, and as few of those visits as possible. `possible` says whether a
    problem has a route, None if that is not known; after `most_checks` calls of it, and when the
    time is `over`, there may be smaller clashes than the one found. None: it is all of them, for
    all that was found out in time."""
    asked = requirements(problem)
    visits = [one for one in asked if one.kind == "visit"]
    rest = [one for one in asked if one.kind != "visit"]

    def of_rest(some: list[Requirement]) -> bool | None:
        return possible(reduced(problem, visits + some))

    def of_visits(more: list[Requirement]) -> bool | None:
        return possible(reduced(problem, more + some))

    some, minimal, smallest = _Finder(rest, of_rest, most_checks, over).infeasible_subset()
    needed, none_spared, fewest = _Finder(visits, of_visits, most_checks, over).infeasible_subset()
    minimal &= none_spared
    if not minimal and len(some) + len(needed) == len(asked):
        return None
    named = {visit for one in some for visit in _named(problem, one)}
    words = [
        one.words for one in [*needed, *some] if one.kind != "visit" or one.number not in named
    ]
    return InfeasibleSubset(tuple(words), minimal, smallest and fewest)


def _named(problem: RouteProblem, requirement: Requirement) -> tuple[int, ...]:
    """The visits that a requirement is about."""
    match requirement.kind:
        case "precedence":
            return problem.precedences[requirement.number].sequence
        case "round":
            return problem.rounds[requirement.number].members
        case "window":
            return (requirement.number,)
        case _:
            return ()


class _Finder:
    """Looks for a smallest part that can't be met of some requirements of which that is known. Has
    state: what is known of their parts."""

    def __init__(
        self,
        asked: list[Requirement],
        possible: Callable[[list[Requirement]], bool | None],
        most_checks: int,
        over: Callable[[], bool],
    ) -> None:
        self._asked, self._possible, self._most = asked, possible, most_checks
        self._over = over
        self._checks = 0
        self._met: list[Kept] = []
        self._clashing: list[Kept] = []
        self._unknown = False

    def infeasible_subset(self) -> tuple[list[Requirement], bool, bool]:
        """The part, whether nothing in it can be spared, and whether there is no smaller one."""
        everything = frozenset(range(len(self._asked)))
        small = self._spared(everything)
        minimal = not self._unknown
        to_hit: list[Kept] = []
        while self._checks < self._most and not self._unknown:
            smallest = _hitting_set(to_hit, len(self._asked), self._over)
            if smallest is None:
                break
            if len(smallest) >= len(small):
                return self._told(small), True, True
            if self._clashes(smallest):
                return self._told(smallest), True, True
            to_hit.append(everything - self._filled(smallest))
        return self._told(small), minimal, False

    def _told(self, infeasible_subset: Kept) -> list[Requirement]:
        return [self._asked[k] for k in sorted(infeasible_subset)]

    def _clashes(self, kept: Kept) -> bool:
        """Whether it is known that they can't all be met."""
        if any(kept <= met for met in self._met):
            return False
        if any(infeasible_subset <= kept for infeasible_subset in self._clashing):
            return True
        if self._over():
            self._unknown = True
            return False
        self._checks += 1
        answer = self._possible(self._told(kept))
        self._unknown |= answer is None
        if answer is False:
            self._clashing.append(kept)
        else:
            self._met.append(kept)
        return answer is False

    def _spared(self, infeasible_subset: Kept) -> Kept:
        """A part of an infeasible subset of which nothing more can be spared, as far as there is
        time: all of them are tried first, then halves, single ones last."""
        size = 2 * len(infeasible_subset)
        while size > 1:
            size //= 2
            parts = sorted(infeasible_subset)
            for first in range(0, len(parts), size):
                fewer = infeasible_subset - set(parts[first : first + size])
                if self._clashes(fewer):
                    infeasible_subset = fewer
        return infeasible_subset

    def _filled(self, met: Kept) -> Kept:
        """A largest part around one that can be met."""
        for part in range(len(self._asked)):
            if part not in met and self._checks < self._most and not self._clashes(met | {part}):
                met = met | {part}
        return met


def _hitting_set(sets: list[Kept], count: int, over: Callable[[], bool]) -> Kept | None:
    """A smallest set that has something in common with each of these; None: no time for it."""
    model = cp_model.CpModel()
    picked = [model.new_bool_var("") for _ in range(count)]
    for one in sets:
        model.add_bool_or([picked[k] for k in sorted(one)])
    model.minimize(sum(picked))
    solver = new_solver()
    solver.parameters.num_workers = 1
    if run_solver(solver, model, None, over) != cp_model.OPTIMAL:
        return None
    return frozenset(k for k in range(count) if solver.boolean_value(picked[k]))
