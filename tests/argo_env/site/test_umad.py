"""The shipped site has its known properties, and keeps the norms and rules."""

import math
from functools import partial
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

from argo_compiler.base.errors import NotFound
from argo_env.site.build import DOCK_DISTANCE
from argo_env.site.shapes import Role
from argo_env.site.site import site_names
from argo_env.site.stairs import flight_end_areas

CHECKPOINTS = [
    (1, "pressure gauge", "pressure gauge 1", 1),
    (2, "liquid level gauge", "liquid level gauge 1", 1),
    (3, "pressure gauge", "pressure gauge 2", 1),
    (4, "valve", "valve R25", 1),
    (5, "valve", "valve R12", 2),
    (6, "pressure gauge", "pressure gauge 3", 2),
    (7, "liquid level gauge", "liquid level gauge 2", 2),
    (8, "pressure gauge", "pressure gauge 5", 2),
    (9, "pressure gauge", "pressure gauge 4", 3),
    (10, "valve", "valve R31", 3),
    (11, "valve", "valve R7", 3),
    (12, "liquid level gauge", "liquid level gauge 3", 3),
    (13, "pressure gauge", "pressure gauge 6", 4),
    (14, "valve", "valve R18", 4),
    (15, "pressure gauge", "pressure gauge 7", 4),
    (16, "liquid level gauge", "liquid level gauge 4", 5),
    (17, "valve", "valve R40", 5),
    (18, "pressure gauge", "pressure gauge 8", 5),
    (19, "valve", "valve R9", 6),
    (20, "liquid level gauge", "liquid level gauge 5", 6),
]


def top(solid):
    return solid.center[2] + solid.size[2] / 2


def flights(site):
    return [flight for tower in site.spec.towers for flight in tower.flights]


def all_mouths(site):
    return [
        mouth
        for tower in site.spec.towers
        for floor in site.spec.floors[:-1]
        for flight in tower.flights
        for mouth in flight_end_areas(flight, floor.z)
    ]


def inside(x, y, rect, tolerance=0.0):
    return (
        rect[0] - tolerance <= x <= rect[2] + tolerance
        and rect[1] - tolerance <= y <= rect[3] + tolerance
    )


def plated(deck, x, y):
    return any(inside(x, y, r) for r in deck.walkways.values()) and not any(
        inside(x, y, r) for r in deck.openings.values()
    )


def distance(x, y, rect):
    return math.hypot(
        max(rect[0] - x, 0.0, x - rect[2]),
        max(rect[1] - y, 0.0, y - rect[3]),
    )


def test_umad_is_shipped(umad):
    assert "umad" in site_names()
    assert umad.name == "umad"


def test_six_floors_at_two_and_a_half_metres(umad):
    assert [(f.number, f.z) for f in umad.spec.floors] == [(n, 2.5 * (n - 1)) for n in range(1, 7)]


@pytest.mark.parametrize(("z", "floor"), [(-0.03, 1), (0.0, 1), (2.39, 1), (2.5, 2), (12.5, 6)])
def test_floor_at_a_height(umad, z, floor):
    assert umad.floor_at(z) == floor


def test_flights_keep_iso_14122(umad):
    for flight in flights(umad):
        assert flight.rise == pytest.approx(0.1786, abs=1e-4)
        assert flight.going == pytest.approx(0.28)
        assert flight.width == pytest.approx(0.9)
        assert 0.6 <= flight.going + 2 * flight.rise <= 0.66
        assert 0.21 <= flight.going <= 0.31
        assert 20 <= math.degrees(math.atan2(flight.rise, flight.going)) <= 45


def test_fourteen_equal_risers_from_floor_to_floor(umad):
    for tower in umad.spec.towers:
        assert sum(f.risers for f in tower.flights) == 14
        for below, above in pairwise(umad.spec.floors):
            prefix = f"{tower.name} {below.number}-{above.number}"
            tops = [
                top(solid)
                for e in umad.elements
                if e.name.startswith(prefix) and e.role in (Role.STAIR, Role.DECK)
                for solid in e.solids
                if solid.size[2] == pytest.approx(0.04)
            ]
            heights = np.unique(np.round([below.z, *tops, above.z], 4))
            assert np.diff(heights) == pytest.approx(np.full(14, 2.5 / 14), abs=5e-4), prefix


def test_handrails_are_900_to_1000_mm_above_the_nosings(umad):
    for tower in umad.spec.towers:
        for flight in tower.flights:
            name = f"{tower.name} 1-2 {flight.name}"
            parts = {e.name: e.solids for e in umad.elements}
            nosings = np.array([[*s.center[:2], top(s)] for s in parts[name]])
            rails = [s for s in parts[f"{name} handrails"] if s.size[1] == s.size[2]]
            highest = max(rails, key=lambda s: s.center[2])
            # The nosing leads its tread's middle by half a going, which is half a rise of slope.
            over = highest.center[2] - (nosings[:, 2].mean() + flight.rise / 2)
            assert 0.9 <= over <= 1.0


def test_landings_are_at_least_800_mm(umad):
    for tower in umad.spec.towers:
        for landing in tower.landings:
            x0, y0, x1, y1 = landing.rect
            assert min(x1 - x0, y1 - y0) >= 0.8
    for tower in umad.spec.towers:
        for below in umad.spec.floors[:-1]:
            for flight in tower.flights:
                yaw = math.radians(flight.yaw)
                foot, head = flight_end_areas(flight, below.z)
                for (z, rect), sign in ((foot, -1), (head, 1)):
                    middle = (rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2
                    for along in np.arange(0.05, 0.8, 0.1):
                        for left in (-0.44, 0.0, 0.44):
                            x = middle[0] + sign * along * math.cos(yaw) - left * math.sin(yaw)
                            y = middle[1] + sign * along * math.sin(yaw) + left * math.cos(yaw)
                            on_floor = any(
                                plated(f, x, y) for f in umad.spec.floors if abs(f.z - z) < 0.01
                            )
                            on_landing = any(
                                inside(x, y, la.rect) and abs(below.z + la.z - z) < 0.01
                                for la in tower.landings
                            )
                            assert on_floor or on_landing, (tower.name, flight.name, z, x, y)


def test_walkways_of_upper_floors_are_wide_and_clear(umad, umad_world):
    solid = set(umad_world.links) - {"grating", "concrete", "gravel"}
    for floor in umad.spec.floors[1:]:
        for name, (x0, y0, x1, y1) in floor.walkways.items():
            assert min(x1 - x0, y1 - y0) >= 0.7 - 1e-9, name
            # Stringers reach a little beyond the first and the last nosing, at a mouth's sides.
            at_stairs = any(
                abs(z - floor.z) < 0.05 and x0 < m[2] and m[0] < x1 and y0 < m[3] and m[1] < y1
                for z, m in all_mouths(umad)
            )
            edge = 0.08 if at_stairs else 0.001
            if any(
                x0 < o[2] and o[0] < x1 and y0 < o[3] and o[1] < y1 for o in floor.openings.values()
            ):
                continue  # railed in its midst
            touched = umad_world.touched(
                (x0 + edge, y0 + edge, 0.01), (x1 - edge, y1 - edge, 2.0), (0, 0, floor.z)
            )
            assert not touched & solid, (floor.number, name, touched)


def test_headroom_over_decks_and_stairs(umad, umad_world):
    """No solid lies within 2.1 m above the middles of walkways and of treads."""
    starts = [
        ((x0 + x1) / 2, (y0 + y1) / 2, floor.z + 0.01)
        for floor in umad.spec.floors[1:]
        for x0, y0, x1, y1 in floor.walkways.values()
        if plated(floor, (x0 + x1) / 2, (y0 + y1) / 2)
    ]
    starts += [
        (*s.center[:2], top(s) + 0.01)
        for e in umad.elements
        if e.role == Role.STAIR
        for s in e.solids
    ]
    hits = umad_world.rays(starts, np.add(starts, [0, 0, 2.09]))
    assert [s for s, (material, _) in zip(starts, hits, strict=True) if material] == []


def test_checkpoints(umad):
    listed = [(c.id, c.kind.value, c.name, c.floor) for c in umad.checkpoints]
    assert listed == CHECKPOINTS
    assert umad.checkpoint(14).name == "valve R18"
    with pytest.raises(NotFound):
        umad.checkpoint(21)


def test_checkpoints_keep_the_rules_of_the_competition(umad, navigator):
    x, y, z = navigator.surface.cell_positions().T
    for c in umad.checkpoints:
        floor = umad.spec.floors[c.floor - 1]
        assert 0.2 - 1e-9 <= c.position[2] - floor.z <= 2.0 + 1e-9, c
        beside = min(distance(*c.position[:2], r) for r in floor.walkways.values())
        assert beside <= 0.5, c
        deck = np.abs(z - floor.z) < 0.01
        to_cell = np.maximum(np.abs(x[deck] - c.position[0]) - 0.05, 0.0)
        to_cell = np.hypot(to_cell, np.maximum(np.abs(y[deck] - c.position[1]) - 0.05, 0.0))
        assert to_cell.min() <= 0.5, c
        assert c.range.low <= c.nominal.low < c.nominal.high <= c.range.high
        assert (
            c.unit == {"pressure gauge": "bar", "liquid level gauge": "%", "valve": "deg"}[c.kind]
        )


def test_faces_of_checkpoints_are_free_and_their_backs_carried(umad, umad_world):
    for c in umad.checkpoints:
        ahead = np.array([math.cos(c.yaw), math.sin(c.yaw), 0.0])
        face = np.array(c.position)
        in_front, behind = umad_world.rays(
            [face + 0.01 * ahead, face - 0.001 * ahead],
            [face + 0.3 * ahead, face - 0.25 * ahead],
        )
        assert in_front[0] is None, c
        assert behind[0] is not None, c


def test_elements_have_unique_names(umad):
    names = [e.name for e in umad.elements]
    assert len(set(names)) == len(names)


def rim(site):
    """Yield points every 5 cm along the rims of all railed decks: x, y, z, outward direction."""
    decks = [(floor.z, floor) for floor in site.spec.floors[1:]]
    decks += [
        (floor.z + landing.z, SimpleNamespace(walkways={"": landing.rect}, openings={}))
        for tower in site.spec.towers
        for floor in site.spec.floors[:-1]
        for landing in tower.landings
    ]
    for z, deck in decks:
        on = partial(plated, deck)
        for x0, y0, x1, y1 in (*deck.walkways.values(), *deck.openings.values()):
            for along in np.arange(x0 + 0.025, x1, 0.05):
                for y in (y0, y1):
                    for out in (-1.0, 1.0):
                        if on(along, y - 0.01 * out) and not on(along, y + 0.01 * out):
                            yield (along, y, z, 0.0, out)
            for along in np.arange(y0 + 0.025, y1, 0.05):
                for x in (x0, x1):
                    for out in (-1.0, 1.0):
                        if on(x - 0.01 * out, along) and not on(x + 0.01 * out, along):
                            yield (x, along, z, out, 0.0)


@pytest.mark.parametrize("height", [0.05, 0.55, 1.08], ids=["toe plate", "knee rail", "top rail"])
def test_free_edges_are_railed_but_for_stair_mouths(umad, umad_world, height):
    points = np.array(list(rim(umad)))
    assert len(points) > 5000
    where, out = points[:, :3] + [0, 0, height], points[:, 3:]
    step = np.column_stack([out, np.zeros(len(out))])
    hits = umad_world.rays(where - 0.03 * step, where + 0.06 * step)
    railed = np.array([material == "railing" for material, _ in hits])
    gaps = all_mouths(umad)
    in_mouth = np.array(
        [
            any(abs(z - p[2]) < 0.05 and inside(p[0], p[1], rect, 1e-6) for z, rect in gaps)
            for p in points
        ]
    )
    assert points[~railed & ~in_mouth].tolist() == []
    # The handrails may stand at the very sides of a mouth.
    assert railed[in_mouth].mean() < 0.15


def test_mouths_of_stairs_are_open(umad, umad_world):
    for z, (x0, y0, x1, y1) in all_mouths(umad):
        touched = umad_world.touched(
            (x0 + 0.03, y0 + 0.03, 0.2), (x1 - 0.03, y1 - 0.03, 1.0), (0, 0, z), 0.0, ["railing"]
        )
        assert not touched, (z, x0, y0)


def test_docking_stations_stand_on_the_gravel(umad, umad_world):
    assert sorted(umad.docks) == [1, 2]
    slab = umad.spec.floors[0].walkways["slab"]
    for pose in umad.docks.values():
        assert pose.z == umad.spec.ground_z
        assert distance(pose.x, pose.y, slab) > 0.5
        ahead = np.array([math.cos(pose.yaw), math.sin(pose.yaw), 0.0])
        station = np.array([pose.x, pose.y, pose.z + 0.3])
        contacts, below = umad_world.rays(
            [station, station], [station + ahead, station - [0, 0, 1]]
        )
        assert contacts[0] == "dock"
        assert (contacts[1] - station) @ ahead == pytest.approx(DOCK_DISTANCE, abs=1e-3)
        assert below[0] == "gravel"
