"""The walkable surface of UMAD against rays and boxes of PyBullet."""

from itertools import pairwise

import numpy as np
import pytest

from argo_env.navigation.raster import CELL
from argo_env.navigation.surface import DIRECTIONS
from argo_env.site.shapes import Role

FLOOR_MATERIALS = {"grating", "concrete", "gravel"}


@pytest.fixture(scope="module")
def surface(navigator):
    return navigator.surface


def some(count, size, seed):
    return np.random.default_rng(seed).choice(size, min(count, size), replace=False)


def test_every_cell_lies_on_the_site(surface, umad_world):
    positions = surface.positions()
    up = np.array([0.0, 0.0, 0.3])
    hits = umad_world.rays(positions + up, positions - up)
    assert {material for material, _ in hits} == FLOOR_MATERIALS
    heights = np.array([point[2] for _, point in hits])
    assert np.abs(heights - surface.z).max() < 0.01


def obstacles(world, center, headroom):
    """What stands in a cell above what the robot climbs."""
    half = CELL / 2 + 0.003  # PyBullet's cylinders are prisms, and 4 mm thinner between the edges
    materials = set(world.links) - FLOOR_MATERIALS
    found = world.touched(
        (-half, -half, 0.02), (half, half, headroom), center, materials=sorted(materials)
    )
    step = world.touched(
        (-half, -half, 0.21), (half, half, headroom), center, materials=sorted(FLOOR_MATERIALS)
    )
    return found | step


def test_cells_are_free_of_obstacles(surface, umad_world, robot):
    for center in surface.positions()[some(1500, surface.size, seed=1)]:
        # A rail's corner may reach into a cell between two samples.
        half = CELL / 2 - 0.015
        assert not umad_world.touched(
            (-half, -half, 0.02),
            (half, half, robot.driving_height - 0.01),
            center,
            materials=sorted(set(umad_world.links) - FLOOR_MATERIALS),
        ), center


def test_what_is_not_walkable_on_a_deck_has_a_reason(umad, surface, umad_world, robot):
    """Everywhere on the floors the surface goes on, or something stands there."""
    grid, unexplained, obstructed = surface.grid, [], 0
    for floor in umad.spec.floors:
        i, j = (a.ravel() for a in np.meshgrid(range(grid.nx), range(grid.ny), indexing="ij"))
        x, y = grid.centers(i, j)
        on = np.zeros(len(x), dtype=bool)
        for x0, y0, x1, y1 in floor.walkways.values():
            on |= (x > x0) & (x < x1) & (y > y0) & (y < y1)
        for x0, y0, x1, y1 in floor.openings.values():
            on &= ~((x > x0) & (x < x1) & (y > y0) & (y < y1))
        # The first tread of a flight lies one rise over the deck.
        level = (surface.z > floor.z - 0.01) & (surface.z < floor.z + robot.max_step)
        on &= ~np.isin(i * grid.ny + j, (surface.i * grid.ny + surface.j)[level])
        missing = np.flatnonzero(on)
        obstructed += len(missing)
        for n in missing[some(120, len(missing), seed=floor.number)]:
            center = (x[n], y[n], floor.z)
            if not obstacles(umad_world, center, robot.driving_height):
                unexplained.append(center)
    assert unexplained == []
    assert obstructed > 500


def test_decks_over_each_other_are_layers(umad, surface):
    """On the north aisle, which every upper floor has over the slab."""
    at = (np.abs(surface.positions()[:, :2] - [6.05, 10.45]) < 0.01).all(axis=1)
    assert surface.z[at] == pytest.approx([f.z for f in umad.spec.floors])


def test_openings_have_no_cells(umad, surface):
    x, y, z = surface.positions().T
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
    """From the cell in the middle of every tread links lead to the next one."""
    x, y, z = surface.positions().T
    checked = 0
    for element in umad.elements:
        if element.role != Role.STAIR:
            continue
        treads = sorted(element.solids, key=lambda s: s.center[2])
        for below, above in pairwise(treads):
            way = np.subtract(above.center, below.center)
            direction = DIRECTIONS.index(tuple(np.round(way[:2] / 0.28).astype(int).tolist()))
            top = below.center[2] + below.size[2] / 2
            near = np.hypot(x - below.center[0], y - below.center[1]) + 10 * np.abs(z - top)
            cell = int(np.argmin(near))
            for _ in range(3):
                cell = surface.links[cell, direction]
                assert cell >= 0
            assert z[cell] == pytest.approx(top + way[2], abs=0.001)
            checked += 1
    assert checked == 5 * (12 + 5 + 5)
