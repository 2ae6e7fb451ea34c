"""From a problem to a suggestion: modes, pruning, bounds, the portfolio; why there is none."""

import time
from dataclasses import replace

import numpy as np

from argo_compiler.errors import Invalid
from argo_compiler.route.assignment import assignment_bound
from argo_compiler.route.infeasible_subset import find_infeasible_subset
from argo_compiler.route.modes import Step
from argo_compiler.route.network import StepNetwork, network
from argo_compiler.route.portfolio import solve
from argo_compiler.route.problem import NEVER, Objective, RouteProblem
from argo_compiler.route.pruning import longest, prune
from argo_compiler.route.ruin_recreate import LocalSearch
from argo_compiler.route.search import Search
from argo_compiler.route.solution import Solution, no_solution
from argo_compiler.route.suggestion import RouteSuggestion

_CHECK = 2.0
"""s for one check of whether some requirements can be met together"""


def find_route(
    problem: RouteProblem, time_limit: float, seed: int, workers: int, *, explain: bool
) -> RouteSuggestion:
    """See `argo_compiler.route.suggestion.suggest_route`."""
    net, search, best, method = _solved(problem, time_limit, seed, workers)
    infeasible_subset: tuple[str, ...] = ()
    if explain and best.path is None and best.proven:
        found = find_infeasible_subset(problem, lambda part: _possible(part, seed))
        if found is not None:
            infeasible_subset = found.words
            search.say(
                "fewer requirements than these can always be met"
                if found.smallest
                else "without any one of these requirements, the others can be met"
            )
    route = None if best.path is None else net.route(best.path, dict(best.charges))
    made = set() if route is None else set(route.order)
    return RouteSuggestion(
        route,
        best.prize,
        best.prize_bound,
        best.cost,
        best.bound,
        best.proven,
        () if route is None else tuple(v for v in range(problem.size) if v not in made),
        infeasible_subset,
        method,
        tuple(search.reasons),
        tuple(search.history),
    )


def _solved(
    problem: RouteProblem, time_limit: float, seed: int, workers: int
) -> tuple[StepNetwork, Search, Solution, str]:
    begun = time.perf_counter()
    most = sum(visit.prize for visit in problem.visits)
    deadline = begun + time_limit
    search = Search(time.perf_counter, deadline, seed, workers, most, begun=begun)

    def order_of(step: Step) -> tuple[Step, ...]:
        return _cycle(problem, step, time_limit / 4, seed)

    net = network(problem, order_of)
    search.certain = net.exact
    if not net.exact:
        search.say("a round has too many members to weigh all of their orders: nothing is proven")
    if longest(net) >= NEVER // 2:
        raise Invalid(
            "the times of this route problem are too long to be added up: take a greater unit"
        )
    pruned = prune(net)
    bound = assignment_bound(net, pruned)
    if bound is None:
        search.say("some step can't be made at all, or not in an order that is asked for")
        return net, search, no_solution(net, proven=net.exact), "pruning"
    if net.objective is not Objective.PRIZE:
        search.known(bound=bound)
    best, method = solve(net, pruned, search)
    if not net.exact:
        best = replace(best, prize_bound=most, bound=0, proven=False)
    return net, search, best, method


def _cycle(problem: RouteProblem, step: Step, time_limit: float, seed: int) -> tuple[Step, ...]:
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
    order = find_route(cycle, time_limit, seed, 1, explain=False).order
    visits = [first, *(rest[k] for k in order)]
    if len(visits) < len(members):
        return tuple(step.parts)
    return tuple(sorted(step.parts, key=lambda part: min(visits.index(v) for v in part.visits)))


def _possible(problem: RouteProblem, seed: int) -> bool | None:
    """Whether a problem has a route; None: that was not found out."""
    begun = time.perf_counter()
    search = Search(time.perf_counter, begun + _CHECK, seed, 1, 0, begun=begun)
    net = network(problem, lambda step: tuple(step.parts))
    pruned = prune(net)
    if assignment_bound(net, pruned) is None:
        return False if net.exact else None
    if LocalSearch(net, pruned, seed).first(lambda: False) is not None:
        return True
    best, _ = solve(net, pruned, search)
    if best.path is not None:
        return True
    return False if best.proven and net.exact else None
