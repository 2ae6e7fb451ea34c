"""Graphs of moves with their costs, kept and searched by scipy.

It is imported with the first graph: much of what is asked of a site needs none, and importing scipy
takes longer than all of that.
"""

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Graph: TypeAlias = "csr_array"
"""Row s has the moves from state s: `indices` where they lead, `data` their costs (s)."""

Trees = tuple[NDArray[np.float64], NDArray[np.int32]]
"""Costs in s, inf where there is no way, and the state next to each on the way, both of shape
(trees, states)."""


def graph_of(
    costs: NDArray[np.float64], heads: NDArray[np.integer], starts: NDArray[np.integer]
) -> Graph:
    """The graph whose moves from state s are those from number `starts[s]` to `starts[s + 1]`."""
    from scipy.sparse import csr_array

    states = len(starts) - 1
    return csr_array((costs, heads, starts), shape=(states, states))


def graph_of_moves(
    costs: NDArray[np.float64],
    sources: NDArray[np.int64],
    targets: NDArray[np.int64],
    states: int,
) -> Graph:
    """The graph of moves in any order; costs of equal moves are added."""
    from scipy.sparse import coo_array

    return coo_array((costs, (sources, targets)), shape=(states, states)).tocsr()


def part_of(graph: Graph, members: NDArray[np.int64] | NDArray[np.bool_]) -> Graph:
    """The moves between the states `members`, which are numbered anew in their order."""
    from scipy.sparse import csr_array

    return csr_array(graph[members][:, members])


def against(graph: Graph) -> Graph:
    """The same moves against time."""
    from scipy.sparse import csr_array

    return csr_array(graph.T.tocsr())


def strong_parts(graph: Graph) -> NDArray[np.int32]:
    """A number for each state, equal where there are ways there and back."""
    from scipy.sparse.csgraph import connected_components

    _, label = connected_components(graph, directed=True, connection="strong")
    return label


def search(graph: Graph, sources: NDArray[np.int64], limit: float = np.inf) -> Trees:
    """The cheapest ways from each of `sources` that cost up to `limit` (s)."""
    from scipy.sparse.csgraph import dijkstra

    if not len(sources):
        return np.empty((0, graph.shape[0])), np.empty((0, graph.shape[0]), dtype=np.int32)
    return dijkstra(graph, indices=sources, return_predecessors=True, limit=limit)


def costs_of(graph: Graph, sources: list[int]) -> NDArray[np.float64]:
    """The costs alone of the cheapest ways from each of `sources`, shape (sources, states)."""
    from scipy.sparse.csgraph import dijkstra

    return dijkstra(graph, indices=sources)
