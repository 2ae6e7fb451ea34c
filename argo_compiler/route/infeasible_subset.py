"""Explanation of why there is no route: requirements of the mission that cannot all be met.

A smallest infeasible subset is found by hitting sets (A. Ignatiev et al., CP 2015). The complement
of a feasible subset is a correction set: each infeasible subset has an element of it. The search
collects correction sets and computes a smallest set that hits all of them. If that set is
infeasible, it is a smallest infeasible subset. If it is feasible, it is extended to a maximal
feasible subset, whose complement is one more correction set to hit.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from ortools.sat.python import cp_model

from argo_compiler.base.message import Message
from argo_compiler.base.quantity_text import duration_text
from argo_compiler.route.cp_solver import new_solver, run_solver
from argo_compiler.route.problem import RouteProblem

Subset = frozenset[int]
"""numbers of some requirements"""


@dataclass(frozen=True)
class Requirement:
    """Constraint of a problem that could be given up."""

    words: str
    kind: str
    number: int = 0


@dataclass(frozen=True)
class InfeasibleSubset:
    """Requirements that cannot all be met."""

    words: tuple[str, ...]
    minimal: bool
    """true if each proper subset can be met"""
    smallest: bool
    """true if no infeasible subset has fewer requirements"""


def requirements(problem: RouteProblem) -> list[Requirement]:
    """Return all constraints of a problem that could be given up, its mandatory visits too."""
    collected = [
        Requirement(precedence.words, "precedence", number)
        for number, precedence in enumerate(problem.precedences)
    ]
    for number, visit in enumerate(problem.visits):
        if visit.mandatory:
            collected.append(
                Requirement(Message("{visit} is visited", visit=visit.name), "visit", number)
            )
        if visit.latest is not None:
            words: str = Message(
                "{visit} by {duration}",
                visit=visit.name,
                duration=duration_text(visit.latest * problem.unit),
            )
            if visit.earliest:
                begin, end = (
                    duration_text(time * problem.unit) for time in (visit.earliest, visit.latest)
                )
                words = Message(
                    "{visit} between {begin} and {end}", visit=visit.name, begin=begin, end=end
                )
            words = problem.words.get(f"window {number}", words)
            collected.append(Requirement(words, "window", number))
    if problem.max_duration is not None:
        limit = Message(
            "within {duration}", duration=duration_text(problem.max_duration * problem.unit)
        )
        collected.append(Requirement(problem.words.get("max_duration", limit), "limit"))
    if problem.battery is not None:
        words = problem.words.get("battery", Message("within the battery's capacity"))
        collected.append(Requirement(words, "battery"))
    collected += [
        Requirement(
            Message("{round} is complete and without interruption", round=round_.name),
            "round",
            number,
        )
        for number, round_ in enumerate(problem.rounds)
    ]
    return collected


def with_only_requirements(problem: RouteProblem, subset: list[Requirement]) -> RouteProblem:
    """Return the problem with only these requirements.

    It has no visits but those that `subset` requires, all mandatory, and those that they need.
    """
    kinds: dict[str, set[int]] = {}
    for requirement in subset:
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
    remaining = sorted(must)
    new_number = {visit: k for k, visit in enumerate(remaining)}
    visits = []
    for number in remaining:
        visit = replace(problem.visits[number], mandatory=True, prize=0)
        if number not in kinds.get("window", set()):
            visit = replace(visit, latest=None)
        visits.append(visit)
    n = problem.size
    rows = [*remaining, n]
    battery = problem.battery if "battery" in kinds else None
    if battery is not None:
        rows += [problem.charger(k) for k in range(len(problem.chargers))]
        battery = replace(battery, energy=battery.energy[np.ix_(rows, rows)])
    return RouteProblem(
        tuple(visits),
        problem.travel[np.ix_(rows, rows)],
        tuple(
            replace(p, sequence=tuple(new_number[v] for v in p.sequence if v in new_number))
            for p in precedences
        ),
        tuple(
            replace(r, members=tuple(new_number[v] for v in r.members))
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
    is_feasible: Callable[[RouteProblem], bool | None],
    is_time_up: Callable[[], bool],
    most_checks: int = 200,
) -> InfeasibleSubset | None:
    """Find requirements that cannot all be met, of a problem without a route.

    First finds as few requirements as possible that cannot all be met together with all mandatory
    visits, then as few of these visits as possible. Returns None if the time was too short to rule
    out any requirement.

    Args:
        problem: A problem without a route.
        is_feasible: Returns whether a problem has a route, or None if that is not known.
        is_time_up: Returns True when the search must end.
        most_checks: Number of calls of `is_feasible`, for the visits and for the other requirements
            each, after which the search for smaller subsets ends. Then, and when the time is up,
            smaller infeasible subsets than the result may exist.
    """
    all_requirements = requirements(problem)
    visits = [r for r in all_requirements if r.kind == "visit"]
    others = [r for r in all_requirements if r.kind != "visit"]

    def can_meet_others(subset: list[Requirement]) -> bool | None:
        return is_feasible(with_only_requirements(problem, visits + subset))

    def can_meet_visits(subset: list[Requirement]) -> bool | None:
        return is_feasible(with_only_requirements(problem, subset + clash))

    clash, minimal, smallest = _Finder(
        others, can_meet_others, most_checks, is_time_up
    ).infeasible_subset()
    needed, needed_minimal, fewest = _Finder(
        visits, can_meet_visits, most_checks, is_time_up
    ).infeasible_subset()
    minimal &= needed_minimal
    if not minimal and len(clash) + len(needed) == len(all_requirements):
        return None
    named = {visit for requirement in clash for visit in _named(problem, requirement)}
    words = [r.words for r in [*needed, *clash] if r.kind != "visit" or r.number not in named]
    return InfeasibleSubset(tuple(words), minimal, smallest and fewest)


def _named(problem: RouteProblem, requirement: Requirement) -> tuple[int, ...]:
    """Return the visits that a requirement names."""
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
    """Search for a smallest infeasible subset of requirements that cannot all be met.

    Holds the subsets that are known to be feasible or infeasible.
    """

    def __init__(
        self,
        candidates: list[Requirement],
        is_feasible: Callable[[list[Requirement]], bool | None],
        most_checks: int,
        is_time_up: Callable[[], bool],
    ) -> None:
        self._candidates, self._is_feasible, self._most = candidates, is_feasible, most_checks
        self._is_time_up = is_time_up
        self._checks = 0
        self._feasible: list[Subset] = []
        self._infeasible: list[Subset] = []
        self._unknown = False

    def infeasible_subset(self) -> tuple[list[Requirement], bool, bool]:
        """Return requirements that can't all be met, and how good this explanation is.

        The second member is True if each smaller part of them can be met; the third one is True if
        no smaller number of requirements is infeasible.
        """
        everything = frozenset(range(len(self._candidates)))
        small = self._shrink(everything)
        minimal = not self._unknown
        to_hit: list[Subset] = []
        while self._checks < self._most and not self._unknown:
            smallest = _hitting_set(to_hit, len(self._candidates), self._is_time_up)
            if smallest is None:
                break
            if len(smallest) >= len(small):
                return self._selected(small), True, True
            if self._is_infeasible(smallest):
                return self._selected(smallest), True, True
            to_hit.append(everything - self._extend(smallest))
        return self._selected(small), minimal, False

    def _selected(self, subset: Subset) -> list[Requirement]:
        return [self._candidates[k] for k in sorted(subset)]

    def _is_infeasible(self, subset: Subset) -> bool:
        """Return True if the requirements are known to be infeasible together.

        Checks it if it is not known yet. An unknown answer, and a lack of time, count as feasible
        and are recorded.
        """
        if any(subset <= feasible for feasible in self._feasible):
            return False
        if any(infeasible <= subset for infeasible in self._infeasible):
            return True
        if self._is_time_up():
            self._unknown = True
            return False
        self._checks += 1
        answer = self._is_feasible(self._selected(subset))
        self._unknown |= answer is None
        if answer is False:
            self._infeasible.append(subset)
        else:
            self._feasible.append(subset)
        return answer is False

    def _shrink(self, infeasible: Subset) -> Subset:
        """Remove requirements from an infeasible subset until it is minimal or the time is up.

        Tries to remove all of them first, then halves, and single ones last.
        """
        size = 2 * len(infeasible)
        while size > 1:
            size //= 2
            parts = sorted(infeasible)
            for first in range(0, len(parts), size):
                fewer = infeasible - set(parts[first : first + size])
                if self._is_infeasible(fewer):
                    infeasible = fewer
        return infeasible

    def _extend(self, feasible: Subset) -> Subset:
        """Add requirements to a feasible subset until none can be added, or no check is left."""
        for added in range(len(self._candidates)):
            if (
                added not in feasible
                and self._checks < self._most
                and not self._is_infeasible(feasible | {added})
            ):
                feasible = feasible | {added}
        return feasible


def _hitting_set(sets: list[Subset], count: int, is_time_up: Callable[[], bool]) -> Subset | None:
    """Return a smallest set with an element of each of `sets`, or None if the time is too short."""
    model = cp_model.CpModel()
    picked = [model.new_bool_var("") for _ in range(count)]
    for set_ in sets:
        model.add_bool_or([picked[k] for k in sorted(set_)])
    model.minimize(sum(picked))
    solver = new_solver()
    solver.parameters.num_workers = 1
    if run_solver(solver, model, None, is_time_up) != cp_model.OPTIMAL:
        return None
    return frozenset(k for k in range(count) if solver.boolean_value(picked[k]))
