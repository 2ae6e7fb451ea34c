"""Search for routes with LKH-3, which gives no bounds.

LKH-3 (K. Helsgaun, "An extension of the Lin-Kernighan-Helsgaun TSP solver for constrained traveling
salesman and vehicle routing problems", Roskilde 2017) is a program that is free for research and
not part of this project. It gets a route problem as an asymmetric tour (ATSP), one with precedence
(SOP) or one with windows (TSPTW), in whole numbers, and runs on one core. It does not support
optional visits, precedence and windows together, rounds, or a battery.
"""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.route import NEVER, Objective, RouteProblem, Tour, evaluate

_PRECISION = 10
_LARGEST = 100_000_000
"""largest distance, as LKH multiplies it by the precision to a 32-bit number"""
_PATIENCE = 10.0
"""wall time, as a multiple of the time limit, after which LKH is ended; LKH itself measures
processor time, and checks the limit only between two trials"""


def unsupported_feature(problem: RouteProblem) -> str | None:
    """Return a feature of the problem that LKH does not support; None: it supports all."""
    windows = _has_windows(problem)
    if any(not visit.mandatory for visit in problem.visits):
        return "optional visits"
    if problem.rounds:
        return "rounds"
    if problem.battery is not None:
        return "a battery"
    if windows and problem.precedences:
        return "precedence with windows"
    if problem.max_duration is not None and not windows:
        return "a maximum duration without windows"
    if windows and problem.objective == Objective.DURATION:
        return "waiting that counts as cost"
    if problem.size < 3:
        return "fewer than three visits"
    times = _times_with_service(problem)
    np.fill_diagonal(times, 0)
    for before, after in _ordered_pairs(problem):
        times[after, before] = 0
    if (times >= _LARGEST).any():
        return "missing connections or such long travel times"
    return None


def search_with_lkh(
    program: Path, problem: RouteProblem, time_limit: float, seed: int
) -> Tour | None:
    """Return the best route that LKH finds within the time limit (s); None: no feasible one.

    Raises:
        ArgoError: The program can't be run, or does not support the problem.
    """
    if feature := unsupported_feature(problem):
        raise ArgoError(f"LKH does not support {feature}; leave it out")
    with TemporaryDirectory() as folder:
        problem_file, tour_file = Path(folder, "problem"), Path(folder, "tour")
        problem_file.write_text("\n".join(_problem_lines(problem)) + "\n", encoding="utf-8")
        parameters = Path(folder, "parameters")
        special = "SPECIAL\n" if problem.precedences or _has_windows(problem) else ""
        parameters.write_text(
            f"{special}PROBLEM_FILE = {problem_file}\nTOUR_FILE = {tour_file}\nRUNS = 1\n"
            f"SEED = {seed + 1}\n"
            f"MAX_TRIALS = 1000000000\nTIME_LIMIT = {time_limit}\nTRACE_LEVEL = 0\n"
            f"PRECISION = {_PRECISION}\n",
            encoding="utf-8",
        )
        try:
            subprocess.run(
                [program.resolve(), parameters],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=_PATIENCE * time_limit + 5.0,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
        except OSError as error:
            raise ArgoError(
                f"{program} can't be run as LKH: {error.strerror}; name the program LKH-3"
            ) from None
        tour = _read_tour(tour_file, problem.size) if tour_file.exists() else None
        return tour if tour and evaluate(problem, tour).feasible else None


def _has_windows(problem: RouteProblem) -> bool:
    return any(visit.earliest or visit.latest is not None for visit in problem.visits)


def _times_with_service(problem: RouteProblem) -> NDArray[np.int64]:
    """Return travel times plus the service at the location that is left.

    The last row is that of the start, the last column that of the end.
    """
    n = problem.size
    return problem.travel[: n + 1, : n + 1] + np.array(
        [[visit.service] for visit in problem.visits] + [[0]]
    )


def _ordered_pairs(problem: RouteProblem) -> Iterator[tuple[int, int]]:
    """Yield all pairs of visits in each precedence constraint, the earlier visit first."""
    for precedence in problem.precedences:
        for k, before in enumerate(precedence.sequence):
            yield from ((before, after) for after in precedence.sequence[k + 1 :])


def _problem_lines(problem: RouteProblem) -> Iterator[str]:
    """Yield the lines of the problem in LKH's extension of TSPLIB. The depot is node 1."""
    n = problem.size
    depot_first = [n, *range(n)]
    times = np.minimum(_times_with_service(problem), NEVER)[np.ix_(depot_first, depot_first)]
    np.fill_diagonal(times, 0)
    kind = "SOP" if problem.precedences else "TSPTW" if _has_windows(problem) else "ATSP"
    if kind == "SOP":  # start and end are two nodes; -1: the column's node precedes the row's
        closed, times = times, np.full((n + 2, n + 2), -1, dtype=np.int64)
        times[:-1, 1:-1], times[:-1, -1] = closed[:, 1:], closed[:, 0]
        times[0, 0], times[0, -1], times[-1, -1] = 0, _LARGEST, 0
        for before, after in _ordered_pairs(problem):
            times[after + 1, before + 1] = -1
    yield from ("NAME: route", f"TYPE: {kind}", f"DIMENSION: {len(times)}")
    yield from ("EDGE_WEIGHT_TYPE: EXPLICIT", "EDGE_WEIGHT_FORMAT: FULL_MATRIX")
    yield "EDGE_WEIGHT_SECTION"
    if kind == "SOP":
        yield str(len(times))
    yield from (" ".join(map(str, row)) for row in times.tolist())
    if kind == "TSPTW":
        last = problem.max_duration or 2**31 - 1
        yield "TIME_WINDOW_SECTION"
        yield f"1 0 {last}"
        for node, visit in enumerate(problem.visits, 2):
            yield f"{node} {visit.earliest} {last if visit.latest is None else visit.latest}"
        yield from ("DEPOT_SECTION", "1", "-1")
    yield "EOF"


def _read_tour(path: Path, size: int) -> Tour:
    """Return the route from a tour file of LKH.

    The tour in the file may begin at any node. The route begins after the depot, which is node 1;
    visit k is node k + 2.
    """
    text = path.read_text(encoding="utf-8").partition("TOUR_SECTION")[2]
    nodes = [int(word) for word in text.split("-1")[0].split()]
    begin = nodes.index(1)
    return Tour(tuple(n - 2 for n in nodes[begin:] + nodes[:begin] if 2 <= n <= size + 1))
