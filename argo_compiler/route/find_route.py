"""From a problem to a suggestion: modes, pruning, bounds, the portfolio; why there is none."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from argo_compiler.base.errors import Invalid
from argo_compiler.route.assignment import assignment_bound
from argo_compiler.route.infeasible_subset import find_infeasible_subset
from argo_compiler.route.modes import Step
from argo_compiler.route.network import network
from argo_compiler.route.portfolio import solve
from argo_compiler.route.problem import NEVER, Objective, RouteProblem
from argo_compiler.route.pruning import longest, prune
from argo_compiler.route.search import Observers, Search, SearchLimits
from argo_compiler.route.solvers import RouteSolver
from argo_compiler.route.stop import FirstFeasible
from argo_compiler.route.suggested import RouteSuggestion

_CHECK = 2.0
"""s for one check of whether some requirements can be met together"""
_BEGUN = 0.3
"""s that it takes at most until a check looks at the time"""
_ROUNDS = 0.2
"""share of the time in which the ways to make rounds are found"""

Clock = Callable[[], float]


def find_route(
    problem: RouteProblem,
    limits: SearchLimits,
    seed: int,
    workers: int,
    clock: Clock,
    *,
    explain: bool,
    observers: Observers,
    solvers: Sequence[str | RouteSolver] | None = None,
) -> RouteSuggestion:
    """See `argo_compiler.route.suggestion.suggest_route`."""
    begun = clock()
    search = _searched(problem, limits, seed, workers, clock, observers, solvers)
    words: tuple[str, ...] = ()
    if explain and search.infeasible:
        words = _explained(problem, search, limits, begun, clock)
    best = search.best
    made = set(best.tour.order) if best else set()
    return RouteSuggestion(
        None if best is None else best.tour,
        0 if best is None else best.prize,
        search.prize_bound,
        0 if best is None else best.cost,
        search.bound,
        search.done,
        () if best is None else tuple(v for v in range(problem.size) if v not in made),
        words,
        search.method,
        search.reasons,
        search.history,
        search.turns,
    )


def _searched(
    problem: RouteProblem,
    limits: SearchLimits,
    seed: int,
    workers: int,
    clock: Clock,
    observers: Observers,
    solvers: Sequence[str | RouteSolver] | None = None,
) -> Search:
    begun = clock()

    def order_of(step: Step) -> tuple[Step, ...]:
        return _cycle(problem, step, limits, seed, clock)

    seconds = inf if limits.seconds is None else limits.seconds
    net = network(problem, order_of, lambda: clock() - begun > _ROUNDS * seconds)
    if longest(net) >= NEVER // 2:
        raise Invalid(
            "the times of this route problem are too long to be added up: take a greater unit"
        )
    search = Search(net, prune(net), limits, seed, clock, observers, begun)
    if not net.exact:
        search.say("rounds have too many orders to weigh them all: nothing is proven")
    bound = assignment_bound(net, search.pruned)
    if bound is None:
        search.say("some step can't be made at all, or not in an order that is asked for")
        with search.by("pruning") as turn:
            turn.impossible()
        return search
    with search.by("assignment") as turn:
        turn.known(prize_bound=int(net.prize[search.pruned.steps].sum()))
        turn.known(bound=None if net.objective is Objective.PRIZE else bound)
    solve(search, workers, solvers)
    return search


def _explained(
    problem: RouteProblem, search: Search, limits: SearchLimits, begun: float, clock: Clock
) -> tuple[str, ...]:
    """Why there is no route, as far as that is found out in the time that is left."""

    longest_check = 0.0

    def left() -> float:
        return inf if limits.seconds is None else limits.seconds - (clock() - begun)

    def possible(part: RouteProblem) -> bool | None:
        nonlocal longest_check
        seconds = None if limits.seconds is None else max(left(), 1e-3)
        before = clock()
        if limits.work is None:
            short = SearchLimits(min(_CHECK, seconds or _CHECK), None, FirstFeasible())
        else:
            short = SearchLimits(seconds, _CHECK, FirstFeasible())
        one = _searched(part, short, search.seed, 1, clock, Observers())
        longest_check = max(longest_check, clock() - before)
        return True if one.best is not None else False if one.infeasible else None

    found = find_infeasible_subset(problem, possible, lambda: left() <= min(longest_check, _BEGUN))
    if found is None:
        search.say("there was no time to find out what can't be met together")
        return ()
    search.say(
        "fewer requirements than these can always be met"
        if found.smallest
        else "without any one of these requirements, the others can be met"
        if found.minimal
        else "there was no time to find out which of these requirements can be spared"
    )
    return found.words


def _cycle(
    problem: RouteProblem, step: Step, limits: SearchLimits, seed: int, clock: Clock
) -> tuple[Step, ...]:
    """The shortest cyclic order of a large round's parts, as a route problem of its own that begins
    and ends at the first part that may be the first."""
    members = sorted(step.visits)
    inner = [r for r in problem.rounds if set(r.members) < step.visits]
    later = {
        visit
        for p in problem.precedences
        for k, visit in enumerate(p.sequence)
        if visit in step.visits and any(v in step.visits for v in p.sequence[:k])
    }
    inside = {visit for r in inner for visit in r.members}
    first = next((v for v in members if v not in later | inside), None)
    if first is None:
        return tuple(step.parts)
    rest = [v for v in members if v != first]
    rows = [*rest, first]
    place = {visit: k for k, visit in enumerate(rest)}
    cycle = RouteProblem(
        tuple(replace(problem.visits[v], mandatory=True) for v in rest),
        np.ascontiguousarray(problem.travel[np.ix_(rows, rows)]),
        tuple(
            replace(p, sequence=tuple(place[v] for v in p.sequence if v in place))
            for p in problem.precedences
        ),
        tuple(replace(r, members=tuple(place[v] for v in r.members)) for r in inner),
        unit=problem.unit,
    )
    share = _ROUNDS / len(problem.rounds)
    seconds, work = (None if one is None else share * one for one in (limits.seconds, limits.work))
    short = SearchLimits(seconds, work, limits.stop)
    best = _searched(cycle, short, seed, 1, clock, Observers()).best
    if best is None:
        return tuple(step.parts)
    visits = [first, *(rest[k] for k in best.tour.order)]
    return tuple(sorted(step.parts, key=lambda part: min(visits.index(v) for v in part.visits)))
