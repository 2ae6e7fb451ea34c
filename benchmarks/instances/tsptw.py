"""Tours with time windows (M. López-Ibáñez and C. Blum, "Benchmark instances for the travelling
salesman problem with time windows", 2020), in the two layouts in which they are exchanged.

A matrix, as all of them are collected there: the number of nodes, the travel times, which hold the
service at the node that is left, and a window for each node; what comes after `#` is a comment.
Times of Ascheuer, Fischetti and Groetschel, of Dumas et al., of Gendreau et al. and of Ohlmann and
Thomas are whole; those of Pesant et al. have 4 decimals, those of Potvin and Bengio up to 5.

Coordinates, as Gendreau et al. and Ohlmann and Thomas published theirs: after a line `CUST NO. ...`
a row `number x y demand opens closes service` for each node, up to one with the number 999. Times
are Euclidean distances without their decimals, which breaks the triangle inequality; so each, row
by row, is then made as short as the best way over one other node. That gives the collected
matrices, to the last one of 140.

The first node is the depot.
"""

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.problem import Objective, RouteProblem, Visit
from benchmarks.instances.named import Kind, NamedProblem
from benchmarks.instances.text import Numbers, Source
from benchmarks.instances.tsplib import round_trip

_MAX_DECIMALS = 5
_COLUMNS, _AFTER_LAST = 7, 999
_NO_WINDOW = "is part of a time window that is negative or ends before it begins"
_CORRECT = "correct it there"


def read_tsptw(source: Source) -> NamedProblem:
    """The problem in a file of one of these layouts. Raises ArgoError if there is none.

    The time windows say when a visit may begin; the objective is the travel without waiting. Times
    with decimals are made whole, and the problem's unit smaller.
    """
    bare = Source(source.path, tuple(line.partition("#")[0] for line in source.lines))
    header = next((k for k, line in enumerate(bare.lines) if line.startswith("CUST NO.")), None)
    times, windows = _matrix(bare) if header is None else _coordinates(bare, header)
    size = len(times)
    scale = _scale(bare, np.concatenate([times.ravel(), windows.ravel()]))
    travel = np.rint(times * scale).astype(np.int64)
    np.fill_diagonal(travel, 0)
    opens, closes = np.rint(windows * scale).astype(np.int64).T.tolist()
    begin = opens[0]  # the clock of a route problem starts when the robot sets off
    nodes = tuple(range(2, size + 1))
    visits = tuple(
        Visit(
            f"node {node}",
            earliest=max(0, opens[node - 1] - begin),
            latest=closes[node - 1] - begin,
        )
        for node in nodes
    )
    problem = RouteProblem(
        visits,
        round_trip(travel, 0),
        max_duration=closes[0] - begin,
        objective=Objective.TRAVEL,
        unit=1.0 / scale,
        words={"max_duration": f"back at the depot by {windows[0, 1]:g}"},
    )
    return NamedProblem(source.path.stem, Kind.TSPTW, problem, nodes)


def _matrix(bare: Source) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The travel times, shape (nodes, nodes), and the windows, shape (nodes, 2)."""
    numbers = Numbers(bare, range(len(bare.lines)))
    count = numbers.take(1, "the number of nodes")[0]
    first = next(k for k, line in enumerate(bare.lines) if line.strip())
    size = bare.nodes(first, count, 1)
    times = numbers.take(size * size, "the travel times")
    numbers.refuse(times < 0, "is a negative time", "correct it there")
    windows = numbers.take(2 * size, "the time windows").reshape(size, 2)
    closed = windows[:, 0] > windows[:, 1]
    numbers.refuse(
        np.stack([closed | (windows[:, 0] < 0), closed], axis=1).ravel(), _NO_WINDOW, _CORRECT
    )
    numbers.finish("the time windows")
    return times.reshape(size, size), windows


def _coordinates(bare: Source, header: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    numbers = Numbers(bare, range(header + 1, len(bare.lines)))
    rows = []
    while numbers.left:
        row = numbers.take(_COLUMNS, "a node")
        if row[0] == _AFTER_LAST:
            numbers.finish("the node 999, which is after the last,")
            break
        opens, closes, service = row[4:]
        wrong = np.zeros(_COLUMNS, dtype=bool)
        wrong[4:6] = not 0 <= opens <= closes
        numbers.refuse(wrong, _NO_WINDOW, _CORRECT)
        wrong = np.array([False] * 6 + [service != 0])
        numbers.refuse(wrong, "is a service, which these files have none of", _CORRECT)
        rows.append(row)
    size = bare.nodes(header, len(rows), 1)
    nodes = np.array(rows)
    times = np.floor(np.hypot(*(nodes[:, None, 1:3] - nodes[:, 1:3]).T))
    for k in range(size):
        for j in range(size):
            times[k, j] = (times[k] + times[:, j]).min()
    return times, nodes[:, 4:6]


def _scale(source: Source, values: np.ndarray) -> int:
    """The least power of ten by which all values become whole."""
    for decimals in range(_MAX_DECIMALS + 1):
        scaled = values * 10**decimals
        if (np.abs(scaled - np.rint(scaled)) < 1e-6 * np.maximum(1.0, scaled / 1e6)).all():
            return int(10**decimals)
    raise source.wrong(
        None, f"its times have more than {_MAX_DECIMALS} decimals", "round them to fewer"
    )
