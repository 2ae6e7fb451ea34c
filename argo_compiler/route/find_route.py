"""Pipeline from a problem to a suggestion: modes, pruning, bounds, the portfolio, explanations."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf

import numpy as np

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message
from argo_compiler.route.assignment import assignment_time_bound
from argo_compiler.route.infeasible_subset import find_infeasible_subset
from argo_compiler.route.modes import Step
from argo_compiler.route.network import build_network
from argo_compiler.route.portfolio import solve
from argo_compiler.route.problem import NEVER, Objective, RouteProblem
from argo_compiler.route.pruning import horizon_without_limit, prune
from argo_compiler.route.search import Observers, Search, SearchLimits
from argo_compiler.route.solvers import RouteSolver
from argo_compiler.route.stop import FirstFeasible
from argo_compiler.route.suggested import RouteSuggestion

_CHECK_TIME = 2.0
"""limit of one check of whether some requirements can be met together, in s"""
_CHECK_START = 0.3
"""longest time until a check reads the clock, in s"""
_ROUNDS_SHARE = 0.2
"""share of the time in which the modes of rounds are computed"""

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
    """Search for the best route, as `argo_compiler.route.suggestion.suggest_route` does."""
    begun = clock()
    search = _run_search(problem, limits, seed, workers, clock, observers, solvers)
    words: tuple[str, ...] = ()
    if explain and search.infeasible:
        words = _explain(problem, search, limits, begun, clock)
    best = search.best
    return RouteSuggestion(
        route=None if best is None else best.tour,
        prize=None if best is None else best.prize,
        prize_bound=search.prize_bound,
        cost=None if best is None else best.cost,
        bound=search.bound,
        proven=best is not None and search.proven,
        infeasible=best is None and search.infeasible,
        dropped=None if best is None else best.tour.left_out(problem.size),
        infeasible_subset=words,
        method=search.proving_or_finding_solver,
        reasons=search.reasons,
        history=search.history,
        turns=search.turns,
    )


def _run_search(
    problem: RouteProblem,
    limits: SearchLimits,
    seed: int,
    workers: int,
    clock: Clock,
    observers: Observers,
    solvers: Sequence[str | RouteSolver] | None = None,
) -> Search:
    begun = clock()

    def cyclic_order(step: Step) -> tuple[Step, ...]:
        return _shortest_cycle(problem, step, limits, seed, clock)

    seconds = inf if limits.seconds is None else limits.seconds
    net = build_network(problem, cyclic_order, lambda: clock() - begun > _ROUNDS_SHARE * seconds)
    if horizon_without_limit(net) >= NEVER // 2:
        raise Invalid(
            "the times of this route problem are too long to be added up: use a larger unit"
        )
    search = Search(net, prune(net), limits, seed, clock, observers, begun)
    if not net.exact:
        search.add_reason(
            Message("rounds have too many orders to check all of them: nothing is proven")
        )
    bound = assignment_time_bound(net, search.pruned)
    if bound is None:
        search.add_reason(Message("some visit can't be made at all, or not in the required order"))
        with search.turn_of("pruning") as turn:
            turn.report_infeasible()
        return search
    with search.turn_of("assignment") as turn:
        turn.report_bounds(prize_bound=int(net.prize[search.pruned.steps].sum()))
        turn.report_bounds(bound=None if net.objective is Objective.PRIZE else bound)
    solve(search, workers, solvers)
    return search


def _explain(
    problem: RouteProblem, search: Search, limits: SearchLimits, begun: float, clock: Clock
) -> tuple[str, ...]:
    """Return requirements that cannot all be met, in the mission's words.

    The search for them ends with the remaining time; returns () if that is too short for any
    result. Adds a reason to the search that states how good the explanation is.
    """
    longest_check = 0.0

    def remaining() -> float:
        return inf if limits.seconds is None else limits.seconds - (clock() - begun)

    def is_feasible(part: RouteProblem) -> bool | None:
        nonlocal longest_check
        seconds = None if limits.seconds is None else max(remaining(), 1e-3)
        check_begun = clock()
        if limits.work is None:
            short = SearchLimits(min(_CHECK_TIME, seconds or _CHECK_TIME), None, FirstFeasible())
        else:
            short = SearchLimits(seconds, _CHECK_TIME, FirstFeasible())
        check = _run_search(part, short, search.seed, 1, clock, Observers())
        longest_check = max(longest_check, clock() - check_begun)
        return True if check.best is not None else False if check.infeasible else None

    subset = find_infeasible_subset(
        problem, is_feasible, lambda: remaining() <= min(longest_check, _CHECK_START)
    )
    if subset is None:
        search.add_reason(
            Message("there was no time to find requirements that can't be met together")
        )
        return ()
    search.add_reason(
        Message("fewer requirements than these can always be met")
        if subset.smallest
        else Message("without any one of these requirements, the others can be met")
        if subset.minimal
        else Message(
            "there was no time to check whether fewer of these requirements can't be met either"
        )
    )
    return subset.words


def _shortest_cycle(
    problem: RouteProblem, step: Step, limits: SearchLimits, seed: int, clock: Clock
) -> tuple[Step, ...]:
    """Search for the shortest cyclic order of a large round's parts: its members and inner rounds.

    It is a route problem of its own, which starts and ends at the first visit that may come first.
    If there is no such visit, or no route is found, the parts keep their order.
    """
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
    new_number = {visit: k for k, visit in enumerate(rest)}
    cycle = RouteProblem(
        tuple(replace(problem.visits[v], mandatory=True) for v in rest),
        np.ascontiguousarray(problem.travel[np.ix_(rows, rows)]),
        tuple(
            replace(p, sequence=tuple(new_number[v] for v in p.sequence if v in new_number))
            for p in problem.precedences
        ),
        tuple(replace(r, members=tuple(new_number[v] for v in r.members)) for r in inner),
        unit=problem.unit,
    )
    share = _ROUNDS_SHARE / len(problem.rounds)
    seconds, work = (
        None if limit is None else share * limit for limit in (limits.seconds, limits.work)
    )
    short = SearchLimits(seconds, work, limits.stop)
    best = _run_search(cycle, short, seed, 1, clock, Observers()).best
    if best is None:
        return tuple(step.parts)
    visits = [first, *(rest[k] for k in best.tour.order)]
    return tuple(sorted(step.parts, key=lambda part: min(visits.index(v) for v in part.visits)))
