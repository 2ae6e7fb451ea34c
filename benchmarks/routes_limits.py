"""Excess of route searches over their time limits.

    python -m benchmarks.routes_limits
    python -m benchmarks.routes_limits --sizes 20 1000 --limits 0.5 2 --workers 2

Prints for random problems of each size and kind by how much the search exceeded its time limit,
whether it found a route, and whether it kept the requirement: an excess of at most a tenth of the
limit plus 0.2 s. Nothing else should run on the machine.
"""

import argparse
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from argo_compiler.route import (
    EnergyBudget,
    Precedence,
    Round,
    RouteProblem,
    Visit,
    evaluate,
    suggest_route,
)

AddRules = Callable[[RouteProblem, np.random.Generator], RouteProblem]
"""Function that returns a problem with further constraints, drawn from the generator."""


def random_problem(count: int, rng: np.random.Generator) -> RouteProblem:
    """Return a problem without constraints: visits of 30 s each, at random in a square.

    The sides of the square take 1,000 s to travel.
    """
    points = rng.integers(0, 1000, (count + 3, 2))
    travel = np.abs(points[:, None] - points).sum(axis=2).astype(np.int64)
    visits = tuple(Visit(f"checkpoint {k}", 30, prize=1) for k in range(count))
    return RouteProblem(visits, travel[: count + 1, : count + 1].copy())


def _add_prizes(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Make visits optional, with prizes of which about half can be won."""
    prizes = rng.integers(1, 10, problem.size).tolist()
    visits = tuple(
        replace(visit, mandatory=False, prize=prize)
        for visit, prize in zip(problem.visits, prizes, strict=True)
    )
    limit = int(0.5 * 30 * problem.size + 400 * np.sqrt(problem.size))
    return replace(problem, visits=visits, max_duration=limit)


def _add_precedences(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Add precedences of pairs, at most half as many as there are visits."""
    order = rng.permutation(problem.size)
    pairs = [sorted(rng.integers(0, problem.size, 2).tolist()) for _ in range(problem.size // 2)]
    return replace(
        problem,
        precedences=tuple(
            Precedence((int(order[a]), int(order[b])), f"{a} before {b}") for a, b in pairs if a < b
        ),
    )


def _add_windows(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Add windows of 1,200 s around the times of a random route."""
    order = rng.permutation(problem.size).tolist()
    begins, now, at = {}, 0, problem.size
    for visit in order:
        now += int(problem.travel[at, visit])
        begins[visit], at = now, visit
        now += 30
    visits = tuple(
        replace(visit, earliest=max(0, begins[k] - 600), latest=begins[k] + 600)
        for k, visit in enumerate(problem.visits)
    )
    return replace(problem, visits=visits)


def _add_battery(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Add a battery that must be recharged several times, and two chargers."""
    n = problem.size
    to_visits = rng.integers(0, 1000, (2, n + 1)).astype(np.int64)
    travel = np.zeros((n + 3, n + 3), np.int64)
    travel[: n + 1, : n + 1] = problem.travel
    travel[n + 1 :, : n + 1], travel[: n + 1, n + 1 :] = to_visits, to_visits.T
    battery = EnergyBudget(travel // 2, capacity=4000, overhead=60)
    return replace(problem, travel=travel, battery=battery, chargers=("dock 1", "dock 2"))


def _add_rounds(problem: RouteProblem, _rng: np.random.Generator) -> RouteProblem:
    """Add rounds with a maximum duration, of five visits each, for the first half of the visits."""
    starts = range(0, problem.size // 2 - 4, 5)
    rounds = tuple(
        Round(f"round {k}", tuple(range(k, k + 5)), repeat=0, duration=600, soft=k % 2 == 0)
        for k in starts
    )
    return replace(problem, rounds=rounds)


KINDS: dict[str, AddRules] = {
    "plain": lambda problem, _: problem,
    "optional": _add_prizes,
    "order": _add_precedences,
    "windows": _add_windows,
    "battery": _add_battery,
    "rounds": _add_rounds,
}


def measure_overrun_and_feasibility(
    sizes: list[int], limits: list[float], workers: int
) -> Iterator[tuple[int, str, float, float, bool]]:
    """Yield size, kind, limit (s), time beyond it (s), and whether a feasible route was found."""
    suggest_route(random_problem(3, np.random.default_rng(0)))  # imports the libraries
    for size in sizes:
        for name, kind in KINDS.items():
            rng = np.random.default_rng(size)
            problem = kind(random_problem(size, rng), rng)
            for limit in limits:
                begun = time.perf_counter()
                suggestion = suggest_route(problem, limit, workers=workers)
                beyond = time.perf_counter() - begun - limit
                route = suggestion.route
                feasible = route is not None and evaluate(problem, route).feasible
                yield size, name, limit, beyond, feasible


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.routes_limits")
    parser.add_argument("--sizes", type=int, nargs="+", default=[20, 100, 400, 1000], help="visits")
    parser.add_argument(
        "--limits", type=float, nargs="+", default=[0.5, 1.0, 2.0, 5.0], help="seconds"
    )
    parser.add_argument("--workers", type=int, default=1, help="processes")
    options = parser.parse_args(arguments)
    print("| visits | kind | limit | beyond it | route | kept |\n|---|---|---|---|---|---|")
    for size, name, limit, beyond, feasible in measure_overrun_and_feasibility(
        options.sizes, options.limits, options.workers
    ):
        kept = "yes" if beyond <= 0.1 * limit + 0.2 else "no"
        route = "yes" if feasible else "no"
        print(f"| {size} | {name} | {limit:g} s | {max(0.0, beyond):.2f} s | {route} | {kept} |")


if __name__ == "__main__":
    main()
