"""The training: repeatable, cut off and gone on with, and what it hands to MaskablePPO."""

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
    State,
    begin,
    load,
    train,
)
from baselines.learned.vec_env import RouteVecEnv  # noqa: E402

SMALL = Settings(
    lesson_parts=1, parts=2, lesson_sizes=(5,), lessons=60, iterations=1, routes=16, moves=10,
    batch=64, checkpoints=(5,), sites=(), validation=2,
)  # fmt: skip


@pytest.fixture(scope="module", autouse=True)
def few_instances() -> Iterator[None]:
    """Batches draw from 64 instances: to make 4,096 takes seconds each time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(route_episodes, "TRAINING", range(64))
        yield


Told = tuple[str | None, float | None, str]


class CutOffError(Exception):
    """The power went."""


@pytest.fixture(scope="module")
def heard() -> list[Told]:
    """What the training has told."""
    return []


@pytest.fixture(scope="module")
def trained(tmp_path_factory: pytest.TempPathFactory, heard: list[Told]) -> tuple[Path, State]:
    folder = tmp_path_factory.mktemp("trained")
    state = begin(SMALL)
    with listen_to_stages(lambda *told: heard.append(told)):
        train(state, folder, [].append)
    return folder, state


@pytest.mark.long
def test_training_changes_weights_and_saves_them(trained: tuple[Path, State]) -> None:
    folder, state = trained
    assert state.part == 3
    assert state.steps > 2 * 16 * 10
    untrained = begin(SMALL).network.state_dict()
    assert all(
        not torch.equal(w, untrained[name])
        for name, w in state.network.state_dict().items()
        if name.endswith("weight")
    )
    shipped = torch.load(folder / WEIGHTS, weights_only=True)
    assert all(w.dtype == torch.float16 for w in shipped.values())
    LearnedPolicy.load(folder / WEIGHTS)


@pytest.mark.long
@pytest.mark.usefixtures("trained")
def test_training_says_what_it_does_and_how_far_it_is(heard: list[Told]) -> None:
    stages = list(dict.fromkeys(stage for stage, _, _ in heard if stage))
    assert stages[:6] == [
        "part 1 of 3", "part 1 of 3: lessons with 5 checkpoints",
        "part 1 of 3: learning from them", "part 1 of 3: evaluating",
        "part 2 of 3", "part 2 of 3: practising",
    ]  # fmt: skip
    assert stages[-1] == "part 3 of 3: evaluating"
    steps = (SMALL.routes * 20 // 5) * (SMALL.moves * 5 // 20)
    *_, last = (told for told in heard if told[0] == stages[5] and told[1] is not None)
    assert last[1] == 1.0
    assert last[2].startswith(f"{steps} of {steps} steps")


@pytest.mark.long
def test_a_training_that_was_cut_off_ends_with_the_same_weights(
    trained: tuple[Path, State], tmp_path: Path
) -> None:
    def cut(line: str) -> None:
        if line.startswith("part 2"):
            raise CutOffError

    with pytest.raises(CutOffError):
        train(begin(SMALL), tmp_path, cut)
    assert main(["--resume", str(tmp_path)]) == 0
    resumed, whole = load(tmp_path), load(trained[0])
    assert (resumed.part, resumed.steps) == (whole.part, whole.steps)
    for name, w in whole.network.state_dict().items():
        assert torch.equal(w, resumed.network.state_dict()[name]), name
    assert str(resumed.optimiser) == str(whole.optimiser)


@pytest.mark.long
def test_the_curve_is_drawn_from_the_logs(trained: tuple[Path, State], tmp_path: Path) -> None:
    picture = tmp_path / "curve.png"
    assert curve.main([str(trained[0]), str(picture)]) == 0
    assert picture.stat().st_size > 10_000
    logs = curve.read_logs(trained[0])
    assert len(logs["validation/random-20"]) == 3
    assert "rollout/ep_rew_mean" in logs


@pytest.mark.long
def test_what_can_not_be_done_is_said(
    trained: tuple[Path, State], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = str(trained[0])
    for arguments, what in [
        (["--resume", str(tmp_path)], "no training to go on with"),
        (["--resume", folder, "--seed", "1"], "the settings that the training began with"),
        (["--out", folder], "has a training already"),
    ]:
        assert main(arguments) == 2
        assert what in capsys.readouterr().err
    assert curve.main([str(tmp_path), str(tmp_path / "curve.png")]) == 2
    assert "no logs" in capsys.readouterr().err
    (tmp_path / CHECKPOINT).write_text("nothing")
    assert main(["--resume", str(tmp_path)]) == 2
    assert "is damaged" in capsys.readouterr().err
    with pytest.raises(ArgoError, match="no weights at"):
        LearnedPolicy.load(tmp_path / "none.pt")
    (tmp_path / "text.pt").write_text("nothing")
    with pytest.raises(ArgoError, match="has no weights of this policy"):
        LearnedPolicy.load(tmp_path / "text.pt")
    with pytest.raises(ArgoError, match="has no weights of this policy"):
        LearnedPolicy.load(trained[0] / CHECKPOINT)


def test_returns_of_the_batch_are_those_of_the_routes() -> None:
    source = RandomRoutes(6)
    env = RouteVecEnv(8, source, seed=5)
    env.reset()
    rng, routes = np.random.default_rng(0), [[] for _ in range(8)]  # type: ignore[var-annotated]
    numbers = env.batch.reset(seed=5)[1]["instance"]
    fresh, ended = np.ones(8, bool), 0
    for _ in range(30):
        masks = get_action_masks(env)
        chosen = np.array([rng.choice(np.flatnonzero(mask)) for mask in masks])
        _, rewards, over, infos = env.step(chosen)
        for k in range(8):
            if not fresh[k]:
                continue
            routes[k].append(int(chosen[k]))
            if chosen[k] == 0:
                assert over[k]
                best = score_route(source.draw(int(numbers[k])), routes[k])
                assert infos[k]["episode"] == {"r": best.prize, "l": len(routes[k])}
                fresh[k], ended = False, ended + 1
            else:
                assert not infos[k]
        assert (rewards[over] == 0).all()
    assert ended == 8


def test_training_keeps_away_from_the_test_instances() -> None:
    source, other = TrainingRoutes(6, sites=()), TrainingRoutes(6, sites=(), offset=4096)
    first = [source.draw(number) for number in range(30)]
    assert {one.size for one in first} == {7}
    assert not np.array_equal(first[0].arrival, other.draw(0).arrival)
    far = TrainingRoutes(6, sites=(), plain=1.0, offset=TEST.start)
    test = RandomRoutes(6).draw(TEST[0])
    assert not np.array_equal(far.draw(0).arrival, test.arrival)
