"""Distances between nodes as TSPLIB defines them (G. Reinelt, "TSPLIB 95", section 2)."""

import numpy as np
from numpy.typing import NDArray

from benchmarks.instances.keywords import Keywords
from benchmarks.instances.text import Numbers

_TRIANGLES = {
    "UPPER_ROW": (np.triu_indices, 1),
    "LOWER_ROW": (np.tril_indices, -1),
    "UPPER_DIAG_ROW": (np.triu_indices, 0),
    "LOWER_DIAG_ROW": (np.tril_indices, 0),
}
_OF_COORDINATES = ("EUC_2D", "CEIL_2D", "ATT", "GEO")
_PI, _EARTH_KM = 3.141592, 6378.388  # as they are defined there
FORBIDDEN = -1
"""in a sequential ordering problem: the column's node comes before the row's"""


def read_distances(keywords: Keywords, nodes: int) -> NDArray[np.int64]:
    """The distances from row to column, shape (nodes, nodes), with zeros from a node to itself.

    Raises ArgoError if the file does not have them.
    """
    kind = keywords.value("EDGE_WEIGHT_TYPE")
    if kind == "EXPLICIT":
        found = _matrix(keywords, nodes)
    elif kind in _OF_COORDINATES:
        found = _between(read_by_node(keywords, "NODE_COORD", nodes, 2), kind)
    else:
        known = ", ".join(("EXPLICIT", *_OF_COORDINATES))
        raise keywords.wrong(
            "EDGE_WEIGHT_TYPE", f"EDGE_WEIGHT_TYPE {kind} is not read", f"there are: {known}"
        )
    np.fill_diagonal(found, 0)
    return found


def read_by_node(keywords: Keywords, section: str, nodes: int, columns: int) -> NDArray[np.float64]:
    """What a section says of each node, in its rows `number value ...`, shape (nodes, columns).

    Raises ArgoError if a node is missing, there twice, or unknown.
    """
    numbers = keywords.section(section)
    found = np.zeros((nodes, columns))
    seen: set[int] = set()
    for _ in range(nodes):
        row = numbers.take(columns + 1, f"{section}_SECTION")
        node = row[0]
        bad = node not in range(1, nodes + 1) or int(node) in seen
        numbers.refuse(
            np.array([bad] + [False] * columns),
            f"is no node or one that is there twice in {section}_SECTION",
            f"number the nodes from 1 to {nodes}",
        )
        seen.add(int(node))
        found[int(node) - 1] = row[1:]
    numbers.finish(f"{section}_SECTION")
    return found


def _matrix(keywords: Keywords, nodes: int) -> NDArray[np.int64]:
    form = keywords.value("EDGE_WEIGHT_FORMAT")
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
        known = ", ".join(("FULL_MATRIX", *_TRIANGLES))
        raise keywords.wrong(
            "EDGE_WEIGHT_FORMAT", f"EDGE_WEIGHT_FORMAT {form} is not read", f"there are: {known}"
        )
    numbers.finish("EDGE_WEIGHT_SECTION")
    return found


def _whole(numbers: Numbers, count: int) -> NDArray[np.int64]:
    values = numbers.take(count, "EDGE_WEIGHT_SECTION")
    bad = (values != np.round(values)) | (values < FORBIDDEN)
    numbers.refuse(bad, "is no distance", "distances are whole numbers from 0")
    return values.astype(np.int64)


def _between(coordinates: NDArray[np.float64], kind: str) -> NDArray[np.int64]:
    if kind == "GEO":
        return _on_earth(coordinates)
    difference = coordinates[:, None, :] - coordinates[None, :, :]
    square = (difference**2).sum(axis=2)
    match kind:
        case "EUC_2D":
            lengths = np.floor(np.sqrt(square) + 0.5)
        case "CEIL_2D":
            lengths = np.ceil(np.sqrt(square))
        case _:  # ATT: pseudo-Euclidean
            lengths = np.ceil(np.sqrt(square / 10.0))
    return np.asarray(lengths, dtype=np.int64)


def _on_earth(coordinates: NDArray[np.float64]) -> NDArray[np.int64]:
    """Kilometres between latitudes and longitudes, written as degrees.minutes."""
    degrees = np.trunc(coordinates)
    latitude, longitude = (_PI * (degrees + 5.0 * (coordinates - degrees) / 3.0) / 180.0).T
    q1 = np.cos(longitude[:, None] - longitude)
    q2 = np.cos(latitude[:, None] - latitude)
    q3 = np.cos(latitude[:, None] + latitude)
    cosine = 0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3)
    return np.asarray(_EARTH_KM * np.arccos(np.clip(cosine, -1.0, 1.0)) + 1.0, dtype=np.int64)
