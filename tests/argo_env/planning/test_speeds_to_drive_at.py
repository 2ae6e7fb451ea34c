"""Speeds that a mission asks for, and those that the robot is known to drive at."""

import pytest

from argo_env.planning.site_warnings import too_fast
from argo_env.robot.spec import load_robot
from tests.yard import measure, mission


@pytest.mark.parametrize("speed", [None, 0.1, 0.4])
def test_a_speed_that_the_robot_drives_at(speed):
    assert list(too_fast(mission(measure(1, velocity=speed)), load_robot())) == []


def test_one_that_it_is_not_known_to_drive_at():
    (finding,) = too_fast(mission(measure(1, velocity=5.0), measure(2)), load_robot())
    assert finding.code == "site.faster-than-robot"
    assert finding.severity == "warning"
    assert "at 5 m/s" in finding.message
    assert "0.4 m/s" in finding.message
    assert finding.subject == "tasks['MEASURE 1'].velocity"
