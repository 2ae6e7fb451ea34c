"""Inspect-v0: actions are drives and measurements, and faults change their results."""

import gymnasium as gym
import numpy as np
import pytest

import argo_env  # noqa: F401
from argo_compiler.base.errors import ArgoError
from argo_env.drives.drive import Incident, Trouble
from argo_env.drives.timed_drive import RouteDrive
from argo_env.envs.inspection import ABNORMAL, DEAD, DOCKED, FINDING, READING
from argo_env.robot.pose import BodyPose
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec

CHECKPOINTS = 20  # of the site


@pytest.fixture
def make(closing):
    return lambda **arguments: closing(
        gym.make("argo/Inspect-v0", disable_env_checker=True, **arguments).unwrapped
    )


@pytest.fixture
def begin(make):
    """Return a function that makes an environment and resets it with a fault.

    The function returns the environment, the observation and the info.
    """

    def one(fault, drive="route", **options):
        env = make(drive=drive)
        return env, *env.reset(seed=2, options={"faults": [fault]} | options)

    return one


def end_dock(observation):
    """Return the action that ends the episode: the only dock with points."""
    docks = np.flatnonzero(observation["points"][CHECKPOINTS:])
    assert len(docks) == 1
    return CHECKPOINTS + int(docks[0])


def nearest(observation):
    return int(np.argmin(np.where(observation["mask"], observation["travel"], 2)[:CHECKPOINTS]))


def test_a_reading_takes_time_and_is_done_once(make, navigator):
    env = make(faults=0)
    observation, _ = env.reset(seed=2)
    k = nearest(observation)
    expected = observation["travel"][k] * 1800
    after, reward, terminated, truncated, info = env.step(k)
    assert (reward, terminated, truncated) == (READING, False, False)
    nominal = navigator.site.checkpoints[k].nominal
    assert nominal.contains(info["reading"])
    measuring = navigator.robot.sensor.measuring_time
    assert info["time"] == pytest.approx(expected + measuring, rel=0.25)
    assert after["left"][0] == pytest.approx(1 - info["time"] / 1800)
    assert after["mask"][k] == 0
    assert after["battery"][0] < observation["battery"][0]
    _, reward, _, _, info = env.step(k)
    assert (reward, info["illegal"]) == (0.0, True)


def test_docking_ends_the_episode(make):
    env = make(faults=0)
    observation, _ = env.reset(seed=3, options={"floor": 1})
    assert observation["mask"][:CHECKPOINTS].sum() == 4
    _, reward, terminated, truncated, info = env.step(end_dock(observation))
    assert (reward, terminated, truncated) == (DOCKED, True, False)
    assert info["terms"]["docked"] == DOCKED


def test_the_time_limit_truncates(make):
    env = make(faults=0, time_limit=20.0)
    observation, _ = env.reset(seed=2)
    far = int(np.argmax(np.where(observation["mask"], observation["points"], 0)[:CHECKPOINTS]))
    _, reward, terminated, truncated, info = env.step(far)
    assert (terminated, truncated) == (False, True)
    assert (reward, info["time"]) == (0.0, 20.0)


def test_an_empty_battery_terminates(begin):
    env, observation, _ = begin({"kind": "worn_battery", "capacity": 0.01})
    over = False
    while not over:
        observation, _, over, truncated, info = env.step(nearest(observation))
        assert not truncated
    assert info["terms"]["dead"] == DEAD


def test_an_abnormal_value_is_worth_more(begin):
    env, _, _ = begin({"kind": "abnormal_value", "checkpoint": 1, "at": 0.0})
    _, reward, _, _, info = env.step(0)
    assert info["terms"]["abnormal"] == ABNORMAL
    assert reward == READING + ABNORMAL + info["terms"]["finding"]


def test_a_camera_that_fails_is_noticed_and_checkpoints_are_given_up(begin):
    fails = {"kind": "sensor_dysfunction", "effect": "fails", "at": 0.0}
    env, observation, _ = begin(fails, floor=1)
    k = nearest(observation)
    findings = []
    for _ in range(2):
        assert observation["mask"][k] == 1
        observation, _, _, _, info = env.step(k)
        assert info["failure"]
        assert "reading" not in info
        findings.append(info["terms"]["finding"])
    assert observation["mask"][k] == 0
    assert observation["noticed"].sum() >= 1
    assert findings == [FINDING, 0]


def test_an_emergency_stop_that_is_released_is_noticed_once(begin):
    env, observation, _ = begin({"kind": "emergency_stop", "at": 30.0, "until": 40.0})
    farthest = int(np.argmax(np.where(observation["mask"], observation["travel"], 0)[:CHECKPOINTS]))
    _, _, _, _, info = env.step(farthest)
    assert info["time"] > 100
    assert info["found"] == ("emergency_stop",)
    assert info["terms"]["finding"] == FINDING


def test_a_site_with_too_many_checkpoints_is_refused():
    with pytest.raises(ArgoError, match="20 checkpoints"):
        gym.make("argo/Inspect-v0", checkpoints=3, disable_env_checker=True)
    with pytest.raises(ArgoError, match="route, kinematic"):
        gym.make("argo/Inspect-v0", drive="flying", disable_env_checker=True)


@pytest.mark.physics
def test_the_kinematic_drive_finds_what_blocks_the_stairs(begin):
    blocked = {"kind": "blocked_stairs", "tower": "west tower", "floor": 1}
    env, observation, info = begin(blocked, drive="kinematic", floor=2)
    assert info["settings"]["drive"] == "kinematic"
    k = 4  # the checkpoint on floor 2 whose fastest path leads over the western stairs
    expected = observation["travel"][k] * 1800
    observation, _, _, _, info = env.step(k)
    assert info["found"] == ("positive_obstacle",)
    # It arrived nevertheless, over the other stairs.
    assert info["terms"]["reading"] == READING
    assert info["time"] > expected + 30.0
    assert observation["noticed"].sum() == 1


@pytest.mark.physics
def test_after_the_platform_alarm_only_docks_are_legal(begin):
    alarm = {"kind": "platform_alarm", "at": 5.0}
    env, observation, _ = begin(alarm, drive="kinematic", floor=1)
    observation, _, _, _, info = env.step(nearest(observation))
    assert "platform_alarm" in info["found"]
    assert np.flatnonzero(observation["mask"]).tolist() == [20, 21]


class TestEpisodeAsRun:
    """An episode equals a run."""

    @pytest.mark.parametrize(
        ("drive", "actions"),
        [
            ("route", (1, 0, 2, 3)),
            ("kinematic", (1, 0, 2, 3)),
            pytest.param("tracked", (1, 3), marks=pytest.mark.long),
        ],
    )
    def test_its_record_equals_that_of_a_run_of_its_mission(self, make, yard_file, drive, actions):
        env = make(scenario=yard_file, drive=drive)
        faults = [
            {"kind": "abnormal_value", "checkpoint": 2, "at": 4.0},
            {"kind": "drive_dysfunction", "at": 5.0, "until": 20.0, "speed": 0.3},
        ]
        _, info = env.reset(seed=4, options={"faults": faults})
        for action in actions:
            _, _, terminated, _, _ = env.step(action)
        assert terminated
        record = env.record()
        assert record.result.success
        assert [r.checkpoint - 1 for r in record.readings] == list(actions[:-1])
        spec = RunSpec(mission=record.mission, site=yard_file, **info["settings"])
        assert simulate(spec) == record

    def test_records_of_unfinished_and_truncated_episodes(self, make, yard_file):
        env = make(scenario=yard_file, faults=0, time_limit=40.0)
        env.reset(seed=4)
        env.step(0)
        assert "has not ended after" in env.record().result.verdict
        truncated = False
        while not truncated:
            truncated = env.step(1)[3]
        assert "the time limit of 40 s was reached" in env.record().result.verdict

    def test_mishaps_of_the_drive_are_reported(self, make, yard_file, monkeypatch):
        """Slipping and being stuck are in the info as in the record of a run."""
        slipped = Incident(Trouble.SLIPPING, "made 0.1 m of 0.5 m", BodyPose(2, 2, 0.02, 0))
        env = make(scenario=yard_file, faults=0)
        monkeypatch.setattr(RouteDrive, "incidents", (slipped,))
        env.reset(seed=4)
        assert env.step(0)[4]["trouble"] == ("slipping: made 0.1 m of 0.5 m",)
        assert env.step(1)[4]["trouble"] == ()
        assert [m.trouble for m in env.record().mishaps] == [Trouble.SLIPPING]


@pytest.mark.physics
@pytest.mark.parametrize("mode", ["sync", "async"])
def test_a_batch_equals_single_environments(make, yard_file, mode):
    """It may use other processes, to which spaces and observations are sent."""
    arguments = {"scenario": yard_file, "drive": "kinematic", "faults": 2}
    batch = gym.make_vec("argo/Inspect-v0", 2, mode, **arguments)
    try:
        observations, infos = batch.reset(seed=[6, 7])
        singles = [make(**arguments) for _ in range(2)]
        firsts = [env.reset(seed=6 + k) for k, env in enumerate(singles)]
        for actions in ([0, 1], [1, 3]):
            for k, (observation, info) in enumerate(firsts):
                for name, value in observation.items():
                    assert np.array_equal(observations[name][k], value), name
                if "found" in info:
                    assert infos["found"][k] == info["found"]
                    assert infos["trouble"][k] == info["trouble"]
            observations, rewards, ended, _, infos = batch.step(np.array(actions))
            steps = [env.step(action) for env, action in zip(singles, actions, strict=True)]
            assert rewards.tolist() == [s[1] for s in steps]
            assert ended.tolist() == [s[2] for s in steps]
            firsts = [(s[0], s[4]) for s in steps]
        assert ended.tolist() == [False, True]
    finally:
        batch.close()
