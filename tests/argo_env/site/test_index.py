"""Which element is at a point: many at once as one by one."""

import numpy as np
import pytest

from argo_env.site import load_site
from argo_env.site.index import ElementIndex

SITE = load_site("umad")


@pytest.mark.parametrize("material", ["railing", "grating", "structure", "pump"])
@pytest.mark.parametrize("reach", [0.001, 0.1, 20.0])
def test_many_points_at_once_are_those_one_by_one(material, reach):
    """Points on surfaces, where several solids may be equally near, beside them, and far away."""
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
    assert index.at_each(points) == [index.at(point) for point in points]
