"""The forces of belts at hand-made contacts."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.drives.tracked.belts import Belts, Traction
from tests.conftest import examples

WEIGHT = 600.0
LEVEL = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
STILL = (0.0, 0.0, 0.0)
CENTER = (0.0, 0.0, 0.25)
GROUND = 7


def contact(x, y, force, link=-1, other=GROUND):
    """Return a contact with level ground; x and y are in m from below the centre of mass."""
    return (0, 0, 0, link, other, (x, y, -0.25), (x, y, -0.25), (0.0, 0.0, 1.0), 0.0, force)


def standing():
    return [contact(x, y, WEIGHT / 4) for x in (-0.4, 0.4) for y in (-0.23, 0.23)]


def pull(belts, contacts, speeds=(0.0, 0.0), velocity=STILL, spin=STILL, steps=1):
    for _ in range(steps):
        wrench, other = belts.wrench_and_other_contacts(
            contacts, GROUND, speeds, STILL, LEVEL, velocity, spin, 1 / 240
        )
    return wrench, other


def belts(**traction):
    return Belts(CENTER, Traction(**traction), WEIGHT)


def test_no_slip_no_force():
    assert pull(belts(), standing())[0] == pytest.approx((0.0,) * 6)


def test_belts_that_run_push_the_robot_on_up_to_their_grip():
    force = pull(belts(grip=2.0), standing(), speeds=(5.0, 5.0), steps=50)[0]
    assert force[0] == pytest.approx(2.0 * WEIGHT)
    assert force[1:4] == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_a_robot_that_slides_sideways_is_held_by_the_side_grip():
    force = pull(belts(side_grip=0.5), standing(), velocity=(0.0, 3.0, 0.0), steps=50)[0]
    assert force[1] == pytest.approx(-0.5 * WEIGHT)


def test_a_push_that_is_held_leaves_no_creep():
    """Bent grousers hold the robot: after a slip the force stays without any slip."""
    held = belts()
    pull(held, standing(), velocity=(0.1, 0.0, 0.0), steps=5)
    first = pull(held, standing())[0][0]
    last = pull(held, standing(), steps=1000)[0][0]
    assert first < -10.0
    assert last == pytest.approx(first)


def test_belts_that_run_against_each_other_turn_the_robot():
    wrench, _ = pull(belts(), standing(), speeds=(-0.2, 0.2), steps=5)
    assert wrench[5] > 10.0
    assert wrench[:2] == pytest.approx((0.0, 0.0), abs=1e-9)


@settings(max_examples=examples(100), deadline=None)
@given(
    st.lists(st.floats(0.0, 400.0), min_size=4, max_size=4),
    st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
    st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0)),
    st.floats(-2.0, 2.0),
)
def test_no_force_is_beyond_the_grip(normals, speeds, velocity, spin):
    places = [(x, y) for x in (-0.4, 0.4) for y in (-0.23, 0.23)]
    contacts = [contact(x, y, n) for (x, y), n in zip(places, normals, strict=True)]
    traction = Traction()
    wrench, _ = pull(belts(), contacts, speeds, (*velocity, 0.0), (0.0, 0.0, spin), steps=3)
    total = min(sum(normals), 1.5 * WEIGHT)
    assert abs(wrench[0]) <= traction.grip * total + 1e-6
    assert abs(wrench[1]) <= traction.side_grip * total + 1e-6
    assert math.hypot(wrench[0], wrench[1]) <= traction.grip * total + 1e-6
    assert wrench[2] == pytest.approx(0.0, abs=1e-9)


def test_other_contacts_are_those_of_no_belt_or_no_ground():
    belly, wall = contact(0.0, 0.0, 50.0), contact(0.4, 0.23, 50.0, other=3)
    _, other = pull(belts(), [*standing(), belly, wall])
    assert other == [belly, wall]
