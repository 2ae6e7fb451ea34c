"""Published route problems beside their known values and beside other solvers.

    python -m benchmarks.routes FOLDER ...
    python -m benchmarks.routes FOLDER --time-limit 30 --workers 2 --only 'ftv*'
    python -m benchmarks.routes FOLDER --lkh LKH-3.0.6/LKH

Reads all TSPLIB (.tsp, .atsp, .sop), OPLib (.oplib) and TSPTW (.tw) files in the folders and below,
and prints for each, as a line of a Markdown table, what `suggest_route` finds and proves within the
time limit, and what its peers find in the same time and with the same seed, on one core, where they
can state the problem: PyVRP knows no precedence, LKH no optional visits, and neither gives bounds.
Costs are those of the file; of orienteering problems it is the score, and more is better. `off` is
by how much a value is worse than the best known one (benchmarks/known_values.py). Each route is
evaluated again, apart from the solvers.
"""

import argparse
import os
import platform
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import RouteProblem, Tour, evaluate
from argo_compiler.route.suggestion import suggest_route
from benchmarks import peer_lkh, peer_pyvrp
from benchmarks.instances import Kind, NamedProblem, read_route_problem
from benchmarks.known_values import Known, known_of
from benchmarks.options import seed_number
from benchmarks.routes_table import PeerFinding, Row, head, line, summary

ENDINGS = (".tsp", ".atsp", ".sop", ".oplib", ".tw")


@dataclass(frozen=True)
class Peer:
    """Another solver."""

    name: str
    why_not: Callable[[RouteProblem], str | None]
    """why it can't state a problem; None if it can"""
    search: Callable[[RouteProblem, float, int], Tour | None]
    """the best route that it finds in some time (s) with a seed"""


def find_files(folder: Path, only: str) -> list[Path]:
    """The problems in a folder and below, in order. Raises ArgoError if there are none."""
    if not folder.is_dir():
        raise ArgoError(f"{folder}: is no folder; name one with TSPLIB, OPLib or TSPTW files")
    found = sorted(
        path
        for path in folder.rglob("*")
        if path.suffix in ENDINGS and (path.match(only) or Path(path.stem).match(only))
    )
    if not found:
        raise ArgoError(
            f"{folder}: no file in it fits `{only}` and ends in {', '.join(ENDINGS)}; name others"
        )
    return found


def measure(
    path: Path,
    named: NamedProblem,
    time_limit: float,
    workers: int,
    seed: int,
    peers: Sequence[Peer] = (),
) -> Row:
    """Return what is found for the problem that was read from a file."""
    known = known_of(path, named.kind)
    started = time.perf_counter()
    found = suggest_route(named.problem, time_limit, seed, workers)
    seconds = time.perf_counter() - started
    bound = named.value(found.prize_bound, found.bound)
    value, wrong = None, None
    if found.route is not None:
        value, wrong = _worth(named, found.route)
        if wrong is None and value != named.value(found.prize, found.cost):
            wrong = f"says {named.value(found.prize, found.cost):.10g}"
    wrong = wrong or _contradiction(named.kind, value, bound, found.proven, known)
    theirs = tuple(_ask(peer, named, time_limit, seed) for peer in peers)
    return Row(
        path.stem, named.kind, _size(named), known, value,
        bound, found.proven, seconds, found.method, theirs, wrong,
    )  # fmt: skip


def _size(named: NamedProblem) -> int:
    """Return the number of nodes, as the file counts them."""
    return len(named.nodes) + 1 + (named.kind == Kind.SOP)


def _ask(peer: Peer, named: NamedProblem, time_limit: float, seed: int) -> PeerFinding:
    if reason := peer.why_not(named.problem):
        return PeerFinding(peer.name, None, reason)
    route = peer.search(named.problem, time_limit, seed)
    if route is None:
        return PeerFinding(peer.name, None)
    value, unlike = _worth(named, route)
    return PeerFinding(peer.name, None, unlike) if unlike else PeerFinding(peer.name, value)


def _worth(named: NamedProblem, route: Tour) -> tuple[float, str | None]:
    """The value of a route as the file counts, and what it does not keep to."""
    evaluation = evaluate(named.problem, route)
    value = named.value(evaluation.prize, evaluation.cost(named.problem.objective))
    return value, evaluation.violations[0] if evaluation.violations else None


def _contradiction(
    kind: Kind, value: float | None, bound: float, proven: bool, known: Known | None
) -> str | None:
    sign = -1 if kind == Kind.OP else 1
    if value is not None and sign * value < sign * bound:
        return "its value is better than its bound"
    if known is None:
        return None
    if sign * bound > sign * known.value + known.rounded:
        return f"its bound excludes the known value {known.value:.10g}"
    if value is None:
        return "it says that there is no route" if proven else None
    if known.bound is not None and sign * value < sign * known.bound - known.rounded:
        return f"its value is better than the known bound {known.bound:.10g}"
    return None


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints all of it. Status 1: a route is not what its solver says."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--time-limit", type=float, default=30.0, help="s for each problem")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=seed_number, default=0)
    parser.add_argument("--only", default="*", metavar="GLOB", help="names of files, such as 'ft*'")
    parser.add_argument("--peers", action=argparse.BooleanOptionalAction, default=True)
    parser.add_argument("--lkh", type=Path, help="the program LKH-3, as a peer too")
    given = parser.parse_args(arguments)
    peers = []
    if given.peers and find_spec("pyvrp"):
        peers.append(Peer("PyVRP", peer_pyvrp.why_not, peer_pyvrp.search))
    elif given.peers:
        print("PyVRP is not installed: it is left out")
    if given.lkh:
        peers.append(Peer("LKH-3", peer_lkh.why_not, partial(peer_lkh.search, given.lkh)))
    rows: list[Row] = []
    try:
        paths = [path for folder in given.folders for path in find_files(folder, given.only)]
        read = [(read_route_problem(path), path) for path in paths]
        print(_setting(given.time_limit, given.workers, given.seed) + "\n")
        print("\n".join(head([peer.name for peer in peers])))
        for named, path in sorted(read, key=lambda one: (one[0].kind, _size(one[0]), one[1].stem)):
            rows.append(measure(path, named, given.time_limit, given.workers, given.seed, peers))
            print(line(rows[-1]), flush=True)
    except ArgoError as error:
        print(error, file=sys.stderr)
        return 2
    print("".join(f"\n- {said}" for said in summary(rows)))
    return int(any(row.wrong for row in rows))


def _setting(time_limit: float, workers: int, seed: int) -> str:
    return (
        f"{time_limit:g} s for each problem, {workers} workers of {os.cpu_count()} cores, seed "
        f"{seed}; Python {platform.python_version()}, OR-Tools {version('ortools')}"
    )


if __name__ == "__main__":
    sys.exit(main())
