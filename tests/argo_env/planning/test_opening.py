"""Opened sites: caches in memory and on disk change no result, whatever happens to them."""

import copy
import gc
import hashlib
import logging
import os
import pickle
import shutil
import subprocess
import sys
import weakref
from concurrent.futures import ThreadPoolExecutor

import pytest

from argo_compiler.base.errors import ArgoError, Conflict, Invalid, NotFound
from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Task
from argo_env.files import cache
from argo_env.files.parts import Parts
from argo_env.navigation import Blockage, Navigator
from argo_env.navigation import navigator as navigator_module
from argo_env.planning import OpenedSite, open_site
from argo_env.planning.catalog import make_catalog
from argo_env.planning.opening import forget_sites
from argo_env.planning.travel import SiteTravel
from argo_env.robot.spec import load_robot
from argo_env.site import load_site, make_site
from tests.processes import ROOT, run_python
from tests.yard import AWAY_FROM_THE_EDGE, SITE, site_of, write_site

DRAWN = "generated:floors=1,size=12x12,checkpoints=2,seed=1"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Use an empty cache for this test."""
    chosen = tmp_path / "cache"
    monkeypatch.setenv(cache.VARIABLE, str(chosen))
    forget_sites()
    yield chosen
    forget_sites()


@pytest.fixture
def yard_file(tmp_path):
    return written(tmp_path / "yard.yaml")


def written(path, **changes):
    return write_site(path, areas=AWAY_FROM_THE_EDGE, **changes)


def digest_of_results(navigator):
    """Return a digest of all results for a site, to the last bit: paths, times, views, names."""
    site, sink = navigator.site, hashlib.sha256()
    poses = [*site.docks.values(), *site.places.values()]
    poses += [Pose(x=x, y=y, z=z) for x, y, z, _ in navigator.turning_poses(1)[::97].tolist()[:4]]
    ids = [checkpoint.id for checkpoint in site.checkpoints]
    first = site.docks[min(site.docks)]
    path = navigator.plan(first, poses[-1])
    middle = path.motions[len(path.motions) // 2].pose_at(0.5)
    brick = Blockage((middle.x, middle.y, middle.x + 0.1, middle.y + 0.1), middle.z, "a brick")
    for one in (navigator, navigator.with_added_blockages([brick])):
        for start in poses[:2]:
            for goal in (*poses, *ids):
                try:
                    sink.update(repr(planned(one, start, goal)).encode())
                except ArgoError as error:
                    sink.update(str(error).encode())
        sink.update(navigator.travel_times([*poses, *ids]).tobytes())
        sink.update(navigator.travel_times_from(poses[-1], ids).tobytes())
        sink.update(repr([one.can_view(id) for id in ids]).encode())
    sink.update(repr([navigator.viewing_pose(id) for id in ids]).encode())
    sink.update(make_catalog(navigator).model_dump_json().encode())
    travel = SiteTravel(navigator)
    tasks = [Task(name=str(id), action=Action.MEASURE, object_id=str(id)) for id in (*ids, 99)]
    tasks += [Task(name=str(k), action=Action.WAYPOINT, pose=p) for k, p in enumerate(poses)]
    tasks.append(Task(name="far", action=Action.WAYPOINT, pose=Pose(x=90.0, y=0.0, z=0.0)))
    sink.update(repr([travel.leg_with_action(first, task, 0.2) for task in tasks]).encode())
    return sink.hexdigest()


def planned(navigator, start, goal):
    plan = navigator.plan if isinstance(goal, Pose) else navigator.plan_to_view
    return plan(start, goal)


def files_in(folder):
    return sorted(path for path in folder.rglob("*") if path.is_file())


def open_anew(reference):
    """Open a site as another process would."""
    forget_sites()
    return open_site(reference)


@pytest.mark.long
@pytest.mark.parametrize("reference", ["darmstadt", "yard"])
def test_what_is_on_disk_equals_what_is_found_anew(reference, yard_file, folder, monkeypatch):
    monkeypatch.setattr("argo_env.navigation.regions._MIN_STATES", 1000)  # as on large sites
    reference = yard_file if reference == "yard" else reference
    first = open_site(reference)
    plain = Navigator(make_site(first.site.spec), first.robot)
    anew = digest_of_results(plain)
    assert digest_of_results(first.navigator) == anew
    assert files_in(folder)
    for name in ("find_surface", "build_lattice"):
        monkeypatch.setattr(navigator_module, name, None)  # is not called any more
    again = open_anew(reference)
    assert again is not first
    assert again.site == first.site
    assert again.site.elements == first.site.elements
    assert digest_of_results(again.navigator) == anew
    assert again.navigator.lattice.costs.data.tobytes() == plain.lattice.costs.data.tobytes()
    assert again.catalog == first.catalog == make_catalog(plain)


@pytest.mark.long
def test_a_drawn_site_is_not_drawn_again(monkeypatch):
    first = open_site(DRAWN)
    dock, catalog = first.site.docks[1], first.catalog
    path, lattice = first.navigator.plan_to_view(dock, 2), first.navigator.lattice
    for name in ("find_surface", "build_lattice"):
        monkeypatch.setattr(navigator_module, name, None)
    monkeypatch.setattr("argo_env.planning.generated.draw_site_and_slots", None)
    again = open_anew(DRAWN)
    assert again is not first
    assert again.site == first.site
    assert again.site.elements == first.site.elements
    assert again.catalog == catalog
    assert again.navigator.plan_to_view(dock, 2) == path
    assert again.navigator.lattice.costs.data.tobytes() == lattice.costs.data.tobytes()


def test_ways_of_a_mission_come_from_disk_without_a_lattice(yard_file, monkeypatch):
    task = Task(name="one", action=Action.MEASURE, object_id="1")
    first = open_site(yard_file)
    dock = first.site.docks[1]
    leg, way = first.travel.leg_with_action(dock, task, None), first.travel.plan_path(dock, task)
    again = open_anew(yard_file)
    monkeypatch.setattr(Navigator, "lattice", None)
    assert again.travel.leg_with_action(dock, task, None) == leg
    assert again.travel.plan_path(dock, task) == way


def damaged(content):
    """Yield variants of a file's content, each damaged in another way."""
    middle = len(content) // 2
    yield b""
    yield content[:middle]
    yield content[:-1]
    yield content + b"\0"
    yield b"PK\x03\x04 another program's"
    for place in (0, 5, 15, 30, middle, len(content) - 1):
        place = min(place, len(content) - 1)
        yield content[:place] + bytes([content[place] ^ 0x10]) + content[place + 1 :]


@pytest.mark.long
def test_a_damaged_entry_is_made_anew(yard_file, folder, caplog):
    anew = digest_of_results(open_site(yard_file).navigator)
    whole = {path: path.read_bytes() for path in files_in(folder)}
    rounds = [[*damaged(content)] for content in whole.values()]
    for k in range(len(rounds[0])):
        for path, contents in zip(whole, rounds, strict=True):
            path.write_bytes(contents[k])
        caplog.clear()
        with caplog.at_level(logging.WARNING, "argo_env"):
            assert digest_of_results(open_anew(yard_file).navigator) == anew
        assert "made anew" in caplog.text
        assert {path: path.read_bytes() for path in files_in(folder)} == whole


@pytest.mark.parametrize("kind", ["surface", "lattice", "portals", "site", "first-dock"])
def test_one_part_may_be_gone(yard_file, folder, kind):
    anew = digest_of_results(open_site(yard_file).navigator)
    for path in folder.rglob(f"{kind}.npz"):
        path.unlink()
    assert digest_of_results(open_anew(yard_file).navigator) == anew


def test_an_entry_of_another_site_is_not_taken(yard_file, tmp_path, folder):
    anew = digest_of_results(open_site(yard_file).navigator)
    (own,) = (folder / "sites").iterdir()
    other = written(tmp_path / "other.yaml", ground=[0, 0, 8, 5], floors=[
        SITE["floors"][0] | {"walkways": {"slab": [0.5, 0.5, 7.5, 4.5]}}
    ])  # fmt: skip
    of_other = digest_of_results(open_site(other).navigator)
    assert of_other != anew
    (foreign,) = set((folder / "sites").iterdir()) - {own}
    shutil.rmtree(own)
    shutil.copytree(foreign, own)
    assert digest_of_results(open_anew(yard_file).navigator) == anew
    assert digest_of_results(open_anew(other).navigator) == of_other


def test_a_part_of_another_name_is_not_taken(tmp_path):
    parts = Parts(tmp_path, "key")
    parts.store_text("one", "a text")
    assert parts.load_text("one") == "a text"
    shutil.copy(tmp_path / "one.txt", tmp_path / "two.txt")
    assert parts.load_text("two") is None
    assert Parts(tmp_path, "another key").load_text("one") is None


PRINT_FOUND = """
import sys
from tests.argo_env.planning.test_opening import digest_of_results
from argo_env.planning import open_site
sys.stdin.readline()
print(digest_of_results(open_site(sys.argv[1]).navigator))
"""


@pytest.mark.long
def test_processes_that_write_at_the_same_time_do_no_harm(yard_file, folder):
    anew = digest_of_results(Navigator(load_site(yard_file), load_robot()))
    command = [sys.executable, "-c", PRINT_FOUND, yard_file]
    options = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "cwd": ROOT}
    running = [subprocess.Popen(command, **options) for _ in range(3)]
    for process in running:
        process.stdin.write("go\n")
        process.stdin.flush()
    said = [process.communicate()[0].strip() for process in running]
    assert said == [anew] * 3
    assert [process.returncode for process in running] == [0] * 3
    assert not [path for path in files_in(folder) if path.name.startswith(".")]
    assert digest_of_results(open_site(yard_file).navigator) == anew


def test_a_reader_beside_a_writer_sees_all_or_nothing(tmp_path):
    parts = Parts(tmp_path, "key")
    texts = [letter * 200_000 for letter in "ab"]
    with ThreadPoolExecutor(2) as pool:
        writing = pool.submit(lambda: [parts.store_text("x", t) for _ in range(100) for t in texts])
        seen = set()
        while not writing.done():
            seen.add(parts.load_text("x"))
    assert seen <= {None, *texts}


def test_threads_that_open_the_same_site_build_it_once(yard_file, monkeypatch):
    built = []
    build = navigator_module.build_lattice

    def counting(*arguments):
        built.append(arguments)
        return build(*arguments)

    monkeypatch.setattr(navigator_module, "build_lattice", counting)
    with ThreadPoolExecutor(8) as pool:
        sites = [*pool.map(lambda _: open_site(yard_file).prepare(), range(16))]
    assert len({id(site) for site in sites}) == 1
    assert len(built) == 1


@pytest.mark.parametrize("where", ["a file/cache", "\0", "x" * 300])
def test_a_folder_that_can_not_be_used_breaks_nothing(yard_file, tmp_path, monkeypatch, where):
    (tmp_path / "a file").write_text("", encoding="utf-8")
    anew = digest_of_results(Navigator(load_site(yard_file), load_robot()))
    monkeypatch.setattr(cache, "cache_folder", lambda: tmp_path / where)
    assert digest_of_results(open_site(yard_file).navigator) == anew
    assert cache.unwritable_reason()
    assert cache.contents() == cache.Contents(0, 0, 0)
    cache.clear()
    cache.evict()


def test_a_full_disk_breaks_nothing(yard_file, folder, monkeypatch):
    anew = digest_of_results(Navigator(load_site(yard_file), load_robot()))

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    assert digest_of_results(open_site(yard_file).navigator) == anew
    assert files_in(folder) == []


def test_the_cache_is_bounded_and_what_was_used_last_stays(yard_file, tmp_path, folder):
    others = [written(tmp_path / f"yard-{k}.yaml", title=f"Yard {k}") for k in range(3)]
    for reference in (yard_file, *others):
        open_site(reference).prepare()
    entries = [*(folder / "sites").iterdir()]
    for k, entry in enumerate(entries):
        os.utime(entry, (k, k))
    (folder / "sites" / "notes.txt").write_text("mine", encoding="utf-8")
    every = cache.contents()
    assert every.sites == 4
    cache.evict(max_size=every.size // 2 + 10_000)  # what is kept of robots is small
    assert set((folder / "sites").glob("?" * 32)) == set(entries[2:])
    cache.evict(max_files=0)
    assert cache.contents().files == 0
    assert (folder / "sites" / "notes.txt").exists()


def test_memory_is_bounded(yard_file, tmp_path):
    first = open_site(yard_file)
    assert open_site(yard_file) is first
    for k in range(8):
        open_site(written(tmp_path / f"yard-{k}.yaml", title=f"Yard {k}"))
    assert open_site(yard_file) is not first
    kept = weakref.ref(first.navigator)
    del first
    gc.collect()
    assert kept() is None


def test_a_file_that_has_changed_is_opened_anew(yard_file, tmp_path):
    before = open_site(yard_file)
    written(tmp_path / "yard.yaml", title="Another yard")
    after = open_site(yard_file)
    assert (before.site.spec.title, after.site.spec.title) == ("Yard", "Another yard")


def test_another_robot_is_another_site(yard_file):
    robot = load_robot()
    slow = robot.model_copy(update={"speed": 0.5 * robot.speed})
    usual, slowed = open_site(yard_file), open_site(yard_file, slow)
    assert open_site(yard_file, robot) is usual
    dock = usual.site.docks[1]
    times = [site.navigator.travel_times([dock, 1])[0, 1] for site in (usual, slowed)]
    assert times[0] < times[1]
    assert usual.digest != slowed.digest


# Pickling


def test_copies_are_the_same_site(yard_file):
    opened = open_site(yard_file)
    assert copy.copy(opened) is copy.deepcopy(opened) is opened
    assert copy.deepcopy([opened])[0] is opened
    assert pickle.loads(pickle.dumps(opened)) is opened


@pytest.mark.parametrize("kind", ["file", "made"])
def test_another_process_opens_it_itself(yard_file, tmp_path, kind):
    opened = open_site(yard_file)
    if kind == "made":
        opened = OpenedSite.from_site(site_of(name="made"))
    content = pickle.dumps(opened)
    assert len(content) < 10_000
    (tmp_path / "pickle").write_bytes(content)
    code = (
        "import pickle, sys; opened = pickle.load(open(sys.argv[1], 'rb'));"
        "print(opened.name, opened.reference, opened.digest, len(opened.catalog.checkpoints))"
    )
    said = run_python("-c", code, tmp_path / "pickle")
    assert said.stdout.split() == [opened.name, opened.reference, opened.digest, "3"]


def test_a_file_that_has_changed_meanwhile_is_refused(yard_file, tmp_path):
    content = pickle.dumps(open_site(yard_file))
    written(tmp_path / "yard.yaml", title="Another yard")
    with pytest.raises(Conflict, match=r"yard.yaml has changed since it was opened"):
        pickle.loads(content)
    (tmp_path / "yard.yaml").unlink()
    with pytest.raises(ArgoError, match="can't be read"):
        pickle.loads(content)


def test_a_site_with_something_in_the_way_is_not_pickled(umad):
    changed = umad.replacing_elements(umad.elements[:-1])
    opened = OpenedSite.from_site(changed)
    assert opened.site is changed
    with pytest.raises(Conflict, match="not as its description says"):
        pickle.dumps(opened)
    assert umad.replacing_elements(umad.elements) is umad


# What is not there


def test_drawn_sites_are_in_no_file():
    with pytest.raises(Invalid, match="open it with `open_site`"):
        load_site(DRAWN)


def test_however_its_parameters_are_written_it_is_the_same_site():
    drawn = open_site(DRAWN)
    assert open_site("generated:seed=1, checkpoints=2,size=12x12,floors=1,clutter=0.50") is drawn
    assert open_site(drawn.reference) is drawn


def test_what_is_not_there_is_named(umad):
    with pytest.raises(NotFound, match="no site `nowhere`; there are: darmstadt, umad"):
        open_site("nowhere")
    with pytest.raises(NotFound, match="no checkpoint 99; there are: 1 to 20"):
        umad.checkpoint(99)
    with pytest.raises(NotFound, match="no floor 9; there are: 1 to 6"):
        umad.floor(9)
    yard = OpenedSite.from_site(site_of())
    with pytest.raises(NotFound, match="no checkpoint 4; there are: 1 to 3"):
        yard.navigator.viewing_pose(4)
    with pytest.raises(NotFound, match="no floor 2; there are: 1"):
        yard.navigator.turning_poses(2)
