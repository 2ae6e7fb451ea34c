"""Obstacles and holes are detected in time, and there are no false alarms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.il import EventKind
from argo_env.drives.drive import DriveStatus
from argo_env.drives.kinematic import KinematicDrive
from argo_env.robot.pose import BodyPose
from argo_env.sensing.signals.site_map import SiteMap
from argo_env.sensing.signals.terrain_watch import TerrainScanner, TerrainWatch
from argo_env.world.world import World
from tests.argo_env.sensing.signals.plant import Z, detections_along, lane, with_brick, with_hole
from tests.conftest import examples

pytestmark = pytest.mark.physics

FRONT, REAR = 0.5, 0.55  # m from the robot's middle to its ends


def make_watch(world, site_map, seed=0):
    return TerrainWatch(TerrainScanner(world, site_map, np.random.default_rng(seed)))


@settings(deadline=None, max_examples=examples(12))
@given(
    st.floats(7.0, 12.0),
    st.floats(-0.25, 0.25),
    st.floats(-math.pi, math.pi),
    st.booleans(),
    st.integers(0, 99),
)
def test_a_brick_is_detected_a_metre_before_it_is_reached(
    site, world, site_map, robot, x, aside, yaw, backwards, seed
):
    poses = lane(1.0, x - 0.7, backwards=backwards)
    elements = with_brick(site, x, 2.0 + aside, yaw=yaw)
    with World(site, robot, elements=elements) as littered:
        _, pose, detection = detections_along(make_watch(littered, site_map, seed), poses)[0]
    assert detection.kind is EventKind.POSITIVE_OBSTACLE
    assert x - 0.12 - pose.x - (REAR if backwards else FRONT) >= 1.0
    x0, y0, x1, y1 = detection.blockage.rect
    assert x0 <= x <= x1 + 0.1
    assert y0 - 0.05 <= 2.0 + aside <= y1 + 0.05
    assert max(x1 - x0, y1 - y0) < 0.6
    assert detection.blockage.z == pytest.approx(Z, abs=0.03)
    assert detections_along(make_watch(world, site_map, seed), poses) == []


@settings(deadline=None, max_examples=examples(8))
@given(st.floats(7.0, 12.0), st.floats(0.4, 1.0), st.booleans(), st.integers(0, 99))
def test_a_missing_plate_is_detected_a_metre_before_it_is_reached(
    site, site_map, robot, x, size, backwards, seed
):
    half = size / 2
    elements = with_hole(site, x - half, 2.0 - half, x + half, 2.0 + half)
    poses = lane(1.0, x - half - FRONT, backwards=backwards)
    with World(site, robot, elements=elements) as holed:
        detections = detections_along(make_watch(holed, site_map, seed), poses)
    _, pose, first = detections[0]
    assert {f.kind for *_, f in detections} == {EventKind.NEGATIVE_OBSTACLE}
    assert x - half - pose.x - (REAR if backwards else FRONT) >= 1.0
    assert first.blockage.z == pytest.approx(Z, abs=0.03)
    # The reported rectangles cover the hole, and not more than the rays can resolve.
    rects = np.array([f.blockage.rect for *_, f in detections])
    assert rects[:, 0].min() <= x - half + 0.1
    assert rects[:, 2].max() >= min(x + half, pose.x + 2.4) - 0.2
    assert rects[:, 0].min() >= x - half - 0.15
    assert rects[:, 2].max() <= x + half + 0.15


def test_an_obstacle_is_reported_once_and_again_after_it_was_gone(site, world, site_map, robot):
    class Changing:
        """A world that can be replaced by another one."""

        def hit_distances_or_inf(self, *rays):
            return self.now.hit_distances_or_inf(*rays)

    changing_world = Changing()
    watch = make_watch(changing_world, site_map)
    with World(site, robot, elements=with_brick(site, 5.0, 2.0)) as littered:
        changing_world.now = littered
        poses = [(5.0 * k, BodyPose(3.0, 2.0, Z, 0.0)) for k in range(30)]
        first = [f for t, p in poses[:10] for f in watch.update(t, p)]
        changing_world.now = world
        gone = [f for t, p in poses[10:20] for f in watch.update(t, p)]
        changing_world.now = littered
        again = [f for t, p in poses[20:] for f in watch.update(t, p)]
    assert [len(part) for part in (first, gone, again)] == [1, 0, 1]


def test_turning_in_place_between_equipment_finds_nothing(world, site_map):
    for x, y in ((6.0, 2.2), (3.0, 3.6), (10.0, 4.0), (1.0, 1.0)):
        turn = [(0.1 * k, BodyPose(x, y, Z, 0.039 * k)) for k in range(200)]
        assert detections_along(make_watch(world, site_map), turn) == []


@pytest.mark.parametrize("goal", [(1.9, 9.2, 2.5), (13.0, 13.0, -0.03)])
def test_stairs_landings_railings_and_rims_are_no_obstacles(
    umad, simulated_world, navigator, robot, goal
):
    """The robot drives up the west tower, or down the east one."""
    here = navigator.snap_keeping_heading(
        Pose(x=3.05, y=-2.55, z=-0.03) if goal[2] > 0 else Pose(x=12.3, y=8, z=2.5)
    )
    drive = KinematicDrive(simulated_world, robot)
    drive.place_robot(BodyPose(here.x, here.y, here.z, here.yaw))
    drive.follow(navigator.plan(here, Pose(x=goal[0], y=goal[1], z=goal[2])), None)
    poses = [(0.0, drive.pose)]
    while drive.step() is DriveStatus.MOVING:
        poses.append((poses[-1][0] + 0.1, drive.pose))
    assert max(abs(p.pitch) for _, p in poses) > 0.4
    assert detections_along(make_watch(simulated_world, SiteMap(umad)), poses) == []
