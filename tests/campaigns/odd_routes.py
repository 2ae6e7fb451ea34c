"""What `suggest_route` claims of odd problems, against all their routes: any number of them.

    python -m tests.campaigns.odd_routes --count 100000 --first 0 --processes 2

prints each disagreement with the number that makes its problem again, and how many there were.
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context

import numpy as np

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import RouteProblem, RouteSuggestion, suggest_route
from tests.argo_compiler.route.odd_problems import odd_problem
from tests.argo_compiler.route.second_reading import Best, Reading

CHUNK = 50
UNPROVEN = "not proven"
TIME_LIMITS = (2.0, 60.0)
"""s, tried one after the other until something is proven: most problems take some hundredths"""


@dataclass(frozen=True)
class Finding:
    """One problem whose suggestion is wrong, or not proven."""

    number: int
    timed: bool
    what: str
    """`false proof`, `not proven` and the like"""
    said: str
    best: Best | None

    def __str__(self) -> str:
        rounds = " (rounds)" if self.timed else ""
        return f"{self.number}{rounds}: {self.what}: {self.said}, but {self.best}"


def numbered(number: int, timed: bool) -> RouteProblem:
    """The odd problem with that number."""
    return odd_problem(np.random.default_rng([number, timed]), timed)


def wrong(problem: RouteProblem, said: RouteSuggestion, best: Best | None) -> str:
    """What is wrong with what is said of a problem, or that it is not proven; empty: nothing."""
    if said.route is None:
        if said.proven and best is not None:
            return "false infeasibility"
    else:
        reading = Reading(problem)
        end = reading.evaluate(said.route)
        if end is None or best is None:
            return "a route that is none"
        if (reading.prize(said.route.order), reading.cost(end)) != (said.prize, said.cost):
            return "wrong prize or cost"
        if said.proven and (said.prize, said.cost) != (best.prize, best.cost):
            return "false proof"
        if said.proven and (said.prize_bound, said.bound) != (said.prize, said.cost):
            return "proven, but not by its bounds"
        if set(said.dropped) != set(range(problem.size)) - set(said.route.order):
            return "wrong visits left out"
    if best is not None:
        if said.prize_bound < best.prize:
            return "a route wins more than the bound"
        if said.prize_bound == best.prize and said.bound > best.cost:
            return "a route costs less than the bound"
        if any(p.prize_bound < best.prize or p.bound > best.cost for p in said.history):
            return "a bound on the way is wrong"
    return "" if said.proven else UNPROVEN


def finding(
    problem: RouteProblem, solvers: tuple[str, ...] = ()
) -> tuple[str, RouteSuggestion, Best | None]:
    """What is wrong (see `wrong`) with what is said of a problem, what is said, and the best.

    Raises ArgoError where the solvers asked for can't take part.
    """
    best = Reading(problem).best()
    for time_limit in TIME_LIMITS:
        said = suggest_route(problem, time_limit, explain=False, solvers=solvers or None)
        what = wrong(problem, said, best)
        if what != UNPROVEN:
            break
    return what, said, best


def findings(
    numbers: range, timed: bool = False, solvers: tuple[str, ...] = ()
) -> tuple[list[Finding], Counter[str]]:
    """What is wrong or not proven among the problems with these numbers, and how often which
    solver found a route or none."""
    found, counts = list[Finding](), Counter[str]()
    for number in numbers:
        try:
            what, said, best = finding(numbered(number, timed), solvers)
        except ArgoError as refused:
            counts[f"refused: {refused}"] += 1
            if not solvers:
                found.append(Finding(number, timed, "refused", str(refused), None))
            continue
        except Exception as broken:
            # Whatever goes wrong is to be found, and the rest of the problems are to be tried.
            found.append(Finding(number, timed, "broken", repr(broken), None))
            continue
        counts[f"{said.method}: {'a route' if said.route else 'none'}"] += 1
        if what:
            words = (
                f"{said.method} says {said.order} {dict(said.charges)}, prize {said.prize} of "
                f"{said.prize_bound}, cost {said.cost} of {said.bound}, proven {said.proven}"
            )
            found.append(Finding(number, timed, what, words, best))
    return found, counts


def chunks(first: int, count: int) -> Iterator[range]:
    for start in range(first, first + count, CHUNK):
        yield range(start, min(start + CHUNK, first + count))


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=10_000, help="how many problems")
    parser.add_argument("--first", type=int, default=0, help="the number of the first")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--rounds", action="store_true", help="mostly with timed rounds")
    parser.add_argument("--solver", action="append", default=[], help="only this one")
    chosen = parser.parse_args(arguments)
    work = partial(findings, timed=chosen.rounds, solvers=tuple(chosen.solver))
    kinds, methods, begun = Counter[str](), Counter[str](), time.monotonic()
    with ProcessPoolExecutor(chosen.processes, mp_context=get_context("spawn")) as pool:
        for found, counts in pool.map(work, chunks(chosen.first, chosen.count)):
            methods += counts
            kinds.update(one.what for one in found)
            for one in found:
                print(one, flush=True)
    for method, number in methods.most_common():
        print(f"{number:8d} {method}")
    unproven = kinds.pop(UNPROVEN, 0)
    print(
        f"{chosen.count} problems in {time.monotonic() - begun:.0f} s: {kinds.total()} disagree "
        f"{dict(kinds)}, {unproven} not proven"
    )
    return 1 if kinds else 0


if __name__ == "__main__":
    sys.exit(main())
