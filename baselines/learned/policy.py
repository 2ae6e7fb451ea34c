"""Policy of MaskablePPO with the route network."""

from typing import Any

from numpy.typing import NDArray
from sb3_contrib.common.maskable.distributions import MaskableDistribution
from sb3_contrib.common.maskable.policies import MaskableActorCriticPolicy
from stable_baselines3.common.type_aliases import PyTorchObs, Schedule
from torch import Tensor

from baselines.learned.network import RouteNetwork


class RoutePolicy(MaskableActorCriticPolicy):
    """Actor-critic policy that has a `RouteNetwork` in place of sb3's extractor and dense layers.

    The network gives a logit for each node, and a value that is a sum over nodes. Its input is the
    observation as the environment gives it.
    """

    def _build(self, lr_schedule: Schedule) -> None:
        self.network = RouteNetwork()
        self.optimizer = self.optimizer_class(
            self.network.parameters(),
            lr=lr_schedule(1),  # type: ignore[call-arg]
            **self.optimizer_kwargs,
        )

    def forward(
        self,
        obs: PyTorchObs,
        deterministic: bool = False,
        action_masks: NDArray[Any] | None = None,
    ) -> tuple[Tensor, Tensor, Tensor]:
        distribution, value = self._distribution_and_value(obs, action_masks)
        actions = distribution.get_actions(deterministic=deterministic)
        return actions, value, distribution.log_prob(actions)

    def evaluate_actions(
        self, obs: PyTorchObs, actions: Tensor, action_masks: Tensor | None = None
    ) -> tuple[Tensor, Tensor, Tensor | None]:
        distribution, value = self._distribution_and_value(obs, action_masks)
        return value, distribution.log_prob(actions), distribution.entropy()

    def get_distribution(
        self, obs: PyTorchObs, action_masks: NDArray[Any] | None = None
    ) -> MaskableDistribution:
        return self._distribution_and_value(obs, action_masks)[0]

    def predict_values(self, obs: PyTorchObs) -> Tensor:
        return self._distribution_and_value(obs, None)[1]

    def _distribution_and_value(
        self, obs: PyTorchObs, masks: NDArray[Any] | Tensor | None
    ) -> tuple[MaskableDistribution, Tensor]:
        scores, value = self.network(obs)
        distribution = self.action_dist.proba_distribution(action_logits=scores)
        if masks is not None:
            distribution.apply_masking(masks)
        return distribution, value
