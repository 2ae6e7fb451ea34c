"""The training: it can be repeated and resumed; its environment for MaskablePPO."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

torch = pytest.importorskip("torch")
pytest.importorskip("sb3_contrib")

from sb3_contrib.common.maskable.utils import get_action_masks  # noqa: E402

from argo_compiler.base.errors import ArgoError  # noqa: E402
from argo_compiler.base.stages import listen_to_stages  # noqa: E402
from argo_env.envs import route_episodes  # noqa: E402
from argo_env.envs.route_instance import score_route  # noqa: E402
from argo_env.envs.route_sources import TEST, RandomRoutes  # noqa: E402
from baselines.learned import curve  # noqa: E402
from baselines.learned.agent import LearnedPolicy  # noqa: E402
from baselines.learned.sources import TrainingRoutes  # noqa: E402
from baselines.learned.train import main  # noqa: E402
from baselines.learned.training import (  # noqa: E402
    CHECKPOINT,
    WEIGHTS,
    Settings,
    TrainingState,
    load_checkpoint,
    train,
    untrained_state,
)
from baselines.learned.vec_env import RouteVecEnv  # noqa: E402

SMALL = Settings(
    lesson_parts=1, parts=2, lesson_sizes=(5,), lessons=60, iterations=1, routes=16, moves=10,
    batch=64, checkpoints=(5,), sites=(), validation=2,
)  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def few_instances() -> Iterator[None]:
    """Make batches draw from 64 instances, as it takes seconds to make 4,096."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(route_episodes, "TRAINING", range(64))
        yield


StageReport = tuple[str | None, float | None, str]


class PowerFailureError(Exception):
    """Error that interrupts a training."""


@pytest.fixture(scope="module")
def reports() -> list[StageReport]:
    """Return the list of the stages that the training reports."""
    return []


@pytest.fixture(scope="module")
def trained(
    tmp_path_factory: pytest.TempPathFactory, reports: list[StageReport]
) -> tuple[Path, TrainingState]:
    folder = tmp_path_factory.mktemp("trained")
    state = untrained_state(SMALL)
    with listen_to_stages(lambda *report: reports.append(report)):
        train(state, folder, [].append)
    return folder, state


@pytest.mark.long
def test_training_changes_weights_and_saves_them(trained: tuple[Path, TrainingState]) -> None:
    folder, state = trained
    assert state.part == 3
    assert state.steps > 2 * 16 * 10
    untrained = untrained_state(SMALL).network.state_dict()
    assert all(
        not torch.equal(w, untrained[name])
        for name, w in state.network.state_dict().items()
        if name.endswith("weight")
    )
    shipped = torch.load(folder / WEIGHTS, weights_only=True)
    assert all(w.dtype == torch.float16 for w in shipped.values())
    LearnedPolicy.from_file(folder / WEIGHTS)


@pytest.mark.long
@pytest.mark.usefixtures("trained")
def test_training_reports_its_stages_and_their_progress(reports: list[StageReport]) -> None:
    stages = list(dict.fromkeys(stage for stage, _, _ in reports if stage))
    assert stages[:6] == [
        "part 1 of 3", "part 1 of 3: making lessons with 5 checkpoints",
        "part 1 of 3: training on the lessons", "part 1 of 3: evaluating",
        "part 2 of 3", "part 2 of 3: training with MaskablePPO",
    ]  # fmt: skip
    assert stages[-1] == "part 3 of 3: evaluating"
    steps = (SMALL.routes * 20 // 5) * (SMALL.moves * 5 // 20)
    *_, last = (report for report in reports if report[0] == stages[5] and report[1] is not None)
    assert last[1] == 1.0
    assert last[2].startswith(f"{steps} of {steps} steps")


@pytest.mark.long
def test_an_interrupted_and_resumed_training_ends_with_the_same_weights(
    trained: tuple[Path, TrainingState], tmp_path: Path
) -> None:
    def interrupt(line: str) -> None:
        if line.startswith("part 2"):
            raise PowerFailureError

    with pytest.raises(PowerFailureError):
        train(untrained_state(SMALL), tmp_path, interrupt)
    assert main(["--resume", str(tmp_path)]) == 0
    resumed, uninterrupted = load_checkpoint(tmp_path), load_checkpoint(trained[0])
    assert (resumed.part, resumed.steps) == (uninterrupted.part, uninterrupted.steps)
    for name, w in uninterrupted.network.state_dict().items():
        assert torch.equal(w, resumed.network.state_dict()[name]), name
    assert str(resumed.optimiser) == str(uninterrupted.optimiser)


@pytest.mark.long
def test_the_curve_is_drawn_from_the_logs(
    trained: tuple[Path, TrainingState], tmp_path: Path
) -> None:
    picture = tmp_path / "curve.png"
    assert curve.main([str(trained[0]), str(picture)]) == 0
    assert picture.stat().st_size > 10_000
    logs = curve.read_points_by_tag(trained[0])
    assert len(logs["validation/random-20"]) == 3
    assert "rollout/ep_rew_mean" in logs


@pytest.mark.long
def test_errors_are_reported(
    trained: tuple[Path, TrainingState], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(trained[0])
    for arguments, message in [
        (["--resume", str(tmp_path)], "no training to resume"),
        (["--resume", folder, "--seed", "1"], "the settings that the training began with"),
        (["--out", folder], "already has a training"),
    ]:
        assert main(arguments) == 2
        assert message in capsys.readouterr().err
    assert curve.main([str(tmp_path), str(tmp_path / "curve.png")]) == 2
    assert "no logs" in capsys.readouterr().err
    (tmp_path / CHECKPOINT).write_text("nothing")
    assert main(["--resume", str(tmp_path)]) == 2
    assert "is damaged" in capsys.readouterr().err
    with pytest.raises(ArgoError, match="no weights at"):
        LearnedPolicy.from_file(tmp_path / "none.pt")
    (tmp_path / "text.pt").write_text("nothing")
    with pytest.raises(ArgoError, match="has no weights of this policy"):
        LearnedPolicy.from_file(tmp_path / "text.pt")
    with pytest.raises(ArgoError, match="has no weights of this policy"):
        LearnedPolicy.from_file(trained[0] / CHECKPOINT)


def test_the_batch_reports_the_returns_of_its_routes() -> None:
    source = RandomRoutes(6)
    env = RouteVecEnv(8, source, seed=5)
    env.reset()
    rng, routes = np.random.default_rng(0), [[] for _ in range(8)]  # type: ignore[var-annotated]
    numbers = env.batch.reset(seed=5)[1]["instance"]
    first_route, ended = np.ones(8, bool), 0
    for _ in range(30):
        masks = get_action_masks(env)
        chosen = np.array([rng.choice(np.flatnonzero(mask)) for mask in masks])
        _, rewards, over, infos = env.step(chosen)
        for k in range(8):
            if not first_route[k]:
                continue
            routes[k].append(int(chosen[k]))
            if chosen[k] == 0:
                assert over[k]
                score = score_route(source.draw(int(numbers[k])), routes[k])
                assert infos[k]["episode"] == {"r": score.prize, "l": len(routes[k])}
                first_route[k], ended = False, ended + 1
            else:
                assert not infos[k]
        assert (rewards[over] == 0).all()
    assert ended == 8


def test_training_does_not_use_the_test_instances() -> None:
    source, other = TrainingRoutes(6, sites=()), TrainingRoutes(6, sites=(), offset=4096)
    first = [source.draw(number) for number in range(30)]
    assert {one.node_count for one in first} == {7}
    assert not np.array_equal(first[0].arrival, other.draw(0).arrival)
    shifted = TrainingRoutes(6, sites=(), plain=1.0, offset=TEST.start)
    test = RandomRoutes(6).draw(TEST[0])
    assert not np.array_equal(shifted.draw(0).arrival, test.arrival)
