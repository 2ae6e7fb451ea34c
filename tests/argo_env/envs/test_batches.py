"""Batches that are distributed over processes equal single environments, and end when closed."""

import copy
import gc
import multiprocessing
import os
import pickle
import signal
import traceback

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode

import argo_env  # noqa: F401
from argo_compiler.base.errors import ArgoError, Invalid, NotFound, Unavailable
from tests.argo_env.envs import rollouts

DRIVE, INSPECT = "argo/Drive-v0", "argo/Inspect-v0"
SHORT = {DRIVE: {"time_limit": 0.7}, INSPECT: {"time_limit": 200.0, "faults": 2}}
"""arguments with which episodes end within a few steps"""
SEED = 31


@pytest.fixture
def make(yard_file, closing):
    """Return a function that makes batches on a small site; they are closed after the test."""

    def one(id, count=3, mode="vector_entry_point", **arguments):
        return closing(
            gym.make_vec(id, count, mode, scenario=yard_file, **SHORT[id], **arguments)
        ).unwrapped

    return one


@pytest.fixture
def workers():
    """Return a function that returns the processes started since the beginning of the test."""
    before = set(multiprocessing.active_children())
    return lambda: set(multiprocessing.active_children()) - before


def random_actions(batch, observation, rng):
    """Return random actions, legal ones if the observation has a mask."""
    if "mask" in observation:
        return (rng.random(observation["mask"].shape) * observation["mask"]).argmax(axis=1)
    return rng.uniform(-1.0, 1.0, batch.action_space.shape).astype(np.float32)


def plain(value):
    """Return the value with lists in place of arrays of objects, whose bytes are addresses."""
    if isinstance(value, dict):
        return {key: plain(part) for key, part in value.items()}
    if isinstance(value, np.ndarray) and value.dtype == object:
        return value.tolist()
    return [plain(part) for part in value] if isinstance(value, tuple | list) else value


def trajectory(batch, steps, seed=SEED, options=None):
    """Return the digests of a reset and of random steps, and the number of ended episodes."""
    rng = np.random.default_rng(SEED)
    observation, info = batch.reset(seed=seed, options=options)
    digests, ended = [rollouts.digest(plain((observation, info)))], 0
    for _ in range(steps):
        observation, *rest = batch.step(random_actions(batch, observation, rng))
        ended += int(rest[1].sum() + rest[2].sum())
        digests.append(rollouts.digest(plain((observation, *rest))))
    return digests, ended


@pytest.mark.long
@pytest.mark.parametrize("id", [DRIVE, INSPECT])
@pytest.mark.parametrize("processes", [1, 2, 3])
def test_batch_equals_single_environments(make, id, processes):
    """This includes episodes that have ended and restarted."""
    batch, singles = make(id, processes=processes), make(id, mode="sync")
    assert batch.metadata["autoreset_mode"] == AutoresetMode.NEXT_STEP
    assert batch.observation_space == singles.observation_space
    assert batch.action_space == singles.action_space
    own = {"floor": 1}
    for seed, options in ((SEED, None), (None, None), ([9, None, 2], own), (5, {})):
        results = [trajectory(one, 17, seed, options) for one in (batch, singles)]
        assert results[0] == results[1]
        assert results[0][1] > 2


def test_masks_are_those_of_the_observation(make):
    batch = make(INSPECT)
    observation, _ = batch.reset(seed=SEED)
    masks = batch.action_masks()
    assert masks.dtype == np.bool_
    assert np.array_equal(masks, observation["mask"])


@pytest.mark.physics
def test_methods_and_attributes_of_each(make):
    batch = make(DRIVE, processes=2)
    batch.reset(seed=SEED)
    goals, states = batch.get_attr("goal"), batch.call("get_state")
    assert [state["goal"] for state in states] == list(goals)
    assert batch.get_attr("np_random_seed") == (SEED, SEED + 1, SEED + 2)
    batch.set_attr("nickname", ["a", "b", "c"])
    assert batch.get_attr("nickname") == ("a", "b", "c")
    batch.set_attr("nickname", "d")
    assert batch.get_attr("nickname") == ("d", "d", "d")
    with pytest.raises(ValueError, match="3 environments"):
        batch.set_attr("nickname", ["a"])


def test_pictures_of_each(make):
    batch = make(INSPECT, count=2, render_mode="rgb_array")
    batch.reset(seed=SEED)
    pictures = batch.render()
    assert len(pictures) == 2
    assert pictures[0].dtype == np.uint8
    assert make(INSPECT).render() is None


@pytest.mark.parametrize("id", [DRIVE, INSPECT])
@pytest.mark.parametrize(
    "duplicate", [copy.deepcopy, lambda batch: pickle.loads(pickle.dumps(batch))]
)
@pytest.mark.parametrize("steps", [7, *(pytest.param(n, marks=pytest.mark.long) for n in (0, 3))])
def test_continues_equally_from_a_state_and_in_a_copy(make, closing, id, duplicate, steps):
    batch = make(id, processes=2)
    rng = np.random.default_rng(SEED)
    observation, _ = batch.reset(seed=SEED)
    for _ in range(steps):
        observation, *_ = batch.step(random_actions(batch, observation, rng))
    other, state = closing(duplicate(batch)), pickle.loads(pickle.dumps(batch.get_state()))
    plan = [random_actions(batch, observation, rng) * 0 for _ in range(9)]
    there = [rollouts.digest(plain(other.step(actions))) for actions in plan]
    assert [rollouts.digest(plain(batch.step(actions))) for actions in plan] == there
    assert rollouts.digest(batch.set_state(state)) == rollouts.digest(observation)
    assert [rollouts.digest(plain(batch.step(actions))) for actions in plan] == there


@pytest.mark.physics
def test_a_copy_of_a_closed_one_is_closed(make):
    batch = make(DRIVE)
    batch.close()
    assert copy.deepcopy(batch).closed


@pytest.mark.physics
def test_invalid_states_are_refused(make):
    batch = make(DRIVE)
    batch.reset(seed=SEED)
    for state in (None, {}, {"states": (), "ended": ()}, {"states": 3, "ended": 3}):
        with pytest.raises(ArgoError, match="not a state of a batch of 3"):
            batch.set_state(state)


@pytest.mark.physics
def test_closing_leaves_no_process(make, workers):
    batch = make(DRIVE, processes=2)
    batch.reset(seed=SEED)
    assert len(workers()) == 2
    batch.close()
    batch.close()
    assert not workers()
    with pytest.raises(gym.error.ClosedEnvironmentError):
        batch.reset()


@pytest.mark.physics
def test_a_garbage_collected_batch_leaves_no_process(yard_file, workers):
    batch = gym.make_vec(DRIVE, 2, scenario=yard_file)
    batch.reset(seed=SEED)
    del batch
    gc.collect()
    assert not workers()


def test_errors_are_those_of_a_single_environment_with_the_place_in_the_worker(make):
    batch = make(INSPECT, processes=2)
    before = trajectory(batch, 3)
    with pytest.raises(Invalid, match="colour") as caught:
        batch.reset(options={"colour": 3})
    results = "".join(traceback.format_exception(caught.value))
    assert "options_from_dict" in results
    assert "worker process" in results
    # Until all are reset, it is unknown which of them have made the step.
    with pytest.raises(gym.error.ResetNeeded):
        batch.step(np.zeros(3, np.int64))
    assert trajectory(batch, 3) == before
    with pytest.raises(Invalid, match=r"the action is np.int64\(10000\)"):
        batch.step(np.array([0, 10_000, 10_000]))
    assert trajectory(batch, 3) == before


@pytest.mark.physics
@pytest.mark.parametrize("actions", [None, np.zeros(2), np.zeros((2, 3)), "abc"])
def test_invalid_actions_change_nothing(make, actions):
    batch = make(DRIVE)
    batch.reset(seed=SEED)
    with pytest.raises(Invalid, match=r"shape \(3, 3\)"):
        batch.step(actions)
    batch.step(np.zeros((3, 3), np.float32))


@pytest.mark.physics
def test_a_step_before_a_reset_is_refused(make):
    with pytest.raises(gym.error.ResetNeeded):
        make(DRIVE).step(np.zeros((3, 3), np.float32))


@pytest.mark.physics
def test_a_wrong_number_of_seeds_is_refused(make):
    with pytest.raises(ValueError, match="3 environments"):
        make(DRIVE).reset(seed=[1, 2])


@pytest.mark.parametrize(
    ("arguments", "kind", "words"),
    [
        ({"render_mode": "human"}, NotFound, "human"),
        ({"processes": 0}, Invalid, "processes"),
        ({"max_way": -1.0}, Invalid, "max_way"),
    ],
)
def test_arguments_are_refused_before_any_process_starts(make, arguments, kind, words, workers):
    with pytest.raises(kind, match=words):
        make(DRIVE, **arguments)
    assert not workers()


@pytest.mark.physics
def test_a_dead_process_is_reported_once_and_ends_the_batch(make, workers):
    batch = make(DRIVE, processes=2)
    batch.reset(seed=SEED)
    [os.kill(p.pid, signal.SIGKILL) for p in workers()][:1]
    with pytest.raises(Unavailable, match="environments 0 to 1 has died with exit code -9"):
        batch.step(np.zeros((3, 3), np.float32))
    assert not workers()
    with pytest.raises(gym.error.ClosedEnvironmentError):
        batch.reset()
