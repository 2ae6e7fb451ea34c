"""Published route problems beside their known values and beside PyVRP.

    python -m benchmarks.routes FOLDER
    python -m benchmarks.routes FOLDER --time-limit 30 --workers 2 --only 'ftv*' --json routes.json

Reads all TSPLIB (.tsp, .atsp, .sop), OPLib (.oplib) and TSPTW (.tw) files in a folder and below,
and prints for each what `suggest_route` finds and proves within the time limit, and what PyVRP
finds in the same time and with the same seed, on one core, where it can state the problem: it knows
no precedence, and gives no bounds. Costs are those of the file; of orienteering problems it is the
score, and more is better. `off` is by how much a value is worse than the best known one. Each route
is evaluated again, apart from the solvers.

Known values of TSPLIB are those of its pages "ATSP" and "SOP" (G. Reinelt, Heidelberg,
comopt.ifi.uni-heidelberg.de/software/TSPLIB95); where two figures are given, they are the bounds
that it lists for an open problem. Those of OPLib are in the `.sol` files beside its problems, and
need not be the best; two were improved and proven with CP-SAT since. Those of tours with time
windows are in a file `best_known.txt` with lines `file cost violations`.
"""

import argparse
import json
import os
import platform
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import version
from itertools import groupby
from pathlib import Path

from argo_compiler.errors import ArgoError
from argo_compiler.route import Tour, evaluate
from argo_compiler.route.suggestion import suggest_route
from benchmarks import peer_pyvrp
from benchmarks.instances import Kind, NamedProblem, read_known_route, read_route_problem
from benchmarks.options import seed_number

ENDINGS = (".tsp", ".atsp", ".sop", ".oplib", ".tw")


@dataclass(frozen=True)
class Known:
    """What is known of a problem: a value that a route has, and one that none is better than."""

    value: float
    bound: float | None = None

    @property
    def proven(self) -> bool:
        return self.value == self.bound


def _optimal(values: dict[str, int]) -> dict[str, Known]:
    return {name: Known(value, value) for name, value in values.items()}


TSPLIB = {
    **_optimal({"br17": 39, "ft70": 38673, "ftv33": 1286, "ftv44": 1613}),
    **_optimal({"ftv170": 2755, "kro124p": 36230, "ry48p": 14422}),
    **_optimal({"br17.10": 55, "br17.12": 55, "ESC12": 1675, "ESC25": 1681, "ESC47": 1288}),
    **_optimal({"ft53.1": 7531, "ft53.4": 14425, "p43.1": 28140, "p43.4": 83005}),
    **_optimal({"prob.42": 243, "rbg048a": 351, "rbg050c": 467, "rbg109a": 1038}),
    **_optimal({"ry48p.1": 15805, "ry48p.4": 31446}),
    "kro124p.4": Known(76103, 73021),
    "ry48p.2": Known(16666, 16074),
}
OPLIB = _optimal({"eil51-gen2-50": 1674, "st70-gen2-50": 2286})


@dataclass(frozen=True)
class Row:
    """What was found for one problem. Values as the file counts."""

    name: str
    kind: Kind
    nodes: int
    known: Known | None
    value: float | None
    bound: float
    proven: bool
    seconds: float
    method: str
    peer: float | None
    """what PyVRP finds; None: nothing"""
    no_peer: str | None
    """why PyVRP was not asked"""
    wrong: str | None
    """what contradicts the evaluation or what is known: a defect of the solvers"""

    def off(self, value: float | None) -> float | None:
        """By what share a value is worse than the best known one, which may be ours."""
        values = [v for v in (self.value, self.peer, self.known and self.known.value) if v]
        if value is None or not values:
            return None
        if self.kind == Kind.OP:
            return (max(values) - value) / max(values)
        return (value - min(values)) / min(values)


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


def known_of(path: Path, kind: Kind) -> Known | None:
    """What is known of the problem in a file; see the top of this module."""
    name = path.stem
    if kind == Kind.OP:
        solution = path.with_suffix(".sol")
        published = Known(read_known_route(solution).score) if solution.exists() else None
        return OPLIB.get(name, published)
    if kind == Kind.TSPTW:
        listed = path.with_name("best_known.txt")
        lines = listed.read_text(encoding="utf-8").splitlines() if listed.exists() else []
        words = [line.split() for line in lines]
        costs = [float(word[1]) for word in words if len(word) == 3 and word[0] == path.name]
        return Known(costs[0]) if costs else None
    return TSPLIB.get(name)


def measure(path: Path, time_limit: float, workers: int, seed: int, peers: bool) -> Row:
    """What is found for the problem in a file. Raises ArgoError if the file holds none."""
    named = read_route_problem(path)
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
    peer, no_peer = None, peer_pyvrp.why_not(named.problem) if peers else "not asked"
    if no_peer is None:
        route = peer_pyvrp.search(named.problem, time_limit, seed)
        if route is not None:
            peer, unlike = _worth(named, route)
            no_peer = unlike and f"its route is none: {unlike}"
    return Row(
        path.stem, named.kind, len(named.nodes) + 1 + (named.kind == Kind.SOP), known, value,
        bound, found.proven, seconds, found.method, peer, no_peer, wrong,
    )  # fmt: skip


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
    if sign * bound > sign * known.value:
        return f"its bound excludes the known value {known.value:.10g}"
    if value is None:
        return "it says that there is no route" if proven else None
    if known.bound is not None and sign * value < sign * known.bound:
        return f"its value is better than the known bound {known.bound:.10g}"
    return None


HEADER = (
    f"{'problem':<18}{'kind':<7}{'nodes':>5}{'known':>9} {'ours':>9}{'bound':>9}{'proven':>8}"
    f"{'off':>8}{'time':>8}  {'PyVRP':>9}{'off':>8}  by"
)


def row_text(row: Row) -> str:
    """One line of the table."""
    known = (
        "-" if row.known is None else _number(row.known.value) + ("" if row.known.proven else "?")
    )
    return (
        f"{row.name:<18}{row.kind:<7}{row.nodes:>5}{known:>9} {_number(row.value):>9}"
        f"{_number(row.bound):>9}{'yes' if row.proven else 'no':>8}{_share(row.off(row.value)):>8}"
        f"{row.seconds:>7.2f}s  {_number(row.peer):>9}{_share(row.off(row.peer)):>8}  {row.method}"
        + (f"  WRONG: {row.wrong}" if row.wrong else "")
    )


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.10g}"


def _share(share: float | None) -> str:
    return "-" if share is None else f"{100 * share:.2f} %"


def summary(rows: Iterable[Row]) -> Iterator[str]:
    """What holds of the problems of each kind."""
    for kind, group in groupby(sorted(rows, key=lambda row: row.kind), key=lambda row: row.kind):
        some = list(group)
        best = sum(row.off(row.value) == 0.0 for row in some)
        line = (
            f"{kind}: {len(some)} problems, {sum(row.proven for row in some)} proven, best known "
            f"value or better {best} times, {sum(row.seconds for row in some):.1f} s in all"
        )
        stated = [row for row in some if row.no_peer is None]
        if stated:
            reached = sum(row.off(row.peer) == 0.0 for row in stated)
            line += f"; PyVRP best known value {reached} times of {len(stated)}"
        else:
            line += f"; PyVRP: {some[0].no_peer}"
        yield line


def main(arguments: Sequence[str] | None = None) -> int:
    """Prints all of it. Status 1: a route is not what its solver says."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--time-limit", type=float, default=30.0, help="s for each problem")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=seed_number, default=0)
    parser.add_argument("--only", default="*", metavar="GLOB", help="names of files, such as 'ft*'")
    parser.add_argument("--peers", action=argparse.BooleanOptionalAction, default=True)
    parser.add_argument("--json", type=Path, help="where the rows are written as well")
    given = parser.parse_args(arguments)
    rows: list[Row] = []
    try:
        paths = find_files(given.folder, given.only)
        print(_setting(given.time_limit, given.workers, given.seed))
        print(HEADER)
        for path in paths:
            row = measure(path, given.time_limit, given.workers, given.seed, given.peers)
            rows.append(row)
            print(row_text(row), flush=True)
            if given.json:
                setting = _setting(given.time_limit, given.workers, given.seed)
                written = {"setting": setting, "rows": [asdict(row) for row in rows]}
                given.json.write_text(json.dumps(written, indent=1) + "\n", encoding="utf-8")
    except ArgoError as error:
        print(error, file=sys.stderr)
        return 2
    for line in summary(rows):
        print(line)
    return int(any(row.wrong for row in rows))


def _setting(time_limit: float, workers: int, seed: int) -> str:
    return (
        f"{time_limit:g} s for each problem, {workers} workers of {os.cpu_count()} cores, seed "
        f"{seed}; Python {platform.python_version()}, OR-Tools {version('ortools')}"
    )


if __name__ == "__main__":
    sys.exit(main())
