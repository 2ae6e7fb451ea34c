"""Training in parts: first with lessons, then with MaskablePPO.

Each part starts only from what the one before it stored in a file, so a training that is
interrupted and resumed leads to the same weights.
"""

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
from baselines.learned.imitation import action_and_value_losses, make_lessons
from baselines.learned.network import RouteNetwork
from baselines.learned.policy import RoutePolicy
from baselines.learned.sources import SITES, TrainingRoutes
from baselines.learned.validation import Validation
from baselines.learned.vec_env import RouteVecEnv

CHECKPOINT, WEIGHTS = "checkpoint.pt", "weights.pt"
_PASSES = 3  # passes over the lessons of a part
_INSTANCES = 4096  # number of instances from which a batch of routes draws


@dataclass(frozen=True)
class Settings:
    """Settings of a training; equal settings give equal weights on the same machine."""

    seed: int = 0
    lesson_parts: int = 12
    """number of parts of the training with lessons"""
    parts: int = 4
    """number of parts of the training with MaskablePPO"""
    lesson_sizes: tuple[int, ...] = (8, 10, 12, 12, 13, 14)
    """numbers of checkpoints in the lessons of a part"""
    lessons: int = 1500
    """number of samples in a part for each of `lesson_sizes`"""
    iterations: int = 6
    """iterations of MaskablePPO in a part, each of `routes` times `moves` steps"""
    routes: int = 256
    """routes at once in MaskablePPO, with 20 checkpoints"""
    moves: int = 40
    """steps of each route in an iteration, with 20 checkpoints"""
    batch: int = 1024
    """batch size of MaskablePPO"""
    passes: int = 2
    """passes of MaskablePPO over the steps of an iteration"""
    lesson_rate: float = 1e-3
    """initial learning rate of the lessons; it falls from part to part"""
    rate: float = 3e-4
    """initial learning rate of MaskablePPO; it falls from part to part"""
    entropy: float = 0.003
    """weight of the entropy in the loss of MaskablePPO"""
    checkpoints: tuple[int, ...] = (20,)
    """numbers of checkpoints in the parts with MaskablePPO, in turn"""
    sites: tuple[str, ...] = SITES
    validation: int = 50
    """number of instances in each validation set"""


@dataclass
class TrainingState:
    """State of a training: the network, the optimiser and the progress."""

    settings: Settings
    network: RouteNetwork
    part: int = 0
    """number of completed parts, those with lessons included"""
    steps: int = 0
    """number of states learned from, in lessons and in the environment"""
    optimiser: dict[str, Any] = field(default_factory=dict)
    """state of the optimiser; empty at the start of each of the two stages"""


def untrained_state(settings: Settings) -> TrainingState:
    """Return the state before the first part, with random weights drawn with the settings' seed."""
    torch.manual_seed(settings.seed)
    return TrainingState(settings, RouteNetwork())


def save_checkpoint(state: TrainingState, folder: Path) -> None:
    """Write the checkpoint and, to another file, the weights in half precision as shipped."""
    checkpoint = {
        "settings": asdict(state.settings),
        "network": state.network.state_dict(),
        "part": state.part,
        "steps": state.steps,
        "optimiser": state.optimiser,
    }
    half = {name: tensor.half() for name, tensor in state.network.state_dict().items()}
    for name, data in ((CHECKPOINT, checkpoint), (WEIGHTS, half)):
        unfinished = folder / f"{name}.part"
        torch.save(data, unfinished)
        unfinished.replace(folder / name)


def load_checkpoint(folder: Path) -> TrainingState:
    """Return the state that is stored in a folder; raise ArgoError if there is none."""
    path = folder / CHECKPOINT
    try:
        checkpoint = torch.load(path, weights_only=True)
        network = RouteNetwork()
        network.load_state_dict(checkpoint["network"])
        settings = Settings(**checkpoint["settings"])
        return TrainingState(
            settings, network, checkpoint["part"], checkpoint["steps"], checkpoint["optimiser"]
        )
    except FileNotFoundError:
        raise NotFound(
            f"no training to resume: {path} does not exist; start one with --out"
        ) from None
    except (UnpicklingError, AttributeError, RuntimeError, EOFError, KeyError, TypeError):
        raise Invalid(
            f"{path} is damaged or no checkpoint of this training: start a new one with --out"
        ) from None


def train(state: TrainingState, folder: Path, write_line: Callable[[str], None] = print) -> None:
    """Carry out all parts that the state has not completed, and save a checkpoint after each.

    Args:
        state: state of the training, which is changed.
        folder: folder of the checkpoint, of the weights and, in `logs`, of the TensorBoard logs.
        write_line: function that is called with a line of results after each part.
    """
    torch.set_num_threads(1)  # so that sums do not depend on the number of cores
    settings = state.settings
    logger = configure(str(folder / "logs"), ["tensorboard"])
    validation = Validation(settings.sites, settings.validation)
    parts = settings.lesson_parts + settings.parts
    while state.part < parts:
        with stage(f"part {state.part + 1} of {parts}"):
            if state.part < settings.lesson_parts:
                _train_on_lessons(state, logger)
            else:
                _train_with_ppo(state, logger)
            state.part += 1
            save_checkpoint(state, folder)
            scores = validation(state.network)
        for name, prize in scores.items():
            logger.record(f"validation/{name}", prize)
        logger.record("validation/part", state.part)
        logger.dump(state.steps)
        prizes = ", ".join(f"{name} {prize:.3f}" for name, prize in scores.items())
        write_line(f"part {state.part}: {state.steps} steps; mean prize {prizes}")
    logger.close()


def _train_on_lessons(state: TrainingState, logger: Logger) -> None:
    """Carry out one part of the training, with lessons."""
    settings, part = state.settings, state.part
    rng = generator(settings.seed, "teach", part)
    source = TrainingRoutes(20, sites=settings.sites)
    lessons = [
        make_lessons(source, size, settings.lessons, int(rng.integers(2**31)))
        for size in settings.lesson_sizes
    ]
    optimiser = torch.optim.Adam(state.network.parameters())
    if state.optimiser:
        optimiser.load_state_dict(state.optimiser)
    optimiser.param_groups[0]["lr"] = settings.lesson_rate * (
        1.0 - 0.95 * part / settings.lesson_parts
    )
    losses: list[tuple[float, float]] = []
    with stage("training on the lessons") as report:
        for done in range(_PASSES):
            batches = [
                (k, rows)
                for k, one in enumerate(lessons)
                for rows in np.array_split(rng.permutation(len(one)), max(len(one) // 256, 1))
            ]
            for number, b in enumerate(rng.permutation(len(batches))):
                report((done + number / len(batches)) / _PASSES, _loss_text(losses))
                k, rows = batches[b]
                actions, value = action_and_value_losses(
                    state.network, lessons[k].select_samples(rows)
                )
                optimiser.zero_grad()
                (actions + value).backward()  # type: ignore[no-untyped-call]
                torch.nn.utils.clip_grad_norm_(state.network.parameters(), 1.0)
                optimiser.step()
                losses.append((actions.item(), value.item()))
    state.steps += sum(len(one) for one in lessons)
    last = part + 1 == settings.lesson_parts
    state.optimiser = {} if last else optimiser.state_dict()
    logger.record("lessons/actions", float(np.mean([one[0] for one in losses])))
    logger.record("lessons/value", float(np.mean([one[1] for one in losses])))


def _loss_text(losses: Sequence[tuple[float, float]]) -> str:
    return f"loss {sum(losses[-1]):.3f}" if losses else ""


class _ProgressCallback(BaseCallback):
    """Callback of MaskablePPO that reports its progress."""

    def __init__(self, report: ProgressReporter, total: int) -> None:
        super().__init__()
        self._report = report
        self._total = total

    def _on_step(self) -> bool:
        done = self.num_timesteps - self._begun
        returns = [one["r"] for one in self.model.ep_info_buffer or ()]
        mean = f", mean return {np.mean(returns):.3f}" if returns else ""
        self._report(done / self._total, f"{done} of {self._total} steps{mean}")
        return True

    def _on_training_start(self) -> None:
        self._begun = self.model.num_timesteps


def _train_with_ppo(state: TrainingState, logger: Logger) -> None:
    """Carry out one part of the training, with MaskablePPO; no two such parts share instances."""
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
    with stage("training with MaskablePPO") as report:
        model.learn(steps, callback=_ProgressCallback(report, steps), reset_num_timesteps=False)
    state.network.load_state_dict(network.state_dict())
    state.optimiser = model.policy.optimizer.state_dict()
    state.steps = model.num_timesteps
