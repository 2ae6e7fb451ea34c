"""Whether searches keep to their limits, and have a route by then.

    python -m benchmarks.routes_limits
    python -m benchmarks.routes_limits --sizes 20 1000 --limits 0.5 2 --workers 2

Prints for problems of each size and kind, made from random places, how long the search took beyond
its limit, what share of the limit that is, and whether it had a route. Nothing else should run on
the machine. It is asked for that nothing takes longer than a tenth of its limit and 0.2 s.
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

Kind = Callable[[RouteProblem, np.random.Generator], RouteProblem]


def places(count: int, rng: np.random.Generator) -> RouteProblem:
    """Visits of 30 s anywhere in a square of 1,000 s; two chargers, which no battery needs."""
    there = rng.integers(0, 1000, (count + 3, 2))
    travel = np.abs(there[:, None] - there).sum(axis=2).astype(np.int64)
    visits = tuple(Visit(f"checkpoint {k}", 30, prize=1) for k in range(count))
    return RouteProblem(visits, travel[: count + 1, : count + 1].copy())


def _optional(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Prizes, of which about half can be won."""
    prizes = rng.integers(1, 10, problem.size).tolist()
    visits = tuple(
        replace(visit, mandatory=False, prize=prize)
        for visit, prize in zip(problem.visits, prizes, strict=True)
    )
    limit = int(0.5 * 30 * problem.size + 400 * np.sqrt(problem.size))
    return replace(problem, visits=visits, max_duration=limit)


def _ordered(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Half as many pairs in order as there are visits."""
    order = rng.permutation(problem.size)
    pairs = [sorted(rng.integers(0, problem.size, 2).tolist()) for _ in range(problem.size // 2)]
    return replace(
        problem,
        precedences=tuple(
            Precedence((int(order[a]), int(order[b])), f"{a} before {b}") for a, b in pairs if a < b
        ),
    )


def _windowed(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """Windows around the times of a random route."""
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


def _charged(problem: RouteProblem, rng: np.random.Generator) -> RouteProblem:
    """A battery that has to be charged now and then."""
    n = problem.size
    there = rng.integers(0, 1000, (2, n + 1)).astype(np.int64)
    travel = np.zeros((n + 3, n + 3), np.int64)
    travel[: n + 1, : n + 1] = problem.travel
    travel[n + 1 :, : n + 1], travel[: n + 1, n + 1 :] = there, there.T
    battery = EnergyBudget(travel // 2, capacity=4000, overhead=60)
    return replace(problem, travel=travel, battery=battery, chargers=("dock 1", "dock 2"))


def _rounds(problem: RouteProblem, _rng: np.random.Generator) -> RouteProblem:
    """Rounds of five with a time, over half of the visits."""
    starts = range(0, problem.size // 2 - 4, 5)
    rounds = tuple(
        Round(f"round {k}", tuple(range(k, k + 5)), repeat=0, duration=600, soft=k % 2 == 0)
        for k in starts
    )
    return replace(problem, rounds=rounds)


KINDS: dict[str, Kind] = {
    "plain": lambda problem, _: problem,
    "optional": _optional,
    "order": _ordered,
    "windows": _windowed,
    "battery": _charged,
    "rounds": _rounds,
}


def rows(
    sizes: list[int], limits: list[float], workers: int
) -> Iterator[tuple[int, str, float, float, bool]]:
    """Size, kind, limit (s), time beyond it (s) and whether there is a route."""
    suggest_route(places(3, np.random.default_rng(0)))  # libraries are imported now
    for size in sizes:
        for name, kind in KINDS.items():
            rng = np.random.default_rng(size)
            problem = kind(places(size, rng), rng)
            for limit in limits:
                begun = time.perf_counter()
                made = suggest_route(problem, limit, workers=workers)
                beyond = time.perf_counter() - begun - limit
                there = made.route is not None and evaluate(problem, made.route).feasible
                yield size, name, limit, beyond, there


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.routes_limits")
    parser.add_argument("--sizes", type=int, nargs="+", default=[20, 100, 400, 1000])
    parser.add_argument("--limits", type=float, nargs="+", default=[0.5, 1.0, 2.0, 5.0], help="s")
    parser.add_argument("--workers", type=int, default=1)
    given = parser.parse_args(arguments)
    print("| visits | kind | limit | beyond it | route | kept |\n|---|---|---|---|---|---|")
    for size, name, limit, beyond, there in rows(given.sizes, given.limits, given.workers):
        kept = "yes" if beyond <= 0.1 * limit + 0.2 else "no"
        route = "yes" if there else "no"
        print(f"| {size} | {name} | {limit:g} s | {max(0.0, beyond):.2f} s | {route} | {kept} |")


if __name__ == "__main__":
    main()
