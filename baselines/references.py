"""The best routes of the test sets that are known, which policies are measured by.

    python -m baselines.references [TEST_SET ...]            # look for better ones, keep them
    python -m baselines.references random-40-v1 --results out/arena/results.json

What is known never gets worse: of each instance the best is kept of the route that was known, those
of several searches of the optimiser, of insertion, of policies (`--policy`), and of policies that
were compared before (`--results`). What is proven already is not searched again.

For instances with noise they are those of somebody who knows beforehand which readings fail, and
for whom no stairs are ever blocked: no policy can win more, and most can't win as much.
"""

import argparse
import json
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from importlib import resources
from pathlib import Path

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.files.atomic_write import write_atomically
from argo_compiler.route import RouteProblem, RouteSuggestion, Tour, suggest_route
from argo_compiler.route.evaluation import evaluate
from argo_env.envs.route_instance import DOCK
from baselines.episodes import play
from baselines.families import TEST_SETS, InstanceSet, find_set
from baselines.heuristics.insertion import insert_and_improve
from baselines.policy import make_policy
from baselines.problem import HUNDREDTH, hindsight

_FOLDER = "data"
_FREE = 0.25  # of the time, for the problem without the order that is asked for
Route = tuple[int, ...]
"""nodes in their order, without the dock"""


@dataclass(frozen=True)
class BestKnown:
    """What is known of the best route on one instance."""

    prize: float
    """of the best route that was found"""
    bound: float
    """no route wins more"""
    time: float = 0.0
    """s until that route is docked"""
    route: Route = ()

    @property
    def proven(self) -> bool:
        return self.prize == self.bound


@dataclass(frozen=True)
class Effort:
    """How long better routes are looked for on one instance, and where."""

    seconds: float
    """of processor time that the optimiser has in all its searches"""
    searches: int = 2
    """of the optimiser, with a seed each"""
    policies: tuple[str, ...] = ()
    """whose routes are tried as well"""


@lru_cache(maxsize=16)
def references(name: str) -> tuple[BestKnown, ...]:
    """Those of the test set of that name, in the order of its numbers.

    Raises ArgoError if there are none, or they are not those of the test set as it is now.
    """
    tests = find_set(name)
    found = resources.files("baselines").joinpath(_FOLDER, f"{name}.json")
    if not found.is_file():
        raise NotFound(
            f"test set {name} has no references: `python -m baselines.references {name}` finds them"
        )
    checksum, known = _parsed(found.read_text(encoding="utf-8"))
    if checksum != tests.checksum():
        raise Conflict(
            f"test set {name} is no longer what its references were found for (checksum "
            f"{tests.checksum()}, not {checksum}): give the changed set another version"
        )
    return known


def improved(
    tests: InstanceSet,
    number: int,
    known: BestKnown | None,
    effort: Effort,
    routes: Iterable[Route] = (),
) -> BestKnown:
    """What is known of one instance after another search, in which these routes are tried too; it
    is not searched where the best route is proven.

    Raises ArgoError if a route wins more than is said to be possible.
    """
    problem = hindsight(tests.family.source.draw(number)).problem
    everything = round(HUNDREDTH * sum(visit.prize for visit in problem.visits), 2)
    best = _best(problem, known or BestKnown(0.0, everything), routes)
    if not (best.proven and best.route):
        best = _best(problem, best, _simple_routes(tests, number, problem, effort))
        for seed in range(effort.searches):
            if best.proven and best.route:
                break
            for bound, order in _searched(problem, effort.seconds / effort.searches, seed):
                best = _best(problem, best, [tuple(visit + 1 for visit in order)])
                best = replace(best, bound=min(best.bound, round(HUNDREDTH * bound, 2)))
    if best.prize > best.bound:
        raise Invalid(
            f"test set {tests.name}, instance {number}: a route wins {best.prize}, but none is "
            f"said to win more than {best.bound}: the optimiser is wrong"
        )
    return best


def improve(
    tests: InstanceSet,
    file: Path,
    effort: Effort,
    routes: Mapping[int, Sequence[Route]] | None = None,
    processes: int = 1,
) -> None:
    """Writes what is known of a test set after another search; `routes` are tried by the number of
    their instance. What was known of another one by the same name counts for nothing."""
    checksum = tests.checksum()
    before: Sequence[BestKnown | None] = [None] * len(tests.numbers)
    if file.is_file():
        had, known = _parsed(file.read_text(encoding="utf-8"))
        before = known if had == checksum else before
    found = []
    with ProcessPoolExecutor(processes) as pool:
        tasks = [
            pool.submit(improved, tests, number, one, effort, (routes or {}).get(number, ()))
            for number, one in zip(tests.numbers, before, strict=True)
        ]
        for number, one, task in zip(tests.numbers, before, tasks, strict=True):
            found.append(task.result())
            print(f"{tests.name} {number}: {_change(one, found[-1])}", file=sys.stderr, flush=True)
    lines = ",\n".join(json.dumps(asdict(one)) for one in found)
    text = f'{{"checksum": {json.dumps(checksum)}, "instances": [\n{lines}\n]}}\n'
    write_atomically(file, text)


def routes_of(results: Sequence[Path], name: str) -> dict[int, list[Route]]:
    """The routes on a test set in files `results.json` of `python -m baselines.evaluate`, by the
    number of the instance. Raises ArgoError if there is no such file."""
    found: dict[int, list[Route]] = {}
    for path in results:
        try:
            for comparison in json.loads(path.read_text(encoding="utf-8")):
                if comparison["test_set"] == name:
                    for outcome in (o for one in comparison["outcomes"].values() for o in one):
                        found.setdefault(outcome["instance"], []).append(_once(outcome["route"]))
        except OSError as error:
            raise NotFound(f"{path} can't be read: {error.strerror}") from None
        except (ValueError, KeyError, TypeError):
            raise Invalid(f"{path} is no results.json of `python -m baselines.evaluate`") from None
    return found


def _best(problem: RouteProblem, known: BestKnown, routes: Iterable[Route]) -> BestKnown:
    """What is known after these routes, of which those that are not feasible count for nothing."""
    for route in routes:
        value = evaluate(problem, Tour(tuple(node - 1 for node in route)))
        prize, ends = round(HUNDREDTH * value.prize, 2), value.duration * problem.unit
        worth, least = (prize, -ends), (known.prize, -known.time if known.route else -float("inf"))
        if value.feasible and worth > least:
            known = replace(known, prize=prize, time=ends, route=route)
    return known


def _searched(
    problem: RouteProblem, seconds: float, seed: int
) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Bounds of the prize, in hundredths, and orders that the optimiser finds. Some of its solvers
    know no order that is asked for: they search the problem without it, and what a route of theirs
    must not visit where it does is visited elsewhere, or not at all."""
    share = 1.0 - _FREE if problem.precedences else 1.0
    found = _suggested(problem, share * seconds, seed)
    yield found.prize_bound, found.order
    if problem.precedences and not found.proven:
        free = _suggested(replace(problem, precedences=()), _FREE * seconds, seed)
        yield free.prize_bound, insert_and_improve(problem, free.order)


def _suggested(problem: RouteProblem, seconds: float, seed: int) -> RouteSuggestion:
    return suggest_route(problem, seconds, seed, explain=False, clock=time.process_time)


def _simple_routes(
    tests: InstanceSet, number: int, problem: RouteProblem, effort: Effort
) -> Iterator[Route]:
    yield tuple(visit + 1 for visit in insert_and_improve(problem))
    alone = InstanceSet(tests.name, tests.family, range(number, number + 1))
    for name in effort.policies:
        for outcome in play(make_policy(name), alone, 1):
            yield _once(outcome.route)


def _once(route: Sequence[int]) -> Route:
    """The nodes of a policy's route, each where it is visited for the last time: only there its
    reading succeeded."""
    return tuple(dict.fromkeys(node for node in reversed(route) if node != DOCK))[::-1]


def _parsed(text: str) -> tuple[str, tuple[BestKnown, ...]]:
    data = json.loads(text)
    known = (BestKnown(**one | {"route": tuple(one["route"])}) for one in data["instances"])
    return data["checksum"], tuple(known)


def _change(before: BestKnown | None, now: BestKnown) -> str:
    most = "proven" if now.proven else f"at most {now.bound:.2f}"
    if before is None or before.prize == now.prize:
        return f"{now.prize:.2f}, {most}"
    return f"{before.prize:.2f} → {now.prize:.2f}, {most}"


def main(arguments: Sequence[str] | None = None) -> int:
    """The exit status: 2 if something that was asked for is not there."""
    parser = argparse.ArgumentParser(
        prog="python -m baselines.references",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="TEST_SET", help="default: all")
    parser.add_argument("--seconds", type=float, default=8.0, metavar="S",
                        help="of processor time for an instance; default 8")  # fmt: skip
    parser.add_argument("--searches", type=int, default=2, metavar="N",
                        help="that share it; 0: the optimiser is not asked; default 2")  # fmt: skip
    parser.add_argument("--policy", nargs="*", default=[], metavar="NAME",
                        help="whose routes are tried as well")  # fmt: skip
    parser.add_argument("--results", nargs="*", type=Path, default=[], metavar="RESULTS.json",
                        help="whose routes are tried as well")  # fmt: skip
    parser.add_argument("--processes", type=int, default=1, metavar="N",
                        help="instances that are searched at a time; default 1")  # fmt: skip
    given = parser.parse_args(arguments)
    folder = Path(__file__).parent / _FOLDER
    effort = Effort(given.seconds, given.searches, tuple(given.policy))
    try:
        for name, number, least in (
            ("searches", given.searches, 0),
            ("processes", given.processes, 1),
        ):
            if number < least:
                raise Invalid(f"--{name} is {number}, and has to be at least {least}")
        if not given.seconds > 0.0:
            raise Invalid(f"--seconds is {given.seconds:g}, and has to be positive")
        for name in given.names or TEST_SETS:
            tests, routes = find_set(name), routes_of(given.results, name)
            improve(tests, folder / f"{name}.json", effort, routes, given.processes)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
