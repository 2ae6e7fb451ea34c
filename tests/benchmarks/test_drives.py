"""Tests of the comparison of the drives: its random missions, and its figures for invented runs."""

import numpy as np
import pytest

from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.il import Action
from argo_env.drives.drive import DriveStatus
from argo_env.drives.timed_drive import RouteDrive
from argo_env.drives.timetable import Timetable
from argo_env.planning import open_site
from argo_env.planning.catalog import make_catalog
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import Calibration, MotionPace
from benchmarks.drives import Run, error_table, random_mission, run_seed, time_path
from benchmarks.fitting import fit_calibration, measured_minus_predicted_seconds


@pytest.fixture(scope="module")
def navigator():
    return open_site("umad").navigator


def test_missions_pass_the_checks_and_depend_on_their_seed(navigator):
    catalog = make_catalog(navigator)
    missions = [random_mission(navigator, seed) for seed in range(30)]
    assert missions == [random_mission(navigator, seed) for seed in range(30)]
    assert len({m.model_dump_json() for m in missions}) == 30
    floors, docks = set(), set()
    for mission in missions:
        assert not check(mission, catalog)
        assert 5 <= len(mission.tasks) <= 10
        docks.add((mission.start_area, mission.end_area))
        for task in mission.tasks[1:-1]:
            if task.action is Action.MEASURE:
                floors.add(navigator.site.checkpoint(int(task.object_id)).floor)
            else:
                floors.add(navigator.site.floor_at(task.pose.z))
    assert floors == {1, 2, 3, 4, 5, 6}
    assert len(docks) == 4


def test_one_mission_is_run(navigator):
    result = run_seed(navigator, 3, "route")
    assert result.verdict is None
    assert result.simulated > 100


def test_errors_are_relative_to_the_tracked_drive():
    runs = [Run(0, "tracked", None, 100.0, 4.0), Run(1, "tracked", None, 200.0, 4.0)]
    runs += [Run(2, "tracked", "it fell over", 50.0, 4.0)]
    for seed in range(3):
        runs.append(Run(seed, "route", None, 99.0 if seed == 0 else 206.0, 0.01))
        runs.append(Run(seed, "kinematic", None, 100.0 if seed == 0 else 200.0, 1.0))
    lines = list(error_table(runs))
    assert lines[0].startswith("2 of 3 missions")
    assert any("it fell over" in line for line in lines)
    table = {line.split()[0]: line.split() for line in lines[-3:]}
    assert table["route"][1:8:2] == ["2.00", "2.80", "3.00", "+1.00"]
    assert table["kinematic"][1:8:2] == ["0.00", "0.00", "0.00", "+0.00"]
    assert table["tracked"][-2] == "38"


class DriveWithCurrentMotion(RouteDrive):
    """Route drive that has the current motion of its path as an attribute."""

    def follow(self, path, velocity):
        super().follow(path, velocity)
        self._table = Timetable(path, self._robot, velocity)

    @property
    def motion(self):
        return self._timetable and self._table.motion_and_share_at(self._steps * self.time_step)[0]


class StuckDrive(DriveWithCurrentMotion):
    """Drive that fails after 100 steps."""

    failure = "it is stuck"

    def step(self):
        super().step()
        return DriveStatus.FAILED if self._steps > 100 else DriveStatus.MOVING


def put_at(drive, pose):
    drive.place_robot(BodyPose(pose.x, pose.y, pose.z, pose.yaw))
    return drive


PACES = Calibration(
    ahead=MotionPace(share=0.9, lost=1.0),
    reverse=MotionPace(share=0.8),
    up=MotionPace(share=0.7, lost=2.0),
    down=MotionPace(share=0.85, lost=1.5),
    turn=MotionPace(share=0.95, lost=0.5),
)


def test_times_of_motions_add_up_and_reproduce_the_paces(navigator):
    robot = navigator.robot.model_copy(update={"calibration": PACES})
    docks, timed = navigator.site.docks, []
    for a, b in ((1, 2), (2, 1)):
        for floor in (2, 4):
            x, y, z, _ = navigator.turning_poses(floor)[5 * a].tolist()
            above = Pose(x=x, y=y, z=z, yaw=1.0)
            for path in (navigator.plan(docks[a], above), navigator.plan(above, docks[b])):
                motions = time_path(put_at(DriveWithCurrentMotion(robot, 0.02), path.start), path)
                assert [d.motions for d in motions] == [(m,) for m in path.motions]
                seconds = sum(d.seconds for d in motions)
                assert seconds == pytest.approx(path.duration(robot), abs=0.02 + 1e-6)
                timed += motions
    fitted = navigator.robot.model_copy(
        update={"calibration": fit_calibration(timed, navigator.robot)}
    )
    # All flights have the same length, so that share and lost time can't be told apart there.
    assert measured_minus_predicted_seconds(timed, fitted) == pytest.approx(
        np.zeros(len(timed)), abs=0.03
    )
    for kind in ("ahead", "turn"):
        fitted_pace, true = getattr(fitted.calibration, kind), getattr(PACES, kind)
        assert fitted_pace.share == pytest.approx(true.share, abs=0.01)
        assert fitted_pace.lost == pytest.approx(true.lost, abs=0.05)


def test_a_path_that_fails_has_no_times(navigator):
    path = navigator.plan(*(navigator.site.docks[n] for n in (1, 2)))
    with pytest.raises(RuntimeError, match="stuck"):
        time_path(put_at(StuckDrive(navigator.robot), path.start), path)
