"""The optimiser as a policy. Its limit is one of work: so it finds the same routes each time, on a
slow or a busy machine as well."""

from argo_compiler.route import suggest_route
from argo_env.envs.observations import Observation
from baselines.planned import PlannedPolicy
from baselines.problem import problem_of

WORK_LIMIT = 5.0
"""for a plan, in nominal s of one core"""


class Portfolio(PlannedPolicy):
    """Drives the best route that is found at the beginning, whatever happens on the way. What has
    become illegal is left out."""

    name = "portfolio"
    again = False
    work_limit = WORK_LIMIT

    def plan(self, observation: Observation) -> list[int]:
        """See Planned."""
        found = problem_of(observation, self._budget)
        suggestion = suggest_route(
            found.problem, time_limit=None, seed=self._seed, work_limit=self.work_limit
        )
        return found.order_of(suggestion.order)


class QuickPortfolio(Portfolio):
    """The same with a fifth of the work."""

    name = "portfolio-1s"
    work_limit = WORK_LIMIT / 5


class ResolvedPortfolio(Portfolio):
    """Plans the rest of the route anew when something has gone otherwise than planned."""

    name = "portfolio-resolved"
    again = True
