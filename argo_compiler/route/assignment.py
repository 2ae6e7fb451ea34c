"""Assignment relaxation: a quick bound, as each step has one successor, in any number of cycles."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from argo_compiler.route.network import StepNetwork
from argo_compiler.route.problem import NEVER
from argo_compiler.route.pruning import Pruned, least_arc_times_without_service


def assignment_time_bound(network: StepNetwork, pruned: Pruned) -> int | None:
    """Compute a lower bound on the time of all arcs and services of any route.

    It is the value of an assignment problem, in which each step is entered once and left once. The
    bound is in the problem's unit of time. Returns 0 if the network has optional steps, and None if
    there is no route.
    """
    if not pruned.possible:
        return None
    if network.selective:
        return 0
    if not len(network.prize):
        direct = int(network.time[network.node_count, network.node_count])
        return direct if direct < NEVER else None
    times = least_arc_times_without_service(network) + np.append(network.service, 0)[None, :]
    least = least_costs_between_steps(network, pruned, times)
    rows, columns = linear_sum_assignment(least.astype(np.float64))
    total = int(least[rows, columns].sum())
    return None if total >= NEVER else total


def least_costs_between_steps(
    network: StepNetwork, pruned: Pruned, costs: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Compute the least cost of the unpruned arcs from each step to each other.

    Each step may have several nodes. With s steps, the shape is (s + 1, s + 1): the last row
    belongs to the start, the last column to the end. NEVER: there is no arc.
    """
    count = len(network.prize)
    least = np.full((count + 1, count + 1), NEVER, np.int64)
    step_of_node = np.append(network.step, count)
    arc_costs = np.where(pruned.arcs, np.minimum(costs, NEVER), NEVER)
    np.minimum.at(least, (step_of_node[:, None], step_of_node[None, :]), arc_costs)
    return least
