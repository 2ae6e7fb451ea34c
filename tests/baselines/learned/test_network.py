"""Properties of the network that hold with any weights."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

torch = pytest.importorskip("torch")

from argo_env.envs.observations import Observation  # noqa: E402
from argo_env.envs.route_batch import RouteVectorEnv  # noqa: E402
from argo_env.envs.route_instance import RouteInstance  # noqa: E402
from argo_env.envs.route_sources import RandomRoutes  # noqa: E402
from baselines.learned.network import RouteNetwork  # noqa: E402
from baselines.learned.sources import TrainingRoutes, pad_instance  # noqa: E402
from tests.conftest import examples  # noqa: E402

torch.set_num_threads(1)


def network(seed: int = 0) -> RouteNetwork:
    torch.manual_seed(seed)
    return RouteNetwork().eval()


def observe_after(source: object, moves: int, seed: int) -> Observation:
    """Return the observation of three routes after some random moves."""
    batch = RouteVectorEnv(3, source=source, full=True)  # type: ignore[arg-type]
    observation, _ = batch.reset(seed=seed, options={"instance": (seed, seed + 1, seed + 2)})
    rng = np.random.default_rng(seed)
    for _ in range(moves):
        chosen = [int(rng.choice(np.flatnonzero(mask[1:]) + 1)) if mask[1:].any() else 0
                  for mask in observation["mask"]]  # fmt: skip
        observation = batch.step(np.array(chosen))[0]
    return observation


def scores_and_values(observation: Observation, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    tensors = {name: torch.from_numpy(array) for name, array in observation.items()}
    with torch.no_grad():
        scores, value = network(seed)(tensors)
    return scores.numpy(), value.numpy()


@given(st.integers(0, 1000), st.integers(2, 12), st.integers(0, 5))
@settings(max_examples=examples(15))
def test_another_order_of_the_checkpoints_changes_nothing(seed: int, size: int, moves: int) -> None:
    observation = observe_after(RandomRoutes(size), moves, seed)
    order = np.append(0, np.random.default_rng(seed).permutation(size) + 1)
    other = {name: observation[name][:, order] for name in ("travel", "home", "prize", "mask")}
    other["left"] = observation["left"]
    other["before"] = observation["before"][:, order][:, :, order]
    other["matrix"] = observation["matrix"][:, np.append(order, size + 1)][:, :, order]
    scores, value = scores_and_values(observation)
    other_scores, other_value = scores_and_values(other)
    np.testing.assert_allclose(other_scores, scores[:, order], atol=1e-4)
    np.testing.assert_allclose(other_value, value, atol=1e-4)


@given(st.integers(0, 1000), st.integers(0, 4))
@settings(max_examples=examples(8))
def test_unused_slots_change_nothing(seed: int, moves: int) -> None:
    class Padded(TrainingRoutes):
        def draw(self, number: int, *_: object) -> RouteInstance:  # type: ignore[override]
            return pad_instance(RandomRoutes(7).draw(number), 11)

    scores, value = scores_and_values(observe_after(RandomRoutes(7), moves, seed))
    padded_scores, padded_value = scores_and_values(observe_after(Padded(11), moves, seed))
    np.testing.assert_allclose(padded_scores[:, :8], scores, atol=1e-4)
    np.testing.assert_allclose(padded_value, value, atol=1e-4)


@pytest.mark.parametrize("size", [1, 5, 20, 100])
def test_the_same_weights_serve_any_number_of_checkpoints(size: int) -> None:
    observation = observe_after(RandomRoutes(size), 1, 0)
    scores, value = scores_and_values(observation)
    assert scores.shape == observation["prize"].shape
    assert np.isfinite(scores).all()
    assert (value >= 0).all()
    assert (value[:, 0] <= observation["prize"].sum(axis=1)).all()
