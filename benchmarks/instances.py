"""Route problems from the files that researchers exchange: TSPLIB, OPLib and TSPTW.

Of the readers that are kept up, vrplib 2.2 takes each line of a matrix for a row of it, where these
files break rows at will, leaves Euclidean distances unrounded and knows no pseudo-Euclidean ones;
tsplib95 has had no release since 2020. So this one is our own. TSPLIB's form and distances are
those of G. Reinelt, "TSPLIB 95", Heidelberg 1995, sections 1 and 2; OPLib adds scores to them.

Tours with time windows (M. López-Ibáñez and C. Blum, "Benchmark instances for the travelling
salesman problem with time windows", 2020) come in two layouts. A matrix, as all of them are
collected there: the number of nodes, the travel times, which hold the service at the node that is
left, and a window for each node; what comes after `#` is a comment. Or coordinates, as Gendreau et
al. and Ohlmann and Thomas published theirs: after a line `CUST NO. ...` a row `number x y demand
opens closes service` for each node, up to one with the number 999. Times are then Euclidean
distances without their decimals, which breaks the triangle inequality; so each, row by row, is made
as short as the best way over one other node. That gives the collected matrices, to the last one
of 140. The first node is the depot.
"""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.files.reading import read_text
from argo_compiler.route.problem import (
    NEVER,
    Objective,
    Precedence,
    RouteProblem,
    Tour,
    Visit,
)

MAX_BYTES = 100_000_000
MAX_NODES = 3000
"""Far above any problem that is solved in minutes, and below what would exhaust the memory."""
LARGEST = 10**10
"""the greatest number that is read: its sums stay far from where whole numbers overflow"""
FORBIDDEN = -1
"""in a sequential ordering problem: the column's node comes before the row's"""

_FILE = "TSPLIB, OPLib or TSPTW file"
_KEYWORD = re.compile(r"\s*([A-Za-z][A-Za-z_0-9]*)\s*(?::\s*(.*?)\s*)?", re.ASCII)
_TRIANGLES = {
    "UPPER_ROW": (np.triu_indices, 1),
    "LOWER_ROW": (np.tril_indices, -1),
    "UPPER_DIAG_ROW": (np.triu_indices, 0),
    "LOWER_DIAG_ROW": (np.tril_indices, 0),
}
_PI, _EARTH_KM = 3.141592, 6378.388  # as TSPLIB defines them
_MAX_DECIMALS = 5
_COLUMNS, _AFTER_LAST = 7, 999


class Kind(StrEnum):
    """The kinds of problems that files hold, as they name them."""

    TSP = "TSP"
    ATSP = "ATSP"
    """asymmetric: from a node through all others and back"""
    SOP = "SOP"
    """sequential ordering: from the first node to the last, with precedence"""
    OP = "OP"
    """orienteering: as much score as a cost limit allows"""
    TSPTW = "TSPTW"
    """with time windows; waiting costs nothing"""


@dataclass(frozen=True, eq=False)
class NamedProblem:
    """A problem that was read from a file, and how its visits and values are those of the file."""

    name: str
    """of the file: TSPLIB's and OPLib's own names don't always tell files apart"""
    kind: Kind
    problem: RouteProblem
    nodes: tuple[int, ...]
    """the number of the node of each visit, as the file counts, which is from 1"""
    start_score: int = 0
    """what the start itself is worth: files count it, a route problem does not"""

    def value(self, prize: int, cost: int) -> float:
        """Return what the file's literature tells of a route, or a bound, with that prize and cost:
        the score where it is the aim, else the cost in the file's unit."""
        if self.problem.objective == Objective.PRIZE:
            return prize + self.start_score
        return cost * self.problem.unit

    def route(self, nodes: Sequence[int]) -> Tour:
        """Return the route through these nodes; the start and the end may be among them."""
        visits = {node: visit for visit, node in enumerate(self.nodes)}
        return Tour(tuple(visits[node] for node in nodes if node in visits))


@dataclass(frozen=True)
class KnownRoute:
    """A route as OPLib publishes it; not always the best one."""

    nodes: tuple[int, ...]
    """as the file counts, the depot first"""
    score: int
    cost: int


def read_route_problem(path: Path) -> NamedProblem:
    """Return the problem in a TSPLIB (TSP, ATSP, SOP), OPLib or TSPTW file.

    Raises ArgoError if the file can't be read or holds none.
    """
    lines = read_text(path, _FILE, MAX_BYTES).splitlines()
    first = next((line.lstrip() for line in lines if line.strip()), "?")
    try:
        if first[0] in "0123456789#!":
            return _time_windows(path.stem, [line.partition("#")[0] for line in lines])
        return _tsplib(path.stem, *_keywords(lines))
    except (ArgoError, ValueError, LookupError) as error:
        raise _wrong(path, error) from None


def read_known_route(path: Path) -> KnownRoute:
    """Return the route in a `.sol` file of OPLib. Raises ArgoError if there is none."""
    try:
        values, sections = _keywords(read_text(path, _FILE, MAX_BYTES).splitlines())
        nodes = sections["NODE_SEQUENCE"][: int(values["ROUTE_NODES"])]
        return KnownRoute(
            tuple(map(int, nodes)), int(values["ROUTE_SCORE"]), int(values["ROUTE_COST"])
        )
    except (ValueError, LookupError) as error:
        raise _wrong(path, error) from None


def _wrong(path: Path, error: Exception) -> ArgoError:
    said = f"{error.args[0]} is missing or unknown" if isinstance(error, KeyError) else error
    return ArgoError(f"{path}: is not read: {said}; name a {_FILE}")


def _keywords(lines: Iterable[str]) -> tuple[dict[str, str], dict[str, list[float]]]:
    """Return what is said by keywords, and the numbers of the sections, without `_SECTION`."""
    values: dict[str, str] = {}
    sections: dict[str, list[float]] = {}
    numbers: list[float] | None = None
    for line in lines:
        text = line.strip()
        if text.upper() == "EOF":
            break
        if match := _KEYWORD.fullmatch(text):
            keyword, value = match[1].upper(), match[2] or ""
            numbers = None
            if keyword != "COMMENT" and keyword in values.keys() | sections.keys():
                raise ValueError(f"{keyword} stands there twice")
            if keyword.endswith("_SECTION"):
                numbers = sections[keyword.removesuffix("_SECTION")] = []
            else:
                values[keyword] = value
        elif text and numbers is None:
            raise ValueError(f"`{text[:40]}` is no keyword with its value")
        elif numbers is not None:
            numbers += _numbers(text)
    return values, sections


def _numbers(text: str) -> list[float]:
    values = [float(word) for word in text.split()]
    if not all(abs(value) <= LARGEST for value in values):  # nor is nan
        raise ValueError(f"`{text[:40]}` has a number above {LARGEST}")
    return values


def _count(number: float, least: int) -> int:
    """Return the number of nodes. Raises ValueError if it can't be one."""
    if number != int(number) or not least <= number <= MAX_NODES:
        raise ValueError(f"it has {number:g} nodes, and not {least} to {MAX_NODES}")
    return int(number)


def _array(numbers: Sequence[float], *shape: int, whole_from: int | None = None) -> NDArray:
    """Return the numbers in that shape; whole ones of at least so much, where that is told."""
    found = np.array(numbers, dtype=np.float64).reshape(shape)
    if whole_from is None:
        return found
    if (found != np.rint(found)).any() or (found < whole_from).any():
        raise ValueError(f"there are numbers that are not whole, or below {whole_from}")
    return found.astype(np.int64)


def _by_node(numbers: Sequence[float], nodes: int, columns: int) -> NDArray[np.float64]:
    """Return what the rows `number value ...` say of each node, shape (nodes, columns)."""
    rows = _array(numbers, nodes, columns + 1)
    order = np.argsort(rows[:, 0])
    if (rows[order, 0] != np.arange(1, nodes + 1)).any():
        raise ValueError(f"the rows of the nodes are not numbered from 1 to {nodes}")
    return rows[order, 1:]


def _tsplib(name: str, values: dict[str, str], sections: dict[str, list[float]]) -> NamedProblem:
    kind = Kind(values["TYPE"].partition(" ")[0])
    nodes = _count(int(values["DIMENSION"]), 2 if kind == Kind.SOP else 1)
    distances = _distances(values, sections, nodes)
    np.fill_diagonal(distances, 0)
    if kind == Kind.SOP:
        return _ordering(name, distances)
    if (distances == FORBIDDEN).any():
        raise ValueError(f"its TYPE is {kind}, but it has distances of -1, as those of SOP have")
    if kind == Kind.OP:
        return _orienteering(name, values, sections, distances)
    visited = tuple(range(2, nodes + 1))
    visits = tuple(Visit(f"node {node}") for node in visited)
    return NamedProblem(name, kind, RouteProblem(visits, _round_trip(distances, 0)), visited)


def _round_trip(distances: NDArray[np.int64], start: int) -> NDArray[np.int64]:
    """Return the travel times of a RouteProblem whose visits are all nodes but the start, from
    which the route goes and to which it returns."""
    last = [node for node in range(len(distances)) if node != start] + [start]
    return np.ascontiguousarray(distances[np.ix_(last, last)])


def _ordering(name: str, distances: NDArray[np.int64]) -> NamedProblem:
    size = len(distances)
    nodes = tuple(range(2, size))
    precedences = tuple(
        Precedence((before - 1, after - 1), f"node {before + 1} before node {after + 1}")
        for after, before in np.argwhere(distances == FORBIDDEN).tolist()
        if 0 < before < size - 1 and 0 < after < size - 1
    )
    if (distances[0, 1:] == FORBIDDEN).any() or (distances[:-1, -1] == FORBIDDEN).any():
        raise ValueError("by its -1, a node comes before the first or after the last")
    possible = np.where(distances == FORBIDDEN, NEVER, distances)
    # The row of the start is the first node's, the column of the end the last one's.
    travel = np.zeros((size - 1, size - 1), dtype=np.int64)
    travel[:-1, :] = possible[1:-1, 1:]
    travel[-1, :] = possible[0, 1:]
    visits = tuple(Visit(f"node {node}") for node in nodes)
    return NamedProblem(name, Kind.SOP, RouteProblem(visits, travel, precedences), nodes)


def _orienteering(
    name: str,
    values: dict[str, str],
    sections: dict[str, list[float]],
    distances: NDArray[np.int64],
) -> NamedProblem:
    size = len(distances)
    scores = _array(_by_node(sections["NODE_SCORE"], size, 1), size, whole_from=0).tolist()
    depot = range(1, size + 1).index(int(sections["DEPOT"][0]))
    nodes = tuple(node + 1 for node in range(size) if node != depot)
    limit = int(values["COST_LIMIT"])
    if not 0 <= limit <= LARGEST:
        raise ValueError(f"the COST_LIMIT {limit} is not between 0 and {LARGEST}")
    problem = RouteProblem(
        tuple(Visit(f"node {node}", mandatory=False, prize=scores[node - 1]) for node in nodes),
        _round_trip(distances, depot),
        max_duration=limit,
        objective=Objective.PRIZE,
        words={"max_duration": f"cost limit {limit}"},
    )
    return NamedProblem(name, Kind.OP, problem, nodes, scores[depot])


def _distances(
    values: dict[str, str], sections: dict[str, list[float]], nodes: int
) -> NDArray[np.int64]:
    """Return the distances from row to column, shape (nodes, nodes)."""
    kind = values["EDGE_WEIGHT_TYPE"]
    if kind != "EXPLICIT":
        return _between(_by_node(sections["NODE_COORD"], nodes, 2), kind)
    form, numbers = values["EDGE_WEIGHT_FORMAT"], sections["EDGE_WEIGHT"]
    if form == "FULL_MATRIX":
        # Files with sequential ordering problems state the number of nodes again.
        again = len(numbers) == nodes * nodes + 1 and numbers[0] == nodes
        return _array(numbers[again:], nodes, nodes, whole_from=FORBIDDEN)
    indices, offset = _TRIANGLES[form]
    rows, columns = indices(nodes, offset)
    found = np.zeros((nodes, nodes), dtype=np.int64)
    found[rows, columns] = _array(numbers, len(rows), whole_from=FORBIDDEN)
    return np.maximum(found, found.T)


def _between(coordinates: NDArray[np.float64], kind: str) -> NDArray[np.int64]:
    if kind == "GEO":
        return _on_earth(coordinates)
    square = ((coordinates[:, None, :] - coordinates[None, :, :]) ** 2).sum(axis=2)
    lengths = {
        "EUC_2D": lambda: np.floor(np.sqrt(square) + 0.5),
        "CEIL_2D": lambda: np.ceil(np.sqrt(square)),
        "ATT": lambda: np.ceil(np.sqrt(square / 10.0)),  # pseudo-Euclidean
    }
    return lengths[kind]().astype(np.int64)


def _on_earth(coordinates: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the kilometres between latitudes and longitudes, written as degrees.minutes."""
    degrees = np.trunc(coordinates)
    latitude, longitude = (_PI * (degrees + 5.0 * (coordinates - degrees) / 3.0) / 180.0).T
    q1 = np.cos(longitude[:, None] - longitude)
    q2 = np.cos(latitude[:, None] - latitude)
    q3 = np.cos(latitude[:, None] + latitude)
    cosine = 0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3)
    return np.asarray(_EARTH_KM * np.arccos(np.clip(cosine, -1.0, 1.0)) + 1.0, dtype=np.int64)


def _time_windows(name: str, lines: Sequence[str]) -> NamedProblem:
    """Return the problem in a file of one of the layouts with time windows.

    The windows say when a visit may begin; the objective is the travel without waiting. Times with
    decimals are made whole, and the problem's unit smaller.
    """
    header = next((k for k, line in enumerate(lines) if line.startswith("CUST NO.")), None)
    numbers = [value for line in lines[header and header + 1 :] for value in _numbers(line)]
    times, windows = _matrix(numbers) if header is None else _customers(numbers)
    if (times < 0).any() or (windows < 0).any() or (windows[:, 0] > windows[:, 1]).any():
        raise ValueError("a time is negative, or a time window ends before it begins")
    scale = _scale(np.concatenate([times.ravel(), windows.ravel()]))
    travel = np.rint(times * scale).astype(np.int64)
    np.fill_diagonal(travel, 0)
    opens, closes = np.rint(windows * scale).astype(np.int64).T.tolist()
    begin = opens[0]  # the clock of a route problem starts when the robot sets off
    nodes = tuple(range(2, len(times) + 1))
    visits = tuple(
        Visit(f"node {k}", earliest=max(0, opens[k - 1] - begin), latest=closes[k - 1] - begin)
        for k in nodes
    )
    problem = RouteProblem(
        visits,
        _round_trip(travel, 0),
        max_duration=closes[0] - begin,
        objective=Objective.TRAVEL,
        unit=1.0 / scale,
        words={"max_duration": f"back at the depot by {windows[0, 1]:g}"},
    )
    return NamedProblem(name, Kind.TSPTW, problem, nodes)


def _matrix(numbers: Sequence[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the travel times, shape (nodes, nodes), and the windows, shape (nodes, 2)."""
    size = _count(numbers[0], 1)
    end = 1 + size * size
    return _array(numbers[1:end], size, size), _array(numbers[end:], size, 2)


def _customers(numbers: Sequence[float]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    nodes = _array(numbers, -1, _COLUMNS)
    nodes = nodes[:-1] if nodes[-1, 0] == _AFTER_LAST else nodes
    size = _count(len(nodes), 1)
    if nodes[:, 6].any():
        raise ValueError("a node has a service, which these files have none of")
    times = np.floor(np.hypot(*(nodes[:, None, 1:3] - nodes[:, 1:3]).T))
    for k in range(size):
        for j in range(size):
            times[k, j] = (times[k] + times[:, j]).min()
    return times, nodes[:, 4:6]


def _scale(values: NDArray[np.float64]) -> int:
    """Return the least power of ten by which all values become whole."""
    for decimals in range(_MAX_DECIMALS + 1):
        scaled = values * 10**decimals
        if (np.abs(scaled - np.rint(scaled)) < 1e-6 * np.maximum(1.0, scaled / 1e6)).all():
            return int(10**decimals)
    raise ValueError(f"its times have more than {_MAX_DECIMALS} decimals")
