"""Railings after ISO 14122-3: top rail, knee rail, toe plate and posts."""

import math

from argo_env.site.shapes import Box, Solid

RAIL_HEIGHT = 1.1  # m above the deck
KNEE_HEIGHT = 0.55  # m
TOE_PLATE = 0.1  # m, its height
THICKNESS = 0.04  # m, of rails and posts
POST_SPACING = 1.5  # m, at most
HANDRAIL_HEIGHT = 0.95  # m above the nosings of a flight


def railing(
    start: tuple[float, float], end: tuple[float, float], z: float, offset: tuple[float, float]
) -> tuple[Solid, ...]:
    """A railing on a deck at height `z` from `start` to `end`, moved sideways by `offset` (m)."""
    x0, y0 = start[0] + offset[0], start[1] + offset[1]
    x1, y1 = end[0] + offset[0], end[1] + offset[1]
    length, yaw = math.hypot(x1 - x0, y1 - y0), math.atan2(y1 - y0, x1 - x0)
    x, y, turn = (x0 + x1) / 2, (y0 + y1) / 2, (0.0, 0.0, yaw)
    solids: list[Solid] = [
        Box((x, y, z + RAIL_HEIGHT - THICKNESS / 2), (length, THICKNESS, THICKNESS), turn),
        Box((x, y, z + KNEE_HEIGHT), (length, THICKNESS, THICKNESS), turn),
        Box((x, y, z + TOE_PLATE / 2), (length, THICKNESS, TOE_PLATE), turn),
    ]
    bays = max(1, math.ceil(length / POST_SPACING))
    for k in range(bays + 1):
        # The end posts stand half a post inside, so that no post reaches beyond the railing.
        along = min(max(length * k / bays, THICKNESS / 2), length - THICKNESS / 2)
        px, py = x0 + along * math.cos(yaw), y0 + along * math.sin(yaw)
        post = (px, py, z + RAIL_HEIGHT / 2)
        solids.append(Box(post, (THICKNESS, THICKNESS, RAIL_HEIGHT), turn))
    return tuple(solids)


def outside(outward: tuple[float, float]) -> tuple[float, float]:
    """How far a railing stands from the rim of its deck, so that the whole deck stays clear."""
    return outward[0] * THICKNESS / 2, outward[1] * THICKNESS / 2
