"""What each part of the route search gains: `python -m benchmarks.route_parts`.

    python -m benchmarks.route_parts --only PyVRP --problems windows optional --count 8
    python -m benchmarks.route_parts --folder FOLDER --time-limit 10 --alone

Solves each problem with all parts, and with all but one, on one worker: those of the kinds of
`benchmarks.routes_limits`, from seeds, or those in a folder as `benchmarks.routes` reads them.
Prints for each part how often the route is worse without it and how often better, what share of the
prize and of the cost it gains, how many proofs are lost, and for how many problems no route is
found any more.
With `--alone` it also prints the same of each part by itself, after the first rules.
"""

import argparse
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from argo_compiler.route import RouteProblem, RouteSuggestion, suggest_route
from argo_compiler.route.solvers import FIRST, solver_names
from benchmarks.instances import read_route_problem
from benchmarks.options import seed_number
from benchmarks.routes import find_files
from benchmarks.routes_limits import KINDS, places


@dataclass(frozen=True)
class Gain:
    """What a problem comes to with and without a part."""

    with_it: RouteSuggestion
    without: RouteSuggestion

    @property
    def better(self) -> int:
        """1: the route is better with the part; -1: it is worse."""
        one, other = _worth(self.with_it), _worth(self.without)
        return (one > other) - (one < other)

    @property
    def prize(self) -> float:
        """Of what is won with the part, what share is not won without it."""
        return (self.with_it.prize - self.without.prize) / max(1, self.with_it.prize)

    @property
    def cost(self) -> float:
        """By what share of the cost it is higher without the part, where as much is won."""
        comparable = self.with_it.route and self.without.route and not self.prize
        return (
            (self.without.cost - self.with_it.cost) / max(1, self.with_it.cost) * bool(comparable)
        )


def _worth(found: RouteSuggestion) -> tuple[bool, int, int]:
    return found.route is not None, found.prize, -found.cost


def summary(part: str, gains: Sequence[Gain]) -> str:
    """One line of the table."""
    lost = sum(g.with_it.proven for g in gains) - sum(g.without.proven for g in gains)
    missing = sum(g.with_it.route is not None for g in gains) - sum(
        g.without.route is not None for g in gains
    )
    prize, cost = np.mean([(g.prize, g.cost) for g in gains], axis=0)
    return (
        f"{part:<22}{sum(g.better > 0 for g in gains):>6}{sum(g.better < 0 for g in gains):>8}"
        f"{100 * prize:>9.2f} %{100 * cost:>9.2f} %{lost:>8}{missing:>9}"
    )


HEADER = (
    f"{'without':<22}{'worse':>6}{'better':>8}{'prize':>11}{'cost':>11}{'proofs':>8}{'routes':>9}"
)


def generated(kinds: Sequence[str], count: int, size: int, seed: int) -> Iterator[RouteProblem]:
    """Problems of those kinds, in turns."""
    for number in range(count):
        for kind in kinds:
            rng = np.random.default_rng([seed, number, sum(kind.encode())])
            there = places(max(4, int(rng.integers(size // 2, size + 1))), rng)
            yield KINDS[kind](there, rng)


def main(arguments: Sequence[str] | None = None) -> None:
    """Prints what each part gains."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--folder", type=Path, help="published problems instead of generated ones")
    parser.add_argument("--problems", nargs="+", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--count", type=int, default=4, help="problems of each kind, or files")
    parser.add_argument("--size", type=int, default=60, help="visits at most")
    parser.add_argument("--only", nargs="+", metavar="PART", help="parts to leave out, one by one")
    parser.add_argument("--alone", action="store_true", help="also each part by itself")
    parser.add_argument("--time-limit", type=float, default=5.0, help="s for each search")
    parser.add_argument("--seed", type=seed_number, default=0)
    given = parser.parse_args(arguments)
    if given.folder:
        paths = islice(find_files(given.folder, "*"), given.count)
        problems = [read_route_problem(path).problem for path in paths]
    else:
        problems = list(generated(given.problems, given.count, given.size, given.seed))
    first = [solver.name for solver in FIRST]
    parts = [name for name in solver_names() if name in (given.only or solver_names())]

    def solved(names: Sequence[str]) -> list[RouteSuggestion]:
        return [
            suggest_route(one, given.time_limit, given.seed, explain=False, solvers=names)
            for one in problems
        ]

    complete = solved(solver_names())
    print(f"{len(problems)} problems, {given.time_limit:g} s each: all parts find", end=" ")
    print(f"{sum(one.route is not None for one in complete)} routes and", end=" ")
    print(f"{sum(one.proven for one in complete)} proofs; without a part, these are lost")
    print(HEADER)
    for part in parts:
        without = solved([name for name in solver_names() if name != part])
        print(summary(part, list(map(Gain, complete, without))), flush=True)
    for part in parts if given.alone else ():
        alone = solved([part, *(name for name in first if name != part)])
        print(summary(f"all but {part}", list(map(Gain, complete, alone))), flush=True)


if __name__ == "__main__":
    main()
