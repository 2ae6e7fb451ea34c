"""Back along the way that the robot came."""

import math
from itertools import groupby

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_env.navigation import Path
from argo_env.navigation.path import wrap
from argo_env.navigation.retreat import driven, recent, way_back
from tests.conftest import examples


@pytest.fixture(scope="module")
def path(yard):
    start, goal = Pose(x=1.05, y=1.05, z=0.02), Pose(x=5.05, y=3.55, z=0.02, yaw=2.0)
    return yard.plan(start, goal)


@settings(max_examples=examples(60), deadline=None)
@given(st.data(), st.floats(0.0, 1.0), st.floats(0.0, 8.0))
def test_the_same_places_in_reverse(path, data, share, length):
    k = data.draw(st.integers(0, len(path.motions) - 1))
    here = path.motions[k].at(share)
    back = way_back(path, here, length)
    came = sum(m.length for m in path.motions[:k]) + share * path.motions[k].length
    assert back.length == pytest.approx(min(length, came), abs=0.06)
    assert math.dist((back.start.x, back.start.y), (here.x, here.y)) < 0.06
    at = back.start
    for motion in back.motions:
        assert math.dist((motion.start.x, motion.start.y), (at.x, at.y)) < 1e-6
        assert abs(wrap(motion.start.yaw - at.yaw)) < 1e-6
        assert abs(wrap(motion.start.yaw + motion.turn - motion.end.yaw)) < 1e-6
        if not motion.turn:
            ahead = (motion.end.x - motion.start.x) * math.cos(motion.start.yaw)
            ahead += (motion.end.y - motion.start.y) * math.sin(motion.start.yaw)
            assert ahead * motion.gear >= -1e-9
        at = motion.end


def test_of_no_way_at_all():
    here = Pose(x=1.0, y=1.0, z=0.0)
    assert way_back(Path(here, ()), here, 1.0) == Path(here, ())


def gears_of(path):
    """Ahead and back, in turns."""
    return [gear for gear, _ in groupby(m.gear for m in path.motions if not m.turn)]


@settings(max_examples=examples(40), deadline=None)
@given(st.integers(2, 60), st.booleans())
def test_the_way_that_was_seen_is_the_way_that_was_driven(path, count, forwards):
    places = [m.at(k / count) for m in path.motions for k in range(count + 1)]
    gears = gears_of(path)
    if not forwards:
        places.reverse()
        gears = [-gear for gear in reversed(gears)]
    seen = driven(places)
    assert gears_of(seen) == gears
    assert seen.length == pytest.approx(path.length, rel=0.02)
    at = places[0]
    for motion in seen.motions:
        assert math.dist((motion.start.x, motion.start.y), (at.x, at.y)) < 1e-6
        assert abs(wrap(motion.start.yaw - at.yaw)) < 1e-6
        assert abs(wrap(motion.start.yaw + motion.turn - motion.end.yaw)) < 1e-6
        at = motion.end
    assert math.dist((at.x, at.y), (places[-1].x, places[-1].y)) < 0.06


def test_stairs_are_gone_back_as_they_were_come():
    flight = [Pose(x=0.2 * k, y=0.01 * (k % 2), z=0.16 * k, yaw=0.03 * (k % 2)) for k in range(9)]
    down = way_back(driven(flight), flight[-1], 1.0)
    assert all(m.on_stairs and m.gear < 0 and not m.turn for m in down.motions)
    assert down.length == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("waited", [0, 500])
def test_waiting_does_not_make_one_forget_the_way(path, waited):
    places = [m.at(k / 20) for m in path.motions for k in range(21)]
    last = [places[-1]] * waited
    seen = recent(reversed([*places, *last]), 2.0)
    assert len(seen) < waited + 60
    assert way_back(driven(seen), places[-1], 1.0).length == pytest.approx(1.0, abs=0.02)
    assert recent(reversed(places), 1000.0) == places


def test_a_robot_that_stood_still_came_from_nowhere():
    here = Pose(x=1.0, y=1.0, z=0.0, yaw=0.5)
    assert driven([here]) == driven([here, here]) == Path(here, ())
