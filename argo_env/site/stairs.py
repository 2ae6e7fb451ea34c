"""Flights of open steel steps with stringers and handrails, and railings after ISO 14122-3.

A railing has a top rail, a knee rail, a toe plate and posts.
"""

import math
from collections.abc import Callable

from argo_env.site.shapes import Box, Element, Role, Solid, Vector
from argo_env.site.spec import FlightSpec, Rect

RAIL_HEIGHT = 1.1  # m above the deck
KNEE_HEIGHT = 0.55  # m
TOE_PLATE = 0.1  # m, height
THICKNESS = 0.04  # m, of rails and posts
POST_SPACING = 1.5  # m, greatest
HANDRAIL_HEIGHT = 0.95  # m above the nosings of a flight


def railing(
    start: tuple[float, float], end: tuple[float, float], z: float, offset: tuple[float, float]
) -> tuple[Solid, ...]:
    """Build a railing on a deck at height `z`, along the line from `start` to `end`, all in m.

    The line is moved by `offset`, such as that of `railing_offset_outward`.
    """
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


def railing_offset_outward(outward: tuple[float, float]) -> tuple[float, float]:
    """Return the vector (m) from a deck's rim to its railing, which leaves the whole deck free.

    `outward` is the unit normal of the rim.
    """
    return outward[0] * THICKNESS / 2, outward[1] * THICKNESS / 2


TREAD_THICKNESS = 0.04  # m
TREAD_OVERLAP = 0.02  # m by which a tread reaches under the next one
STRINGER_DEPTH = 0.2  # m
MOUTH_DEPTH = 0.3  # m across the first and the last nosing, without railings


def flight_run(flight: FlightSpec) -> float:
    """Return the horizontal distance (m) from the lowest nosing of a flight to its upper end.

    That end is the rim of the deck, which is the nosing of the last riser.
    """
    return (flight.risers - 1) * flight.going


def build_flight(flight: FlightSpec, prefix: str, base_z: float) -> tuple[Element, ...]:
    """Build the steps of a flight as one element, and its handrails and stringers as another.

    `prefix` begins their names; `base_z` is the height (m) of the floor from which the stairs rise.
    """
    yaw = math.radians(flight.yaw)
    slope = math.atan2(flight.rise, flight.going)
    place = _placer(flight, base_z)
    steps = tuple(
        Box(
            place(
                (i + 0.5) * flight.going + TREAD_OVERLAP / 2,
                0.0,
                (i + 1) * flight.rise - TREAD_THICKNESS / 2,
            ),
            (flight.going + TREAD_OVERLAP, flight.width, TREAD_THICKNESS),
            (0.0, 0.0, yaw),
        )
        for i in range(flight.risers - 1)
    )
    length = math.hypot(flight_run(flight), (flight.risers - 1) * flight.rise)
    middle, rise_to_middle = flight_run(flight) / 2, (flight.risers - 1) * flight.rise / 2
    tilt = (0.0, -slope, yaw)
    sides: list[Solid] = []
    for side in (-1.0, 1.0):
        across = side * (flight.width + THICKNESS) / 2
        # Nosings lie one rise above the line through the backs of the treads.
        nosing = rise_to_middle + flight.rise
        stringer = place(middle, across, nosing - STRINGER_DEPTH / 2 / math.cos(slope) - 0.05)
        sides.append(Box(stringer, (length, THICKNESS, STRINGER_DEPTH), tilt))
        for height in (HANDRAIL_HEIGHT, HANDRAIL_HEIGHT / 2):
            rail = place(middle, across, nosing + height)
            sides.append(Box(rail, (length, THICKNESS, THICKNESS), tilt))
        for step in range(0, flight.risers, 4):
            along = min(step, flight.risers - 1.5) * flight.going + flight.going / 4
            foot = along / flight.going * flight.rise
            post = place(along, across, foot + flight.rise + HANDRAIL_HEIGHT / 2)
            sides.append(Box(post, (THICKNESS, THICKNESS, HANDRAIL_HEIGHT), (0.0, 0.0, yaw)))
    return (
        Element(f"{prefix} {flight.name}", Role.STAIR, steps, "grating"),
        Element(f"{prefix} {flight.name} handrails", Role.RAILING, tuple(sides), "railing"),
    )


def flight_end_areas(
    flight: FlightSpec, base_z: float
) -> tuple[tuple[float, Rect], tuple[float, Rect]]:
    """Return the height (m) and the area of a flight's foot, then those of its head.

    In these areas, where the flight joins the decks, there is no railing. `base_z` is the height
    (m) of the floor from which the stairs rise.
    """
    place = _placer(flight, base_z)
    result = []
    for along, height in ((0.0, 0.0), (flight_run(flight), flight.risers * flight.rise)):
        corners = [
            place(along + a, b, height)
            for a in (-MOUTH_DEPTH / 2, MOUTH_DEPTH / 2)
            for b in (-flight.width / 2, flight.width / 2)
        ]
        xs, ys = [c[0] for c in corners], [c[1] for c in corners]
        result.append((corners[0][2], (min(xs), min(ys), max(xs), max(ys))))
    return result[0], result[1]


def _placer(flight: FlightSpec, base_z: float) -> Callable[[float, float, float], Vector]:
    """Return a function that maps a point in the flight's frame to the site's frame.

    The point is given in m: along the flight, to its left, up.
    """
    yaw = math.radians(flight.yaw)
    cos, sin = math.cos(yaw), math.sin(yaw)
    x, y, z = flight.foot

    def place(along: float, left: float, up: float) -> Vector:
        return x + along * cos - left * sin, y + along * sin + left * cos, base_z + z + up

    return place
