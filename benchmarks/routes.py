"""Comparison on published route problems with known values and with other solvers.

    python -m benchmarks.routes FOLDER ...
    python -m benchmarks.routes FOLDER --time-limit 30 --workers 2 --only 'ftv*'
    python -m benchmarks.routes FOLDER --lkh LKH-3.0.6/LKH

Reads all TSPLIB (.tsp, .atsp, .sop), OPLib (.oplib) and TSPTW (.tw) files in the folders and their
subfolders. Prints a Markdown table with a line for each: the value and bound of `suggest_route`
within the time limit, and the values of other solvers in the same time and with the same seed, on
one core, if they support the problem. PyVRP does not support precedence, LKH no optional visits,
and neither gives bounds. Values are the costs of the file; for orienteering problems they are the
score, and more is better. `off` is by how much a value is worse than the best known one
(benchmarks/known_values.py). Each route is evaluated again, independently of the solvers.
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
from benchmarks.instances import Kind, NamedProblem, read_published_problem
from benchmarks.known_values import KnownValue, find_known_value
from benchmarks.options import parse_seed
from benchmarks.routes_table import PeerResult, Row, header_lines, row_line, summary_lines

ENDINGS = (".tsp", ".atsp", ".sop", ".oplib", ".tw")


@dataclass(frozen=True)
class Peer:
    """Another solver."""

    name: str
    unsupported_feature: Callable[[RouteProblem], str | None]
    """function that returns a feature it does not support; None: it supports all"""
    search: Callable[[RouteProblem, float, int], Tour | None]
    """function that returns the best route that it finds within a time (s) with a seed"""


def find_files(folder: Path, pattern: str) -> list[Path]:
    """Return a folder's problem files, with those in subfolders, whose names match; sorted.

    Raises ArgoError if there are none.
    """
    if not folder.is_dir():
        raise ArgoError(f"{folder} is not a folder; name one with TSPLIB, OPLib or TSPTW files")
    paths = sorted(
        path
        for path in folder.rglob("*")
        if path.suffix in ENDINGS and (path.match(pattern) or Path(path.stem).match(pattern))
    )
    if not paths:
        raise ArgoError(
            f"{folder}: no file in it matches `{pattern}` and ends in {', '.join(ENDINGS)}; "
            "name others"
        )
    return paths


def measure_problem(
    path: Path,
    named: NamedProblem,
    time_limit: float,
    workers: int,
    seed: int,
    peers: Sequence[Peer] = (),
) -> Row:
    """Solve a problem read from a file, also with other solvers; return its row of the table."""
    known = find_known_value(path, named.kind)
    started = time.perf_counter()
    suggestion = suggest_route(named.problem, time_limit, seed, workers)
    seconds = time.perf_counter() - started
    bound = named.published_value(suggestion.prize_bound, suggestion.bound)
    value, wrong = None, None
    is_decided = suggestion.proven or suggestion.infeasible
    if suggestion.route is not None:
        value, wrong = _evaluate(named, suggestion.route)
        claimed = named.published_value(suggestion.prize, suggestion.cost)
        if wrong is None and value != claimed:
            wrong = f"its solver claims {claimed:.10g}"
    wrong = wrong or _find_contradiction(named.kind, value, bound, is_decided, known)
    peer_results = tuple(_run_peer(peer, named, time_limit, seed) for peer in peers)
    return Row(
        path.stem, named.kind, _node_count(named), known, value,
        bound, is_decided, seconds, suggestion.method, peer_results, wrong,
    )  # fmt: skip


def _node_count(named: NamedProblem) -> int:
    """Return the number of nodes, as the file counts them."""
    return len(named.nodes) + 1 + (named.kind == Kind.SOP)


def _run_peer(peer: Peer, named: NamedProblem, time_limit: float, seed: int) -> PeerResult:
    if feature := peer.unsupported_feature(named.problem):
        return PeerResult(peer.name, None, feature)
    route = peer.search(named.problem, time_limit, seed)
    if route is None:
        return PeerResult(peer.name, None)
    value, violation = _evaluate(named, route)
    return PeerResult(peer.name, None, violation) if violation else PeerResult(peer.name, value)


def _evaluate(named: NamedProblem, route: Tour) -> tuple[float, str | None]:
    """Return the value of a route in the file's terms, and its first violation, if any."""
    evaluation = evaluate(named.problem, route)
    value = named.published_value(evaluation.prize, evaluation.cost(named.problem.objective))
    return value, evaluation.violations[0] if evaluation.violations else None


def _find_contradiction(
    kind: Kind, value: float | None, bound: float, proven: bool, known: KnownValue | None
) -> str | None:
    sign = -1 if kind == Kind.OP else 1
    if value is not None and sign * value < sign * bound:
        return "its value is better than its bound"
    if known is None:
        return None
    if sign * bound > sign * known.value + known.rounded:
        return f"its bound excludes the known value {known.value:.10g}"
    if value is None:
        return "it claims that there is no route" if proven else None
    if known.bound is not None and sign * value < sign * known.bound - known.rounded:
        return f"its value is better than the known bound {known.bound:.10g}"
    return None


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table and its summary; return 1 if a result is contradictory, 2 for wrong input."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folders", type=Path, nargs="+", help="folders with problem files")
    parser.add_argument("--time-limit", type=float, default=30.0, help="seconds for each problem")
    parser.add_argument("--workers", type=int, default=2, help="processes of Argo's search")
    parser.add_argument("--seed", type=parse_seed, default=0)
    parser.add_argument(
        "--only", default="*", metavar="GLOB", help="only files with such names, as 'ft*'"
    )
    parser.add_argument("--peers", action=argparse.BooleanOptionalAction, default=True)
    parser.add_argument("--lkh", type=Path, help="the program LKH-3, which is then run too")
    options = parser.parse_args(arguments)
    peers = []
    if options.peers and find_spec("pyvrp"):
        peers.append(Peer("PyVRP", peer_pyvrp.unsupported_feature, peer_pyvrp.search_with_pyvrp))
    elif options.peers:
        print("PyVRP is not installed: it is left out")
    if options.lkh:
        search = partial(peer_lkh.search_with_lkh, options.lkh)
        peers.append(Peer("LKH-3", peer_lkh.unsupported_feature, search))
    rows: list[Row] = []
    try:
        paths = [path for folder in options.folders for path in find_files(folder, options.only)]
        problems = [(read_published_problem(path), path) for path in paths]
        print(_settings_line(options.time_limit, options.workers, options.seed) + "\n")
        print("\n".join(header_lines([peer.name for peer in peers])))
        for named, path in sorted(
            problems, key=lambda pair: (pair[0].kind, _node_count(pair[0]), pair[1].stem)
        ):
            rows.append(
                measure_problem(
                    path, named, options.time_limit, options.workers, options.seed, peers
                )
            )
            print(row_line(rows[-1]), flush=True)
    except ArgoError as error:
        print(error, file=sys.stderr)
        return 2
    print("".join(f"\n- {text}" for text in summary_lines(rows)))
    return int(any(row.wrong for row in rows))


def _settings_line(time_limit: float, workers: int, seed: int) -> str:
    return (
        f"{time_limit:g} s for each problem, {workers} workers of {os.cpu_count()} cores, seed "
        f"{seed}; Python {platform.python_version()}, OR-Tools {version('ortools')}"
    )


if __name__ == "__main__":
    sys.exit(main())
