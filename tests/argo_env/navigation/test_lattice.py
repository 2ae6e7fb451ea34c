from itertools import pairwise

import numpy as np
import pytest

from argo_env.navigation.lattice import LEVEL
from argo_env.navigation.raster import CELL
from argo_env.navigation.surface import DIRECTIONS
from argo_env.site.shapes import Role
from tests.argo_env.navigation.conftest import FLOOR_MATERIALS, footprint_box


@pytest.fixture(scope="module")
def surface(navigator):
    return navigator.surface


def some(count, size, seed):
    return np.random.default_rng(seed).choice(size, min(count, size), replace=False)


def test_every_cell_lies_on_the_site(surface, umad_world):
    positions = surface.cell_positions()
    up = np.array([0.0, 0.0, 0.3])
    hits = umad_world.rays(positions + up, positions - up)
    assert {material for material, _ in hits} == FLOOR_MATERIALS
    heights = np.array([point[2] for _, point in hits])
    assert np.abs(heights - surface.z).max() < 0.01


def obstructing_materials(world, center, headroom, obstacles):
    """Return the materials in a cell that are above the height that the robot climbs."""
    half = CELL / 2 + 0.003  # PyBullet's cylinders are prisms, and 4 mm thinner between the edges
    touched = world.touched((-half, -half, 0.02), (half, half, headroom), center, 0.0, obstacles)
    step = world.touched(
        (-half, -half, 0.21), (half, half, headroom), center, materials=sorted(FLOOR_MATERIALS)
    )
    return touched | step


def test_cells_are_free_of_obstacles(surface, umad_world, robot, obstacles):
    for center in surface.cell_positions()[some(1500, surface.size, seed=1)]:
        # A rail's corner may reach into a cell between two samples.
        half = CELL / 2 - 0.015
        assert not umad_world.touched(
            (-half, -half, 0.02),
            (half, half, robot.driving_height - 0.01),
            center,
            materials=obstacles,
        ), center


def test_decks_are_traversable_except_at_obstacles(umad, surface, umad_world, robot, obstacles):
    grid, unexplained, obstructed = surface.grid, [], 0
    for floor in umad.spec.floors:
        i, j = (a.ravel() for a in np.meshgrid(range(grid.nx), range(grid.ny), indexing="ij"))
        x, y = grid.centers(i, j)
        on = np.zeros(len(x), dtype=bool)
        for x0, y0, x1, y1 in floor.walkways.values():
            on |= (x > x0) & (x < x1) & (y > y0) & (y < y1)
        for x0, y0, x1, y1 in floor.openings.values():
            on &= ~((x > x0) & (x < x1) & (y > y0) & (y < y1))
        # The first tread of a flight is one rise above the deck.
        level = (surface.z > floor.z - 0.01) & (surface.z < floor.z + robot.max_step)
        on &= ~np.isin(i * grid.ny + j, (surface.i * grid.ny + surface.j)[level])
        missing = np.flatnonzero(on)
        obstructed += len(missing)
        for n in missing[some(120, len(missing), seed=floor.number)]:
            center = (x[n], y[n], floor.z)
            if not obstructing_materials(umad_world, center, robot.driving_height, obstacles):
                unexplained.append(center)
    assert unexplained == []
    assert obstructed > 500


def test_decks_over_each_other_are_layers(umad, surface):
    """The north aisle is on every upper floor, above the slab."""
    at = (np.abs(surface.cell_positions()[:, :2] - [6.05, 10.45]) < 0.01).all(axis=1)
    assert surface.z[at] == pytest.approx([f.z for f in umad.spec.floors])


def test_openings_have_no_cells(umad, surface):
    x, y, z = surface.cell_positions().T
    openings = [(f.z, r) for f in umad.spec.floors for r in f.openings.values()]
    assert openings
    for floor_z, (x0, y0, x1, y1) in openings:
        inside = (x > x0) & (x < x1) & (y > y0) & (y < y1)
        assert not (inside & (np.abs(z - floor_z) < 0.3)).any()
        assert inside.any(), "the floor below goes on under the opening"


def test_links_lead_to_the_neighbour_and_back(surface, robot):
    for k, (di, dj) in enumerate(DIRECTIONS):
        here = np.flatnonzero(surface.links[:, k] >= 0)
        there = surface.links[here, k]
        assert (surface.i[there] - surface.i[here] == di).all()
        assert (surface.j[there] - surface.j[here] == dj).all()
        assert np.abs(surface.z[there] - surface.z[here]).max() <= robot.max_step
        assert (surface.links[there, (k + 4) % 8] == here).all()


def test_consecutive_treads_are_linked(umad, surface):
    """Links lead from the cell in the middle of each tread to the next tread."""
    x, y, z = surface.cell_positions().T
    checked = 0
    for element in umad.elements:
        if element.role != Role.STAIR:
            continue
        treads = sorted(element.solids, key=lambda s: s.center[2])
        for below, above in pairwise(treads):
            step = np.subtract(above.center, below.center)
            direction = DIRECTIONS.index(tuple(np.round(step[:2] / 0.28).astype(int).tolist()))
            top = below.center[2] + below.size[2] / 2
            near = np.hypot(x - below.center[0], y - below.center[1]) + 10 * np.abs(z - top)
            cell = int(np.argmin(near))
            for _ in range(3):
                cell = surface.links[cell, direction]
                assert cell >= 0
            assert z[cell] == pytest.approx(top + step[2], abs=0.001)
            checked += 1
    assert checked == 5 * (12 + 5 + 5)


@pytest.fixture(scope="module")
def lattice(navigator):
    return navigator.lattice


def test_the_whole_footprint_is_free_in_every_state(lattice, umad_world, robot, obstacles):
    flat = np.flatnonzero(np.abs(lattice.rise) < 1e-6)
    chosen = np.random.default_rng(2).choice(flat, 1500, replace=False)
    low, high = footprint_box(robot, 0.06, robot.driving_height - 0.01)
    for x, y, z, yaw in lattice.state_poses()[chosen]:
        touched = umad_world.touched(low, high, (x, y, z), yaw, obstacles)
        assert not touched, (x, y, z, yaw, touched)


@pytest.mark.parametrize(("degrees", "touched"), [(0, set()), (45, {"railing"}), (90, {"railing"})])
def test_the_narrowest_aisle_admits_the_robot_along_it_only(
    lattice, umad_world, robot, degrees, touched
):
    """This also shows that PyBullet's boxes touch the railings."""
    low, high = footprint_box(robot, 0.06, robot.driving_height - 0.01)
    at = (3.95, 5.55, 5.0)
    assert umad_world.touched(low, high, at, np.radians(degrees)) - FLOOR_MATERIALS == touched
    (cell,) = np.flatnonzero(np.abs(lattice.surface.cell_positions() - at).max(axis=1) < 0.01)
    assert (lattice.state_of[cell, degrees // 45] >= 0) == (not touched)


def test_the_whole_footprint_is_supported_in_every_state(lattice, umad_world, robot):
    """Rays down from points of the footprint hit the floor within the height of a step."""
    foot = robot.footprint
    along, left = np.meshgrid(
        np.linspace(-foot.rear, foot.front, 5), np.linspace(-foot.half_width, foot.half_width, 3)
    )
    flat = np.flatnonzero(np.abs(lattice.rise) < 1e-6)
    chosen = np.random.default_rng(3).choice(flat, 1000, replace=False)
    poses = lattice.state_poses()[chosen]
    cos, sin = np.cos(poses[:, 3])[:, None], np.sin(poses[:, 3])[:, None]
    x = poses[:, 0, None] + along.ravel() * cos - left.ravel() * sin
    y = poses[:, 1, None] + along.ravel() * sin + left.ravel() * cos
    z = np.broadcast_to(poses[:, 2, None], x.shape)
    starts = np.stack([x, y, z + 0.25], axis=-1).reshape(-1, 3)
    hits = umad_world.rays(starts, starts - [0, 0, 0.5])
    heights = np.array([np.nan if point is None else point[2] for _, point in hits])
    assert {material for material, _ in hits} <= FLOOR_MATERIALS
    assert np.abs(heights - z.ravel()).max() <= robot.max_step + 0.01


def test_the_front_is_never_the_higher_end(lattice):
    assert lattice.rise.max() <= LEVEL
    assert lattice.rise.min() < -0.5


def test_every_state_has_its_cell_and_heading(lattice):
    states = lattice.state_of[lattice.cell, lattice.heading]
    assert (states == np.arange(lattice.size)).all()
    assert (lattice.state_of >= 0).sum() == lattice.size


def test_moves_are_drives_to_a_neighbour_or_turns_in_place(lattice, robot):
    moves = lattice.costs.tocoo()
    source, target = moves.coords
    poses = lattice.state_poses()
    turned = (lattice.heading[target] - lattice.heading[source]) % 8
    still = lattice.cell[source] == lattice.cell[target]
    assert np.isin(turned[still], [1, 7]).all()
    assert (turned[~still] == 0).all()
    step = poses[target] - poses[source]
    yaw = poses[source, 3]
    aside = step[:, 1] * np.cos(yaw) - step[:, 0] * np.sin(yaw)
    assert np.abs(aside).max() < 1e-9
    assert np.abs(lattice.rise[source][still]).max() <= LEVEL
    # No move takes less time than its length at the highest speed, or its angle at the turn rate.
    length = np.hypot(step[:, 0], step[:, 1])
    assert (moves.data[~still] >= length[~still] / robot.speed - 1e-9).all()
    assert (moves.data[still] >= np.pi / 4 / robot.turn_rate_radians - 1e-9).all()


def test_backwards_up_and_forwards_down(lattice):
    moves = lattice.costs.tocoo()
    source, target = moves.coords
    poses = lattice.state_poses()
    step = poses[target] - poses[source]
    steep = (lattice.rise[source] + lattice.rise[target]) / 2 < -LEVEL
    ahead = step[:, 0] * np.cos(poses[source, 3]) + step[:, 1] * np.sin(poses[source, 3])
    up, down = steep & (step[:, 2] > 0.01), steep & (step[:, 2] < -0.01)
    assert up.any()
    assert down.any()
    assert (ahead[up] < 0).all()
    assert (ahead[down] > 0).all()


def test_turns_touch_nothing_between_two_headings(lattice, umad_world, robot, obstacles):
    moves = lattice.costs.tocoo()
    source, target = moves.coords
    turns = np.flatnonzero(
        (lattice.cell[source] == lattice.cell[target])
        & ((lattice.heading[target] - lattice.heading[source]) % 8 == 1)
    )
    low, high = footprint_box(robot, 0.06, robot.driving_height - 0.01)
    poses = lattice.state_poses()
    for turn in np.random.default_rng(4).choice(turns, 300, replace=False):
        x, y, z, yaw = poses[source[turn]]
        for share in (0.25, 0.5, 0.75):
            touched = umad_world.touched(low, high, (x, y, z), yaw + share * np.pi / 4, obstacles)
            assert not touched, (x, y, z, yaw, share)
