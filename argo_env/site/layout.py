"""Layout of a generated site: aisles, stair towers, fields, and slots for checkpoints.

Fields are the openings between the aisles, and slots are the points beside the aisles where
checkpoints may be. All edges of decks lie at multiples of 0.1 m, except at the heads of flights.
x points east.
"""

import math
from dataclasses import dataclass

import numpy as np

from argo_env.site.family import Family, Stairs
from argo_env.site.spec import FlightSpec, LandingSpec, Rect, TowerSpec

CORNER = 1.6  # m, the edge of the squares in which the robot turns
LANDING = 1.6  # m
FLIGHT_WIDTH = 0.9  # m
MARGIN = 4.0  # m of ground around the decks
_STOREYS = (2.5, 2.7, 3.0)  # m
_RISE = (0.16, 0.195)  # m: steps that the robot climbs and people accept
_GOING = (0.21, 0.31)  # m, ISO 14122-3
_STRIDE = (0.60, 0.66)  # m, going + 2 rise, ISO 14122-3
_BAY = (4.0, 7.0)  # m from one cross aisle to the next
_SPACING = 0.8  # m from slot to slot along an aisle


@dataclass(frozen=True)
class Slot:
    """Point on the edge of an aisle (m); `out` is the unit vector away from the aisle."""

    x: float
    y: float
    out: tuple[int, int]


@dataclass(frozen=True)
class Layout:
    """Layout of a site, the same on all upper floors.

    `ring` maps the names of the outer deck's rectangles to them, and `crossings` does so for each
    cross aisle. `fields` are the openings between them. `storey` is the height from floor to floor
    in m.
    """

    storey: float
    towers: tuple[TowerSpec, ...]
    ring: dict[str, Rect]
    crossings: tuple[dict[str, Rect], ...]
    fields: tuple[Rect, ...]
    slots: tuple[Slot, ...]


def draw_layout(family: Family, random: np.random.Generator) -> Layout:
    """Draw the layout of a site with a family's parameters; `random` replaces their seed."""
    width, depth = (float(edge) for edge in family.size)
    storey = float(random.choice(_STOREYS))
    aisle = float(random.choice([1.0, 1.1, 1.2]))
    towers: list[TowerSpec] = []
    ring: dict[str, Rect] = {
        "south aisle": (0.0, 0.0, width, aisle),
        "north aisle": (0.0, depth - aisle, width, depth),
        "west aisle": (0.0, 0.0, aisle, depth),
        "east aisle": (width - aisle, 0.0, width, depth),
        "corner south-west": (0.0, 0.0, CORNER, CORNER),
        "corner south-east": (width - CORNER, 0.0, width, CORNER),
        "corner north-west": (0.0, depth - CORNER, CORNER, depth),
        "corner north-east": (width - CORNER, depth - CORNER, width, depth),
    }
    taken: list[Rect] = []
    if family.floors > 1 and family.stairs != Stairs.DOG_LEG:
        tower, landings = _straight_tower(storey, aisle, depth, random)
        towers.append(tower)
        ring |= landings
        taken += landings.values()
        first, second = landings.values()
        taken.append((-1.3, first[1], 0.0, second[3]))
    if family.floors > 1 and family.stairs != Stairs.STRAIGHT:
        tower, landings = _dog_leg_tower(storey, aisle, width, depth, random)
        towers.append(tower)
        ring |= landings
        taken += landings.values()
    crossings, fields = _bays(width, depth, aisle, random)
    slots = _slots(width, depth, aisle, fields, taken)
    return Layout(storey, tuple(towers), ring, crossings, fields, slots)


def draw_steps(
    storey: float, even_count: bool, random: np.random.Generator
) -> tuple[int, float, float]:
    """Draw the steps of stairs that rise one storey (m), within the limits of ISO 14122-3.

    Returns the number of risers, which is even if `even_count` is True, and the rise and going (m)
    of a step.
    """
    choices = []
    for risers in range(int(storey / _RISE[1]), int(storey / _RISE[0]) + 2):
        rise = storey / risers
        low = max(_GOING[0], _STRIDE[0] - 2 * rise)
        high = min(_GOING[1], _STRIDE[1] - 2 * rise)
        goings = np.arange(np.ceil(low * 100 - 1e-6), np.floor(high * 100 + 1e-6) + 1) / 100
        if _RISE[0] <= rise <= _RISE[1] and not (even_count and risers % 2):
            choices += [(risers, rise, float(going)) for going in goings]
    return choices[int(random.integers(len(choices)))]


def _tenths(low: float, high: float, random: np.random.Generator) -> float:
    """Draw a multiple of 0.1 m from `low` to `high`."""
    return int(random.integers(round(low * 10), round(high * 10) + 1)) / 10


def _straight_tower(
    storey: float, aisle: float, depth: float, random: np.random.Generator
) -> tuple[TowerSpec, dict[str, Rect]]:
    risers, rise, going = draw_steps(storey, False, random)
    run = round((risers - 1) * going, 3)
    foot = _tenths(CORNER + LANDING, depth - CORNER - LANDING - np.ceil(run * 10) / 10, random)
    head = round(foot + run, 3)
    flight = FlightSpec(
        name="flight",
        foot=(-0.55, foot, 0.0),
        yaw=90,
        risers=risers,
        rise=rise,
        going=going,
        width=FLIGHT_WIDTH,
    )
    inner = round(aisle + 0.3, 1)
    return TowerSpec(name="west tower", flights=(flight,)), {
        "west landing south": (-1.3, round(foot - LANDING, 3), inner, foot),
        "west landing north": (-1.3, head, inner, round(head + LANDING, 3)),
    }


def _dog_leg_tower(
    storey: float, aisle: float, width: float, depth: float, random: np.random.Generator
) -> tuple[TowerSpec, dict[str, Rect]]:
    risers, rise, going = draw_steps(storey, True, random)
    half = risers // 2
    middle = _tenths(CORNER + 1.4, depth - CORNER - 1.4, random)
    turn = round(width + (half - 1) * going, 3)
    common = {"risers": half, "rise": rise, "going": going, "width": FLIGHT_WIDTH}
    flights = (
        FlightSpec(name="lower flight", foot=(width, middle - 0.5, 0.0), yaw=0, **common),
        FlightSpec(name="upper flight", foot=(turn, middle + 0.5, half * rise), yaw=180, **common),
    )
    landing = LandingSpec(
        name="half landing",
        rect=(turn, round(middle - 1.3, 1), round(turn + LANDING, 3), round(middle + 1.3, 1)),
        z=half * rise,
    )
    inner = round(width - aisle - 0.5, 1)
    return TowerSpec(name="east tower", flights=flights, landings=(landing,)), {
        "east landing": (inner, round(middle - 1.4, 1), width, round(middle + 1.4, 1)),
    }


def _bays(
    width: float, depth: float, aisle: float, random: np.random.Generator
) -> tuple[tuple[dict[str, Rect], ...], tuple[Rect, ...]]:
    """Draw the cross aisles, each with its two ends, and the fields between them, west to east.

    A cross aisle runs from south to north.
    """
    least, most = math.ceil(width / _BAY[1]), int(width // _BAY[0])
    bays = int(random.integers(least, most + 1))
    crossings, edges = [], [aisle]
    for number in range(1, bays):
        across = float(random.choice([0.8, 0.9, 1.0]))
        x = round(width * number / bays - across / 2 + _tenths(-0.3, 0.3, random), 1)
        square = round(x + across / 2 - CORNER / 2, 1)
        crossings.append(
            {
                f"cross aisle {number}": (x, aisle, round(x + across, 1), depth - aisle),
                f"cross aisle {number} south end": (square, 0.0, square + CORNER, CORNER),
                f"cross aisle {number} north end": (
                    square, depth - CORNER, square + CORNER, depth,
                ),
            }
        )  # fmt: skip
        edges += [x, round(x + across, 1)]
    edges.append(width - aisle)
    fields = tuple(
        (west, aisle, east, depth - aisle)
        for west, east in zip(edges[::2], edges[1::2], strict=True)
    )
    return tuple(crossings), fields


def _slots(
    width: float, depth: float, aisle: float, fields: tuple[Rect, ...], taken: list[Rect]
) -> tuple[Slot, ...]:
    """Return slots along the edges of the decks, away from corners, stairs and landings."""
    slots = []
    for x in np.arange(CORNER + 0.4, width - CORNER - 0.3, _SPACING).round(2).tolist():
        slots += [Slot(x, 0.0, (0, -1)), Slot(x, depth, (0, 1))]
    for y in np.arange(CORNER + 0.4, depth - CORNER - 0.3, _SPACING).round(2).tolist():
        slots += [Slot(0.0, y, (-1, 0)), Slot(width, y, (1, 0))]
    for x0, y0, x1, y1 in fields:
        inset = CORNER - aisle + 0.5
        for x in np.arange(x0 + inset, x1 - inset + 0.01, _SPACING).round(2).tolist():
            slots += [Slot(x, y0, (0, 1)), Slot(x, y1, (0, -1))]
        for y in np.arange(y0 + inset, y1 - inset + 0.01, _SPACING).round(2).tolist():
            slots += [Slot(x0, y, (1, 0)), Slot(x1, y, (-1, 0))]
    reach = 0.9
    return tuple(
        s
        for s in slots
        if not any(
            x0 - reach < s.x < x1 + reach and y0 - reach < s.y < y1 + reach
            for x0, y0, x1, y1 in taken
        )
    )
