"""Graphs of moves with their costs, stored and searched by scipy.

scipy is imported when the first graph is made: many queries about a site need no graph, and the
import takes longer than all of them.
"""

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Graph: TypeAlias = "csr_array"
"""sparse matrix whose row s has the moves from state s: `indices` are the states that they lead to,
`data` their costs (s)"""

Trees = tuple[NDArray[np.float64], NDArray[np.int32]]
"""cheapest paths between the root of each tree and all states: their costs (s), inf where there is
no path, and for each state the next one towards the root, negative at the root and where there is
no path; both of shape (trees, states)"""


def make_graph(
    costs: NDArray[np.float64], heads: NDArray[np.integer], starts: NDArray[np.integer]
) -> Graph:
    """Return the graph with the given moves, which are sorted by the state that they start from.

    The moves from state s are those with the indices from `starts[s]` to `starts[s + 1] - 1`. Each
    leads to its state in `heads`, and costs its item of `costs` (s).
    """
    from scipy.sparse import csr_array

    states = len(starts) - 1
    return csr_array((costs, heads, starts), shape=(states, states))


def make_graph_of_moves(
    costs: NDArray[np.float64],
    sources: NDArray[np.int64],
    targets: NDArray[np.int64],
    states: int,
) -> Graph:
    """Return the graph of moves in any order between so many `states`; costs are in s.

    If a move occurs twice, its costs are added.
    """
    from scipy.sparse import coo_array

    return coo_array((costs, (sources, targets)), shape=(states, states)).tocsr()


def subgraph(graph: Graph, members: NDArray[np.int64] | NDArray[np.bool_]) -> Graph:
    """Return the graph of the moves between `members`; state k of it is the k-th member."""
    from scipy.sparse import csr_array

    return csr_array(graph[members][:, members])


def reverse_graph(graph: Graph) -> Graph:
    """Return the graph with each move reversed."""
    from scipy.sparse import csr_array

    return csr_array(graph.T.tocsr())


def label_strong_components(graph: Graph) -> NDArray[np.int32]:
    """Return a label for each state, the same for states that can be reached from each other."""
    from scipy.sparse.csgraph import connected_components

    _, label = connected_components(graph, directed=True, connection="strong")
    return label


def shortest_path_trees(graph: Graph, sources: NDArray[np.int64], limit: float = np.inf) -> Trees:
    """Return the cheapest paths from each of `sources`, the root of a tree, to all states.

    Where the path costs more than `limit` (s), the cost is inf, as without a path.
    """
    from scipy.sparse.csgraph import dijkstra

    if not len(sources):
        return np.empty((0, graph.shape[0])), np.empty((0, graph.shape[0]), dtype=np.int32)
    return dijkstra(graph, indices=sources, return_predecessors=True, limit=limit)


def shortest_path_costs(graph: Graph, sources: list[int]) -> NDArray[np.float64]:
    """Return the costs (s) of the cheapest paths from each source, shape (sources, states).

    The costs are inf where there is no path.
    """
    from scipy.sparse.csgraph import dijkstra

    return dijkstra(graph, indices=sources)
