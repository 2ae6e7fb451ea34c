"""A quick bound: each step has one successor, whether or not that makes a single route."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned, shortest


def assignment_bound(network: StepNetwork, pruned: Pruned) -> int | None:
    """The least time that arcs and services take if each step is left once and entered once; 0
    where something may be left out. None: there is no route."""
    if not pruned.possible:
        return None
    if network.selective:
        return 0
    if not len(network.prize):
        direct = int(network.time[network.size, network.size])
        return direct if direct < NEVER else None
    times = shortest(network) + np.append(network.service, 0)[None, :]
    least = least_between_steps(network, pruned, times)
    rows, columns = linear_sum_assignment(least.astype(np.float64))
    total = int(least[rows, columns].sum())
    return None if total >= NEVER else total


def least_between_steps(
    network: StepNetwork, pruned: Pruned, costs: NDArray[np.int64]
) -> NDArray[np.int64]:
    """The least cost of the arcs that are left from each step to each other; the last row is that
    of the start, the last column that of the end; NEVER: no arc."""
    count = len(network.prize)
    least = np.full((count + 1, count + 1), NEVER, np.int64)
    home = np.append(network.step, count)
    left = np.where(pruned.arcs, np.minimum(costs, NEVER), NEVER)
    np.minimum.at(least, (home[:, None], home[None, :]), left)
    return least
