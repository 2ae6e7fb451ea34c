"""Policies with a trained network, for any number of checkpoints.

`LearnedPolicy` chooses the node with the highest score, step by step. `SampledPolicy` first
simulates the rest of the route many times, on the travel times that it observes, and follows the
best of these routes.
"""

from collections.abc import Mapping
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid, NotFound
from argo_env.envs.observations import Observation
from argo_env.envs.route_instance import DOCK
from argo_env.seeding import generator
from baselines.learned.extra import require_learned_extra

WEIGHTS = Path(__file__).parent / "weights" / "route.pt"
"""file of the shipped weights"""
ROLLOUTS = 64
"""default number of simulated routes"""
_PAIRS = 1 << 20  # greatest number of pairs of nodes in one call of the network
_MARGIN = 1e-6  # share of the budget, because times are rounded in a simulated route
_SAME = 1e-6  # share of the budget; travel times that differ by less have not changed


class Scorer:
    """A network with trained weights, which is applied to observations in NumPy."""

    def __init__(self, path: Path = WEIGHTS) -> None:
        """Load the weights; raise ArgoError without such weights or without torch."""
        require_learned_extra()
        import torch

        from baselines.learned.network import RouteNetwork

        torch.set_num_threads(1)  # one route is too little work for several threads

        self._torch, self._network = torch, RouteNetwork()
        try:
            weights = torch.load(path, weights_only=True)
            self._network.load_state_dict({name: w.float() for name, w in weights.items()})
        except FileNotFoundError:
            raise NotFound(
                f"no weights at {path}: train some, see {WEIGHTS.parent / 'README.md'}"
            ) from None
        except (UnpicklingError, AttributeError, RuntimeError, EOFError):
            raise Invalid(
                f"{path} has no weights of this policy: give a `weights.pt` that its training wrote"
            ) from None
        self._network.eval()

    def __call__(self, observation: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """Return the scores of a batch of states, shape (batch, n + 1); -inf for illegal nodes."""
        torch = self._torch
        rows = len(observation["left"])
        size = observation["prize"].shape[1]
        step = max(_PAIRS // size**2, 1)
        scores = []
        with torch.inference_mode():
            for k in range(0, rows, step):
                part = {name: torch.from_numpy(a[k : k + step]) for name, a in observation.items()}
                scores.append(self._network(part)[0].numpy())
        return np.where(observation["mask"] == 1, np.concatenate(scores), -np.inf)


class LearnedPolicy:
    """Policy that chooses the legal node with the highest score; it holds the weights only."""

    name = "learned"

    def __init__(self, scorer: Scorer) -> None:
        self.scorer = scorer

    @classmethod
    def from_file(cls, path: Path = WEIGHTS) -> "LearnedPolicy":
        """Return a policy with the weights of a file, by default the shipped ones."""
        return cls(Scorer(path))

    def begin(self, observation: Observation, robot_time_budget: float, seed: int) -> None:
        """Do nothing: there is nothing to prepare."""

    def act(self, observation: Observation) -> int:
        nodes = dock_and_open_nodes(observation)
        return int(nodes[self.scorer(select_nodes_as_batch(observation, nodes))[0].argmax()])


class SampledPolicy:
    """Policy that simulates the route `rollouts` times and follows the best simulated route.

    One simulation chooses the nodes with the highest scores, the others draw nodes according to the
    scores. The best route has the highest prize, and of several such routes the least time. The
    policy simulates again when an observation deviates from its plan. It holds the plan.
    """

    name = "learned-sampled"

    def __init__(self, scorer: Scorer, rollouts: int = ROLLOUTS) -> None:
        self.scorer, self.rollouts = scorer, rollouts
        self._plan: list[int] = []
        self._matrix: NDArray[np.float32] | None = None
        self._rng = generator(0, "sampled routes")

    @classmethod
    def from_file(cls, path: Path = WEIGHTS, rollouts: int = ROLLOUTS) -> "SampledPolicy":
        """Return a policy with the weights of a file, by default the shipped ones."""
        return cls(Scorer(path), rollouts)

    def begin(self, observation: Observation, robot_time_budget: float, seed: int) -> None:  # noqa: ARG002
        """Discard the plan of the last episode, and seed the draws."""
        self._rng = generator(seed, "sampled routes")
        self._matrix = None

    def act(self, observation: Observation) -> int:
        if not self._plan_is_valid(observation):
            self._plan = best_rollout(self.scorer, observation, self.rollouts, self._rng)
            self._matrix = observation["matrix"].copy()
        self._expected_open = observation["prize"] > 0
        node = self._plan.pop(0)
        self._expected_open[node] = False
        return node

    def _plan_is_valid(self, observation: Observation) -> bool:
        return (
            self._matrix is not None
            and np.allclose(self._matrix, observation["matrix"], rtol=0.0, atol=_SAME)
            and np.array_equal(self._expected_open, observation["prize"] > 0)
            and bool(self._plan)
            and bool(observation["mask"][self._plan[0]])
        )


def dock_and_open_nodes(observation: Observation) -> NDArray[np.int64]:
    """Return the numbers of the dock and of all nodes that are legal or still have a prize."""
    is_open = (observation["prize"] > 0) | (observation["mask"] == 1)
    is_open[DOCK] = True
    return np.flatnonzero(is_open)


def select_nodes_as_batch(
    observation: Observation, nodes: NDArray[np.int64]
) -> dict[str, NDArray[Any]]:
    """Return a copy of the observation with these nodes only, as a batch of one state."""
    selected = {name: observation[name][nodes] for name in ("travel", "home", "prize", "mask")}
    selected["left"] = observation["left"]
    selected["matrix"] = observation["matrix"][np.ix_(nodes, nodes)]
    selected["before"] = observation["before"][np.ix_(nodes, nodes)]
    return {name: array[None] for name, array in selected.items()}


def best_rollout(
    scorer: Scorer, observation: Observation, rollouts: int, rng: np.random.Generator
) -> list[int]:
    """Return the best of some simulated routes from the observed state to the dock.

    The best route has the highest prize, and of several such routes the least time. It is a list
    of nodes, with the dock at the end. The first simulation chooses the highest scores; the others
    draw nodes with softmax probabilities of the scores (Gumbel-max trick).
    """
    nodes = dock_and_open_nodes(observation)
    state = {
        name: np.repeat(array, rollouts, axis=0)
        for name, array in select_nodes_as_batch(observation, nodes).items()
    }
    rows, total = np.arange(rollouts), np.zeros(rollouts)
    steps: list[NDArray[np.int64]] = []
    docked = np.zeros(rollouts, np.bool_)
    while not docked.all():
        scores = scorer(state)
        scores[1:] += rng.gumbel(size=scores[1:].shape)
        chosen = np.where(docked, DOCK, scores.argmax(axis=1))
        steps.append(nodes[chosen])
        total += state["prize"][rows, chosen]
        _step(state, rows, chosen, docked)
        docked |= chosen == DOCK
    left = state["left"][:, 0]
    best = int(np.lexsort((-left, -np.round(total, 4)))[0])
    route = [int(step[best]) for step in steps]
    return route[: route.index(DOCK) + 1]


def _step(
    state: dict[str, NDArray[Any]],
    rows: NDArray[np.int64],
    chosen: NDArray[np.int64],
    docked: NDArray[np.bool_],
) -> None:
    """Change `state`, a batch, by the chosen node of each row, as the environment would.

    `rows` are the indices of all rows. Rows that are docked stay there.
    """
    moving = chosen != DOCK
    took = np.where(docked, 0.0, state["travel"][rows, chosen])
    state["left"] = (state["left"][:, 0] - took)[:, None].astype(np.float32)
    state["prize"][rows, chosen] = 0.0
    state["travel"] = state["matrix"][rows, chosen]
    unvisited = state["prize"] > 0
    blocked = (state["before"] & unvisited[:, :, None]).any(axis=1)
    legal = unvisited & ~blocked & moving[:, None]
    legal &= state["travel"] + state["home"] <= state["left"] - _MARGIN
    legal[:, DOCK] = True
    state["mask"] = legal.astype(np.int8)
