import pytest

from argo_env.navigation import Navigator
from argo_env.site import load_site

FLOOR_MATERIALS = {"grating", "concrete", "gravel"}


@pytest.fixture(scope="session")
def obstacles(umad_world):
    """The materials that the robot must not touch."""
    return sorted(set(umad_world.links) - FLOOR_MATERIALS)


def footprint_box(robot, low, high):
    """Return opposite corners of the robot's box between two heights."""
    foot = robot.footprint
    return (-foot.rear, -foot.half_width, low), (foot.front, foot.half_width, high)


@pytest.fixture(scope="session")
def hall(robot):
    """The navigator of the small test site, which has two floors and one flight."""
    return Navigator(load_site("darmstadt"), robot)
