"""Tests of the fit of the calibration: known paces are recovered from the times of drives."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.model import Pose
from argo_env.drives.drive import DriveStatus
from argo_env.drives.timed_drive import RouteDrive
from argo_env.files import resources
from argo_env.navigation import Path
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.spec import Calibration, MotionKind, MotionPace, load_robot
from benchmarks.fitting import TimedDrive, fit_calibration, measured_minus_predicted_seconds
from tests.conftest import examples

ROBOT = load_robot().model_copy(update={"calibration": Calibration()})

paces = st.builds(MotionPace, share=st.floats(0.4, 1.3), lost=st.floats(0.0, 4.0))
calibrations = st.builds(Calibration, ahead=paces, reverse=paces, up=paces, down=paces, turn=paces)


def random_motion(rng, kind):
    a = Pose(x=0.0, y=0.0, z=0.0, yaw=0.0)
    if kind is MotionKind.TURN:
        turn = float(rng.choice([-1, 1]) * rng.uniform(0.2, 3.0))
        return Motion(a, a.model_copy(update={"yaw": wrap(turn)}), turn=turn)
    gear = 1 if kind in (MotionKind.AHEAD, MotionKind.DOWN) else -1
    length = float(rng.uniform(0.1, 6.0))
    stairs = kind in (MotionKind.UP, MotionKind.DOWN)
    end = Pose(x=gear * length, y=0.0, z=-gear * length * 0.6 * stairs, yaw=0.0)
    return Motion(a, end, gear=gear, on_stairs=stairs)


def drives(calibration, rng, count, kinds=tuple(MotionKind), each=1, velocity=None, noise=0.0):
    robot = ROBOT.model_copy(update={"calibration": calibration})
    for _ in range(count):
        motions = tuple(random_motion(rng, kinds[k]) for k in rng.integers(len(kinds), size=each))
        seconds = sum(m.duration(robot, velocity) for m in motions)
        yield TimedDrive(motions, seconds + noise * float(rng.normal()), velocity)


def assert_close(fitted, true, share=1e-3, lost=1e-3):
    for kind in MotionKind:
        assert fitted.pace_for(kind).share == pytest.approx(true.pace_for(kind).share, abs=share)
        assert fitted.pace_for(kind).lost == pytest.approx(true.pace_for(kind).lost, abs=lost)


@given(calibrations, st.integers(0, 99), st.sampled_from([1, 7]), st.sampled_from([None, 0.3]))
@settings(max_examples=examples(30), deadline=None)
def test_finds_known_paces_from_single_motions_and_whole_paths(true, seed, each, velocity):
    timed = drives(true, np.random.default_rng(seed), 200, each=each, velocity=velocity)
    assert_close(fit_calibration(timed, ROBOT), true)


@given(calibrations, st.integers(0, 99))
@settings(max_examples=examples(10), deadline=None)
def test_finds_known_paces_in_spite_of_noise(true, seed):
    timed = drives(true, np.random.default_rng(seed), 3000, noise=0.3)
    assert_close(fit_calibration(timed, ROBOT), true, share=0.06, lost=0.15)


def test_a_kind_that_is_never_driven_keeps_the_commanded_speed():
    true = Calibration(ahead=MotionPace(share=0.8, lost=1.0))
    kinds = (MotionKind.AHEAD,)
    fitted = fit_calibration(drives(true, np.random.default_rng(1), 20, kinds=kinds), ROBOT)
    assert_close(fitted, true)
    assert fitted.up == MotionPace()


def test_errors_are_measured_minus_predicted_times():
    rng = np.random.default_rng(5)
    timed = list(drives(Calibration(), rng, 10))
    late = [TimedDrive(d.motions, d.seconds + 2.0) for d in timed]
    assert measured_minus_predicted_seconds(timed, ROBOT) == pytest.approx(np.zeros(10), abs=1e-9)
    assert measured_minus_predicted_seconds(late, ROBOT) == pytest.approx(np.full(10, 2.0))


def test_a_fit_without_drives_is_refused():
    with pytest.raises(ValueError, match="no drives"):
        fit_calibration([TimedDrive((), 0.1)], ROBOT)


def test_a_drive_and_its_fit_agree():
    """Times are counted in time steps of the drive, so they are off by one step at most."""
    true = Calibration(ahead=MotionPace(share=0.9, lost=1.0), turn=MotionPace(share=0.8, lost=0.5))
    robot, rng, timed = ROBOT.model_copy(update={"calibration": true}), np.random.default_rng(3), []
    for _ in range(100):
        motion = random_motion(rng, (MotionKind.AHEAD, MotionKind.TURN)[rng.integers(2)])
        drive = RouteDrive(robot, 0.01)
        drive.follow(Path(motion.start, (motion,)), None)
        steps = 1
        while drive.step() is DriveStatus.MOVING:
            steps += 1
        timed.append(TimedDrive((motion,), steps * 0.01))
    assert_close(fit_calibration(timed, ROBOT), true, share=0.01, lost=0.02)


def test_a_robot_comes_with_its_calibration(tmp_path, monkeypatch):
    folder = tmp_path / "robot"
    folder.mkdir()
    shipped = (resources.urdf_folder() / "robot" / "tracker.yaml").read_text(encoding="utf-8")
    (folder / "other.yaml").write_text(shipped, encoding="utf-8")
    monkeypatch.setattr("argo_env.robot.spec.robot_folder", lambda: folder)
    assert load_robot("other").calibration == Calibration()
    calibrated = folder / "other.calibration.yaml"
    calibrated.write_text("ahead: {share: 0.5, lost: 2.0}\n", encoding="utf-8")
    robot = load_robot("other")
    assert robot.calibration == Calibration(ahead=MotionPace(share=0.5, lost=2.0))
    assert robot.motion_time(MotionKind.AHEAD, 4.0) == pytest.approx(4.0 / (robot.speed / 2) + 2.0)
    with pytest.raises(ArgoError, match=r"there are: other$"):
        load_robot("another")
    calibrated.write_text("ahead: {share: -1}\n", encoding="utf-8")
    with pytest.raises(ArgoError, match=r"other\.calibration\.yaml"):
        load_robot("other")
