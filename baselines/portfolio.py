"""The optimiser as a policy."""

from argo_compiler.route import suggest_route
from argo_env.envs.observations import Observation
from baselines.planned import PlannedPolicy
from baselines.problem import problem_of

TIME_LIMIT = 5.0
"""s for a plan"""


class Portfolio(PlannedPolicy):
    """Drives the best route that is found at the beginning, whatever happens on the way. What has
    become illegal is left out."""

    name = "portfolio"
    again = False

    def plan(self, observation: Observation) -> list[int]:
        """See Planned."""
        found = problem_of(observation, self._budget)
        suggestion = suggest_route(found.problem, TIME_LIMIT, self._seed)
        return found.order_of(suggestion.order)


class ResolvedPortfolio(Portfolio):
    """Plans the rest of the route anew when something has gone otherwise than planned."""

    name = "portfolio-resolved"
    again = True
