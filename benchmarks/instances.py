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
"""Far above any problem that is solved in minutes, and below what would exhaust the memory."""
LARGEST = 10**10
"""the greatest number that is read: its sums stay far from where whole numbers overflow"""
FORBIDDEN = -1
"""in a sequential ordering problem: the column's node comes before the row's"""

_FILE = "TSPLIB, OPLib or TSPTW file"
_CORRECT = "correct it there"
_OF_NUMBERS = frozenset("0123456789+-.eE \t\r\f\v")
_KEYWORD = re.compile(r"\s*([A-Za-z][A-Za-z_0-9]*)\s*(?::\s*(.*?)\s*)?", re.ASCII)
_TRIANGLES = {
    "UPPER_ROW": (np.triu_indices, 1),
    "LOWER_ROW": (np.tril_indices, -1),
    "UPPER_DIAG_ROW": (np.triu_indices, 0),
    "LOWER_DIAG_ROW": (np.tril_indices, 0),
}
_OF_COORDINATES = ("EUC_2D", "CEIL_2D", "ATT", "GEO")
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

    Raises ArgoError, with the line where there is one, if the file can't be read or holds none.
    """
    file = _read(path)
    first = next(line for line in file.lines if line.strip()).lstrip()
    try:
        return _time_windows(file) if first[0] in "0123456789#!" else _tsplib(_keywords(file))
    except ArgoError as error:
        if str(path) in str(error):
            raise
        raise ArgoError(f"{path}: {error}") from None  # a RouteProblem knows no file


def read_known_route(path: Path) -> KnownRoute:
    """Return the route in a `.sol` file of OPLib. Raises ArgoError if there is none."""
    keywords = _keywords(_read(path))
    numbers = keywords.section("NODE_SEQUENCE")
    nodes = numbers.take(keywords.number("ROUTE_NODES"), "NODE_SEQUENCE_SECTION")
    wrong = (nodes < 1) | (nodes != np.rint(nodes))
    numbers.refuse(wrong, "is no node", "nodes are counted from 1")
    score, cost = keywords.number("ROUTE_SCORE"), keywords.number("ROUTE_COST")
    return KnownRoute(tuple(int(node) for node in nodes), score, cost)


@dataclass(frozen=True)
class _File:
    """A text file, by its lines, which count from 0."""

    path: Path
    lines: tuple[str, ...]

    def wrong(self, line: int | None, what: str, way_out: str) -> ArgoError:
        """Return the error that says so. None: the file as a whole."""
        place = f"{self.path}" if line is None else f"{self.path}:{line + 1}"
        return ArgoError(f"{place}: {what}; {way_out}")

    def nodes(self, line: int | None, count: float, least: int) -> int:
        """Return the number of nodes that is stated there. Raises ArgoError if it can't be one."""
        if count != int(count) or count < least:
            raise self.wrong(line, f"{count:g} nodes are no problem", f"it needs {least} or more")
        if count > MAX_NODES:
            said = f"it has {count:.0f} nodes"
            raise self.wrong(line, said, f"at most {MAX_NODES} are read: take a part")
        return int(count)


def _read(path: Path) -> _File:
    text = read_text(path, _FILE, MAX_BYTES)
    if not text.strip():
        raise ArgoError(f"{path}: is empty; name a {_FILE}")
    return _File(path, tuple(text.splitlines()))


class _Numbers:
    """The numbers in some lines of a file, taken from the first to the last. Has state: how far it
    has come."""

    def __init__(self, file: _File, lines: Iterable[int]) -> None:
        """Raises ArgoError at the first thing that is no number."""
        self._file = file
        self._lines = list(lines)
        rows = [_numbers(file, line) for line in self._lines]
        self._line = [line for line, row in zip(self._lines, rows, strict=True) for _ in row]
        """of each number"""
        self._values = np.array([value for row in rows for value in row], dtype=np.float64)
        self._next = 0

    @property
    def left(self) -> int:
        """Return how many numbers have not been taken."""
        return len(self._values) - self._next

    def take(self, count: int, what: str) -> NDArray[np.float64]:
        """Return the next ones. Raises ArgoError, with what they are of, if they are too few."""
        if self.left < count:
            said = f"of {count} numbers for {what} there are {self.left}"
            last = self._lines[-1] if self._lines else None
            raise self._file.wrong(last, said, "is the file complete?")
        self._next += count
        return self._values[self._next - count : self._next]

    def skip(self, value: float) -> None:
        """Leave out the next one if it is this."""
        if self.left and self._values[self._next] == value:
            self._next += 1

    def refuse(self, wrong: NDArray[np.bool_], what: str, way_out: str) -> None:
        """Raises ArgoError at the line of the first of the numbers taken last that is wrong."""
        if wrong.any():
            first = self._next - wrong.size + int(np.flatnonzero(wrong)[0])
            raise self._file.wrong(self._line[first], f"{self._values[first]:g} {what}", way_out)

    def finish(self, what: str) -> None:
        """Raises ArgoError if there are more numbers than those that were taken."""
        if self.left:
            said = f"there are {self.left} numbers more than {what} needs"
            way_out = "does the number of nodes agree with them?"
            raise self._file.wrong(self._line[self._next], said, way_out)


def _numbers(file: _File, line: int) -> list[float]:
    found = []
    for word in file.lines[line].split():
        try:
            # float() reads `nan`, `1_000` and other digits too
            value = float(word) if _OF_NUMBERS.issuperset(word) else np.nan
        except ValueError:
            value = np.nan
        if not abs(value) <= LARGEST:
            raise file.wrong(line, f"`{word[:40]}` is no number of up to {LARGEST}", _CORRECT)
        found.append(value)
    return found


@dataclass(frozen=True)
class _Keywords:
    """The keywords of a TSPLIB or OPLib file with their values, and its sections of numbers."""

    file: _File
    values: Mapping[str, tuple[int, str]]
    """by keyword: the line, the value"""
    sections: Mapping[str, range]
    """by keyword, without `_SECTION`: the lines with its numbers"""

    def given(self, keyword: str) -> tuple[int, str]:
        """Return the line of a keyword, and its value. Raises ArgoError if it is not there."""
        if keyword not in self.values:
            raise self.file.wrong(None, f"it has no {keyword}", f"add a line `{keyword}: ...`")
        return self.values[keyword]

    def number(self, keyword: str) -> int:
        """Return the whole number that is given for it. Raises ArgoError if none is."""
        line, text = self.given(keyword)
        try:
            if abs(number := int(text)) <= LARGEST:
                return number
        except ValueError:
            pass
        said = f"{keyword} `{text[:40]}` is no whole number of up to {LARGEST}"
        raise self.file.wrong(line, said, _CORRECT)

    def section(self, keyword: str) -> _Numbers:
        """Return the numbers of a section. Raises ArgoError if there is no such section."""
        if keyword not in self.sections:
            way_out = "add it, or is the file cut off?"
            raise self.file.wrong(None, f"it has no {keyword}_SECTION", way_out)
        return _Numbers(self.file, self.sections[keyword])

    def unknown(self, keyword: str, what: str, known: Iterable[str]) -> ArgoError:
        """Return the error at the keyword's line that its value is not among the known ones."""
        return self.file.wrong(self.values[keyword][0], what, f"there are: {', '.join(known)}")


def _keywords(file: _File) -> _Keywords:
    """Return what the file says. Raises ArgoError at a line that is neither keyword nor number, or
    that says again what was said."""
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
            said = f"`{text.strip()[:40]}` is no keyword with its value"
            raise file.wrong(line, said, f"is this a {_FILE}?")
        elif match is not None:
            keyword, value = match[1].upper(), match[2] or ""
            name = keyword.removesuffix("_SECTION")
            section = name if name != keyword else None
            if keyword != "COMMENT" and (keyword in values or name in sections):
                raise file.wrong(line, f"{keyword} stands here again", "remove one of the two")
            if section is None:
                values.setdefault(keyword, (line, value))
            else:
                sections[section] = range(line + 1, line + 1)
    return _Keywords(file, values, sections)


def _tsplib(keywords: _Keywords) -> NamedProblem:
    kind = keywords.given("TYPE")[1].partition(" ")[0]
    of_keywords = (Kind.TSP, Kind.ATSP, Kind.SOP, Kind.OP)
    least = 2 if kind == Kind.SOP else 1
    line, count = keywords.given("DIMENSION")[0], keywords.number("DIMENSION")
    nodes = keywords.file.nodes(line, count, least)
    if kind not in of_keywords:
        raise keywords.unknown("TYPE", f"problems of TYPE `{kind}` are not read", of_keywords)
    distances = _distances(keywords, nodes)
    np.fill_diagonal(distances, 0)
    if kind == Kind.SOP:
        return _ordering(keywords, distances)
    if (distances == FORBIDDEN).any():
        said = "it has distances of -1, which order nodes"
        raise keywords.file.wrong(keywords.given("TYPE")[0], said, "is its TYPE meant to be SOP?")
    if kind == Kind.OP:
        return _orienteering(keywords, distances)
    visited = tuple(range(2, nodes + 1))
    visits = tuple(Visit(f"node {node}") for node in visited)
    problem = RouteProblem(visits, _round_trip(distances, 0))
    return NamedProblem(keywords.file.path.stem, Kind(kind), problem, visited)


def _round_trip(distances: NDArray[np.int64], start: int) -> NDArray[np.int64]:
    """Return the travel times of a RouteProblem whose visits are all nodes but the start, from
    which the route goes and to which it returns."""
    last = [node for node in range(len(distances)) if node != start] + [start]
    return np.ascontiguousarray(distances[np.ix_(last, last)])


def _ordering(keywords: _Keywords, distances: NDArray[np.int64]) -> NamedProblem:
    size = len(distances)
    nodes = tuple(range(2, size))
    precedences = tuple(
        Precedence((before - 1, after - 1), f"node {before + 1} before node {after + 1}")
        for after, before in np.argwhere(distances == FORBIDDEN).tolist()
        if 0 < before < size - 1 and 0 < after < size - 1
    )
    if (distances[0, 1:] == FORBIDDEN).any() or (distances[:-1, -1] == FORBIDDEN).any():
        raise keywords.file.wrong(
            keywords.given("DIMENSION")[0],
            "by its -1, a node comes before the first or after the last",
            "number the nodes so that 1 is the first and the last the end",
        )
    possible = np.where(distances == FORBIDDEN, NEVER, distances)
    # The row of the start is the first node's, the column of the end the last one's.
    travel = np.zeros((size - 1, size - 1), dtype=np.int64)
    travel[:-1, :] = possible[1:-1, 1:]
    travel[-1, :] = possible[0, 1:]
    visits = tuple(Visit(f"node {node}") for node in nodes)
    problem = RouteProblem(visits, travel, precedences)
    return NamedProblem(keywords.file.path.stem, Kind.SOP, problem, nodes)


def _orienteering(keywords: _Keywords, distances: NDArray[np.int64]) -> NamedProblem:
    size = len(distances)
    scores = _by_node(keywords, "NODE_SCORE", size, 1)[:, 0]
    for node in np.flatnonzero((scores < 0) | (scores != np.rint(scores))):
        said = f"the score of node {node + 1} is {scores[node]:g}"
        line = keywords.sections["NODE_SCORE"].start - 1
        raise keywords.file.wrong(line, said, "scores are whole numbers from 0")
    numbers = keywords.section("DEPOT")
    depots = numbers.take(1, "DEPOT_SECTION")
    known = np.isin(depots, np.arange(1, size + 1))
    numbers.refuse(~known, "is no node", f"there are 1 to {size}")
    numbers.skip(-1)
    numbers.finish("one depot")
    depot = int(depots[0]) - 1
    nodes = tuple(node + 1 for node in range(size) if node != depot)
    limit = keywords.number("COST_LIMIT")
    if limit < 0:
        line = keywords.given("COST_LIMIT")[0]
        raise keywords.file.wrong(line, f"the COST_LIMIT {limit} is negative", _CORRECT)
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
    """Return the distances from row to column, shape (nodes, nodes)."""
    kind = keywords.given("EDGE_WEIGHT_TYPE")[1]
    if kind in _OF_COORDINATES:
        return _between(_by_node(keywords, "NODE_COORD", nodes, 2), kind)
    if kind != "EXPLICIT":
        known = ("EXPLICIT", *_OF_COORDINATES)
        raise keywords.unknown("EDGE_WEIGHT_TYPE", f"EDGE_WEIGHT_TYPE {kind} is not read", known)
    form = keywords.given("EDGE_WEIGHT_FORMAT")[1]
    numbers = keywords.section("EDGE_WEIGHT")
    if form == "FULL_MATRIX":
        if numbers.left == nodes * nodes + 1:
            numbers.skip(nodes)  # files with sequential ordering problems state it again
        found = _whole(numbers, nodes * nodes).reshape(nodes, nodes)
    elif form in _TRIANGLES:
        indices, offset = _TRIANGLES[form]
        rows, columns = indices(nodes, offset)
        found = np.zeros((nodes, nodes), dtype=np.int64)
        found[rows, columns] = _whole(numbers, len(rows))
        found = np.maximum(found, found.T)
    else:
        said = f"EDGE_WEIGHT_FORMAT {form} is not read"
        raise keywords.unknown("EDGE_WEIGHT_FORMAT", said, ("FULL_MATRIX", *_TRIANGLES))
    numbers.finish("EDGE_WEIGHT_SECTION")
    return found


def _whole(numbers: _Numbers, count: int) -> NDArray[np.int64]:
    values = numbers.take(count, "EDGE_WEIGHT_SECTION")
    wrong = (values != np.rint(values)) | (values < FORBIDDEN)
    numbers.refuse(wrong, "is no distance", "distances are whole numbers from 0")
    return values.astype(np.int64)


def _by_node(keywords: _Keywords, section: str, nodes: int, columns: int) -> NDArray[np.float64]:
    """Return what the rows `number value ...` of a section say of each node, shape (nodes,
    columns). Raises ArgoError if a node is missing, there twice, or unknown."""
    numbers = keywords.section(section)
    found: dict[float, NDArray[np.float64]] = {}
    for _ in range(nodes):
        row = numbers.take(columns + 1, f"{section}_SECTION")
        wrong = np.zeros(columns + 1, dtype=bool)
        wrong[0] = row[0] not in range(1, nodes + 1) or row[0] in found
        said = f"is no node or one that is there twice in {section}_SECTION"
        numbers.refuse(wrong, said, f"number the nodes from 1 to {nodes}")
        found[row[0]] = row[1:]
    numbers.finish(f"{section}_SECTION")
    return np.array([found[node] for node in sorted(found)])


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


def _time_windows(file: _File) -> NamedProblem:
    """Return the problem in a file of one of the layouts with time windows.

    The windows say when a visit may begin; the objective is the travel without waiting. Times with
    decimals are made whole, and the problem's unit smaller.
    """
    bare = _File(file.path, tuple(line.partition("#")[0] for line in file.lines))
    header = next((k for k, line in enumerate(bare.lines) if line.startswith("CUST NO.")), None)
    times, windows = _matrix(bare) if header is None else _customers(bare, header)
    scale = _scale(bare, np.concatenate([times.ravel(), windows.ravel()]))
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
    return NamedProblem(file.path.stem, Kind.TSPTW, problem, nodes)


_NO_WINDOW = "is part of a time window that is negative or ends before it begins"


def _matrix(file: _File) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the travel times, shape (nodes, nodes), and the windows, shape (nodes, 2)."""
    numbers = _Numbers(file, range(len(file.lines)))
    count = numbers.take(1, "the number of nodes")[0]
    first = next(k for k, line in enumerate(file.lines) if line.strip())
    size = file.nodes(first, count, 1)
    times = numbers.take(size * size, "the travel times")
    numbers.refuse(times < 0, "is a negative time", _CORRECT)
    windows = numbers.take(2 * size, "the time windows").reshape(size, 2)
    closed = windows[:, 0] > windows[:, 1]
    wrong = np.stack([closed | (windows[:, 0] < 0), closed], axis=1)
    numbers.refuse(wrong.ravel(), _NO_WINDOW, _CORRECT)
    numbers.finish("the time windows")
    return times.reshape(size, size), windows


def _customers(file: _File, header: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the same of the rows that follow a header."""
    numbers = _Numbers(file, range(header + 1, len(file.lines)))
    rows = []
    while numbers.left:
        row = numbers.take(_COLUMNS, "a node")
        if row[0] == _AFTER_LAST:
            numbers.finish("the node 999, which is after the last,")
            break
        opens, closes, service = row[4:]
        bad = not 0 <= opens <= closes
        numbers.refuse(np.array([bad, bad, False]), _NO_WINDOW, _CORRECT)
        numbers.refuse(
            np.array([service != 0]), "is a service, which these files have none of", _CORRECT
        )
        rows.append(row)
    size = file.nodes(header, len(rows), 1)
    nodes = np.array(rows)
    times = np.floor(np.hypot(*(nodes[:, None, 1:3] - nodes[:, 1:3]).T))
    for k in range(size):
        for j in range(size):
            times[k, j] = (times[k] + times[:, j]).min()
    return times, nodes[:, 4:6]


def _scale(file: _File, values: NDArray[np.float64]) -> int:
    """Return the least power of ten by which all values become whole."""
    for decimals in range(_MAX_DECIMALS + 1):
        scaled = values * 10**decimals
        if (np.abs(scaled - np.rint(scaled)) < 1e-6 * np.maximum(1.0, scaled / 1e6)).all():
            return int(10**decimals)
    said = f"its times have more than {_MAX_DECIMALS} decimals"
    raise file.wrong(None, said, "round them to fewer")
