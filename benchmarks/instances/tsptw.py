"""Tours with time windows, in the layout in which the instances of Ascheuer, Fischetti and
Groetschel and those of Dumas et al. are collected (López-Ibáñez and Blum, "Benchmark instances for
the travelling salesman problem with time windows", 2020): the number of nodes, the matrix of
travel times, which hold the service at the node that is left, and a window for each node. The first
node is the depot; what comes after `#` is a comment.
"""

import numpy as np

from argo_compiler.route.problem import Objective, RouteProblem, Visit
from benchmarks.instances.named import Kind, NamedProblem
from benchmarks.instances.text import Numbers, Source
from benchmarks.instances.tsplib import round_trip

_MAX_DECIMALS = 4


def read_tsptw(source: Source) -> NamedProblem:
    """The problem in a file of this layout. Raises ArgoError if there is none.

    The time windows say when a visit may begin; the objective is the travel without waiting. Times
    with decimals are made whole, and the problem's unit smaller.
    """
    bare = Source(source.path, tuple(line.partition("#")[0] for line in source.lines))
    numbers = Numbers(bare, range(len(bare.lines)))
    count = numbers.take(1, "the number of nodes")[0]
    first = next(k for k, line in enumerate(bare.lines) if line.strip())
    size = bare.nodes(first, count, 1)
    times = numbers.take(size * size, "the travel times")
    numbers.refuse(times < 0, "is a negative time", "correct it there")
    windows = numbers.take(2 * size, "the time windows").reshape(size, 2)
    closed = windows[:, 0] > windows[:, 1]
    numbers.refuse(
        np.stack([closed | (windows[:, 0] < 0), closed], axis=1).ravel(),
        "is part of a time window that is negative or ends before it begins",
        "correct it there",
    )
    numbers.finish("the time windows")
    scale = _scale(bare, np.concatenate([times, windows.ravel()]))
    travel = np.rint(times * scale).astype(np.int64).reshape(size, size)
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


def _scale(source: Source, values: np.ndarray) -> int:
    """The least power of ten by which all values become whole."""
    for decimals in range(_MAX_DECIMALS + 1):
        scaled = values * 10**decimals
        if (np.abs(scaled - np.rint(scaled)) < 1e-6 * np.maximum(1.0, scaled / 1e6)).all():
            return int(10**decimals)
    raise source.wrong(
        None, f"its times have more than {_MAX_DECIMALS} decimals", "round them to fewer"
    )
