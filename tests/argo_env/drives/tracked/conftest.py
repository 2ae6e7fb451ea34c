"""Worlds and bodies for the tracked robot, separate from the world of other tests."""

import pytest

from argo_env.drives.tracked.body import TrackedBody
from argo_env.drives.tracked.drive import TrackedDrive
from argo_env.world.world import World


@pytest.fixture(scope="package")
def ground(umad, robot):
    with World(umad, robot) as world:
        yield world


@pytest.fixture(scope="package")
def body(ground, robot):
    with TrackedBody(ground, robot) as body:
        yield body


@pytest.fixture(scope="package")
def drive(ground, robot):
    return TrackedDrive(ground, robot)
