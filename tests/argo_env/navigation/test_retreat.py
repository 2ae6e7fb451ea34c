"""Back along the way that the robot came."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_compiler.model import Pose
from argo_env.navigation import Path
from argo_env.navigation.path import wrap
from argo_env.navigation.retreat import way_back
from tests.conftest import examples
from tests.yard import yard


@pytest.fixture(scope="module")
def path():
    start, goal = Pose(x=1.05, y=1.05, z=0.02), Pose(x=5.05, y=3.55, z=0.02, yaw=2.0)
    return yard().plan(start, goal)


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
