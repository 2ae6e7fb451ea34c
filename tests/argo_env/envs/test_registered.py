"""Properties that all registered environments have."""

import gc
import json
import pickle
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import argo_env  # noqa: F401
from argo_compiler.base.errors import ArgoError
from argo_env.envs import ENVIRONMENTS
from tests.argo_env.envs import rollouts
from tests.processes import run_python

IDS = sorted(ENVIRONMENTS)
SEED, STEPS = 11, 6
FEWER = 4  # steps, where the site is UMAD
RESETS = {"argo/Route-v0": 1000}  # for the others: 30
PAGE = 4096  # bytes


@pytest.fixture(scope="module")
def digests_of_another_process():
    """Return the digests of rollouts in another process, by id."""
    run = run_python("-m", "tests.argo_env.envs.rollouts", SEED, FEWER, *IDS)
    return json.loads(run.stdout)


def test_everything_registered_is_listed():
    assert {id for id in gym.registry if id.startswith("argo/")} == set(IDS)


def test_registration_loads_no_environment():
    code = (
        "import sys, argo_env; "
        "print([m for m in ('pybullet', 'scipy', 'PIL', 'matplotlib', 'argo_env.envs.route') "
        "if m in sys.modules])"
    )
    assert run_python("-c", code).stdout.strip() == "[]"


def test_gymnasium_reports_no_error(make, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")  # windows are drawn in memory
    check_env(make(render_mode="rgb_array"))


@pytest.mark.learned
def test_stable_baselines_reports_no_error(make):
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(make())


def test_docstrings_have_all_sections(make):
    parts = (
        "Description", "Observation Space", "Action Space", "Rewards", "Starting State",
        "Episode End", "Randomisation", "Arguments", "Version History",
    )  # fmt: skip
    described = type(make()).__doc__
    places = [described.index(f"## {part}") for part in parts]
    assert places == sorted(places)


@pytest.mark.long
def test_rollouts_are_equal_here_and_in_another_process(id, make, digests_of_another_process):
    first, second = (rollouts.digests([id], SEED, FEWER) for _ in range(2))
    assert first[id] == second[id] == digests_of_another_process[id]
    # Another seed gives another rollout.
    one, other = (rollouts.digest(rollouts.rollout(make(), SEED + k, STEPS)) for k in range(2))
    assert one != other


def test_a_reset_with_the_same_seed_repeats_the_episode(make):
    env = make()
    first = rollouts.digest(rollouts.rollout(env, SEED, STEPS))
    rollouts.rollout(env, SEED + 5, 5)
    assert rollouts.digest(rollouts.rollout(env, SEED, STEPS)) == first


def test_a_restored_state_continues_equally(make):
    env = make()
    before = rollouts.rollout(env, SEED, 4)[-1][0]
    state = pickle.loads(pickle.dumps(env.get_state()))
    first = rollouts.rollout(env, 3, STEPS, before)
    rollouts.rollout(env, SEED + 5, 2)
    again = env.set_state(state)
    assert rollouts.digest(again) == rollouts.digest(before)
    assert rollouts.digest(rollouts.rollout(env, 3, STEPS, again)) == rollouts.digest(first)


def test_rewards_are_the_sum_of_their_terms(make):
    for outcome in rollouts.rollout(make(), SEED, STEPS):
        if len(outcome) == 5:
            _, reward, terminated, truncated, info = outcome
            assert reward == pytest.approx(sum(info["terms"].values()), abs=1e-12)
            assert not (terminated and truncated)


class OnlyOneTerm(gym.Wrapper):
    """Wrapper with another reward: one term, and a penalty for time."""

    def step(self, action):
        observation, _, terminated, truncated, info = self.env.step(action)
        reward = next(iter(info["terms"].values())) - 0.5
        return observation, reward, terminated, truncated, info


def test_a_wrapper_computes_a_reward_from_the_terms(make):
    env = OnlyOneTerm(make())
    observation, _ = env.reset(seed=SEED)
    rng = np.random.default_rng(0)
    _, reward, _, _, info = env.step(rollouts.choose(env, observation, rng))
    assert reward == next(iter(info["terms"].values())) - 0.5


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"colour": 3}, ("colour", "scenario", "floor", "faults")),
        ({"scenario": "nowhere"}, ("nowhere", "umad")),
        ({"floor": 99}, ("floor", "99")),
        ({"floor": "first"}, ("floor",)),
        ({"faults": "many"}, ("faults",)),
    ],
)
def test_bad_options_are_refused_and_change_nothing(make, options, words):
    env = make()
    first = rollouts.digest(rollouts.rollout(env, SEED, 3))
    with pytest.raises(ArgoError) as error:
        env.reset(options=options)
    for word in words:
        assert word in str(error.value)
    assert rollouts.digest(rollouts.rollout(env, SEED, 3)) == first


def test_a_window_needs_a_display(make, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "MPLBACKEND"):
        monkeypatch.delenv(name, raising=False)
    env = make(render_mode="human")
    with pytest.raises(ArgoError, match="DISPLAY"):
        env.reset(seed=1)


def test_unknown_render_mode_is_refused(make):
    kind = type(make())
    with pytest.raises(ArgoError, match="hologram"):
        kind(render_mode="hologram")


@pytest.mark.long
def test_resets_leak_no_memory(id, make):
    env = make()
    count = RESETS.get(id, 30)

    def resident():
        gc.collect()
        return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE

    env.reset(seed=SEED)
    for _ in range(count):
        env.reset()
    before = resident()
    for _ in range(count):
        env.reset()
    assert resident() - before < 8e6
