"""Pauses of a route: the waits and charges between its visits."""

from dataclasses import dataclass, replace

from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import RouteProblem, Tour


@dataclass(frozen=True)
class TourPause:
    """Wait or charge of a route between two visits."""

    duration: int
    """duration in the problem's units"""
    visit: int | None = None
    """visit whose time window the robot waits for; None: it charges"""
    charger: int | None = None
    """number of the charger; None: the robot waits"""


def pauses_by_position(problem: RouteProblem, route: Tour) -> dict[int, tuple[TourPause, ...]]:
    """Return a route's pauses by the position in its order before which they take place.

    The position of pauses before the end is the length of the order.
    """
    pauses_by_position: dict[int, tuple[TourPause, ...]] = {}
    for k in range(len(route.order) + 1):
        here = []
        if k in route.charges:
            duration = _charging_time(problem, route, k)
            here.append(TourPause(duration, charger=route.charges[k]))
        if k < len(route.order) and problem.visits[route.order[k]].earliest:
            before, after = _prefix(route, k, k), _prefix(route, k + 1, k)
            waiting = evaluate(problem, after).waiting - evaluate(problem, before).waiting
            if waiting:
                here.append(TourPause(waiting, visit=route.order[k]))
        if here:
            pauses_by_position[k] = tuple(here)
    return pauses_by_position


def _prefix(route: Tour, visit_count: int, last_charge: int) -> Tour:
    """Return a route's first `visit_count` visits, and its charges up to position `last_charge`."""
    charges = {k: charger for k, charger in route.charges.items() if k <= last_charge}
    return Tour(route.order[:visit_count], charges)


def _charging_time(problem: RouteProblem, route: Tour, position: int) -> int:
    """Return the duration of a charge, without the drives to the charger and onward.

    It is the difference that the charge makes to the duration of the route up to `position`, if
    drives to chargers and to the end take no time.
    """
    travel = problem.travel.copy()
    travel[:, problem.end :] = 0
    free = replace(problem, travel=travel)
    charged, uncharged = _prefix(route, position, position), _prefix(route, position, position - 1)
    return evaluate(free, charged).duration - evaluate(free, uncharged).duration
