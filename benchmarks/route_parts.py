"""Gain of each part of the route search, a solver: `python -m benchmarks.route_parts`.

    python -m benchmarks.route_parts --only PyVRP --problems windows optional --count 8
    python -m benchmarks.route_parts --folder FOLDER --time-limit 10 --alone

Solves each problem with all parts, and with all but one, on one worker. The problems are random
ones of the kinds of `benchmarks.routes_limits`, or those in a folder that `benchmarks.routes`
reads. Prints for each part how often the route is worse without it and how often better, the lost
share of the prize and of the cost, and the number of lost proofs and of lost routes. With `--alone`
it prints the same for each part on its own, with only `solvers.FIRST`, the first rules, before it.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from argo_compiler.route import RouteProblem, RouteSuggestion, suggest_route
from argo_compiler.route.solvers import FIRST, all_solver_names
from benchmarks.instances import read_published_problem
from benchmarks.options import parse_seed
from benchmarks.routes import find_files
from benchmarks.routes_limits import KINDS, random_problem


@dataclass(frozen=True)
class Gain:
    """Results of a problem with and without a part of the route search, which is one solver."""

    with_it: RouteSuggestion
    without: RouteSuggestion

    @property
    def sign(self) -> int:
        """1 if the route is better with the part than without it, -1 if worse, 0 if as good.

        Any route is better than none, then a higher prize counts, then a lower cost.
        """
        with_it, without = _quality(self.with_it), _quality(self.without)
        return (with_it > without) - (with_it < without)

    @property
    def lost_prize_share(self) -> float:
        """Share of the prize with the part that is lost without it; negative if more is won."""
        with_it, without = self.with_it.prize or 0, self.without.prize or 0
        return (with_it - without) / max(1, with_it)

    @property
    def relative_cost_increase(self) -> float:
        """Relative increase of the cost without the part; 0 without routes of equal prize."""
        if self.with_it.cost is None or self.without.cost is None or self.lost_prize_share:
            return 0.0
        return (self.without.cost - self.with_it.cost) / max(1, self.with_it.cost)


def _quality(suggestion: RouteSuggestion) -> tuple[bool, int, int]:
    return suggestion.route is not None, suggestion.prize or 0, -(suggestion.cost or 0)


def _is_decided(suggestion: RouteSuggestion) -> bool:
    return suggestion.proven or suggestion.infeasible


def summary_line(part: str, gains: Sequence[Gain]) -> str:
    """Return the line of the table for a part of the route search."""
    lost = sum(_is_decided(g.with_it) for g in gains) - sum(_is_decided(g.without) for g in gains)
    missing = sum(g.with_it.route is not None for g in gains) - sum(
        g.without.route is not None for g in gains
    )
    prize, cost = np.mean([(g.lost_prize_share, g.relative_cost_increase) for g in gains], axis=0)
    return (
        f"{part:<22}{sum(g.sign > 0 for g in gains):>6}{sum(g.sign < 0 for g in gains):>8}"
        f"{100 * prize:>9.2f} %{100 * cost:>9.2f} %{lost:>8}{missing:>9}"
    )


HEADER = (
    f"{'without':<22}{'worse':>6}{'better':>8}{'prize':>11}{'cost':>11}{'proofs':>8}{'routes':>9}"
)


def random_problems(
    kinds: Sequence[str], count: int, max_size: int, seed: int
) -> Iterator[RouteProblem]:
    """Yield `count` random problems of each kind, alternating; at most `max_size` visits each."""
    for number in range(count):
        for kind in kinds:
            rng = np.random.default_rng([seed, number, sum(kind.encode())])
            problem = random_problem(max(4, int(rng.integers(max_size // 2, max_size + 1))), rng)
            yield KINDS[kind](problem, rng)


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the gain of each part of the route search."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, help="published problems instead of generated ones")
    parser.add_argument(
        "--problems", nargs="+", choices=list(KINDS), default=list(KINDS), help="kinds"
    )
    parser.add_argument("--count", type=int, default=4, help="problems of each kind, or files")
    parser.add_argument("--size", type=int, default=60, help="visits at most")
    parser.add_argument("--only", nargs="+", metavar="PART", help="parts to leave out, one by one")
    parser.add_argument("--alone", action="store_true", help="also each part on its own")
    parser.add_argument("--time-limit", type=float, default=5.0, help="seconds for each search")
    parser.add_argument("--seed", type=parse_seed, default=0)
    options = parser.parse_args(arguments)
    if options.folder:
        paths = islice(find_files(options.folder, "*"), options.count)
        problems = [read_published_problem(path).problem for path in paths]
    else:
        problems = list(
            random_problems(options.problems, options.count, options.size, options.seed)
        )
    first = [solver.name for solver in FIRST]
    parts = [name for name in all_solver_names() if name in (options.only or all_solver_names())]

    def solve(names: Sequence[str]) -> list[RouteSuggestion]:
        return [
            suggest_route(problem, options.time_limit, options.seed, explain=False, solvers=names)
            for problem in problems
        ]

    complete = solve(all_solver_names())
    print(f"{len(problems)} problems, {options.time_limit:g} s each: all parts find", end=" ")
    print(f"{sum(each.route is not None for each in complete)} routes and", end=" ")
    print(f"{sum(_is_decided(each) for each in complete)} proofs; without a part, these are lost")
    print(HEADER)
    for part in parts:
        without = solve([name for name in all_solver_names() if name != part])
        print(summary_line(part, list(map(Gain, complete, without))), flush=True)
    for part in parts if options.alone else ():
        alone = solve([part, *(name for name in first if name != part)])
        print(summary_line(f"all but {part}", list(map(Gain, complete, alone))), flush=True)


if __name__ == "__main__":
    main()
