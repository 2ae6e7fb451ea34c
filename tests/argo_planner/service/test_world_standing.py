"""Maps of where the robot can stand agree with the navigator."""

import json
import math
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from argo_compiler.base.errors import Invalid, NotFound, Unreachable
from argo_compiler.base.model import Pose
from argo_env.navigation.lattice import build_lattice
from argo_env.navigation.navigator import SNAP_DISTANCE, nearest_state
from argo_env.navigation.stencil import HEADINGS
from argo_planner.service.world.obstacles import Obstacle, with_obstacles
from argo_planner.service.world.standing_map import Ground, read_standing_map, standing_map

FLOORS = range(1, 7)


def crate(id, x, y, z, size=(0.5, 0.4, 1.0), yaw=0.0):
    return Obstacle(id=id, name=f"crate {id}", pose=Pose(x=x, y=y, z=z, yaw=yaw), size=size)


@pytest.fixture(scope="module")
def crates(site):
    """Four crates at random poses on the deck of floor 2."""
    rng = np.random.default_rng(5)
    places = site.navigator.turning_poses(2)
    chosen = places[rng.choice(len(places), 4, replace=False)]
    return tuple(
        crate(str(k), x, y, z, yaw=0.4 * k) for k, (x, y, z, _) in enumerate(chosen.tolist())
    )


def maps_of(site, obstacles=()):
    maps = {
        (floor, heading): standing_map(site, floor, heading, obstacles)
        for floor in FLOORS
        for heading in range(HEADINGS)
    }
    return {key: read_standing_map(one.to_bytes()) for key, one in maps.items()}


@pytest.fixture(scope="module")
def maps(site):
    return maps_of(site)


def cells_of(one):
    """Return the positions and the codes of all cells with ground."""
    layer, row, column = np.nonzero(one.codes)
    x = one.origin[0] + (column + 0.5) * one.cell
    y = one.origin[1] + (row + 0.5) * one.cell
    z = one.z + one.heights[layer, row, column] / 1000
    return np.column_stack([x, y, z]), one.codes[layer, row, column]


def poses_of(maps, rng, count):
    """Yield poses above random cells of random maps, with their codes and maps.

    Each code of a map is equally likely.
    """
    for _ in range(count):
        one = maps[int(rng.choice(FLOORS)), int(rng.integers(HEADINGS))]
        places, codes = cells_of(one)
        code = rng.choice(np.unique(codes))
        x, y, z = places[rng.choice(np.flatnonzero(codes == code))].tolist()
        yield Pose(x=x, y=y, z=z, yaw=one.yaw), Ground(int(code)), one


def is_state(lattice, pose):
    state = nearest_state(lattice, pose)
    if state is None:
        return False
    x, y, z, yaw = lattice.state_poses(np.array([state]))[0]
    here = math.dist((x, y, z), (pose.x, pose.y, pose.z)) < 2e-3
    return here and abs(yaw - pose.yaw) < 1e-6


def test_all_cells_of_the_surface_are_on_one_floor(site, maps):
    lattice, surface = site.navigator.lattice, site.navigator.surface
    for heading in range(HEADINGS):
        codes = [cells_of(maps[floor, heading])[1] for floor in FLOORS]
        assert sum(map(len, codes)) == surface.size
        reached = sum(int((c == Ground.REACHED).sum()) for c in codes)
        assert reached == int((lattice.heading == heading).sum())


def test_the_map_has_the_poses_of_the_navigator(site, maps):
    rng, lattice = np.random.default_rng(1), site.navigator.lattice
    seen = set()
    for pose, code, one in poses_of(maps, rng, 300):
        assert one.ground_at(pose.x, pose.y, pose.z) is code
        assert is_state(lattice, pose) == (code is Ground.REACHED), (pose, code)
        seen.add(code)
    assert seen >= {Ground.TOO_NEAR, Ground.TOO_STEEP, Ground.CUT_OFF, Ground.REACHED}


def test_the_robot_could_stand_where_it_is_cut_off_but_not_too_near_or_too_steep(site, maps):
    everything = build_lattice(site.navigator.surface, site.robot)
    for pose, code, _ in poses_of(maps, np.random.default_rng(2), 200):
        assert is_state(everything, pose) == (code in (Ground.CUT_OFF, Ground.REACHED))


def test_the_robot_reaches_the_poses_that_are_marked_so(site, maps):
    dock = site.site.docks[1]
    reached = 0
    for pose, code, _ in poses_of(maps, np.random.default_rng(3), 60):
        if code is Ground.REACHED:
            end = site.navigator.plan(dock, pose).end
            assert math.dist((end.x, end.y, end.z), (pose.x, pose.y, pose.z)) < 2e-3
            assert math.cos(end.yaw - pose.yaw) > 1 - 1e-6
            reached += 1
    assert reached > 10


def test_a_pose_is_accepted_near_a_reached_one(site, maps):
    rng = np.random.default_rng(4)
    near = [cells_of(one) for one in maps.values()]
    places = np.vstack([p[c == Ground.REACHED] for p, c in near])
    x0, y0, x1, y1 = site.site.spec.ground
    taken = set()
    for _ in range(200):
        x, y = rng.uniform(x0, x1), rng.uniform(y0, y1)
        z = float(rng.choice([0.0, 2.5, 5.0])) + rng.uniform(-0.6, 0.6)
        away = np.hypot(places[:, 0] - x, places[:, 1] - y) + np.abs(places[:, 2] - z)
        if abs(away.min() - SNAP_DISTANCE) < 2e-3:
            continue
        expected = away.min() < SNAP_DISTANCE
        try:
            site.navigator.snap_keeping_heading(Pose(x=x, y=y, z=z))
            assert expected
        except Unreachable:
            assert not expected
        taken.add(bool(expected))
    assert taken == {True, False}


def test_with_obstacles_the_map_agrees_with_planned_paths(site, crates):
    maps, navigator = maps_of(site, crates), with_obstacles(site, crates).navigator
    dock, seen = site.site.docks[1], set()
    for pose, code, _ in poses_of(maps, np.random.default_rng(6), 250):
        if code is Ground.CLOSED:
            assert is_state(site.navigator.lattice, pose)
            assert not is_state(navigator.lattice, pose)
        elif code is Ground.REACHED:
            assert is_state(navigator.lattice, pose)
            if len(seen) < 12:
                end = navigator.plan(dock, pose).end
                assert math.dist((end.x, end.y), (pose.x, pose.y)) < 2e-3
        elif code is Ground.CUT_OFF and is_state(navigator.lattice, pose):
            with pytest.raises(Unreachable):
                navigator.plan(dock, pose)
        seen.add((code, pose.x))
    assert {code for code, _ in seen} >= {Ground.CLOSED, Ground.REACHED}


def test_an_obstacle_closes_only_poses_at_which_the_robot_would_touch_it(site):
    x, y, z, _ = site.navigator.turning_poses(3)[40].tolist()
    box = crate("a", x, y, z, (0.6, 0.3, 0.5), yaw=0.7)
    robot = site.robot.footprint
    reach, inner = robot.radius + 0.6, robot.half_width
    for heading in range(HEADINGS):
        before, after = (standing_map(site, 3, heading, o) for o in ((), (box,)))
        changed = before.codes != after.codes
        assert set(np.unique(after.codes[changed])) <= {Ground.CLOSED, Ground.CUT_OFF}
        places, codes = cells_of(after)
        away = np.hypot(places[:, 0] - x, places[:, 1] - y)
        assert away[codes == Ground.CLOSED].max(initial=0) < reach
        assert not (codes[away < inner] == Ground.REACHED).any()
        places, codes = cells_of(standing_map(site, 2, heading, (box,)))
        assert (codes[places[:, 2] < z - 1.0] != Ground.CLOSED).all()


def test_an_obstacle_above_the_robot_closes_nothing(site):
    x, y, z, _ = site.navigator.turning_poses(6)[10].tolist()
    beam = crate("beam", x, y, z + site.robot.driving_height + 0.1, (1.0, 1.0, 0.3))
    assert (standing_map(site, 6, 0, (beam,)).codes == standing_map(site, 6, 0).codes).all()


def test_unknown_floors_headings_and_maps_are_refused(site):
    with pytest.raises(NotFound):
        standing_map(site, 8, 0)
    with pytest.raises(Invalid, match="no heading 8"):
        standing_map(site, 1, 8)
    with pytest.raises(Invalid, match="not a map"):
        read_standing_map(b"{}\nnothing")
    twice = crate("a", 0, 0, 0), crate("a", 1, 1, 0)
    with pytest.raises(Invalid, match="two obstacles"):
        with_obstacles(site, twice)


@pytest.mark.skipif(shutil.which("node") is None, reason="needs node")
def test_the_documented_reader_of_a_map_is_right(site, tmp_path):
    page = Path(__file__).parents[3] / "docs" / "service.md"
    (reader,) = re.findall("```js\n(.*?)```", page.read_text(encoding="utf-8"), re.DOTALL)
    one = standing_map(site, 1, 3)
    (tmp_path / "map").write_bytes(one.to_bytes())
    script = f"""
const content = require("fs").readFileSync({json.dumps(str(tmp_path / "map"))});
globalThis.fetch = async () => new Response(content);
{reader}
readMap("map").then((map) => {{
  const count = map.layers * map.rows * map.columns;
  const cells = [...Array(count).keys()].filter((k) => k % 997 == 0 || k >= count - 500);
  console.log(JSON.stringify(cells.map((k) => [k, map.code(k), map.height(k)])));
}});
"""
    (tmp_path / "read.js").write_text(script, encoding="utf-8")
    output = subprocess.run(
        ["node", tmp_path / "read.js"], capture_output=True, text=True, check=True
    ).stdout
    cells = json.loads(output)
    assert len(cells) > 500
    for k, code, height in cells:
        assert code == one.codes.ravel()[k]
        assert height == pytest.approx(one.z + one.heights.ravel()[k] / 1000)
