"""Errors of environments, which can be used afterwards."""

import gc
import math
import weakref

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

from argo_compiler.base.errors import ArgoError
from argo_env.envs.drive import DriveEnv
from argo_env.envs.inspection import InspectEnv, draw_faults
from argo_env.envs.route import RouteEnv
from argo_env.envs.route_batch import RouteVectorEnv
from argo_env.faults.kinds import resolve_faults
from argo_env.planning.opening import forget_sites, open_site
from tests.argo_env.envs import rollouts

ONE_FLOOR = "generated:floors=1,seed=3"
CHOICES = (-1, 999, None, "dock", np.array([0, 1]), 1.5, np.float64(1.0))
COMMANDS = (np.zeros(2), np.full(3, math.nan), None, "ahead", 1.0, np.full(3, math.inf))


@pytest.fixture
def env(make):
    return make()


def an_action(env, observation):
    return rollouts.choose(env, observation, np.random.default_rng(0))


def test_faults_that_are_drawn_fit_the_site():
    site = open_site(ONE_FLOOR).site
    for seed in range(30):
        faults = draw_faults(8, "kinematic", site, np.random.default_rng(seed))
        assert len({fault.kind for fault in faults}) == 8
        resolve_faults(faults, site, seed)


def test_observations_do_not_depend_on_cached_sites(yard_file):
    digests = []
    for forget in (False, True):
        env = InspectEnv(yard_file, faults=0, render_mode="rgb_array")
        observation, _ = env.reset(seed=1)
        env.render()
        kept = weakref.ref(open_site(yard_file).navigator)
        if forget:  # as when other environments have been on many other sites
            forget_sites()
        digests.append(rollouts.digest(rollouts.rollout(env, 1, 3, observation)))
        env.close()
    assert digests[0] == digests[1]
    # Neither pictures nor travel times keep the site's large navigator alive.
    del env
    gc.collect()
    assert kept() is None


def test_a_refused_number_of_seeds_leaves_the_options():
    batch = RouteVectorEnv(2, checkpoints=4)
    _, before = batch.reset(seed=1)
    with pytest.raises(ValueError, match="2 environments"):
        batch.reset(seed=[1, 2, 3], options={"instance": 7})
    _, info = batch.reset(seed=1)
    assert info["instance"].tolist() == before["instance"].tolist() != [7, 7]


@pytest.mark.physics
def test_drive_continues_after_refused_options(yard_file):
    env = DriveEnv(yard_file)
    env.reset(seed=1)
    for options in (
        {"faults": [{"kind": "brick", "floor": 9}]},
        {"scenario": [yard_file, "nowhere"]},
        {"faults": [{"kind": "gas_leak"}]},
        {"faults": [{"kind": "drive_dysfunction"}], "floor": 7},
        {"scenario": []},
        {"scenario": 3},
    ):
        with pytest.raises(ArgoError):
            env.reset(options=options)
        env.step(np.zeros(3))
        env.get_state()
    assert env.reset()[1]["scenario"]
    env.close()


@pytest.mark.parametrize(
    ("kind", "arguments", "words"),
    [
        (DriveEnv, {"scenario": ()}, "scenario"),
        (DriveEnv, {"time_limit": math.nan}, "time_limit"),
        (DriveEnv, {"max_way": 0.0}, "max_way"),
        (InspectEnv, {"time_limit": math.nan}, "time_limit"),
        (InspectEnv, {"time_limit": math.inf}, "time_limit"),
        (DriveEnv, {"max_way": 4.9}, "`max_way` is 4.9, .* at least 5"),
        (DriveEnv, {"max_way": True}, "`max_way` is True, .* a number"),
        (DriveEnv, {"scenario": 3}, "`scenario` is 3, .* name"),
        (DriveEnv, {"scenario": ["umad", None]}, "`scenario` is None, .* name"),
        (InspectEnv, {"scenario": None}, "`scenario` is None, .* name"),
        (InspectEnv, {"time_limit": "long"}, "`time_limit` is 'long', .* a number"),
        (InspectEnv, {"time_limit": True}, "`time_limit` is True, .* a number"),
        (InspectEnv, {"time_limit": 1e9}, "at most 100000"),
        (InspectEnv, {"faults": -1}, "whole number of at least 0"),
        (InspectEnv, {"faults": 9}, "at most 8"),
        (InspectEnv, {"faults": True}, "whole number"),
        (InspectEnv, {"checkpoints": 10**6}, "`checkpoints` is 1000000, .* at most 1000"),
        (InspectEnv, {"docks": 10**5}, "`docks` is 100000, .* at most 1000"),
        (
            InspectEnv,
            {"checkpoints": -1},
            "`checkpoints` is -1, .* at least 20, as site umad has 20",
        ),
        (InspectEnv, {"checkpoints": 19}, "`checkpoints` is 19, .* at least 20"),
        (InspectEnv, {"checkpoints": 20.5}, "`checkpoints` is 20.5, .* whole number"),
        (InspectEnv, {"docks": 1}, "`docks` is 1, .* at least 2"),
        (RouteEnv, {"budget": math.nan}, "budget"),
        (RouteEnv, {"budget": "x"}, "`budget` is 'x', .* a number"),
        (RouteEnv, {"budget": None}, "`budget` is None, .* a number"),
        (RouteEnv, {"budget": 1e6}, "`budget` is 1000000.0, .* at most 100000"),
        (RouteEnv, {"scenario": 3}, "`scenario` is 3, .* name"),
        (RouteEnv, {"checkpoints": 0}, "`checkpoints` is 0, .* at least 1"),
        (RouteEnv, {"checkpoints": 10**6}, "`checkpoints` is 1000000, .* at most 500"),
        (RouteVectorEnv, {"num_envs": 10**9}, "`num_envs` is 1000000000, .* at most"),
    ],
)
def test_bad_arguments_are_refused(kind, arguments, words):
    with pytest.raises(ArgoError, match=words):
        kind(**arguments)


def test_methods_that_need_an_episode_are_refused_without_one(env, id):
    calls = [lambda: env.step(env.action_space.sample()), env.get_state]
    if id != "argo/Drive-v0":
        calls.append(env.action_masks)
    for call in calls:
        with pytest.raises(ResetNeeded, match=f"{id}: .* call reset"):
            call()


def test_wrong_actions_are_refused_and_change_nothing(env, id):
    observation, _ = env.reset(seed=1)
    state = rollouts.digest(env.get_state())
    for action in COMMANDS if id == "argo/Drive-v0" else CHOICES:
        with pytest.raises(ArgoError, match=rf"{id}: the action is .*(whole|three) number"):
            env.step(action)
    assert rollouts.digest(env.get_state()) == state
    env.step(np.asarray(an_action(env, observation)))


def test_wrong_actions_of_a_batch_are_refused():
    batch = RouteVectorEnv(3, checkpoints=4)
    with pytest.raises(ResetNeeded):
        batch.step(np.zeros(3, np.int64))
    batch.reset(seed=1)
    before = rollouts.digest(batch.get_state()["arrays"])
    for actions in ([0, 0], [0, 0, 5], [0, -1, 0], [0.0, 1.0, 2.0], None, "dock", 0, [[0, 0, 0]]):
        with pytest.raises(ArgoError, match="3 whole numbers from 0 to 4"):
            batch.step(actions)
    assert rollouts.digest(batch.get_state()["arrays"]) == before
    for state in ({"x": 1}, None, RouteVectorEnv(2, checkpoints=4).get_state()):
        with pytest.raises(ArgoError, match="not a state of a batch of 3"):
            batch.set_state(state)
    batch.step([0, 1, 2])


def test_steps_after_the_end_of_an_episode_are_refused(env, id):
    if id == "argo/Drive-v0":
        env.reset(seed=1)
        state = env.get_state()
        env.set_state(state | {"goal": state["start"][:3]})  # there already
        action = np.zeros(3)
    else:
        observation, _ = env.reset(seed=1)
        action = 0
        if id == "argo/Inspect-v0":
            action = int(np.argmax(observation["points"]))  # the end dock
        assert env.step(action)[2]
        env.set_state(env.get_state())
    with pytest.raises(ResetNeeded, match="the episode is over: call reset"):
        env.step(action)
    observation, _ = env.reset()
    env.step(an_action(env, observation))


def test_invalid_states_are_refused(env, id):
    env.render_mode = "rgb_array"
    observation, _ = env.reset(seed=1)
    env.step(an_action(env, observation))
    state = env.get_state()
    other = RouteEnv() if id != "argo/Route-v0" else RouteVectorEnv(2)
    other.reset(seed=1)
    for wrong in ({"x": 1}, None, other.get_state(), state | {"generator": {"state": 1}}):
        with pytest.raises(ArgoError, match=f"not a state of {id}"):
            env.set_state(wrong)
    assert rollouts.digest(env.get_state()) == rollouts.digest(state)
    with pytest.raises(ArgoError, match="nowhere"):
        env.set_state(state | {"options": {"scenario": "nowhere"}})
    assert env.render_mode == "rgb_array"
    env.set_state(state)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ([1], "are a dictionary"),
        ({"faults": "many"}, "faults"),
        ({"faults": [{"kind": "gas"}]}, "faults"),
        ({"faults": [{"kind": "low_battery", "charg": 1}]}, "faults"),
        ({"faults": [{}, 3]}, "faults"),
        ({"floor": "first"}, "`floor` has to be a whole number, or a list"),
        ({"floor": [1, "a"]}, r"`floor\[1\]`: .* a whole number;"),
        ({"floor": "1"}, "`floor` has to be a whole number, or a list"),
        ({"floor": True}, "`floor` has to be a whole number, or a list"),
        ({"floor": [True]}, r"`floor\[0\]`: .* a whole number;"),
        ({"floor": 1.0}, "`floor` has to be a whole number, or a list"),
    ],
)
def test_errors_of_options_are_in_plain_words(env, options, words):
    with pytest.raises(ArgoError, match=words) as error:
        env.reset(options=options)
    for internal in ("constrained", "tagged", "union", "tuple", "valid"):
        assert internal not in str(error.value)


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (9, "`faults`: `faults` has to be at most 8;"),
        ("many", "`faults`: `faults` has to be a whole number, or a list;"),
        ([{"kind": "low_battery", "charg": 1}], r"`faults\[0\].charg`: .* `charge` meant"),
        ([{"kind": "low_battery", "charge": 3}], r"`faults\[0\].charge`: .* at most 1;"),
        ([{"kind": "gas"}], r"`faults\[0\]`: no kind `gas`"),
    ],
)
def test_errors_of_faults_name_only_the_mistake(yard_file, faults, words):
    env = InspectEnv(yard_file)
    with pytest.raises(ArgoError, match=words):
        env.reset(options={"faults": faults})


@pytest.mark.physics
@pytest.mark.parametrize(
    ("kind", "options", "words"),
    [
        (RouteEnv, {"instance": True}, "`instance` has to be a whole number"),
        (RouteEnv, {"test": "yes"}, "`test` has to be true or false"),
        (RouteEnv, {"faults": {"closed": "2"}}, "`closed` has to be a whole number"),
        (RouteEnv, {"faults": {"battery": "0.5"}}, "`battery` has to be a number"),
        (InspectEnv, {"seed": "3"}, "`seed` has to be a whole number"),
        (InspectEnv, {"faults": True}, "`faults` has to be a whole number, or a list"),
        (DriveEnv, {"max_way": "60"}, "`max_way` has to be a number"),
        (DriveEnv, {"max_way": 3.0}, "`max_way` has to be at least 5"),
    ],
)
def test_options_of_wrong_types_are_refused(kind, options, words, yard_file):
    env = kind() if kind is RouteEnv else kind(yard_file)
    with pytest.raises(ArgoError, match=words):
        env.reset(options=options)
    env.close()


def test_numbers_of_numpy_are_accepted(env):
    plain = env.reset(seed=1, options={"floor": [1]})[0]
    for floor in (np.int64(1), np.array([1]), [np.int32(1)], (1,)):
        again = env.reset(seed=1, options={"floor": floor})[0]
        assert rollouts.digest(again) == rollouts.digest(plain)
    ones = (
        RouteEnv(budget=budget, checkpoints=count)
        for budget, count in ((900.0, 5), (np.float32(900), np.int64(5)), (900, np.uint8(5)))
    )
    assert len({rollouts.digest(one.reset(seed=1)) for one in ones}) == 1
    RouteVectorEnv(np.int64(2), np.int32(5)).reset(seed=1)


def test_missing_floors_have_one_message(env, id, yard_file):
    name, floors = ("random", "the floors 1 to 6") if "Route" in id else (yard_file, "floor 1 only")
    with pytest.raises(ArgoError) as error:
        env.reset(options={"floor": 9})
    assert str(error.value) == f"scenario {name} has {floors}, not 9"
