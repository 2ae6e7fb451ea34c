"""Tests of closed parts of the surface, and of paths back."""

import math
from itertools import groupby

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_env.navigation import Blockage, Path
from argo_env.navigation.path import wrap
from argo_env.navigation.retreat import path_back, path_through, recent_poses
from benchmarks.paths import poses_of_states
from tests.conftest import examples

FLIGHT = Blockage((3.0, 1.0, 3.5, 2.1), 1.0, "the stairs are blocked")


def over(pose, footprint, rect, margin=0.0):
    """Return True if any of a grid of points under the robot is in the rectangle."""
    along = np.linspace(-footprint.rear - margin, footprint.front + margin, 23)
    left = np.linspace(-footprint.half_width - margin, footprint.half_width + margin, 13)
    along, left = (a.ravel() for a in np.meshgrid(along, left))
    x = pose.x + along * math.cos(pose.yaw) - left * math.sin(pose.yaw)
    y = pose.y + along * math.sin(pose.yaw) + left * math.cos(pose.yaw)
    return bool(((x >= rect[0]) & (x <= rect[2]) & (y >= rect[1]) & (y <= rect[3])).any())


def poses_along(path):
    """Yield poses every few centimetres and degrees along a path."""
    for motion in path.motions:
        count = 2 + math.ceil(max(motion.length / 0.05, abs(motion.turn) / math.radians(3)))
        yield from (motion.pose_at(share) for share in np.linspace(0.0, 1.0, count))


@settings(max_examples=examples(6), deadline=None)
@given(
    x=st.floats(0.5, 9.5), y=st.floats(0.5, 7.0), width=st.floats(0.0, 1.2),
    depth=st.floats(0.0, 1.2), seed=st.integers(0, 10**6),
)  # fmt: skip
def test_no_path_touches_a_closed_area(hall, robot, x, y, width, depth, seed):
    rect = (x, y, x + width, y + depth)
    avoiding = hall.with_added_blockages([Blockage(rect, 0.0, "a brick")])
    random = np.random.default_rng(seed)
    ground = np.flatnonzero(hall.lattice.surface.z[hall.lattice.cell] < 0.05)
    chosen = poses_of_states(hall, random.choice(ground, 3))
    # A robot that is on a closed area may leave it.
    for start in (p for p in chosen if not over(p, robot.footprint, rect)):
        for goal in chosen:
            try:
                path = avoiding.plan(start, goal)
            except Unreachable:
                continue
            assert not any(over(p, robot.footprint, rect) for p in poses_along(path) if p.z < 0.9)


def test_detours_take_longer_and_the_first_navigator_is_unchanged(hall, robot):
    start, goal = Pose(x=1.05, y=4.05, z=0.0), Pose(x=6.05, y=6.55, z=0.0)
    direct = hall.plan(start, goal)
    middle = direct.motions[len(direct.motions) // 2].pose_at(0.5)
    rect = (middle.x - 0.2, middle.y - 0.2, middle.x + 0.2, middle.y + 0.2)
    avoiding = hall.with_added_blockages([Blockage(rect, 0.0, "a brick")])
    assert avoiding.plan(start, goal).duration(robot) > direct.duration(robot)
    assert hall.plan(start, goal) == direct
    assert avoiding.site is hall.site
    assert avoiding.surface is hall.surface
    assert hall.with_added_blockages([]) is hall


def test_a_closed_area_does_not_close_the_deck_above(hall):
    below = Blockage((5.64, 0.6, 9.6, 2.4), 0.0, "a leak")
    start, goal = Pose(x=6.5, y=1.55, z=2.5), Pose(x=9.0, y=1.55, z=2.5)
    assert hall.with_added_blockages([below]).plan(start, goal) == hall.plan(start, goal)


def test_blocked_stairs_separate_the_floors(hall):
    avoiding = hall.with_added_blockages([FLIGHT])
    dock = hall.site.docks[1]
    for refused in (
        lambda: avoiding.plan_to_view(dock, 4),
        lambda: avoiding.plan(dock, Pose(x=9.0, y=1.5, z=2.5)),
        lambda: avoiding.plan(Pose(x=9.0, y=1.5, z=2.5), dock),
    ):
        with pytest.raises(Unreachable, match="the stairs are blocked"):
            refused()
    # Paths on either side are unchanged.
    assert avoiding.plan_to_view(dock, 3) == hall.plan_to_view(dock, 3)
    up = Pose(x=9.0, y=1.5, z=2.5)
    assert avoiding.plan_to_view(up, 6) == hall.plan_to_view(up, 6)
    times = avoiding.travel_times([dock, up])
    assert np.isinf(times[[0, 1], [1, 0]]).all()
    assert np.diag(times).tolist() == [0.0, 0.0]


def test_a_robot_that_meets_a_blockage_on_the_stairs_goes_back(hall):
    """It climbs backwards, so it goes back forwards."""
    on_the_flight = hall.plan(hall.site.docks[1], Pose(x=9.0, y=1.5, z=2.5))
    below = next(p for p in poses_along(on_the_flight) if 0.4 < p.z < 0.5)
    ahead = Blockage((below.x + 0.8, 1.0, below.x + 1.0, 2.1), below.z + 0.5, "a brick")
    avoiding = hall.with_added_blockages([ahead])
    back = avoiding.plan(below, hall.site.docks[1])
    assert back.end.z < 0.1
    assert {m.gear for m in back.motions if m.on_stairs} == {1}


def test_blockages_can_be_added_together_or_one_by_one(hall):
    bricks = [Blockage((2, 3, 2.4, 3.2), 0.0, "a brick"), Blockage((4, 3, 4.2, 4.4), 0.0, "a bag")]
    together, after = (
        hall.with_added_blockages(bricks),
        hall.with_added_blockages(bricks[:1]).with_added_blockages(bricks[1:]),
    )
    assert together.blockages == after.blockages
    assert together.lattice.state_of.tolist() == after.lattice.state_of.tolist()
    goal = Pose(x=6.05, y=4.05, z=0.0)
    for dock in hall.site.docks.values():
        assert together.plan(dock, goal) == after.plan(dock, goal)


def test_exactly_the_states_over_a_blockage_are_closed(hall, robot):
    rect = (4.03, 3.02, 4.31, 3.24)
    closed = hall.with_added_blockages([Blockage(rect, 0.0, "a brick")]).lattice
    lattice = hall.lattice
    near = lattice.surface.cells_in_square(4.2, 3.1, 1.0)
    states = lattice.state_of[near]
    gone = (states >= 0) & (closed.state_of[near] < 0)
    assert gone.sum() > 100
    for (k, heading), was in np.ndenumerate(states):
        if was < 0 or not -0.1 < lattice.surface.z[near[k]] < 0.1:
            continue
        (pose,) = poses_of_states(hall, np.array([was]))
        if over(pose, robot.footprint, rect):
            assert gone[k, heading], pose
        if gone[k, heading]:
            # This allows for the margin, and for the spacing of the points.
            wide = (rect[0] - 0.06, rect[1] - 0.06, rect[2] + 0.06, rect[3] + 0.06)
            assert over(pose, robot.footprint, wide, margin=0.02), pose
    assert (closed.state_of >= 0).sum() == lattice.size - gone.sum()


def test_without_a_detour_the_goal_is_unreachable(yard):
    """The site is one small region without landmarks."""
    wall = Blockage((3.4, 0.0, 3.6, 5.0), 0.02, "a trench")
    start, goal = Pose(x=1.55, y=1.55, z=0.02), Pose(x=5.55, y=2.55, z=0.02)
    assert yard.plan(start, goal).length > 4.0
    with pytest.raises(Unreachable, match="a trench"):
        yard.with_added_blockages([wall]).plan(start, goal)


@pytest.fixture(scope="module")
def path(yard):
    start, goal = Pose(x=1.05, y=1.05, z=0.02), Pose(x=5.05, y=3.55, z=0.02, yaw=2.0)
    return yard.plan(start, goal)


def require_joined(motions, at):
    """Check that each motion begins at the pose where the previous one ended, the first at `at`."""
    for motion in motions:
        assert math.dist((motion.start.x, motion.start.y), (at.x, at.y)) < 1e-6
        assert abs(wrap(motion.start.yaw - at.yaw)) < 1e-6
        assert abs(wrap(motion.start.yaw + motion.turn - motion.end.yaw)) < 1e-6
        at = motion.end


@settings(max_examples=examples(60), deadline=None)
@given(st.data(), st.floats(0.0, 1.0), st.floats(0.0, 8.0))
def test_the_path_back_has_the_same_poses_in_reverse(path, data, share, length):
    k = data.draw(st.integers(0, len(path.motions) - 1))
    here = path.motions[k].pose_at(share)
    back = path_back(path, here, length)
    came = sum(m.length for m in path.motions[:k]) + share * path.motions[k].length
    assert back.length == pytest.approx(min(length, came), abs=0.06)
    assert math.dist((back.start.x, back.start.y), (here.x, here.y)) < 0.06
    require_joined(back.motions, back.start)
    for motion in back.motions:
        if not motion.turn:
            ahead = (motion.end.x - motion.start.x) * math.cos(motion.start.yaw)
            ahead += (motion.end.y - motion.start.y) * math.sin(motion.start.yaw)
            assert ahead * motion.gear >= -1e-9


def test_path_back_along_a_path_without_motions():
    here = Pose(x=1.0, y=1.0, z=0.0)
    assert path_back(Path(here, ()), here, 1.0) == Path(here, ())


def gears_of(path):
    """Return the gears of a path's drives, without repetitions."""
    return [gear for gear, _ in groupby(m.gear for m in path.motions if not m.turn)]


@settings(max_examples=examples(40), deadline=None)
@given(st.integers(2, 60), st.booleans())
def test_the_path_through_observed_poses_is_the_driven_path(path, count, forwards):
    observed = [m.pose_at(k / count) for m in path.motions for k in range(count + 1)]
    gears = gears_of(path)
    if not forwards:
        observed.reverse()
        gears = [-gear for gear in reversed(gears)]
    seen = path_through(observed)
    assert gears_of(seen) == gears
    assert seen.length == pytest.approx(path.length, rel=0.02)
    require_joined(seen.motions, observed[0])
    assert math.dist((seen.end.x, seen.end.y), (observed[-1].x, observed[-1].y)) < 0.06


def test_the_path_back_on_stairs_is_straight_and_reversed():
    flight = [Pose(x=0.2 * k, y=0.01 * (k % 2), z=0.16 * k, yaw=0.03 * (k % 2)) for k in range(9)]
    down = path_back(path_through(flight), flight[-1], 1.0)
    assert all(m.on_stairs and m.gear < 0 and not m.turn for m in down.motions)
    assert down.length == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("waited", [0, 500])
def test_waiting_does_not_shorten_the_recent_path(path, waited):
    observed = [m.pose_at(k / 20) for m in path.motions for k in range(21)]
    last = [observed[-1]] * waited
    seen = recent_poses(reversed([*observed, *last]), 2.0)
    assert len(seen) < waited + 60
    assert path_back(path_through(seen), observed[-1], 1.0).length == pytest.approx(1.0, abs=0.02)
    assert recent_poses(reversed(observed), 1000.0) == observed


def test_the_path_of_a_robot_at_rest_has_no_motions():
    here = Pose(x=1.0, y=1.0, z=0.0, yaw=0.5)
    assert path_through([here]) == path_through([here, here]) == Path(here, ())
