"""Route problems stated for LKH-3, which searches and gives no bounds.

LKH-3 (K. Helsgaun, "An extension of the Lin-Kernighan-Helsgaun TSP solver for constrained traveling
salesman and vehicle routing problems", Roskilde 2017) is a program that is free for research and no
part of this project. It takes one of our problems as an asymmetric tour, one with precedence (SOP)
or one with windows (TSPTW), with whole numbers throughout, on one core. It leaves out no visit, and
knows neither precedence and windows together, nor rounds, nor a battery.
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
"""the largest distance: LKH takes them times the precision, as 32-bit numbers"""
_PATIENCE = 10.0
"""after how many times the time limit it is given up: it counts processor time, and looks at the
clock between two attempts only"""


def why_not(problem: RouteProblem) -> str | None:
    """Why LKH can't state the problem; None if it can."""
    windows = _windows(problem)
    if any(not visit.mandatory for visit in problem.visits):
        return "visits that may be left out"
    if problem.rounds:
        return "rounds"
    if problem.battery is not None:
        return "a battery"
    if windows and problem.precedences:
        return "precedence with windows"
    if problem.max_duration is not None and not windows:
        return "a limit to the duration without windows"
    if windows and problem.objective == Objective.DURATION:
        return "waiting that counts"
    if problem.size < 3:
        return "fewer than three visits"
    times = _times(problem)
    np.fill_diagonal(times, 0)
    for before, after in _pairs(problem):
        times[after, before] = 0
    if (times >= _LARGEST).any():
        return "ways that there are none of, or longer ones than it counts"
    return None


def search(program: Path, problem: RouteProblem, time_limit: float, seed: int) -> Tour | None:
    """The best route that LKH finds in that time (s); None: it has found none that is feasible.

    Raises ArgoError if the program can't be run or the problem not be stated.
    """
    if reason := why_not(problem):
        raise ArgoError(f"LKH does not know {reason}; leave it out")
    with TemporaryDirectory() as folder:
        stated, found = Path(folder, "problem"), Path(folder, "tour")
        stated.write_text("\n".join(_statement(problem)) + "\n", encoding="utf-8")
        given = Path(folder, "parameters")
        special = "SPECIAL\n" if problem.precedences or _windows(problem) else ""
        given.write_text(
            f"{special}PROBLEM_FILE = {stated}\nTOUR_FILE = {found}\nRUNS = 1\nSEED = {seed + 1}\n"
            f"MAX_TRIALS = 1000000000\nTIME_LIMIT = {time_limit}\nTRACE_LEVEL = 0\n"
            f"PRECISION = {_PRECISION}\n",
            encoding="utf-8",
        )
        try:
            subprocess.run(
                [program.resolve(), given],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                capture_output=True,
                timeout=_PATIENCE * time_limit + 5.0,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
        except OSError as error:
            raise ArgoError(f"{program}: can't be run as LKH: {error.strerror}; name it") from None
        tour = _tour(found, problem.size) if found.exists() else None
        return tour if tour and evaluate(problem, tour).feasible else None


def _windows(problem: RouteProblem) -> bool:
    return any(visit.earliest or visit.latest is not None for visit in problem.visits)


def _times(problem: RouteProblem) -> NDArray[np.int64]:
    """Travel times with the service at the place that is left; the last row is the start, the last
    column the end."""
    n = problem.size
    return problem.travel[: n + 1, : n + 1] + np.array(
        [[visit.service] for visit in problem.visits] + [[0]]
    )


def _pairs(problem: RouteProblem) -> Iterator[tuple[int, int]]:
    """Visits of which the first comes before the second."""
    for precedence in problem.precedences:
        for k, before in enumerate(precedence.sequence):
            yield from ((before, after) for after in precedence.sequence[k + 1 :])


def _statement(problem: RouteProblem) -> Iterator[str]:
    """The lines of the problem in LKH's extension of TSPLIB. The depot is node 1."""
    n = problem.size
    depot_first = [n, *range(n)]
    times = np.minimum(_times(problem), NEVER)[np.ix_(depot_first, depot_first)]
    np.fill_diagonal(times, 0)
    kind = "SOP" if problem.precedences else "TSPTW" if _windows(problem) else "ATSP"
    if kind == "SOP":  # the start and the end are apart, and -1 is: the column before the row
        closed, times = times, np.full((n + 2, n + 2), -1, dtype=np.int64)
        times[:-1, 1:-1], times[:-1, -1] = closed[:, 1:], closed[:, 0]
        times[0, 0], times[0, -1], times[-1, -1] = 0, _LARGEST, 0
        for before, after in _pairs(problem):
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


def _tour(path: Path, size: int) -> Tour:
    """What LKH wrote. It counts the depot as 1, and may begin elsewhere."""
    text = path.read_text(encoding="utf-8").partition("TOUR_SECTION")[2]
    nodes = [int(word) for word in text.split("-1")[0].split()]
    begin = nodes.index(1)
    return Tour(tuple(n - 2 for n in nodes[begin:] + nodes[:begin] if 2 <= n <= size + 1))
