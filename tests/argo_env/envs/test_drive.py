"""Drive-v0: the tracked robot with continuous actions."""

import math

import gymnasium as gym
import numpy as np
import pytest

import argo_env  # noqa: F401
from argo_compiler.base.errors import ArgoError
from argo_env.envs import drive_site, lidar
from argo_env.envs.drive import CONTACT, GOAL, PROGRESS, TIME, TIPPING
from argo_env.envs.drive_site import DriveOptions, DriveSite, DriveSites
from argo_env.envs.expert import Expert
from tests.argo_env.envs.rollouts import digest

pytestmark = pytest.mark.physics


@pytest.fixture(scope="module")
def env():
    """Yield an environment on UMAD; tests set what they need by the options of a reset."""
    env = gym.make("argo/Drive-v0", disable_env_checker=True).unwrapped
    yield env
    env.close()


@pytest.fixture
def make(yard_file, closing):
    """Return a function that makes environments on the yard."""
    return lambda **arguments: closing(
        gym.make("argo/Drive-v0", **{"scenario": yard_file} | arguments, disable_env_checker=True)
    )


def follow(observation):
    """Return the action of a simple controller on the level.

    It turns to the heading of the path, then drives to its next point.
    """
    x, y, _, sine, cosine = observation["way"]
    turn = math.atan2(sine, cosine)
    gear = 1 if x >= 0 else -1
    if abs(turn) > 0.2:
        return np.array([0.0, np.clip(2 * turn, -1, 1), 0.25], np.float32)
    speed = gear * min(0.8, 2 * math.hypot(x, y))
    return np.array([speed, np.clip(1.5 * turn + 2 * gear * y, -1, 1), 0.25], np.float32)


def drive(env, expert, until=lambda: False):
    """Return the outcomes of the expert's steps.

    They go on to the end of the episode, or until a condition is true.
    """
    outcomes = []
    while not (until() or (outcomes and (outcomes[-1][2] or outcomes[-1][3]))):
        outcomes.append(env.step(expert.act()))
    return outcomes


def repeat(env, action, steps):
    """Return the outcomes of one action, repeated until the episode ends."""
    outcomes = []
    for _ in range(steps):
        outcomes.append(env.step(np.array(action, np.float32)))
        if outcomes[-1][2]:
            break
    return outcomes


@pytest.fixture(scope="module")
def descent(env):
    """Return a state in mid-flight of a drive to a goal one floor down, and all outcomes."""
    env.reset(seed=21, options={"floor": [5, 6], "max_way": 60.0})
    expert, top = Expert(env), env.pose.z
    first = drive(env, expert, lambda: env.pose.z < top - 1.3)
    middle = env.get_state()
    return middle, first + drive(env, expert)


def test_the_expert_gets_a_floor_down(descent, navigator):
    middle, outcomes = descent
    *_, terminated, truncated, info = outcomes[-1]
    assert (terminated, truncated, info["success"]) == (True, False, True)
    floors = [navigator.site.floor_at(middle[place][2]) for place in ("start", "goal")]
    assert floors == [6, 5]
    # Forwards on the flight.
    pitches = [observation["body"][0] * 90 for observation, *_ in outcomes]
    assert max(pitches) == pytest.approx(32.5, abs=5.0)


@pytest.mark.long
def test_the_expert_gets_a_floor_up(env, navigator):
    _, info = env.reset(seed=25, options={"floor": [4, 5], "max_way": 60.0})
    assert [navigator.site.floor_at(z) for z in (env.pose.z, info["goal"][2])] == [4, 5]
    outcomes = drive(env, Expert(env))
    assert outcomes[-1][4]["success"]
    # Backwards on the flight.
    steep = [o["body"] for o, *_ in outcomes if o["body"][0] * 90 > 25]
    assert len(steep) > 50
    assert np.mean([body[2] for body in steep]) < -0.1


def test_the_expert_takes_over_from_another_driver(make):
    env = make(max_way=30.0)  # in Gymnasium's wrappers
    env.reset(seed=4)
    expert, rng = Expert(env), np.random.default_rng(0)
    for _ in range(30):
        expert.act()
        env.step(np.array([*rng.uniform(0.2, 1, 2), 0.25], np.float32))
    assert drive(env, expert)[-1][4]["success"]


def test_the_expert_sets_off_after_a_turn(env):
    """It does not swing about the heading of the turn's end."""
    env.reset(seed=1_000_002, options={})
    expert, start = Expert(env), env.pose
    drive(env, expert, lambda: math.hypot(env.pose.x - start.x, env.pose.y - start.y) > 0.3)
    assert len(env.get_state()["actions"]) < 60


def test_the_expert_refuses_other_environments():
    with pytest.raises(ArgoError, match="Drive-v0"):
        Expert(gym.make("argo/Route-v0"))


@pytest.mark.long
def test_on_a_flight_a_restored_state_continues_equally(env, descent):
    middle, outcomes = descent
    outcomes_twice = []
    for _ in range(2):
        env.set_state(middle)
        outcomes_twice.append(repeat(env, (-0.3, 0.4, 0.1), 8))
    assert digest(outcomes_twice[0]) == digest(outcomes_twice[1])
    # `get_state` does not change the following steps either.
    actions = middle["actions"]
    env.set_state(middle | {"actions": actions[:-1]})
    env.get_state()
    assert digest(env.step(np.array(actions[-1]))) == digest(outcomes[len(actions) - 1])


def test_on_a_flight_a_restored_snapshot_of_the_body_continues_equally(env, descent):
    env.set_state(descent[0])
    body = env.site.body
    moment = body.snapshot()
    first = [o for o, *_ in repeat(env, (-0.3, 0.4, 0.1), 8)]
    repeat(env, (0.5, 0.0, 1.0), 5)
    body.restore(moment)
    assert digest([o for o, *_ in repeat(env, (-0.3, 0.4, 0.1), 8)]) == digest(first)
    body.release(moment)


def test_turning_across_a_flight_tips_the_robot_over(env, descent):
    env.set_state(descent[0])
    outcomes = repeat(env, (1.0, 1.0, -1.0), 30)
    *_, last = outcomes
    observation, reward, terminated, truncated, info = last
    assert (terminated, truncated, info["success"]) == (True, False, False)
    assert info["terms"]["tipped"] == TIPPING
    assert reward == pytest.approx(sum(info["terms"].values()))
    pitch, roll = observation["body"][:2] * math.pi / 2
    assert math.cos(pitch) * math.cos(roll) < math.cos(math.radians(60))
    assert abs(roll) > math.radians(30)
    assert all(info["terms"]["tipped"] == 0.0 for *_, info in outcomes[:-1])


def test_following_the_waypoints_reaches_the_goal(env):
    observation, _ = env.reset(seed=5, options={"floor": 1, "max_way": 12.0})
    before, total, steps = env.get_state(), 0.0, 0
    togo = observation["goal"][3] * 300
    over = False
    while not over:
        observation, _, over, truncated, info = env.step(follow(observation))
        total += info["terms"]["progress"]
        steps += 1
        assert not truncated
    assert info["success"]
    assert info["terms"]["goal"] == GOAL
    assert info["terms"]["time"] == TIME
    # The progress adds up to the decrease of the travel time.
    assert total == pytest.approx(PROGRESS * (togo - observation["goal"][3] * 300), abs=1e-3)
    assert len(env.get_state()["actions"]) == steps
    assert not before["actions"]


def test_actions_have_the_documented_effects(env):
    env.reset(seed=3, options={"floor": 1})
    start = env.get_state()
    observations = {}
    for name, action in {"stay": (0, 0, 0), "turn": (0, 1, 0), "flippers": (0, 0, 1)}.items():
        first = env.set_state(start)
        observations[name] = first, repeat(env, action, 12)[-1][0]
    first, last = observations["stay"]
    assert np.abs(last["body"][2:4]).max() < 0.02
    assert observations["turn"][1]["body"][3] > 0.2
    assert observations["flippers"][1]["body"][4] > 0.9
    # After a turn to the left, the goal is farther to the right.
    before = math.atan2(first["goal"][1], first["goal"][0])
    after = math.atan2(observations["turn"][1]["goal"][1], observations["turn"][1]["goal"][0])
    assert math.sin(after - before) < 0


def test_the_time_limit_truncates(make):
    env = make(time_limit=0.5)
    env.reset(seed=1)
    ends = [outcome[2:4] for outcome in repeat(env, (0, 0, 0), 5)]
    assert ends == [(False, False)] * 4 + [(False, True)]


def test_lidar_detects_railings_and_equipment(env):
    for seed in range(3):
        observation, _ = env.reset(seed=seed, options={"floor": 3})
        # Railings and equipment are near everywhere on a floor.
        assert 0.02 < observation["lidar"].min() < 0.6
        # The robot stands on the level.
        assert np.abs(observation["ground"][8:14]).max() < 0.02
        assert len(observation["lidar"]) == lidar.RAYS


def test_pressing_against_a_railing_costs(env):
    env.reset(seed=1, options={"floor": 3, "max_way": 60.0})
    infos = [info for *_, info in repeat(env, (1, 0.05, -1), 120)]
    pressed = [info for info in infos if info["touched"]]
    assert pressed
    assert all(info["terms"]["contact"] == CONTACT for info in pressed)


def test_a_dysfunction_slows_the_robot(make):
    env = make()
    faults = [{"kind": "drive_dysfunction", "at": 0.0, "speed": 0.0}]
    env.reset(seed=3, options={"faults": faults})
    observation, *_ = repeat(env, (1, 1, 1), 10)[-1]
    assert np.abs(observation["body"][2:4]).max() < 0.02


def test_start_and_goal_are_on_the_floors_asked_for(env, navigator):
    heights = {f.number: f.z for f in navigator.site.spec.floors}
    for seed in range(4):
        _, info = env.reset(seed=seed, options={"floor": [2, 5]})
        assert min(abs(info["goal"][2] - heights[f]) for f in (2, 5)) < 0.05
        assert min(abs(env.get_state()["start"][2] - heights[f]) for f in (2, 5)) < 0.05


def test_sites_that_were_built_are_closed_after_any_error(monkeypatch):
    """A site can fail to be built for other reasons than wrong options, such as lack of memory."""
    built, closed = [], []

    class BuiltSite(DriveSite):
        def __init__(self, name, faults):
            if built:
                raise MemoryError
            super().__init__(name, faults)
            built.append(self)

        def close(self):
            closed.append(self)
            super().close()

    monkeypatch.setattr(drive_site, "DriveSite", BuiltSite)
    sites = DriveSites(("darmstadt", "umad"))
    with pytest.raises(MemoryError):
        sites.apply_options(DriveOptions())
    assert len(built) == 1
    assert closed == built
    sites.close()


def test_unsupported_faults_are_refused(env):
    with pytest.raises(ArgoError, match="brick"):
        env.reset(options={"faults": [{"kind": "gas_leak"}]})
