import pytest

from argo_env.navigation import Navigator
from argo_env.site import load_site

FLOOR_MATERIALS = {"grating", "concrete", "gravel"}


@pytest.fixture(scope="session")
def obstacles(umad_world):
    """The materials that the robot has to keep away from."""
    return sorted(set(umad_world.links) - FLOOR_MATERIALS)


def footprint_box(robot, low, high):
    """The corners of the robot between two heights."""
    foot = robot.footprint
    return (-foot.rear, -foot.half_width, low), (foot.front, foot.half_width, high)


@pytest.fixture(scope="session")
def hall(robot):
    """The navigator of the small test site: two floors, one flight."""
    return Navigator(load_site("darmstadt"), robot)
