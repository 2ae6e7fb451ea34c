"""A small plant for tests: one deck, a metre over the ground, with a vessel, a pipe and two pumps.

The deck is `DECK`; along y = 2 it is free from one end to the other.
"""

from dataclasses import replace

from argo_env.robot.pose import BodyPose
from argo_env.site import make_site
from argo_env.site.shapes import Box, Element, Role
from argo_env.site.spec import SiteSpec

DECK = (0.0, 0.0, 16.0, 8.0)
Z = 1.0
SPEC = {
    "name": "plant",
    "title": "Plant",
    "storey": 2.5,
    "ground": [-4, -4, 20, 12],
    "ground_z": 0.0,
    "towers": [],
    "areas": [{"number": 1, "dock": [-2.0, -2.0, 180]}],
    "floors": [
        {
            "number": 1,
            "z": Z,
            "railed": False,
            "walkways": {"slab": list(DECK)},
            "vessels": [
                {"name": "vessel V-1", "center": [12.0, 5.0, 1.5], "radius": 1.0, "length": 3.0}
            ],
            "pumps": [
                {"name": "pump P-1", "center": [3.0, 5.0]},
                {"name": "pump P-2", "center": [8.0, 6.0], "yaw": 90},
            ],
            "checkpoints": [
                {
                    "id": 1,
                    "kind": "pressure gauge",
                    "name": "gauge 1",
                    "position": [6.0, 3.0, 0.6],
                    "yaw": -90,
                    "nominal": {"low": 2, "high": 5},
                }
            ],
        }
    ],
    "pipes": [{"name": "pipe 1", "points": [[6.0, 3.2, 0.0], [6.0, 3.2, 4.0]]}],
}


def plant():
    return make_site(SiteSpec.model_validate(SPEC))


def with_brick(site, x, y, size=(0.1, 0.2, 0.1), yaw=0.0):
    """Return the elements of the site with a brick on the deck."""
    box = Box((x, y, Z + size[2] / 2), size, (0.0, 0.0, yaw))
    return (*site.elements, Element("brick", Role.STRUCTURE, (box,), "brick"))


def with_hole(site, x0, y0, x1, y1):
    """Return the elements of the site with a hole in the deck."""
    a0, b0, a1, b1 = DECK
    rests = [(a0, b0, x0, b1), (x1, b0, a1, b1), (x0, b0, x1, y0), (x0, y1, x1, b1)]
    boxes = tuple(
        Box(((p + r) / 2, (q + s) / 2, Z - 0.1), (r - p, s - q, 0.2)) for p, q, r, s in rests
    )
    return tuple(replace(e, solids=boxes) if e.role is Role.DECK else e for e in site.elements)


def lane(start, end, y=2.0, backwards=False):
    """Return times and poses from x = `start` to `end` along the lane, at 0.4 m/s, every 0.1 s."""
    sign = 1 if end > start else -1
    heading = 0.0 if (sign > 0) != backwards else 3.141592653589793
    count = round(abs(end - start) / 0.04)
    return [(0.1 * k, BodyPose(start + sign * 0.04 * k, y, Z, heading)) for k in range(count + 1)]


def detections_along(watch, poses):
    """Return the detections of a watch along these times and poses, with time and pose."""
    due, detections = 0.0, []
    for now, pose in poses:
        if now >= due - 1e-6:
            due = now + watch.period
            detections += [(now, pose, detection) for detection in watch.update(now, pose)]
    return detections
