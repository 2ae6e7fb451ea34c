"""The UMAD site, its navigator, and the same site in PyBullet as an independent witness."""

import numpy as np
import pytest

import argo_env.world.world
from argo_compiler.script import read_script
from argo_env.files import resources
from argo_env.navigation import Navigator
from argo_env.planning import open_site
from argo_env.planning.catalog import make_catalog
from argo_env.robot.spec import load_robot
from argo_env.site import load_site
from argo_env.site.urdf import to_urdf
from argo_env.world.pybullet_client import pybullet
from tests import yard as the_yard
from tests.whole_scripts import import_whole
from tests.yard import Watching, opened, simulated

_WITH_PYBULLET = {"client", "umad_world", "simulated_world", "sheet_run", "protocol_record"}
"""fixtures below that need PyBullet"""


def pytest_itemcollected(item):
    """Mark the tests that use one of these fixtures."""
    if _WITH_PYBULLET & set(getattr(item, "fixturenames", ())):
        item.add_marker("physics")


class World:
    """A site in a PyBullet server of its own. Links are addressed by the material they carry."""

    def __init__(self, urdf_file):
        self._client = pybullet.connect(pybullet.DIRECT)
        self.body = pybullet.loadURDF(
            str(urdf_file), useFixedBase=True, physicsClientId=self._client
        )
        self.links = {
            self.ask("getJointInfo", self.body, n)[12].decode(): n
            for n in range(self.ask("getNumJoints", self.body))
        }
        self._names = {number: name for name, number in self.links.items()}
        self._probes = {}

    def ask(self, function, *arguments, **options):
        return getattr(pybullet, function)(*arguments, **options, physicsClientId=self._client)

    def rays(self, starts, ends):
        """For each ray the material it hits first and the point, or (None, None)."""
        hits = []
        for first in range(0, len(starts), 8000):
            batch = slice(first, first + 8000)
            hits += self.ask(
                "rayTestBatch", np.asarray(starts)[batch].tolist(), np.asarray(ends)[batch].tolist()
            )
        return [
            (self._names[link], np.array(point)) if body == self.body else (None, None)
            for body, link, _, point, _ in hits
        ]

    def touched(self, low, high, center, yaw=0.0, materials=None):
        """Materials that overlap the box from `low` to `high` (m) in the frame at `center`, `yaw`.

        Only `materials` are looked at, if given. An overlap of a micrometre is none.
        """
        size = tuple(np.round((np.array(high) - np.array(low)) / 2, 6).tolist())
        if size not in self._probes:
            shape = self.ask("createCollisionShape", pybullet.GEOM_BOX, halfExtents=size)
            self._probes[size] = self.ask("createMultiBody", 0, shape)
        probe = self._probes[size]
        middle = (np.array(low) + np.array(high)) / 2
        cos, sin = np.cos(yaw), np.sin(yaw)
        offset = [middle[0] * cos - middle[1] * sin, middle[0] * sin + middle[1] * cos, middle[2]]
        pose = (np.array(center) + offset).tolist(), pybullet.getQuaternionFromEuler([0, 0, yaw])
        self.ask("resetBasePositionAndOrientation", probe, *pose)
        found = {
            material
            for material in materials or self.links
            for contact in self.ask(
                "getClosestPoints", probe, self.body, 0.0, -1, self.links[material]
            )
            if contact[8] < -1e-6
        }
        # Out of the way of later rays.
        self.ask("resetBasePositionAndOrientation", probe, [0, 0, -100], [0, 0, 0, 1])
        return found

    def close(self):
        pybullet.disconnect(self._client)


@pytest.fixture(scope="session")
def robot():
    return load_robot()


@pytest.fixture(scope="session")
def umad():
    return load_site("umad")


@pytest.fixture(scope="session")
def navigator(umad, robot):
    # With what others have found, in this run of the tests or in another process of it.
    navigator = Navigator(umad, robot, open_site("umad").navigator.parts)
    assert navigator.lattice.size > 0
    return navigator


@pytest.fixture(scope="session")
def yard():
    """The navigator of the yard."""
    return the_yard.yard()


@pytest.fixture(scope="session")
def site(yard):
    """The yard, opened."""
    return opened(yard)


@pytest.fixture(scope="module")
def client():
    """A PyBullet server without a site."""
    client = pybullet.connect(pybullet.DIRECT)
    yield client
    pybullet.disconnect(client)


@pytest.fixture(scope="session")
def umad_urdf(umad, tmp_path_factory):
    path = tmp_path_factory.mktemp("site") / "umad.urdf"
    path.write_text(to_urdf(umad.name, umad.elements), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def umad_world(umad_urdf):
    world = World(umad_urdf)
    yield world
    world.close()


@pytest.fixture(scope="session")
def simulated_world(umad, robot):
    """The world that Argo runs missions in, to place the robot in and look."""
    with argo_env.world.world.World(umad, robot) as world:
        yield world


@pytest.fixture(scope="session")
def catalog(navigator):
    return make_catalog(navigator)


@pytest.fixture(scope="session")
def shipped(catalog):
    """A shipped script by name, imported."""

    def imported(name, **areas):
        path = resources.scenarios_folder() / "umad" / "missions" / name
        return import_whole(read_script(path), catalog, **areas)

    return imported


@pytest.fixture(scope="session")
def sheet_run(shipped, navigator):
    """Mission #1, run from area 1 to area 2: the mission's record and what the observer saw."""
    seen = []
    mission = shipped("mission_1.txt", start_area=1, end_area=2).mission
    record = simulated(
        mission, navigator, seed=3, observers=[Watching(lambda *now: seen.append(now))]
    )
    return record, seen


@pytest.fixture(scope="session")
def protocol_record(shipped, navigator):
    """The record of protocol #2."""
    return simulated(shipped("protocol_2.txt").mission, navigator, seed=3)
