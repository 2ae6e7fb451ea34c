"""Policies that follow routes of the optimiser.

The optimiser has a limit of work, not of time, so it finds the same routes on a slow or busy
machine.
"""

from argo_compiler.route import suggest_route
from argo_env.envs.observations import Observation
from baselines.planned import PlannedPolicy
from baselines.problem import problem_from_observation

WORK_LIMIT = 5.0
"""work limit of one plan, in nominal s of one core"""


class Portfolio(PlannedPolicy):
    """Policy that drives the optimiser's route of the start, without nodes that become illegal.

    It is the route with the highest prize that the optimiser finds.
    """

    name = "portfolio"
    replans = False
    work_limit = WORK_LIMIT

    def plan_route(self, observation: Observation) -> list[int]:
        open_problem = problem_from_observation(observation, self._budget)
        suggestion = suggest_route(
            open_problem.problem, time_limit=None, seed=self._seed, work_limit=self.work_limit
        )
        return open_problem.to_nodes(suggestion.order or ())


class QuickPortfolio(Portfolio):
    """`Portfolio` with a fifth of the work limit."""

    name = "portfolio-1s"
    work_limit = WORK_LIMIT / 5


class ResolvedPortfolio(Portfolio):
    """`Portfolio` that plans the rest of the route again when an observation deviates."""

    name = "portfolio-resolved"
    replans = True
