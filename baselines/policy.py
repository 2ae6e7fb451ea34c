"""Protocol of policies, and the policies that can be chosen by name."""

from collections.abc import Callable
from importlib import import_module
from operator import attrgetter
from typing import Protocol, cast

from argo_compiler.base.errors import NotFound
from argo_env.envs.observations import Observation


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


POLICIES: dict[str, str | Callable[[], Policy]] = {
    "given-order": "baselines.heuristics.greedy:GivenOrder",
    "nearest-neighbour": "baselines.heuristics.greedy:NearestNeighbour",
    "prize-over-time": "baselines.heuristics.greedy:PrizeOverTime",
    "insertion": "baselines.heuristics.insertion:Insertion",
    "portfolio": "baselines.portfolio:Portfolio",
    "portfolio-1s": "baselines.portfolio:QuickPortfolio",
    "portfolio-resolved": "baselines.portfolio:ResolvedPortfolio",
    "learned": "baselines.learned.agent:LearnedPolicy.from_file",
    "learned-sampled": "baselines.learned.agent:SampledPolicy.from_file",
}
"""Factory of each policy, by name: a class, a function, or `module:name` of one. A new policy needs
one line here, or `POLICIES["mine"] = Mine` in the program that uses it."""


def make_policy(name: str) -> Policy:
    """Return a new policy, by its name or by `module:name` of its factory.

    Raises ArgoError if there is none.
    """
    maker = POLICIES.get(name, name)
    if not isinstance(maker, str):
        return maker()
    module, _, attribute = maker.partition(":")
    if not attribute:
        raise NotFound(
            f"no policy `{name}`; choose one of: {', '.join(POLICIES)}; name a policy of your own "
            "as `module:class`"
        )
    try:
        factory = attrgetter(attribute)(import_module(module))
    except (ImportError, AttributeError) as error:
        raise NotFound(f"policy `{name}`: `{maker}` can't be loaded ({error})") from None
    return cast("Policy", factory())
