"""Queries for many rays or points at once give the same as one query at a time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from argo_env.site import load_site
from argo_env.site.index import ElementIndex, SolidRays
from argo_env.site.shapes import Box, Cylinder, Element, Role, crossing
from tests.conftest import examples

turns = st.one_of(st.just((0.0, 0.0, 0.0)), st.tuples(*[st.floats(-3.1, 3.1)] * 3))
middles = st.tuples(*[st.floats(-3.0, 3.0)] * 3)
sizes = st.floats(0.05, 2.0)
solids = st.one_of(
    st.builds(Box, middles, st.tuples(sizes, sizes, sizes), turns),
    st.builds(Cylinder, middles, sizes, sizes, turns),
)


def gathered(parts):
    """Return the solids in elements of up to two."""
    pairs = [tuple(parts[k : k + 2]) for k in range(0, len(parts), 2)]
    return tuple(Element(f"part {k}", Role.STRUCTURE, p, "steel") for k, p in enumerate(pairs))


def one_by_one(parts, origin, direction, reach, inside):
    """Return the distance to the first solid and its number, found with `crossing`."""
    best = np.inf, -1
    for number, solid in enumerate(parts):
        entry, leave = (t[0] for t in crossing(solid, origin[None], direction))
        if entry <= min(leave, reach) and (leave if inside else entry) >= 0.0:
            best = min(best, (entry, number))
    return best


@given(
    st.lists(solids, max_size=8),
    st.integers(0, 2**32 - 1),
    st.booleans(),
    st.booleans(),
)
@settings(max_examples=examples(150), deadline=None)
def test_many_rays_are_as_one_by_one(parts, seed, inside, apart):
    rng, reach = np.random.default_rng(seed), 5.0
    directions = rng.normal(size=(30, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    origins = rng.uniform(-4.0, 4.0, (30, 3))
    if not apart:
        origins[:] = origins[0]
    elements = gathered(parts)
    rays = SolidRays(elements)
    assert [e.name for e in rays.elements] == [e.name for e in elements for _ in e.solids]
    distances, found = rays.first_hits(origins if apart else origins[0], directions, reach, inside)
    for origin, direction, distance, solid in zip(
        origins, directions, distances, found.tolist(), strict=True
    ):
        known, which = one_by_one(parts, origin, direction, reach, inside)
        assert distance == pytest.approx(known, abs=1e-6)
        assert solid == which


def test_a_ray_from_inside_begins_behind_itself():
    rays = SolidRays(
        gathered([Box((0.0, 0.0, 0.0), (2.0, 2.0, 2.0)), Cylinder((3.0, 0, 0), 0.5, 1.0)])
    )
    ahead = np.array([[1.0, 0.0, 0.0]])
    assert [v[0] for v in rays.first_hits(np.zeros(3), ahead, 9.0)] == [2.5, 1]
    assert [
        v[0] for v in rays.first_hits(np.zeros(3), ahead, 9.0, include_solids_around_origin=True)
    ] == [
        -1.0,
        0,
    ]
    assert [v[0] for v in rays.first_hits(np.zeros(3), ahead, 2.0)] == [np.inf, -1]


SITE = load_site("umad")


@pytest.mark.parametrize("material", ["railing", "grating", "structure", "pump"])
@pytest.mark.parametrize("reach", [0.001, 0.1, 20.0])
def test_many_points_at_once_are_those_one_by_one(material, reach):
    """The points lie on surfaces, where several solids may be equally near, beside them, or far."""
    index = ElementIndex(SITE.elements, material)
    rng = np.random.default_rng(7)
    solids = [s for e in SITE.elements if e.material == material for s in e.solids]
    points = []
    for k in rng.integers(len(solids), size=60).tolist():
        solid = solids[k]
        half = np.array(getattr(solid, "size", (0.05, 0.05, 0.5))) / 2
        corner = np.sign(rng.uniform(-1.0, 1.0, 3)) * half * rng.integers(0, 2, 3)
        place = np.array(solid.center) + solid.rotation() @ corner
        points.append(tuple((place + rng.uniform(-reach, reach, 3)).tolist()))
        points.append(tuple(place.tolist()))
    assert index.nearest_each(points) == [index.nearest(point) for point in points]
