"""Reader of published route problems in the formats TSPLIB, OPLib and TSPTW.

No maintained reader fits. vrplib 2.2 takes each line of a matrix as one of its rows, but these
files break rows anywhere; it does not round Euclidean distances and does not support
pseudo-Euclidean ones. tsplib95 has had no release since 2020. The format and the distances of
TSPLIB are those of G. Reinelt, "TSPLIB 95", Heidelberg 1995, sections 1 and 2; OPLib adds scores to
them.

Tours with time windows (M. López-Ibáñez and C. Blum, "Benchmark instances for the travelling
salesman problem with time windows", 2020) have one of two layouts. The first node is the depot.

- Matrix, the layout of that collection: the number of nodes, the travel times, which include the
  service at the node that is left, and a window for each node. Text after `#` is a comment.
- Coordinates, as published by Gendreau et al. and by Ohlmann and Thomas: after `CUST NO. ...` a
  row `number x y demand opens closes service` for each node, up to a row with the number 999.
  Times are Euclidean distances without their decimals. As this violates the triangle inequality,
  each time is reduced, row by row, to that of the best path over one other node. The results equal
  the matrices of the collection, for all 140 problems.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.files.loading import read_text
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
"""largest number of nodes, far above any problem that is solved in minutes, and within memory"""
LARGEST = 10**10
"""largest absolute value that is accepted; its sums stay far from an overflow of 64-bit integers"""
FORBIDDEN = -1
"""entry of a sequential ordering problem's matrix if the column's node precedes the row's"""

_FILE = "TSPLIB, OPLib or TSPTW file"
_CORRECT = "correct it there"
_NUMBER_CHARACTERS = frozenset("0123456789+-.eE \t\r\f\v")
_KEYWORD = re.compile(r"\s*([A-Za-z][A-Za-z_0-9]*)\s*(?::\s*(.*?)\s*)?", re.ASCII)
_TRIANGLES = {
    "UPPER_ROW": (np.triu_indices, 1),
    "LOWER_ROW": (np.tril_indices, -1),
    "UPPER_DIAG_ROW": (np.triu_indices, 0),
    "LOWER_DIAG_ROW": (np.tril_indices, 0),
}
_COORDINATE_TYPES = ("EUC_2D", "CEIL_2D", "ATT", "GEO")
_PI, _EARTH_KM = 3.141592, 6378.388  # as TSPLIB defines them
_MAX_DECIMALS = 5
_COLUMNS, _AFTER_LAST = 7, 999


class Kind(StrEnum):
    """Kind of a problem, with the name that files use."""

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
    """Problem read from a file, with the file's numbers of its nodes and its unit of values."""

    name: str
    """name of the file, as the names in TSPLIB and OPLib files are not always unique"""
    kind: Kind
    problem: RouteProblem
    nodes: tuple[int, ...]
    """number of the node of each visit; files count from 1"""
    start_score: int = 0
    """score of the start, which files count and a route problem does not"""

    def published_value(self, prize: int, cost: int) -> float:
        """Return the value that publications state for a route or bound of this prize and cost.

        It is the score if the objective is the prize, otherwise the cost in the file's unit.
        """
        if self.problem.objective == Objective.PRIZE:
            return prize + self.start_score
        return cost * self.problem.unit

    def make_route(self, nodes: Sequence[int]) -> Tour:
        """Return the route through nodes, by their numbers in the file, without start and end."""
        visits = {node: visit for visit, node in enumerate(self.nodes)}
        return Tour(tuple(visits[node] for node in nodes if node in visits))


@dataclass(frozen=True)
class KnownRoute:
    """Route published by OPLib, which need not be optimal."""

    nodes: tuple[int, ...]
    """numbers of the nodes, counted from 1, the depot first"""
    score: int
    cost: int


def read_published_problem(path: Path) -> NamedProblem:
    """Return the problem in a TSPLIB (TSP, ATSP, SOP), OPLib or TSPTW file.

    Raises:
        ArgoError: The file can't be read or has no such problem. The message names the line if one
            line is at fault.
    """
    file = _read(path)
    first = next(line for line in file.lines if line.strip()).lstrip()
    try:
        return (
            _parse_time_windows(file)
            if first[0] in "0123456789#!"
            else _parse_tsplib(_parse_keywords(file))
        )
    except ArgoError as error:
        if str(path) in str(error):
            raise
        raise ArgoError(f"{path}: {error}") from None  # RouteProblem does not know the file


def read_known_route(path: Path) -> KnownRoute:
    """Return the route in a `.sol` file of OPLib; raises ArgoError if there is none."""
    keywords = _parse_keywords(_read(path))
    numbers = keywords.section("NODE_SEQUENCE")
    nodes = numbers.take(keywords.whole_number("ROUTE_NODES"), "NODE_SEQUENCE_SECTION")
    wrong = (nodes < 1) | (nodes != np.rint(nodes))
    numbers.raise_if(wrong, "is not a node", "nodes are counted from 1")
    score, cost = keywords.whole_number("ROUTE_SCORE"), keywords.whole_number("ROUTE_COST")
    return KnownRoute(tuple(int(node) for node in nodes), score, cost)


@dataclass(frozen=True)
class _File:
    """Text file as its lines, counted from 0."""

    path: Path
    lines: tuple[str, ...]

    def error(self, line: int | None, problem: str, remedy: str) -> ArgoError:
        """Return an error at a line, or about the file as a whole if the line is None."""
        place = f"{self.path}" if line is None else f"{self.path}:{line + 1}"
        return ArgoError(f"{place}: {problem}; {remedy}")

    def check_node_count(self, line: int | None, count: float, minimum: int) -> int:
        """Return a number of nodes as an integer; raises ArgoError if it is out of range."""
        if count != int(count) or count < minimum:
            problem = f"{count:g} nodes are no problem"
            raise self.error(line, problem, f"a problem needs {minimum} or more")
        if count > MAX_NODES:
            problem = f"it has {count:.0f} nodes"
            raise self.error(line, problem, f"at most {MAX_NODES} are read: take a part")
        return int(count)


def _read(path: Path) -> _File:
    text = read_text(path, _FILE, MAX_BYTES)
    if not text.strip():
        raise ArgoError(f"{path}: the file is empty; name a {_FILE}")
    return _File(path, tuple(text.splitlines()))


class _Numbers:
    """Numbers in some lines of a file, taken one after the other. Has state: the next number."""

    def __init__(self, file: _File, lines: Iterable[int]) -> None:
        """Read the numbers in the lines with these indices; raises ArgoError at any other word."""
        self._file = file
        self._lines = list(lines)
        rows = [_parse_numbers(file, line) for line in self._lines]
        self._line = [line for line, row in zip(self._lines, rows, strict=True) for _ in row]
        """line of each number"""
        self._values = np.array([value for row in rows for value in row], dtype=np.float64)
        self._next = 0

    @property
    def remaining(self) -> int:
        """Count of numbers that have not been taken."""
        return len(self._values) - self._next

    def take(self, count: int, subject: str) -> NDArray[np.float64]:
        """Return the next numbers; raises ArgoError that names the subject if some are missing."""
        if self.remaining < count:
            problem = f"of {count} numbers for {subject} there are {self.remaining}"
            last = self._lines[-1] if self._lines else None
            raise self._file.error(last, problem, "is the file complete?")
        self._next += count
        return self._values[self._next - count : self._next]

    def skip(self, value: float) -> None:
        """Skip the next number if it is equal to a value."""
        if self.remaining and self._values[self._next] == value:
            self._next += 1

    def raise_if(self, wrong: NDArray[np.bool_], problem: str, remedy: str) -> None:
        """Raise ArgoError at the first wrong number of those taken last, if there is one."""
        if wrong.any():
            first = self._next - wrong.size + int(np.flatnonzero(wrong)[0])
            problem = f"{self._values[first]:g} {problem}"
            raise self._file.error(self._line[first], problem, remedy)

    def expect_end(self, subject: str) -> None:
        """Raise ArgoError if there are more numbers than those that were taken."""
        if self.remaining:
            problem = f"there are {self.remaining} numbers more than {subject} needs"
            remedy = "does the number of nodes agree with them?"
            raise self._file.error(self._line[self._next], problem, remedy)


def _parse_numbers(file: _File, line: int) -> list[float]:
    numbers = []
    for word in file.lines[line].split():
        try:
            # float() also accepts `nan`, `1_000` and digits of other scripts.
            value = float(word) if _NUMBER_CHARACTERS.issuperset(word) else np.nan
        except ValueError:
            value = np.nan
        if not abs(value) <= LARGEST:
            raise file.error(line, f"`{word[:40]}` is not a number of up to {LARGEST}", _CORRECT)
        numbers.append(value)
    return numbers


@dataclass(frozen=True)
class _Keywords:
    """Keywords of a TSPLIB or OPLib file with their values, and its sections of numbers."""

    file: _File
    values: Mapping[str, tuple[int, str]]
    """line and value by keyword"""
    sections: Mapping[str, range]
    """lines with the numbers of each section, by keyword without `_SECTION`"""

    def value_of(self, keyword: str) -> tuple[int, str]:
        """Return the line and the value of a keyword; raises ArgoError if it is missing."""
        if keyword not in self.values:
            raise self.file.error(None, f"it has no {keyword}", f"add a line `{keyword}: ...`")
        return self.values[keyword]

    def whole_number(self, keyword: str) -> int:
        """Return the whole number of a keyword; raises ArgoError if it is missing or not whole."""
        line, text = self.value_of(keyword)
        try:
            if abs(number := int(text)) <= LARGEST:
                return number
        except ValueError:
            pass
        problem = f"{keyword} `{text[:40]}` is not a whole number of up to {LARGEST}"
        raise self.file.error(line, problem, _CORRECT)

    def section(self, keyword: str) -> _Numbers:
        """Return the numbers of a section; raises ArgoError if it is missing."""
        if keyword not in self.sections:
            remedy = "add it, or is the file cut off?"
            raise self.file.error(None, f"it has no {keyword}_SECTION", remedy)
        return _Numbers(self.file, self.sections[keyword])

    def unknown_value(self, keyword: str, problem: str, known: Iterable[str]) -> ArgoError:
        """Return an error at the keyword's line that lists the known values."""
        return self.file.error(self.values[keyword][0], problem, f"there are: {', '.join(known)}")


def _parse_keywords(file: _File) -> _Keywords:
    """Return the keywords and sections of a file; the lines of sections are not checked.

    Raises:
        ArgoError: A line outside sections is no keyword, or one other than COMMENT is repeated.
    """
    values: dict[str, tuple[int, str]] = {}
    sections: dict[str, range] = {}
    section: str | None = None
    for line, text in enumerate(file.lines):
        if text.strip().upper() == "EOF":
            break
        match = _KEYWORD.fullmatch(text)
        if match is None and section is not None:
            sections[section] = range(sections[section].start, line + 1)
        elif match is None and text.strip():
            problem = f"`{text.strip()[:40]}` is not a keyword with its value"
            raise file.error(line, problem, f"is this a {_FILE}?")
        elif match is not None:
            keyword, value = match[1].upper(), match[2] or ""
            name = keyword.removesuffix("_SECTION")
            section = name if name != keyword else None
            if keyword != "COMMENT" and (keyword in values or name in sections):
                raise file.error(line, f"{keyword} is given a second time", "remove one of the two")
            if section is None:
                values.setdefault(keyword, (line, value))
            else:
                sections[section] = range(line + 1, line + 1)
    return _Keywords(file, values, sections)


def _parse_tsplib(keywords: _Keywords) -> NamedProblem:
    kind = keywords.value_of("TYPE")[1].partition(" ")[0]
    known = (Kind.TSP, Kind.ATSP, Kind.SOP, Kind.OP)
    minimum = 2 if kind == Kind.SOP else 1
    line, count = keywords.value_of("DIMENSION")[0], keywords.whole_number("DIMENSION")
    nodes = keywords.file.check_node_count(line, count, minimum)
    if kind not in known:
        raise keywords.unknown_value("TYPE", f"problems of TYPE `{kind}` are not read", known)
    distances = _distances(keywords, nodes)
    np.fill_diagonal(distances, 0)
    if kind == Kind.SOP:
        return _make_ordering_problem(keywords, distances)
    if (distances == FORBIDDEN).any():
        message = "it has distances of -1, which stand for precedence"
        remedy = "is its TYPE meant to be SOP?"
        raise keywords.file.error(keywords.value_of("TYPE")[0], message, remedy)
    if kind == Kind.OP:
        return _make_orienteering_problem(keywords, distances)
    visited = tuple(range(2, nodes + 1))
    visits = tuple(Visit(f"node {node}") for node in visited)
    problem = RouteProblem(visits, _round_trip(distances, 0))
    return NamedProblem(keywords.file.path.stem, Kind(kind), problem, visited)


def _round_trip(distances: NDArray[np.int64], start: int) -> NDArray[np.int64]:
    """Return the travel times of a RouteProblem for a round trip from the start.

    All other nodes are visits; the last row and column belong to the start.
    """
    last = [node for node in range(len(distances)) if node != start] + [start]
    return np.ascontiguousarray(distances[np.ix_(last, last)])


def _make_ordering_problem(keywords: _Keywords, distances: NDArray[np.int64]) -> NamedProblem:
    size = len(distances)
    nodes = tuple(range(2, size))
    precedences = tuple(
        Precedence((before - 1, after - 1), f"node {before + 1} before node {after + 1}")
        for after, before in np.argwhere(distances == FORBIDDEN).tolist()
        if 0 < before < size - 1 and 0 < after < size - 1
    )
    if (distances[0, 1:] == FORBIDDEN).any() or (distances[:-1, -1] == FORBIDDEN).any():
        raise keywords.file.error(
            keywords.value_of("DIMENSION")[0],
            "a -1 puts a node before the first or after the last one",
            "number the nodes so that 1 is the first and the last the end",
        )
    possible = np.where(distances == FORBIDDEN, NEVER, distances)
    # The last row is that of the start, node 1; the last column is that of the end, the last node.
    travel = np.zeros((size - 1, size - 1), dtype=np.int64)
    travel[:-1, :] = possible[1:-1, 1:]
    travel[-1, :] = possible[0, 1:]
    visits = tuple(Visit(f"node {node}") for node in nodes)
    problem = RouteProblem(visits, travel, precedences)
    return NamedProblem(keywords.file.path.stem, Kind.SOP, problem, nodes)


def _make_orienteering_problem(keywords: _Keywords, distances: NDArray[np.int64]) -> NamedProblem:
    size = len(distances)
    scores = _take_node_values(keywords, "NODE_SCORE", size, 1)[:, 0]
    for node in np.flatnonzero((scores < 0) | (scores != np.rint(scores))):
        message = f"the score of node {node + 1} is {scores[node]:g}"
        line = keywords.sections["NODE_SCORE"].start - 1
        raise keywords.file.error(line, message, "scores are whole numbers from 0")
    numbers = keywords.section("DEPOT")
    depots = numbers.take(1, "DEPOT_SECTION")
    known = np.isin(depots, np.arange(1, size + 1))
    numbers.raise_if(~known, "is not a node", f"there are 1 to {size}")
    numbers.skip(-1)
    numbers.expect_end("one depot")
    depot = int(depots[0]) - 1
    nodes = tuple(node + 1 for node in range(size) if node != depot)
    limit = keywords.whole_number("COST_LIMIT")
    if limit < 0:
        line = keywords.value_of("COST_LIMIT")[0]
        raise keywords.file.error(line, f"the COST_LIMIT {limit} is negative", _CORRECT)
    problem = RouteProblem(
        tuple(
            Visit(f"node {node}", mandatory=False, prize=int(scores[node - 1])) for node in nodes
        ),
        _round_trip(distances, depot),
        max_duration=limit,
        objective=Objective.PRIZE,
        words={"max_duration": f"cost limit {limit}"},
    )
    return NamedProblem(keywords.file.path.stem, Kind.OP, problem, nodes, int(scores[depot]))


def _distances(keywords: _Keywords, nodes: int) -> NDArray[np.int64]:
    """Return the distances from each row's node to each column's, shape (nodes, nodes)."""
    kind = keywords.value_of("EDGE_WEIGHT_TYPE")[1]
    if kind in _COORDINATE_TYPES:
        return _coordinate_distances(_take_node_values(keywords, "NODE_COORD", nodes, 2), kind)
    if kind != "EXPLICIT":
        known = ("EXPLICIT", *_COORDINATE_TYPES)
        raise keywords.unknown_value(
            "EDGE_WEIGHT_TYPE", f"EDGE_WEIGHT_TYPE {kind} is not read", known
        )
    form = keywords.value_of("EDGE_WEIGHT_FORMAT")[1]
    numbers = keywords.section("EDGE_WEIGHT")
    if form == "FULL_MATRIX":
        if numbers.remaining == nodes * nodes + 1:
            numbers.skip(nodes)  # files of sequential ordering problems repeat the number of nodes
        distances = _take_distances(numbers, nodes * nodes).reshape(nodes, nodes)
    elif form in _TRIANGLES:
        indices, offset = _TRIANGLES[form]
        rows, columns = indices(nodes, offset)
        distances = np.zeros((nodes, nodes), dtype=np.int64)
        distances[rows, columns] = _take_distances(numbers, len(rows))
        distances = np.maximum(distances, distances.T)
    else:
        problem = f"EDGE_WEIGHT_FORMAT {form} is not read"
        raise keywords.unknown_value("EDGE_WEIGHT_FORMAT", problem, ("FULL_MATRIX", *_TRIANGLES))
    numbers.expect_end("EDGE_WEIGHT_SECTION")
    return distances


def _take_distances(numbers: _Numbers, count: int) -> NDArray[np.int64]:
    values = numbers.take(count, "EDGE_WEIGHT_SECTION")
    wrong = (values != np.rint(values)) | (values < FORBIDDEN)
    numbers.raise_if(wrong, "is not a distance", "distances are whole numbers from 0")
    return values.astype(np.int64)


def _take_node_values(
    keywords: _Keywords, section: str, nodes: int, columns: int
) -> NDArray[np.float64]:
    """Return each node's values in a section of rows `number value ...`, shape (nodes, columns).

    Raises:
        ArgoError: A node is missing, given twice, or unknown.
    """
    numbers = keywords.section(section)
    values: dict[float, NDArray[np.float64]] = {}
    for _ in range(nodes):
        row = numbers.take(columns + 1, f"{section}_SECTION")
        wrong = np.zeros(columns + 1, dtype=bool)
        wrong[0] = row[0] not in range(1, nodes + 1) or row[0] in values
        problem = f"is not a node, or is given twice, in {section}_SECTION"
        numbers.raise_if(wrong, problem, f"number the nodes from 1 to {nodes}")
        values[row[0]] = row[1:]
    numbers.expect_end(f"{section}_SECTION")
    return np.array([values[node] for node in sorted(values)])


def _coordinate_distances(coordinates: NDArray[np.float64], kind: str) -> NDArray[np.int64]:
    if kind == "GEO":
        return _geographical_distances(coordinates)
    square = ((coordinates[:, None, :] - coordinates[None, :, :]) ** 2).sum(axis=2)
    lengths = {
        "EUC_2D": lambda: np.floor(np.sqrt(square) + 0.5),
        "CEIL_2D": lambda: np.ceil(np.sqrt(square)),
        "ATT": lambda: np.ceil(np.sqrt(square / 10.0)),  # pseudo-Euclidean
    }
    return lengths[kind]().astype(np.int64)


def _geographical_distances(coordinates: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the distances (km) between latitudes and longitudes written as degrees.minutes."""
    degrees = np.trunc(coordinates)
    latitude, longitude = (_PI * (degrees + 5.0 * (coordinates - degrees) / 3.0) / 180.0).T
    q1 = np.cos(longitude[:, None] - longitude)
    q2 = np.cos(latitude[:, None] - latitude)
    q3 = np.cos(latitude[:, None] + latitude)
    cosine = 0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3)
    return np.asarray(_EARTH_KM * np.arccos(np.clip(cosine, -1.0, 1.0)) + 1.0, dtype=np.int64)


def _parse_time_windows(file: _File) -> NamedProblem:
    """Return the problem in a file of either layout with time windows.

    A visit may begin within its window; the objective is the travel time without waiting. Times
    with decimals are scaled to whole numbers of a smaller unit.
    """
    bare = _File(file.path, tuple(line.partition("#")[0] for line in file.lines))
    header = next((k for k, line in enumerate(bare.lines) if line.startswith("CUST NO.")), None)
    times, windows = _read_matrix(bare) if header is None else _read_customers(bare, header)
    scale = _find_scale(bare, np.concatenate([times.ravel(), windows.ravel()]))
    travel = np.rint(times * scale).astype(np.int64)
    np.fill_diagonal(travel, 0)
    opens, closes = np.rint(windows * scale).astype(np.int64).T.tolist()
    begin = opens[0]  # time 0 of a route problem is its departure
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
    return NamedProblem(file.path.stem, Kind.TSPTW, problem, nodes)


_NO_WINDOW = "is part of a time window that is negative or ends before it begins"


def _read_matrix(file: _File) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the travel times, shape (nodes, nodes), and the windows, shape (nodes, 2)."""
    numbers = _Numbers(file, range(len(file.lines)))
    count = numbers.take(1, "the number of nodes")[0]
    first = next(k for k, line in enumerate(file.lines) if line.strip())
    size = file.check_node_count(first, count, 1)
    times = numbers.take(size * size, "the travel times")
    numbers.raise_if(times < 0, "is a negative time", _CORRECT)
    windows = numbers.take(2 * size, "the time windows").reshape(size, 2)
    closed = windows[:, 0] > windows[:, 1]
    wrong = np.stack([closed | (windows[:, 0] < 0), closed], axis=1)
    numbers.raise_if(wrong.ravel(), _NO_WINDOW, _CORRECT)
    numbers.expect_end("the time windows")
    return times.reshape(size, size), windows


def _read_customers(file: _File, header: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return travel times and windows, in the same shapes, from the rows after a header line."""
    numbers = _Numbers(file, range(header + 1, len(file.lines)))
    rows = []
    while numbers.remaining:
        row = numbers.take(_COLUMNS, "a node")
        if row[0] == _AFTER_LAST:
            numbers.expect_end("the node 999, which ends the list,")
            break
        opens, closes, service = row[4:]
        bad = not 0 <= opens <= closes
        numbers.raise_if(np.array([bad, bad, False]), _NO_WINDOW, _CORRECT)
        numbers.raise_if(
            np.array([service != 0]), "is a service time, which must be 0 in these files", _CORRECT
        )
        rows.append(row)
    size = file.check_node_count(header, len(rows), 1)
    nodes = np.array(rows)
    times = np.floor(np.hypot(*(nodes[:, None, 1:3] - nodes[:, 1:3]).T))
    for k in range(size):
        for j in range(size):
            times[k, j] = (times[k] + times[:, j]).min()
    return times, nodes[:, 4:6]


def _find_scale(file: _File, values: NDArray[np.float64]) -> int:
    """Return the smallest power of ten that scales all values to whole numbers."""
    for decimals in range(_MAX_DECIMALS + 1):
        scaled = values * 10**decimals
        if (np.abs(scaled - np.rint(scaled)) < 1e-6 * np.maximum(1.0, scaled / 1e6)).all():
            return int(10**decimals)
    problem = f"its times have more than {_MAX_DECIMALS} decimals"
    raise file.error(None, problem, "round them to fewer")
