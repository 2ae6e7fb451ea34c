"""Best known routes of the test sets, the references with which policies are compared.

    python -m baselines.references [TEST_SET ...]            # search for better routes, store them
    python -m baselines.references random-40-v1 --results out/arena/results.json

References never get worse. For each instance the best of these routes is stored: the known one, the
routes of several searches of the optimiser, of insertion, of policies (`--policy`), and of earlier
comparisons (`--results`). Instances with a proof are not searched again.

On instances with noise the references assume that it is known in advance which readings fail, and
that no stairs are ever blocked: no policy can win more, and most can't win as much.
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
from baselines.families import TEST_SETS, InstanceSet, find_test_set
from baselines.heuristics.insertion import insert_and_improve
from baselines.policy import make_policy
from baselines.problem import PRIZE_UNIT, hindsight_problem

_FOLDER = "data"
_RELAXED_SHARE = 0.25  # share of the time for the relaxation without precedence constraints
Route = tuple[int, ...]
"""nodes in their order, without the dock"""


@dataclass(frozen=True)
class BestKnown:
    """Best known route of one instance, with a bound.

    It is the route with the highest prize, and of several such routes the one that is docked first.
    """

    prize: float
    """prize of the best known route"""
    bound: float
    """upper bound on the prize of any route"""
    time: float = 0.0
    """time in s when the robot is docked on the best known route"""
    route: Route = ()

    @property
    def proven(self) -> bool:
        return self.prize == self.bound


@dataclass(frozen=True)
class Effort:
    """Effort that the search for better routes spends on one instance."""

    seconds: float
    """processor time in s that all searches of the optimiser share"""
    searches: int = 2
    """number of searches of the optimiser, each with its own seed"""
    policies: tuple[str, ...] = ()
    """names of policies whose routes are tried as well"""


@lru_cache(maxsize=16)
def load_references(name: str) -> tuple[BestKnown, ...]:
    """Return the best known route of each instance of a test set, in the order of the instances.

    Raises ArgoError if there are none, or they belong to another version of the test set.
    """
    test_set = find_test_set(name)
    path = resources.files("baselines").joinpath(_FOLDER, f"{name}.json")
    if not path.is_file():
        raise NotFound(
            f"test set {name} has no references: `python -m baselines.references {name}` finds them"
        )
    checksum, known = _parse(path.read_text(encoding="utf-8"))
    if checksum != test_set.checksum():
        raise Conflict(
            f"test set {name} has changed since its references were found (checksum "
            f"{test_set.checksum()}, not {checksum}): give the changed set another version"
        )
    return known


def improve_best_known(
    test_set: InstanceSet,
    number: int,
    known: BestKnown | None,
    effort: Effort,
    routes: Iterable[Route] = (),
) -> BestKnown:
    """Search for a better route of one instance; return the best one known afterwards.

    An instance whose best known route is proven optimal is not searched.

    Args:
        test_set: test set of the instance.
        number: number of the instance.
        known: best known route so far; None if there is none.
        effort: effort of the search.
        routes: further routes that are compared with it.

    Raises:
        ArgoError: if a route wins more than the bound, which is a defect of the optimiser.
    """
    problem = hindsight_problem(test_set.family.source.draw(number)).problem
    everything = round(PRIZE_UNIT * sum(visit.prize for visit in problem.visits), 2)
    best = _better_reference(problem, known or BestKnown(0.0, everything), routes)
    if not (best.proven and best.route):
        best = _better_reference(problem, best, _policy_routes(test_set, number, problem, effort))
        for seed in range(effort.searches):
            if best.proven and best.route:
                break
            for bound, order in _search(problem, effort.seconds / effort.searches, seed):
                best = _better_reference(problem, best, [tuple(visit + 1 for visit in order)])
                best = replace(best, bound=min(best.bound, round(PRIZE_UNIT * bound, 2)))
    if best.prize > best.bound:
        raise Invalid(
            f"test set {test_set.name}, instance {number}: a route wins {best.prize}, more than "
            f"the upper bound {best.bound}: the optimiser is wrong"
        )
    return best


def update_references(
    test_set: InstanceSet,
    file: Path,
    effort: Effort,
    routes: Mapping[int, Sequence[Route]] | None = None,
    processes: int = 1,
) -> None:
    """Search for better routes of a test set, and write the best known ones to a file.

    References in the file that belong to another test set with the same name are discarded.

    Args:
        test_set: the test set.
        file: file of its references; it need not exist.
        effort: effort of the search for each instance.
        routes: further routes that are tried, by the number of their instance.
        processes: number of instances that are searched at a time.
    """
    checksum = test_set.checksum()
    before: Sequence[BestKnown | None] = [None] * len(test_set.numbers)
    if file.is_file():
        old_checksum, known = _parse(file.read_text(encoding="utf-8"))
        before = known if old_checksum == checksum else before
    after = []
    with ProcessPoolExecutor(processes) as pool:
        tasks = [
            pool.submit(
                improve_best_known, test_set, number, old, effort, (routes or {}).get(number, ())
            )
            for number, old in zip(test_set.numbers, before, strict=True)
        ]
        for number, old, task in zip(test_set.numbers, before, tasks, strict=True):
            after.append(task.result())
            print(
                f"{test_set.name} {number}: {_describe_change(old, after[-1])}",
                file=sys.stderr,
                flush=True,
            )
    lines = ",\n".join(json.dumps(asdict(reference)) for reference in after)
    text = f'{{"checksum": {json.dumps(checksum)}, "instances": [\n{lines}\n]}}\n'
    write_atomically(file, text)


def read_routes(results: Sequence[Path], name: str) -> dict[int, list[Route]]:
    """Return the routes of all policies in result files on a test set, by instance number.

    Args:
        results: files `results.json` of `python -m baselines.evaluate`.
        name: name of the test set.

    Raises:
        ArgoError: if a file can't be read or is no such file.
    """
    routes: dict[int, list[Route]] = {}
    for path in results:
        try:
            for comparison in json.loads(path.read_text(encoding="utf-8")):
                if comparison["test_set"] == name:
                    for outcome in (o for one in comparison["outcomes"].values() for o in one):
                        routes.setdefault(outcome["instance"], []).append(
                            _last_visits(outcome["route"])
                        )
        except OSError as error:
            raise NotFound(f"{path} can't be read: {error.strerror}") from None
        except (ValueError, KeyError, TypeError):
            raise Invalid(
                f"{path} is not a result of `python -m baselines.evaluate`; name a file that this "
                "command wrote"
            ) from None
    return routes


def _better_reference(
    problem: RouteProblem, known: BestKnown, routes: Iterable[Route]
) -> BestKnown:
    """Return the reference after trying these routes; infeasible ones are ignored.

    Of two routes with the same prize, the one that is docked earlier is better.
    """
    for route in routes:
        value = evaluate(problem, Tour(tuple(node - 1 for node in route)))
        prize, ends = round(PRIZE_UNIT * value.prize, 2), value.duration * problem.unit
        old_key = (known.prize, -known.time if known.route else -float("inf"))
        if value.feasible and (prize, -ends) > old_key:
            known = replace(known, prize=prize, time=ends, route=route)
    return known


def _search(
    problem: RouteProblem, seconds: float, seed: int
) -> Iterator[tuple[int, tuple[int, ...]]]:
    """Yield upper bounds on the prize of any order (in hundredths), each with an order found.

    Some of its solvers do not support precedence constraints. So without a proof, the relaxation
    without these constraints is solved too. Its bound is valid for the full problem; from its
    route, insertion drops the visits that violate a constraint, and inserts what fits.
    """
    share = 1.0 - _RELAXED_SHARE if problem.precedences else 1.0
    suggestion = _suggest(problem, share * seconds, seed)
    yield suggestion.prize_bound, suggestion.order or ()
    if problem.precedences and not (suggestion.proven or suggestion.infeasible):
        relaxed = _suggest(replace(problem, precedences=()), _RELAXED_SHARE * seconds, seed)
        yield relaxed.prize_bound, insert_and_improve(problem, relaxed.order or ())


def _suggest(problem: RouteProblem, seconds: float, seed: int) -> RouteSuggestion:
    return suggest_route(problem, seconds, seed, explain=False, clock=time.process_time)


def _policy_routes(
    test_set: InstanceSet, number: int, problem: RouteProblem, effort: Effort
) -> Iterator[Route]:
    """Yield the route of insertion and those of the policies of the effort."""
    yield tuple(visit + 1 for visit in insert_and_improve(problem))
    instance = InstanceSet(test_set.name, test_set.family, range(number, number + 1))
    for name in effort.policies:
        for outcome in play(make_policy(name), instance, 1):
            yield _last_visits(outcome.route)


def _last_visits(route: Sequence[int]) -> Route:
    """Return the nodes of a policy's route in the order of their last visits, without the dock.

    Only the last visit of a node gave a reading.
    """
    return tuple(dict.fromkeys(node for node in reversed(route) if node != DOCK))[::-1]


def _parse(text: str) -> tuple[str, tuple[BestKnown, ...]]:
    """Return the checksum of the test set and the references in the text of a file."""
    data = json.loads(text)
    known = (BestKnown(**one | {"route": tuple(one["route"])}) for one in data["instances"])
    return data["checksum"], tuple(known)


def _describe_change(before: BestKnown | None, now: BestKnown) -> str:
    bound = "proven" if now.proven else f"at most {now.bound:.2f}"
    if before is None or before.prize == now.prize:
        return f"{now.prize:.2f}, {bound}"
    return f"{before.prize:.2f} → {now.prize:.2f}, {bound}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; return its exit status, 2 after an error that is reported."""
    parser = argparse.ArgumentParser(
        prog="python -m baselines.references",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="TEST_SET", help="test sets; default all")
    parser.add_argument("--seconds", type=float, default=8.0, metavar="S",
                        help="processor time for each instance; default 8")  # fmt: skip
    parser.add_argument("--searches", type=int, default=2, metavar="N",
                        help="number of searches of the optimiser that share this time; 0: no "
                        "search; default 2")  # fmt: skip
    parser.add_argument("--policy", nargs="*", default=[], metavar="NAME",
                        help="policies whose routes are tried as well")  # fmt: skip
    parser.add_argument("--results", nargs="*", type=Path, default=[], metavar="RESULTS.json",
                        help="results whose routes are tried as well")  # fmt: skip
    parser.add_argument("--processes", type=int, default=1, metavar="N",
                        help="number of instances searched at a time; default 1")  # fmt: skip
    options = parser.parse_args(arguments)
    folder = Path(__file__).parent / _FOLDER
    effort = Effort(options.seconds, options.searches, tuple(options.policy))
    try:
        for name, number, minimum in (
            ("searches", options.searches, 0),
            ("processes", options.processes, 1),
        ):
            if number < minimum:
                raise Invalid(f"--{name} is {number}: give a number of at least {minimum}")
        if not options.seconds > 0.0:
            raise Invalid(f"--seconds is {options.seconds:g}: give a positive number")
        for name in options.names or TEST_SETS:
            test_set, routes = find_test_set(name), read_routes(options.results, name)
            update_references(test_set, folder / f"{name}.json", effort, routes, options.processes)
    except ArgoError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
