"""What a policy is, and which there are."""

from collections.abc import Callable
from importlib import import_module
from operator import attrgetter
from typing import Protocol, cast

from argo_compiler.base.errors import NotFound
from argo_env.envs.observations import Observation


class Policy(Protocol):
    """Chooses where to go next, one episode of `argo/Route-v0` after the other.

    It sees what the environment shows with `full=True`, and nothing else: `matrix` has the travel
    times as they are known now, `prize` what is still to be had, `before` the order that is asked
    for, `place` the row where the robot is, `mask` what is legal. Node 0 is the dock.
    """

    name: str

    def begin(self, observation: Observation, budget: float, seed: int) -> None:
        """Before the first decision: the first observation, and the budget (s) that all times in
        observations are shares of. Whatever is drawn at random follows from the seed.

        Does nothing unless a policy has something to prepare.
        """

    def act(self, observation: Observation) -> int:
        """The node to go to; an illegal one counts as the dock, which ends the episode."""
        ...


POLICIES: dict[str, str | Callable[[], Policy]] = {
    "given-order": "baselines.heuristics.greedy:GivenOrder",
    "nearest-neighbour": "baselines.heuristics.greedy:NearestNeighbour",
    "prize-over-time": "baselines.heuristics.greedy:PrizeOverTime",
    "insertion": "baselines.heuristics.insertion:Insertion",
    "portfolio": "baselines.portfolio:Portfolio",
    "portfolio-1s": "baselines.portfolio:QuickPortfolio",
    "portfolio-resolved": "baselines.portfolio:ResolvedPortfolio",
    "learned": "baselines.learned.agent:LearnedPolicy.load",
    "learned-sampled": "baselines.learned.agent:SampledPolicy.load",
}
"""By name, what makes the policy: a class, a function, or `module:name` of one. A new policy is one
line here, or `POLICIES["mine"] = Mine` in a program of one's own."""


def make_policy(name: str) -> Policy:
    """The policy of that name, or the one that `module:name` makes.

    Raises ArgoError if there is none.
    """
    maker = POLICIES.get(name, name)
    if not isinstance(maker, str):
        return maker()
    module, _, attribute = maker.partition(":")
    if not attribute:
        raise NotFound(
            f"no policy `{name}`; there are: {', '.join(POLICIES)}; one of your own is "
            "`module:class`"
        )
    try:
        made = attrgetter(attribute)(import_module(module))
    except (ImportError, AttributeError) as error:
        raise NotFound(f"policy `{name}`: there is no `{maker}` ({error})") from None
    return cast("Policy", made())
