"""A picture of the site that stands still, with the robot put into it, is the picture of both."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.files import cache
from argo_env.pictures.light import shadowed, sun_camera
from argo_env.pictures.overview import site_camera, still_view, with_robot
from argo_env.pictures.scene import Scene
from argo_env.robot.pose import BodyPose

SIZE, MAP = (480, 360), 320


@pytest.fixture(scope="module")
def whole(umad, robot):
    with Scene(umad, robot) as scene:
        yield scene


@pytest.fixture(scope="module")
def alone(robot):
    with Scene(None, robot) as scene:
        yield scene


@pytest.mark.long
@settings(max_examples=15)
@given(
    st.floats(-3.0, 18.0), st.floats(-4.0, 12.0), st.sampled_from([-0.03, 2.5, 5.0, 12.5]),
    st.floats(-3.0, 3.0),
)  # fmt: skip
def test_both_are_equal_pixel_by_pixel(umad, robot, whole, alone, x, y, z, yaw):
    camera, sun = site_camera(umad, SIZE), sun_camera(umad, MAP)
    still = still_view(umad, robot, camera, sun)
    for scene in (whole, alone):
        scene.place_robot(BodyPose(x, y, z, yaw), robot.arm_raised)
    put = with_robot(still, alone, camera, sun)
    seen, lit = whole.look(camera), whole.look(sun)
    # Where two surfaces are equally near either may be seen.
    assert (put.view.colours != seen.colours).any(axis=2).mean() < 1e-3
    finite = np.isfinite(seen.depth)
    assert (np.isfinite(put.view.depth) == finite).all()
    assert put.view.depth[finite] == pytest.approx(seen.depth[finite], abs=1e-3)
    dark = shadowed(camera, seen.depth, sun, lit.depth)
    assert (put.dark != dark).mean() < 1e-4


def test_it_is_rendered_once(umad, robot, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    camera, sun = site_camera(umad, (80, 60)), sun_camera(umad, 50)
    first = still_view(umad, robot, camera, sun)
    monkeypatch.setattr("argo_env.pictures.overview.Scene", None)  # none can be made any more
    again = still_view(umad, robot, camera, sun)
    assert (again.view.colours == first.view.colours).all()
    assert (again.view.depth == first.view.depth).all()
    assert (again.dark == first.dark).all()


def test_another_site_or_camera_is_another_picture(umad, robot, tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path))
    camera, sun = site_camera(umad, (80, 60)), sun_camera(umad, 50)
    first = still_view(umad, robot, camera, sun)
    fewer = umad.with_elements(umad.elements[: len(umad.elements) // 2])
    assert (still_view(fewer, robot, camera, sun).view.colours != first.view.colours).any()
    assert still_view(umad, robot, site_camera(umad, (60, 80)), sun).view.depth.shape == (80, 60)
