"""Protocol of policies, the names of Argo's own, and the choice of one by name."""

from typing import Protocol, cast

from argo_compiler.base.errors import NotFound
from argo_env.envs.observations import Observation
from argo_env.policies import POLICIES, import_policy


class Policy(Protocol):
    """Protocol of a policy, which chooses the next node in episodes of `argo/Route-v0`.

    Its only input is the observation of the environment with `full=True`: among others `matrix`,
    the travel times as they are known now; `prize`, the prizes that can still be won; `before`, the
    precedence constraints; `place`, the row of the robot's node; and `mask`, the legal nodes. Node
    0 is the dock.
    """

    name: str

    def begin(self, observation: Observation, robot_time_budget: float, seed: int) -> None:
        """Prepare for an episode, before its first decision; by default do nothing.

        Args:
            observation: first observation of the episode.
            robot_time_budget: time budget of the episode in simulated s; times in observations
                are shares of it.
            seed: seed of all random decisions.
        """

    def act(self, observation: Observation) -> int:
        """Return the next node; an illegal one counts as the dock, which ends the episode."""
        ...


OWN_POLICIES = (
    "given-order",
    "nearest-neighbour",
    "prize-over-time",
    "insertion",
    "portfolio",
    "portfolio-1s",
    "portfolio-resolved",
    "learned",
    "learned-sampled",
)
"""names of Argo's policies, in the order in which they are compared. A new one needs a line here,
and one in `pyproject.toml`, which has the class or function of each"""


def make_policy(name: str) -> Policy:
    """Return a new policy, by its name or by `module:name` of its factory.

    Raises ArgoError if there is none, or if it can't be used.
    """
    if ":" in name:
        return cast("Policy", import_policy(name)())
    try:
        factory = POLICIES[name]
    except NotFound as error:
        raise NotFound(f"{error}; name a policy of your own as `module:class`") from None
    return cast("Policy", factory())
