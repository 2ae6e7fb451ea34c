"""The learned policies as the arena plays them, for any number of checkpoints.

One takes the node with the highest score, step by step. The other first plays the rest of the route
many times in thought, on the travel times that it is shown, and goes the best of these ways.
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
from baselines.learned.extra import check_learned

WEIGHTS = Path(__file__).parent / "weights" / "route.pt"
ROLLOUTS = 64
_PAIRS = 1 << 20  # of nodes that the network looks at in one go
_MARGIN = 1e-6  # of the budget: in thought, times are rounded
_SAME = 1e-6  # likewise: travel times that differ by less have not changed


class Scorer:
    """Trained weights, applied to observations in NumPy."""

    def __init__(self, path: Path = WEIGHTS) -> None:
        """Raises ArgoError if there are no such weights, or torch is not installed."""
        check_learned()
        import torch

        from baselines.learned.network import RouteNetwork

        torch.set_num_threads(1)  # one route is too little work to share out

        self._torch, self._network = torch, RouteNetwork()
        try:
            weights = torch.load(path, weights_only=True)
            self._network.load_state_dict({name: w.float() for name, w in weights.items()})
        except FileNotFoundError:
            raise NotFound(f"no weights at {path}: train some, see {WEIGHTS.parent}") from None
        except (UnpicklingError, AttributeError, RuntimeError, EOFError):
            raise Invalid(
                f"{path} has no weights of this policy: take a `weights.pt` that its training wrote"
            ) from None
        self._network.eval()

    def __call__(self, observation: Mapping[str, NDArray[Any]]) -> NDArray[np.float32]:
        """The scores of a batch of states, shape (batch, n + 1); -inf for what is not legal."""
        torch = self._torch
        rows = len(observation["left"])
        size = observation["prize"].shape[1]
        step = max(_PAIRS // size**2, 1)
        found = []
        with torch.inference_mode():
            for k in range(0, rows, step):
                part = {name: torch.from_numpy(a[k : k + step]) for name, a in observation.items()}
                found.append(self._network(part)[0].numpy())
        return np.where(observation["mask"] == 1, np.concatenate(found), -np.inf)


class LearnedPolicy:
    """Takes the legal node with the highest score. Holds the weights only."""

    name = "learned"

    def __init__(self, scorer: Scorer) -> None:
        self.scorer = scorer

    @classmethod
    def load(cls, path: Path = WEIGHTS) -> "LearnedPolicy":
        """With the weights of that file, or those that ship."""
        return cls(Scorer(path))

    def begin(self, observation: Observation, budget: float, seed: int) -> None:
        """Nothing has to be prepared."""

    def act(self, observation: Observation) -> int:
        """The node to go to."""
        nodes = open_nodes(observation)
        return int(nodes[self.scorer(narrowed(observation, nodes))[0].argmax()])


class SampledPolicy:
    """Plays the route `rollouts` times in thought, once by the highest scores and otherwise by
    chance according to them, and goes the way that brought most; of equal ones the shortest.

    Thinks again when what it sees differs from what it planned with. Holds its plan.
    """

    name = "learned-sampled"

    def __init__(self, scorer: Scorer, rollouts: int = ROLLOUTS) -> None:
        self.scorer, self.rollouts = scorer, rollouts
        self._plan: list[int] = []
        self._matrix: NDArray[np.float32] | None = None
        self._rng = generator(0, "sampled routes")

    @classmethod
    def load(cls, path: Path = WEIGHTS, rollouts: int = ROLLOUTS) -> "SampledPolicy":
        """With the weights of that file, or those that ship."""
        return cls(Scorer(path), rollouts)

    def begin(self, observation: Observation, budget: float, seed: int) -> None:  # noqa: ARG002
        """Forgets the plan of the last route."""
        self._rng = generator(seed, "sampled routes")
        self._matrix = None

    def act(self, observation: Observation) -> int:
        """The node to go to."""
        if not self._still_good(observation):
            self._plan = best_rollout(self.scorer, observation, self.rollouts, self._rng)
            self._matrix = observation["matrix"].copy()
        self._left_over = observation["prize"] > 0
        node = self._plan.pop(0)
        self._left_over[node] = False
        return node

    def _still_good(self, observation: Observation) -> bool:
        return (
            self._matrix is not None
            and np.allclose(self._matrix, observation["matrix"], rtol=0.0, atol=_SAME)
            and np.array_equal(self._left_over, observation["prize"] > 0)
            and bool(self._plan)
            and bool(observation["mask"][self._plan[0]])
        )


def open_nodes(observation: Observation) -> NDArray[np.int64]:
    """The dock and what was not visited yet: nothing else matters for what comes."""
    still = (observation["prize"] > 0) | (observation["mask"] == 1)
    still[DOCK] = True
    return np.flatnonzero(still)


def narrowed(observation: Observation, nodes: NDArray[np.int64]) -> dict[str, NDArray[Any]]:
    """One observation with these nodes only, as a batch of one."""
    narrow = {name: observation[name][nodes] for name in ("travel", "home", "prize", "mask")}
    narrow["left"] = observation["left"]
    narrow["matrix"] = observation["matrix"][np.ix_(nodes, nodes)]
    narrow["before"] = observation["before"][np.ix_(nodes, nodes)]
    return {name: array[None] for name, array in narrow.items()}


def best_rollout(
    scorer: Scorer, observation: Observation, rollouts: int, rng: np.random.Generator
) -> list[int]:
    """The best of some ways to the dock from the state that is observed, as nodes in order."""
    nodes = open_nodes(observation)
    state = {
        name: np.repeat(array, rollouts, axis=0)
        for name, array in narrowed(observation, nodes).items()
    }
    rows, total = np.arange(rollouts), np.zeros(rollouts)
    ways: list[NDArray[np.int64]] = []
    docked = np.zeros(rollouts, np.bool_)
    while not docked.all():
        scores = scorer(state)
        scores[1:] += rng.gumbel(size=scores[1:].shape)
        chosen = np.where(docked, DOCK, scores.argmax(axis=1))
        ways.append(nodes[chosen])
        total += state["prize"][rows, chosen]
        _move(state, rows, chosen, docked)
        docked |= chosen == DOCK
    time = state["left"][:, 0]
    best = int(np.lexsort((-time, -np.round(total, 4)))[0])
    way = [int(step[best]) for step in ways]
    return way[: way.index(DOCK) + 1]


def _move(
    state: dict[str, NDArray[Any]],
    rows: NDArray[np.int64],
    chosen: NDArray[np.int64],
    docked: NDArray[np.bool_],
) -> None:
    """Goes on in all rows, as the environment would; those that are docked stay there."""
    moving = chosen != DOCK
    took = np.where(docked, 0.0, state["travel"][rows, chosen])
    state["left"] = (state["left"][:, 0] - took)[:, None].astype(np.float32)
    state["prize"][rows, chosen] = 0.0
    state["travel"] = state["matrix"][rows, chosen]
    waiting = state["prize"] > 0
    missing = (state["before"] & waiting[:, :, None]).any(axis=1)
    legal = waiting & ~missing & moving[:, None]
    legal &= state["travel"] + state["home"] <= state["left"] - _MARGIN
    legal[:, DOCK] = True
    state["mask"] = legal.astype(np.int8)
