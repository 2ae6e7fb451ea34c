"""Fixtures: the plant, its map and its world, without faults."""

import pytest

from argo_env.sensing.signals.site_map import SiteMap
from argo_env.world.world import World
from tests.argo_env.sensing.signals.plant import plant


@pytest.fixture(scope="session")
def site():
    return plant()


@pytest.fixture(scope="session")
def site_map(site):
    return SiteMap(site)


@pytest.fixture(scope="session")
def world(site, robot):
    with World(site, robot) as world:
        yield world
