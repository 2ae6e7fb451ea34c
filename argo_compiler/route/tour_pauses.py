"""Where a route waits or charges, and for how long."""

from dataclasses import dataclass, replace

from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import RouteProblem, Tour


@dataclass(frozen=True)
class TourPause:
    """Something that a route does between two visits."""

    duration: int
    """in the problem's units"""
    visit: int | None = None
    """the one that is waited for"""
    charger: int | None = None
    """where the robot is charged; None: it waits"""


def pauses(problem: RouteProblem, route: Tour) -> dict[int, tuple[TourPause, ...]]:
    """By the position in the order before which they are made; that of the end is its length."""
    found: dict[int, tuple[TourPause, ...]] = {}
    for k in range(len(route.order) + 1):
        here = []
        if k in route.charges:
            duration = _charging(problem, route, k)
            here.append(TourPause(duration, charger=route.charges[k]))
        if k < len(route.order) and problem.visits[route.order[k]].earliest:
            before, after = _part(route, k, k), _part(route, k + 1, k)
            waiting = evaluate(problem, after).waiting - evaluate(problem, before).waiting
            if waiting:
                here.append(TourPause(waiting, visit=route.order[k]))
        if here:
            found[k] = tuple(here)
    return found


def _part(route: Tour, visits: int, charges: int) -> Tour:
    """The first visits, with the charges up to a position."""
    kept = {k: charger for k, charger in route.charges.items() if k <= charges}
    return Tour(route.order[:visits], kept)


def _charging(problem: RouteProblem, route: Tour, position: int) -> int:
    """What a charge takes without the ways there and on: those to chargers and to the end are
    reckoned as none."""
    travel = problem.travel.copy()
    travel[:, problem.end :] = 0
    free = replace(problem, travel=travel)
    with_it, without = _part(route, position, position), _part(route, position, position - 1)
    return evaluate(free, with_it).duration - evaluate(free, without).duration
