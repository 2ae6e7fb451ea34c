"""Warnings about a mission on its site: poses with hidden checkpoints, and speeds."""

import math
import re

import pytest

from argo_compiler.base.model import Pose
from argo_env.planning.site_warnings import above_own_speed_warnings, not_seen_from_pose_warnings
from argo_env.robot.spec import load_robot
from tests.yard import measure, mission


def found(site, **pose):
    plan = mission(measure(1, pose=Pose(z=0.02, **pose)))
    return list(not_seen_from_pose_warnings(plan, site))


@pytest.mark.rule("T10")
def test_a_pose_that_sees_the_checkpoint(site):
    assert found(site, x=2.55, y=2.55, yaw=math.radians(90)) == []


def test_one_that_does_not(site):
    (finding,) = found(site, x=5.55, y=1.55)
    assert finding.code == "site.not-seen-from-pose"
    assert finding.severity == "warning"
    assert "gauge 1 is" in finding.message
    assert finding.subject == "tasks['MEASURE 1'].pose"


def test_the_hint_has_the_nearest_pose_that_sees_it(site):
    (finding,) = found(site, x=5.55, y=1.55)
    offered = re.search(r"x (\S+), y (\S+), z (\S+), yaw (\S+)\), or none", finding.hint)
    x, y, z, yaw = map(float, offered.groups())
    assert found(site, x=x, y=y, yaw=yaw) == []
    assert z == pytest.approx(0.02, abs=0.01)


def test_one_where_the_robot_can_not_stand_is_not_its_matter(site):
    assert found(site, x=50.0, y=1.55) == []


def test_without_poses_nothing_is_looked_at(site):
    assert list(not_seen_from_pose_warnings(mission(measure(1), measure(2)), site)) == []


@pytest.mark.parametrize("speed", [None, 0.1, 0.4])
def test_a_speed_that_the_robot_drives_at(speed):
    assert list(above_own_speed_warnings(mission(measure(1, velocity=speed)), load_robot())) == []


def test_one_that_it_is_not_known_to_drive_at():
    (finding,) = above_own_speed_warnings(
        mission(measure(1, velocity=5.0), measure(2)), load_robot()
    )
    assert finding.code == "site.faster-than-robot"
    assert finding.severity == "warning"
    assert "at 5 m/s" in finding.message
    assert "0.4 m/s" in finding.message
    assert finding.subject == "tasks['MEASURE 1'].velocity"
