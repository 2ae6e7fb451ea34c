"""Route problems stated for PyVRP, which searches and gives no bounds (extra `route`).

PyVRP (N. Wouda, L. Lan, W. Kool, INFORMS Journal on Computing 2024) is a local search for vehicle
routing. It takes one of our problems as one vehicle that sets off at time 0, with whole numbers
throughout, on one core. It has windows, prizes and a limit to the duration, and neither precedence
other than of pairs, nor rounds, nor a battery.
"""

import warnings
from importlib.util import find_spec

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import Objective, RouteProblem, Tour

_LATEST = 1 << 40
_FAR = 1 << 30
"""A way that there is none of: PyVRP reckons penalties with distances, and NEVER would overflow."""


def why_not(problem: RouteProblem) -> str | None:
    """Why PyVRP can't state the problem; None if it can."""
    if problem.precedences:
        return "precedence"
    if problem.rounds:
        return "rounds"
    if problem.battery is not None:
        return "a battery"
    if any(not visit.mandatory and visit.prize == 0 for visit in problem.visits):
        return "visits without a prize that may be left out"
    return None


def search(problem: RouteProblem, time_limit: float, seed: int) -> Tour | None:
    """The best route that PyVRP finds in that time (s); None: it has found none.

    Raises ArgoError if PyVRP is not installed or can't state the problem.
    """
    if find_spec("pyvrp") is None:
        raise ArgoError("PyVRP is not installed; run: pip install 'argo-mission[route]'")
    if reason := why_not(problem):
        raise ArgoError(f"PyVRP does not know {reason}; leave it out")
    import pyvrp
    import pyvrp.exceptions
    from pyvrp.stop import MaxRuntime

    n = problem.size
    windows = any(visit.earliest or visit.latest is not None for visit in problem.visits)
    times = _times(problem)
    # Where nothing waits, the duration is a distance, in which PyVRP searches better.
    limit = "shift_duration" if windows else "max_distance"
    by_duration = windows and problem.objective == Objective.DURATION
    # A prize that is worth more than any route costs comes before the cost, as it does with us;
    # without the cost, PyVRP wins less.
    worth = _worth(problem, times)
    clients = [
        pyvrp.Client(
            location=k,
            tw_early=visit.earliest,
            tw_late=_LATEST if visit.latest is None else visit.latest,
            required=visit.mandatory,
            prize=visit.prize * worth,
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
        # That no route was found is told by what is returned.
        warnings.simplefilter("ignore", pyvrp.exceptions.PenaltyBoundWarning)
        best = pyvrp.solve(data, MaxRuntime(time_limit), seed, collect_stats=False).best
    if not best.is_feasible():
        return None
    return Tour(tuple(a.idx for route in best.routes() for a in route if a.is_client()))


def _times(problem: RouteProblem) -> NDArray[np.int64]:
    """Travel times, with the service at the place that is left, and the start and the end apart."""
    n = problem.size
    times = np.full((n + 2, n + 2), _FAR, dtype=np.int64)
    from_place = problem.travel[: n + 1] + np.array(
        [[visit.service] for visit in problem.visits] + [[0]]
    )
    times[: n + 1, :n] = from_place[:, :n]
    times[: n + 1, n + 1] = from_place[:, n]
    times = np.minimum(times, _FAR)
    np.fill_diagonal(times, 0)
    return times


def _worth(problem: RouteProblem, times: NDArray[np.int64]) -> int:
    """What one unit of prize is worth in units of cost."""
    if not problem.selective:
        return 1
    if problem.max_duration is not None:
        return problem.max_duration + 1
    return int(np.where(times == _FAR, 0, times).max(axis=1).sum()) + 1
