"""Problems in the form of TSPLIB and OPLib."""

import numpy as np
from numpy.typing import NDArray

from argo_compiler.route.problem import NEVER, Objective, Precedence, RouteProblem, Visit
from benchmarks.instances.distances import FORBIDDEN, read_by_node, read_distances
from benchmarks.instances.keywords import Keywords, read_keywords
from benchmarks.instances.named import Kind, NamedProblem
from benchmarks.instances.text import Source


def read_tsplib(source: Source) -> NamedProblem:
    """The problem in a file with keywords. Raises ArgoError if there is none."""
    keywords = read_keywords(source)
    kind = keywords.value("TYPE").split()[0] if keywords.value("TYPE") else ""
    nodes = source.nodes(
        keywords.line("DIMENSION"), keywords.number("DIMENSION"), 2 if kind == Kind.SOP else 1
    )
    match kind:
        case Kind.TSP | Kind.ATSP:
            return _tour(keywords, Kind(kind), read_distances(keywords, nodes))
        case Kind.SOP:
            return _ordering(keywords, read_distances(keywords, nodes))
        case Kind.OP:
            return _orienteering(keywords, read_distances(keywords, nodes))
    raise keywords.wrong("TYPE", f"problems of TYPE `{kind}` are not read", "there are: "
                         "TSP, ATSP, SOP, OP")  # fmt: skip


def round_trip(distances: NDArray[np.int64], start: int) -> NDArray[np.int64]:
    """Travel times of a RouteProblem whose visits are all nodes but the start, from which the
    route goes and to which it returns."""
    last = [node for node in range(len(distances)) if node != start] + [start]
    return np.ascontiguousarray(distances[np.ix_(last, last)])


def _tour(keywords: Keywords, kind: Kind, distances: NDArray[np.int64]) -> NamedProblem:
    _refuse_forbidden(keywords, distances)
    nodes = tuple(range(2, len(distances) + 1))
    problem = RouteProblem(tuple(Visit(f"node {node}") for node in nodes), round_trip(distances, 0))
    return NamedProblem(_name(keywords), kind, problem, nodes)


def _ordering(keywords: Keywords, distances: NDArray[np.int64]) -> NamedProblem:
    size = len(distances)
    nodes = tuple(range(2, size))
    precedences = tuple(
        Precedence((before - 1, after - 1), f"node {before + 1} before node {after + 1}")
        for after, before in np.argwhere(distances == FORBIDDEN).tolist()
        if 0 < before < size - 1 and 0 < after < size - 1
    )
    if (distances[0, 1:] == FORBIDDEN).any() or (distances[:-1, -1] == FORBIDDEN).any():
        raise keywords.source.wrong(
            keywords.line("DIMENSION"),
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
    return NamedProblem(_name(keywords), Kind.SOP, problem, nodes)


def _orienteering(keywords: Keywords, distances: NDArray[np.int64]) -> NamedProblem:
    _refuse_forbidden(keywords, distances)
    size = len(distances)
    scores = _scores(keywords, size)
    depot = _depot(keywords, size)
    nodes = tuple(node + 1 for node in range(size) if node != depot)
    limit = keywords.number("COST_LIMIT")
    if limit < 0:
        raise keywords.wrong("COST_LIMIT", f"the COST_LIMIT {limit} is negative", "correct it")
    problem = RouteProblem(
        tuple(
            Visit(f"node {node}", mandatory=False, prize=int(scores[node - 1])) for node in nodes
        ),
        round_trip(distances, depot),
        max_duration=limit,
        objective=Objective.PRIZE,
        words={"max_duration": f"cost limit {limit}"},
    )
    return NamedProblem(_name(keywords), Kind.OP, problem, nodes, int(scores[depot]))


def _scores(keywords: Keywords, size: int) -> NDArray[np.int64]:
    scores = read_by_node(keywords, "NODE_SCORE", size, 1)[:, 0]
    bad = (scores < 0) | (scores != np.round(scores))
    if bad.any():
        node = int(np.flatnonzero(bad)[0])
        raise keywords.source.wrong(
            keywords.sections["NODE_SCORE"].start - 1,
            f"the score of node {node + 1} is {scores[node]:g}",
            "scores are whole numbers from 0",
        )
    return scores.astype(np.int64)


def _depot(keywords: Keywords, size: int) -> int:
    """The number of the depot, from 0."""
    numbers = keywords.section("DEPOT")
    depot = numbers.take(1, "DEPOT_SECTION")
    numbers.refuse(~np.isin(depot, np.arange(1, size + 1)), "is no node", f"there are 1 to {size}")
    numbers.skip(-1)
    numbers.finish("one depot")
    return int(depot[0]) - 1


def _refuse_forbidden(keywords: Keywords, distances: NDArray[np.int64]) -> None:
    if (distances == FORBIDDEN).any():
        raise keywords.wrong(
            "TYPE", "it has distances of -1, which order nodes", "is its TYPE meant to be SOP?"
        )


def _name(keywords: Keywords) -> str:
    """As the file is called: TSPLIB's and OPLib's own names don't always tell files apart."""
    return keywords.source.path.stem
