"""Training in parts: first lessons, then MaskablePPO. Each part begins with nothing but what the
one before it left in a file, so that a training that was cut off goes on to the same weights."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import numpy as np
import torch
from sb3_contrib import MaskablePPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger, configure
from stable_baselines3.common.utils import set_random_seed

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.stages import ProgressReporter, stage
from argo_env.seeding import generator
from baselines.learned.imitation import lessons, loss
from baselines.learned.network import RouteNetwork
from baselines.learned.policy import RoutePolicy
from baselines.learned.sources import SITES, TrainingRoutes
from baselines.learned.validation import Validation
from baselines.learned.vec_env import RouteVecEnv

CHECKPOINT, WEIGHTS = "checkpoint.pt", "weights.pt"
_PASSES = 3  # over the lessons of a part
_INSTANCES = 4096  # a batch of routes draws from


@dataclass(frozen=True)
class Settings:
    """What decides the weights: equal settings give equal weights on the same machine."""

    seed: int = 0
    lesson_parts: int = 12
    parts: int = 4
    """of MaskablePPO"""
    lesson_sizes: tuple[int, ...] = (8, 10, 12, 12, 13, 14)
    """checkpoints in the lessons of a part"""
    lessons: int = 1500
    """of each of these in a part"""
    iterations: int = 6
    """of MaskablePPO in a part, each of `routes` times `moves` steps"""
    routes: int = 256
    moves: int = 40
    batch: int = 1024
    passes: int = 2
    lesson_rate: float = 1e-3
    rate: float = 3e-4
    """learning rates at the start; both fall"""
    entropy: float = 0.003
    checkpoints: tuple[int, ...] = (20,)
    """in the routes of the parts of MaskablePPO, in turn"""
    sites: tuple[str, ...] = SITES
    validation: int = 50
    """instances of each validation set"""


@dataclass
class State:
    """What is learned so far, and what the optimiser keeps."""

    settings: Settings
    network: RouteNetwork
    part: int = 0
    """parts that are done, those with lessons included"""
    steps: int = 0
    """states that it has learned from, in lessons and in the environment"""
    optimiser: dict[str, Any] = field(default_factory=dict)


def begin(settings: Settings) -> State:
    """A network that has learned nothing."""
    torch.manual_seed(settings.seed)
    return State(settings, RouteNetwork())


def save(state: State, folder: Path) -> None:
    """Writes the checkpoint, and the weights as they ship: in half precision."""
    kept = {
        "settings": asdict(state.settings),
        "network": state.network.state_dict(),
        "part": state.part,
        "steps": state.steps,
        "optimiser": state.optimiser,
    }
    half = {name: tensor.half() for name, tensor in state.network.state_dict().items()}
    for name, data in ((CHECKPOINT, kept), (WEIGHTS, half)):
        unfinished = folder / f"{name}.part"
        torch.save(data, unfinished)
        unfinished.replace(folder / name)


def load(folder: Path) -> State:
    """The state that was saved there; ArgoError if there is none."""
    path = folder / CHECKPOINT
    try:
        kept = torch.load(path, weights_only=True)
        network = RouteNetwork()
        network.load_state_dict(kept["network"])
        settings = Settings(**kept["settings"])
        return State(settings, network, kept["part"], kept["steps"], kept["optimiser"])
    except FileNotFoundError:
        raise NotFound(f"no training to go on with: there is no {path}") from None
    except (UnpicklingError, AttributeError, RuntimeError, EOFError, KeyError, TypeError):
        raise Invalid(
            f"{path} is damaged, or not of this training: begin a new one with --out"
        ) from None


def train(state: State, folder: Path, tell: Callable[[str], None] = print) -> None:
    """Goes on from the state to the end, saving after each part. Logs are under `folder/logs`."""
    torch.set_num_threads(1)  # the same sums in the same order, however many cores there are
    settings = state.settings
    logger = configure(str(folder / "logs"), ["tensorboard"])
    validation = Validation(settings.sites, settings.validation)
    parts = settings.lesson_parts + settings.parts
    while state.part < parts:
        with stage(f"part {state.part + 1} of {parts}"):
            if state.part < settings.lesson_parts:
                _teach(state, logger)
            else:
                _practise(state, logger)
            state.part += 1
            save(state, folder)
            scores = validation(state.network)
        for name, prize in scores.items():
            logger.record(f"validation/{name}", prize)
        logger.record("validation/part", state.part)
        logger.dump(state.steps)
        prizes = ", ".join(f"{name} {prize:.3f}" for name, prize in scores.items())
        tell(f"part {state.part}: {state.steps} steps; mean prize {prizes}")
    logger.close()


def _teach(state: State, logger: Logger) -> None:
    """One part with lessons."""
    settings, part = state.settings, state.part
    rng = generator(settings.seed, "teach", part)
    source = TrainingRoutes(20, sites=settings.sites)
    taught = [
        lessons(source, size, settings.lessons, int(rng.integers(2**31)))
        for size in settings.lesson_sizes
    ]
    optimiser = torch.optim.Adam(state.network.parameters())
    if state.optimiser:
        optimiser.load_state_dict(state.optimiser)
    optimiser.param_groups[0]["lr"] = settings.lesson_rate * (
        1.0 - 0.95 * part / settings.lesson_parts
    )
    losses: list[tuple[float, float]] = []
    with stage("learning from them") as tell:
        for done in range(_PASSES):
            batches = [
                (k, rows)
                for k, one in enumerate(taught)
                for rows in np.array_split(rng.permutation(len(one)), max(len(one) // 256, 1))
            ]
            for number, b in enumerate(rng.permutation(len(batches))):
                tell((done + number / len(batches)) / _PASSES, _latest(losses))
                k, rows = batches[b]
                actions, value = loss(state.network, taught[k].part(rows))
                optimiser.zero_grad()
                (actions + value).backward()  # type: ignore[no-untyped-call]
                torch.nn.utils.clip_grad_norm_(state.network.parameters(), 1.0)
                optimiser.step()
                losses.append((actions.item(), value.item()))
    state.steps += sum(len(one) for one in taught)
    last = part + 1 == settings.lesson_parts
    state.optimiser = {} if last else optimiser.state_dict()
    logger.record("lessons/actions", float(np.mean([one[0] for one in losses])))
    logger.record("lessons/value", float(np.mean([one[1] for one in losses])))


def _latest(losses: Sequence[tuple[float, float]]) -> str:
    return f"loss {sum(losses[-1]):.3f}" if losses else ""


class _Told(BaseCallback):
    """Tells how far MaskablePPO is."""

    def __init__(self, tell: ProgressReporter, total: int) -> None:
        super().__init__()
        self._tell = tell
        self._total = total

    def _on_step(self) -> bool:
        done = self.num_timesteps - self._begun
        returns = [one["r"] for one in self.model.ep_info_buffer or ()]
        mean = f", mean return {np.mean(returns):.3f}" if returns else ""
        self._tell(done / self._total, f"{done} of {self._total} steps{mean}")
        return True

    def _on_training_start(self) -> None:
        self._begun = self.model.num_timesteps


def _practise(state: State, logger: Logger) -> None:
    """One part of MaskablePPO, on instances that no other part has."""
    settings = state.settings
    part = state.part - settings.lesson_parts
    seed = int(generator(settings.seed, "practise", part).integers(2**31))
    checkpoints = settings.checkpoints[part % len(settings.checkpoints)]
    routes = max(settings.routes * 20 // checkpoints, 1)
    moves = settings.moves * checkpoints // 20
    source = TrainingRoutes(checkpoints, sites=settings.sites, offset=part * _INSTANCES)
    set_random_seed(seed)
    model = MaskablePPO(
        RoutePolicy,
        RouteVecEnv(routes, source, seed),
        learning_rate=settings.rate * (1.0 - 0.95 * part / settings.parts),
        n_steps=moves,
        batch_size=settings.batch,
        n_epochs=settings.passes,
        gamma=1.0,
        ent_coef=settings.entropy,
        stats_window_size=1000,
        device="cpu",
        seed=seed,
    )
    network: RouteNetwork = model.policy.network  # type: ignore[assignment]
    network.load_state_dict(state.network.state_dict())
    if state.optimiser:
        model.policy.optimizer.load_state_dict(state.optimiser)
    model.set_logger(logger)
    model.num_timesteps = state.steps
    steps = settings.iterations * routes * moves
    with stage("practising") as tell:
        model.learn(steps, callback=_Told(tell, steps), reset_num_timesteps=False)
    state.network.load_state_dict(network.state_dict())
    state.optimiser = model.policy.optimizer.state_dict()
    state.steps = model.num_timesteps
