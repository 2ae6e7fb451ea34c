"""Search for routes with PyVRP (extra `route`), which gives no bounds.

PyVRP (N. Wouda, L. Lan, W. Kool, INFORMS Journal on Computing 2024) is a local search for vehicle
routing. It gets a route problem as that of one vehicle that departs at time 0, in whole numbers,
and runs on one core. It supports windows, prizes and a maximum duration; it does not support
precedence other than of pairs, rounds, or a battery.
"""

import warnings
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import Objective, RouteProblem, Tour

_LATEST = 1 << 40
_FAR = 1 << 30
"""distance of a missing connection; NEVER would overflow in PyVRP's penalties"""


def unsupported_feature(problem: RouteProblem) -> str | None:
    """Return a feature of the problem that PyVRP does not support; None: it supports all."""
    if problem.precedences:
        return "precedence"
    if problem.rounds:
        return "rounds"
    if problem.battery is not None:
        return "a battery"
    if any(not visit.mandatory and visit.prize == 0 for visit in problem.visits):
        return "optional visits without a prize"
    return None


def search_with_pyvrp(problem: RouteProblem, time_limit: float, seed: int) -> Tour | None:
    """Return the best route that PyVRP finds within the time limit (s); None: no feasible one.

    Raises:
        ArgoError: PyVRP is not installed, or does not support the problem.
    """
    if find_spec("pyvrp") is None:
        raise ArgoError("PyVRP is not installed; run: pip install 'argo-mission[route]'")
    if feature := unsupported_feature(problem):
        raise ArgoError(f"PyVRP does not support {feature}; leave it out")
    import pyvrp
    import pyvrp.exceptions
    from pyvrp.stop import MaxRuntime

    n = problem.size
    windows = any(visit.earliest or visit.latest is not None for visit in problem.visits)
    times = _times_with_service(problem)
    # Without waiting, the duration is a distance, for which PyVRP searches better.
    limit = "shift_duration" if windows else "max_distance"
    by_duration = windows and problem.objective == Objective.DURATION
    # A prize that is worth more than any route costs has priority over the cost, as in Argo. If the
    # cost is left out altogether, PyVRP finds less prize.
    prize_value = _prize_value(problem, times)
    clients = [
        pyvrp.Client(
            location=k,
            tw_early=visit.earliest,
            tw_late=_LATEST if visit.latest is None else visit.latest,
            required=visit.mandatory,
            prize=visit.prize * prize_value,
        )
        for k, visit in enumerate(problem.visits)
    ]
    vehicle = pyvrp.VehicleType(
        start_depot=0,
        end_depot=1,
        start_late=0,
        unit_distance_cost=0 if by_duration else 1,
        unit_duration_cost=1 if by_duration else 0,
        **({} if problem.max_duration is None else {limit: problem.max_duration}),
    )
    data = pyvrp.ProblemData(
        locations=[pyvrp.Location(0, 0) for _ in range(n + 2)],
        clients=clients,
        depots=[pyvrp.Depot(location=n), pyvrp.Depot(location=n + 1)],
        vehicle_types=[vehicle],
        distance_matrices=[times],
        duration_matrices=[times if windows else np.zeros_like(times)],
    )
    with warnings.catch_warnings():
        # The warning says that no feasible route was found, which the return value states too.
        warnings.simplefilter("ignore", pyvrp.exceptions.PenaltyBoundWarning)
        best = pyvrp.solve(data, MaxRuntime(time_limit), seed, collect_stats=False).best
    if not best.is_feasible():
        return None
    return Tour(tuple(a.idx for route in best.routes() for a in route if a.is_client()))


def _times_with_service(problem: RouteProblem) -> NDArray[np.int64]:
    """Return travel times plus the service at the location that is left, shape (n + 2, n + 2).

    The last two rows and columns are those of the start and of the end.
    """
    n = problem.size
    times = np.full((n + 2, n + 2), _FAR, dtype=np.int64)
    with_service = problem.travel[: n + 1] + np.array(
        [[visit.service] for visit in problem.visits] + [[0]]
    )
    times[: n + 1, :n] = with_service[:, :n]
    times[: n + 1, n + 1] = with_service[:, n]
    times = np.minimum(times, _FAR)
    np.fill_diagonal(times, 0)
    return times


def _prize_value(problem: RouteProblem, times: NDArray[np.int64]) -> int:
    """Return a cost that one unit of prize is worth, above that of any route; 1 without prizes."""
    if not problem.selective:
        return 1
    if problem.max_duration is not None:
        return problem.max_duration + 1
    return int(np.where(times == _FAR, 0, times).max(axis=1).sum()) + 1
