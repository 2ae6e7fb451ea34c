"""A quick bound: each step has one successor, whether or not that makes a single route."""

import numpy as np
from scipy.optimize import linear_sum_assignment

from argo_compiler.route.network import Network
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned, shortest


def assignment_bound(network: Network, pruned: Pruned) -> int | None:
    """The least time that arcs and services take if each step is left once and entered once; 0
    where something may be left out. None: there is no route."""
    if not pruned.possible:
        return None
    if network.selective:
        return 0
    count, m = len(network.prize), network.size
    times = shortest(network) + np.append(network.service, 0)[None, :]
    times = np.where(pruned.arcs, times, NEVER)
    if not count:
        return int(network.time[m, m]) if network.time[m, m] < NEVER else None
    least = np.full((count + 1, count + 1), NEVER, np.int64)
    home = np.append(network.step, count)
    np.minimum.at(least, (home[:, None], home[None, :]), times)
    rows, columns = linear_sum_assignment(np.minimum(least, NEVER).astype(np.float64))
    total = int(least[rows, columns].sum())
    return None if total >= NEVER else total
