"""Simulations in several threads give the same results as alone, and don't change the process."""

import gc
import math
import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from argo_compiler.base.garbage_collector import collector_held
from argo_env.drives.tracked.body import TrackedBody
from argo_env.planning.opening import open_site
from argo_env.robot.pose import BodyPose
from argo_env.run.record import RunRecord
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_env.world.world import World, pybullet
from tests.processes import run_python
from tests.whole_scripts import import_whole
from tests.yard import write_site

pytestmark = pytest.mark.long

THREADS = 8
DRIVES = ("kinematic", "tracked", "kinematic", "route") * 2
SCRIPT = """Mission Protocol #{k}
Maximum duration: 20 min
If the battery is low, return to the docking station.
1. Set the starting point in starting area 1.
2. Check checkpoint #{first}.
3. Check checkpoint #{second}, retry twice. If the value is above 4 bar, skip to step 5.
4. Check chekpoint #{third}.
5. Return to the docking station in starting area 1.
"""


def run(file: str, k: int) -> RunRecord:
    """Return the record of the k-th mission, compiled from its script."""
    opened = open_site(file)
    first, second, third = (1 + (k + part) % 3 for part in range(3))
    script = SCRIPT.format(k=k, first=first, second=second, third=third)
    imported = import_whole(script, opened.catalog)
    spec = RunSpec.model_validate(
        {
            "mission": imported.mission,
            "site": file,
            "drive": DRIVES[k],
            "sensor": "camera" if k % 4 == 2 else "ideal",
            "seed": k,
            "faults": [{"kind": "low_battery", "seed": k}],
            "diagnostics": imported.diagnostics,
        }
    )
    return simulate(spec, opened)


@pytest.fixture
def site(tmp_path):
    return write_site(tmp_path / "yard.yaml")


@pytest.fixture
def hasty():
    """Threads switch a hundred times as often as usual."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(5e-5)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("hasty")
def test_eight_threads_give_the_records_that_they_give_alone(site):
    alone = [run(site, k) for k in range(THREADS)]
    assert len({record.model_dump_json() for record in alone}) == THREADS
    with ThreadPoolExecutor(THREADS) as pool:
        assert list(pool.map(run, [site] * THREADS, range(THREADS))) == alone
    assert gc.isenabled()


def contacts_at(world, x, y):
    """Return PyBullet's contacts of the robot at this position, also those with a gap."""
    world.place_robot(BodyPose(x, y, 0.02, math.radians(-90)))
    world.touches()
    client = world._client
    body = next(
        number
        for number in range(pybullet.getNumBodies(physicsClientId=client))
        if pybullet.getBodyInfo(number, physicsClientId=client)[1] == b"tracker"
    )
    contacts = pybullet.getContactPoints(bodyA=body, physicsClientId=client)
    return sorted((c[2:5], round(c[8], 6)) for c in contacts)


def test_a_tracked_body_changes_nothing_for_other_worlds(site):
    """PyBullet has only one contact threshold for all of its connections."""
    opened = open_site(site)
    positions = [(1.0 + 0.2 * k, 0.9 + 0.01 * k) for k in range(12)]
    with World(opened.site, opened.robot) as world, World(opened.site, opened.robot) as other:
        before = [contacts_at(world, *position) for position in positions]
        with TrackedBody(other, opened.robot) as body:
            body.reset(BodyPose(2.0, 2.0, 0.02, 0.0))
            assert [contacts_at(world, *position) for position in positions] == before
            body.advance(5)
            assert [contacts_at(world, *position) for position in positions] == before


_BESIDE = """
import os, sys, threading

written, over = 0, threading.Event()

def write():
    global written
    while not over.is_set():
        os.write(1, b"out\\n")
        os.write(2, b"err\\n")
        written += 1
        over.wait(0.0002)

before = [os.fstat(fd) for fd in (1, 2)]
thread = threading.Thread(target=write, daemon=True)
thread.start()
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from argo_env.pictures import overview, write_film, write_overview
from argo_env.planning.opening import open_site
from tests.argo_env.world import test_threads

overview.SIZE, overview._FINER, overview._SHADOW_MAP = (160, 120), 1, 80
file = sys.argv[1]
with ThreadPoolExecutor(4) as pool:  # each drive and the camera
    records = list(pool.map(test_threads.run, [file] * 4, range(4)))
opened, folder = open_site(file), Path(file).parent
write_film(records[0], opened.site, opened.robot, folder / "film.gif", speed=60.0, size=(64, 64))
write_overview(records[1], opened.site, opened.robot, folder / "site.png")
over.set()
thread.join()
assert [os.fstat(fd)[:3] for fd in (1, 2)] == [one[:3] for one in before]
import ctypes
libc = ctypes.CDLL(None)
libc.puts(b"from C")
libc.fflush(None)
print(written, flush=True)
"""


def test_the_output_of_other_threads_is_not_lost(site):
    """Nothing is lost from the first import on, and PyBullet prints nothing."""
    completed = run_python("-c", _BESIDE, site)
    *lines, from_c, count = completed.stdout.splitlines()
    assert from_c == "from C"
    assert lines == ["out"] * int(count)
    assert completed.stderr.splitlines() == ["err"] * int(count)


def test_the_collector_comes_back():
    """It is enabled again after any overlap of the threads that disable it."""
    meet, part = threading.Barrier(4), threading.Barrier(4)
    seen = []

    def hold():
        for _ in range(50):
            meet.wait()
            with collector_held(), collector_held():
                seen.append(gc.isenabled())
            part.wait()
            if not gc.isenabled():
                raise AssertionError("the collector is still off")

    with ThreadPoolExecutor(4) as pool:
        for future in [pool.submit(hold) for _ in range(4)]:
            future.result()
    assert False in seen
    gc.disable()
    try:
        with collector_held():
            assert not gc.isenabled()
        assert not gc.isenabled()
    finally:
        gc.enable()
