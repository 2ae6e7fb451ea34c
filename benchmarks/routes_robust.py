"""Gain of robust routes over short ones: `python -m benchmarks.routes_robust`.

First on random problems of six visits, for which all orders can be tried; then on all checkpoints
of UMAD, with optional readings for some maximum durations, and with mandatory ones for some
multiples of the shortest route's duration. Times vary as in `CAUTIOUS`.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from argo_compiler.route import RouteProblem, Tour, Visit, evaluate
from argo_compiler.route.robust import RobustSuggestion, suggest_robust_route
from argo_compiler.route.robust_sampling import Draws, estimate_completion
from argo_compiler.route.robust_spread import CAUTIOUS
from argo_compiler.route.suggestion import suggest_route
from argo_env.planning import open_site
from argo_env.seeding import generator

VISITS = 6
READING = 10.0
"""duration of a reading in s"""
UNIT = 0.1
DRAWS = 10_000


def small_problems(count: int) -> Iterator[RouteProblem]:
    """Yield random problems with a maximum duration 12 % above that of the shortest route.

    Every second one has some time windows.
    """
    for seed in range(count):
        rng = generator(seed, "robust routes")
        points = rng.uniform(0, 300, (VISITS + 1, 2))
        up = np.maximum(points[None, :, 1] - points[:, None, 1], 0.0)
        travel = np.rint(np.abs(points[:, None] - points).sum(axis=2) + 0.7 * up).astype(np.int64)
        visits = [Visit(f"{k}", 20) for k in range(VISITS)]
        problem = RouteProblem(tuple(visits), travel)
        usual = suggest_route(problem, 5.0)
        assert usual.route is not None
        if seed % 2:
            arrivals = evaluate(problem, usual.route).arrivals
            for visit, arrival in zip(usual.order, arrivals, strict=True):
                if rng.random() < 0.5:
                    visits[visit] = replace(visits[visit], latest=int(1.1 * arrival) + 60)
        yield replace(problem, visits=tuple(visits), max_duration=int(1.12 * usual.cost))


def compare_with_all_orders(count: int, time_limit: float) -> None:
    """Print the gain of robust routes in the probability to be in time, and the loss to the best.

    The gain is that over the routes of `suggest_route`, the loss that to the most probable of all
    orders. Travel times are random.
    """
    gains, losses = [], []
    for seed, problem in enumerate(small_problems(count)):
        suggestion = suggest_robust_route(problem, CAUTIOUS, time_limit, seed, confidence=1.0)
        draws = Draws(CAUTIOUS, DRAWS, generator(seed, "all orders"))
        assert suggestion.nominal.route is not None
        usual, robust = (
            estimate_completion(problem, route, draws).probability
            for route in (suggestion.nominal.route, suggestion.route)
        )
        all_orders = [
            estimate_completion(problem, Tour(o), draws) for o in permutations(range(VISITS))
        ]
        gains.append(robust - usual)
        losses.append(max(order.probability for order in all_orders) - robust)
    print(f"{count} problems of {VISITS} mandatory visits, in percentage points:")
    rows = (("more certain than the usual route", gains), ("less than the best order", losses))
    for text, values in rows:
        mean, maximum = 100 * float(np.mean(values)), 100 * max(values)
        print(f"  {text}: {mean:.2f} on average, {maximum:.2f} at most")


def umad_problem() -> RouteProblem:
    """Return the problem of all checkpoints of UMAD in any order, from dock 1 and back to it."""
    navigator = open_site("umad").navigator
    ids = [checkpoint.id for checkpoint in navigator.site.checkpoints]
    times = navigator.travel_times([*ids, navigator.site.docks[1]])
    visits = tuple(Visit(f"checkpoint {id}", round(READING / UNIT)) for id in ids)
    return RouteProblem(visits, np.rint(times / UNIT).astype(np.int64), unit=UNIT)


def _result_text(suggestion: RobustSuggestion) -> str:
    usual, robust = suggestion.nominal_completion, suggestion.completion
    return (
        f"usual {len(suggestion.nominal.order)} readings, completed by "
        f"{100 * usual.probability:.1f} %; robust {len(suggestion.route.order)}, by "
        f"{100 * robust.probability:.1f} % ({suggestion.tried} routes compared)"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the results of both parts."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--problems", type=int, default=20, help="number of random problems")
    parser.add_argument(
        "--minutes", nargs="*", type=float, default=(10, 15, 20), help="maximum durations on UMAD"
    )
    parser.add_argument(
        "--shares",
        nargs="*",
        type=float,
        default=(1.02, 1.05, 1.1, 1.2),
        help="multiples of the shortest duration",
    )
    parser.add_argument("--time-limit", type=float, default=30.0, help="seconds of each search")
    options = parser.parse_args(arguments)
    compare_with_all_orders(options.problems, options.time_limit)
    problem = umad_problem()
    optional = tuple(replace(visit, mandatory=False, prize=1) for visit in problem.visits)
    print(f"UMAD, {problem.size} checkpoints, {READING:g} s each:")
    for minutes in options.minutes:
        limited = replace(problem, visits=optional, max_duration=round(minutes * 60 / UNIT))
        suggestion = suggest_robust_route(limited, CAUTIOUS, options.time_limit)
        print(f"  {minutes:g} min: {_result_text(suggestion)}", flush=True)
    shortest = suggest_route(problem, options.time_limit).cost
    for share in options.shares:
        limited = replace(problem, max_duration=int(share * shortest))
        suggestion = suggest_robust_route(limited, CAUTIOUS, options.time_limit, confidence=1.0)
        print(
            f"  {share:g} times the shortest, nothing left out: {_result_text(suggestion)}",
            flush=True,
        )


if __name__ == "__main__":
    main()
