"""Policy: the nearest checkpoint first in episodes, the lowest one first in missions."""

import numpy as np

from argo_compiler.il import Mission
from argo_compiler.reorder.requirements import Requirements
from argo_compiler.reorder.rewriting import apply_route
from argo_compiler.route import Tour
from argo_env.envs.observations import Observation
from argo_env.planning.opening import OpenedSite
from argo_env.planning.route_matrix import make_mission_problem


class BottomUp:
    """Policy for episodes of `argo/Route-v0`, which also orders the tasks of missions."""

    name = "bottom-up"

    def begin(self, observation: Observation, robot_time_budget: float, seed: int) -> None:
        """Prepare for an episode of `argo/Route-v0`: there is nothing to prepare."""

    def act(self, observation: Observation) -> int:
        """Return the legal node whose visit ends first; 0 is the dock."""
        travel = np.where(observation["mask"], observation["travel"], np.inf)[1:]
        return int(np.argmin(travel)) + 1 if np.isfinite(travel).any() else 0

    @staticmethod
    def order_tasks(mission: Mission, site: OpenedSite) -> Mission:
        """Return the mission with its tasks by height, for `argo evaluate --policy bottom-up`."""
        planned = make_mission_problem(mission, site.navigator, Requirements(), site.travel)
        heights = {
            str(checkpoint.id): checkpoint.position[2] for checkpoint in site.site.checkpoints
        }
        units = planned.visits.task_units
        tasks = [planned.visits.leaf_task(unit.entry) for unit in units]
        order = sorted(range(len(units)), key=lambda k: heights.get(tasks[k].object_id or "", 0.0))
        return apply_route(planned, Tour(tuple(order)))
