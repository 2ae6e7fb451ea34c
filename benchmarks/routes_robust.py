"""What is gained by sure routes instead of short ones: `python -m benchmarks.routes_robust`.

First on random problems of six visits, where all orders can be tried, then on all checkpoints of
UMAD: with readings that may be left out for some maximum durations, and with none left out for some
shares of what the shortest route takes. Times spread as in `CAUTIOUS`.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations

import numpy as np

from argo_compiler.route import RouteProblem, Tour, Visit, evaluate
from argo_compiler.route.robust import RobustSuggestion, suggest_robust_route
from argo_compiler.route.robust_sampling import Draws, completion
from argo_compiler.route.robust_spread import CAUTIOUS
from argo_compiler.route.suggestion import suggest_route
from argo_env.planning import open_site
from argo_env.seeding import generator

VISITS = 6
READING = 10.0
"""s that a reading takes"""
UNIT = 0.1
JUDGED = 10_000


def small_problems(count: int) -> Iterator[RouteProblem]:
    """Random ones, every second with some time windows, that leave 12 % more time than the shortest
    route takes."""
    for seed in range(count):
        rng = generator(seed, "robust routes")
        at = rng.uniform(0, 300, (VISITS + 1, 2))
        up = np.maximum(at[None, :, 1] - at[:, None, 1], 0.0)
        travel = np.rint(np.abs(at[:, None] - at).sum(axis=2) + 0.7 * up).astype(np.int64)
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
    """Prints how much surer the routes are than the usual ones, and how much less sure than the
    surest order."""
    gained, missed = [], []
    for seed, problem in enumerate(small_problems(count)):
        found = suggest_robust_route(problem, CAUTIOUS, time_limit, seed, confidence=1.0)
        draws = Draws(CAUTIOUS, JUDGED, generator(seed, "all orders"))
        assert found.nominal.route is not None
        usual, sure = (
            completion(problem, route, draws).probability
            for route in (found.nominal.route, found.route)
        )
        every = [completion(problem, Tour(o), draws) for o in permutations(range(VISITS))]
        gained.append(sure - usual)
        missed.append(max(one.probability for one in every) - sure)
    print(f"{count} problems of {VISITS} visits that all have to be made, in percentage points:")
    for what, values in (("surer than the usual route", gained), ("below the surest", missed)):
        mean, most = 100 * float(np.mean(values)), 100 * max(values)
        print(f"  {what}: {mean:.2f} on average, {most:.2f} at most")


def umad() -> RouteProblem:
    """All checkpoints of UMAD in any order, from dock 1 back to it."""
    navigator = open_site("umad").navigator
    ids = [checkpoint.id for checkpoint in navigator.site.checkpoints]
    times = navigator.travel_times([*ids, navigator.site.docks[1]])
    visits = tuple(Visit(f"checkpoint {id}", round(READING / UNIT)) for id in ids)
    return RouteProblem(visits, np.rint(times / UNIT).astype(np.int64), unit=UNIT)


def _said(found: RobustSuggestion) -> str:
    usual = len(found.nominal.order)
    return (
        f"usual {usual} readings, completed by {100 * found.nominal_completion.probability:.1f} %; "
        f"sure {len(found.route.order)}, by {100 * found.completion.probability:.1f} % "
        f"({found.tried} routes compared)"
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Print all of it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--problems", type=int, default=20, help="random ones")
    parser.add_argument("--minutes", nargs="*", type=float, default=(10, 15, 20), help="on UMAD")
    parser.add_argument("--shares", nargs="*", type=float, default=(1.02, 1.05, 1.1, 1.2))
    parser.add_argument("--time-limit", type=float, default=30.0, help="s of each search")
    given = parser.parse_args(arguments)
    compare_with_all_orders(given.problems, given.time_limit)
    problem = umad()
    optional = tuple(replace(visit, mandatory=False, prize=1) for visit in problem.visits)
    print(f"UMAD, {problem.size} checkpoints, {READING:g} s each:")
    for minutes in given.minutes:
        limited = replace(problem, visits=optional, max_duration=round(minutes * 60 / UNIT))
        found = suggest_robust_route(limited, CAUTIOUS, given.time_limit)
        print(f"  {minutes:g} min: {_said(found)}", flush=True)
    shortest = suggest_route(problem, given.time_limit).cost
    for share in given.shares:
        limited = replace(problem, max_duration=int(share * shortest))
        found = suggest_robust_route(limited, CAUTIOUS, given.time_limit, confidence=1.0)
        print(f"  {share:g} times the shortest, nothing left out: {_said(found)}", flush=True)


if __name__ == "__main__":
    main()
