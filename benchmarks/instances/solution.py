"""Known routes, in the form in which OPLib publishes them."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.instances.keywords import read_keywords
from benchmarks.instances.text import read_source


@dataclass(frozen=True)
class KnownRoute:
    """A route as it was published; not always the best one."""

    nodes: tuple[int, ...]
    """as the file counts, the depot first"""
    score: int
    cost: int


def read_known_route(path: Path) -> KnownRoute:
    """The route in a `.sol` file. Raises ArgoError if there is none."""
    source = read_source(path)
    keywords = read_keywords(source)
    count = keywords.number("ROUTE_NODES")
    numbers = keywords.section("NODE_SEQUENCE")
    nodes = numbers.take(count, "NODE_SEQUENCE_SECTION")
    numbers.refuse(
        (nodes < 1) | (nodes != np.round(nodes)), "is no node", "nodes are counted from 1"
    )
    return KnownRoute(
        tuple(int(node) for node in nodes),
        keywords.number("ROUTE_SCORE"),
        keywords.number("ROUTE_COST"),
    )
