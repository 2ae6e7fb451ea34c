"""Generator of a site's description from the parameters of a family.

The sites resemble UMAD: decks of gratings around open fields, vertical pipes (risers) beside the
aisles that carry the checkpoints, and vessels that reach through all decks.
`argo_env.planning.generated` checks that the robot can drive on a site before it returns the site.
"""

from collections.abc import Collection

import numpy as np

from argo_compiler.base.catalog import CheckpointKind, Interval
from argo_compiler.base.errors import Invalid
from argo_env.seeding import generator
from argo_env.site.build import MOUNT_LENGTH
from argo_env.site.family import Family, Stairs
from argo_env.site.layout import MARGIN, Layout, Slot, draw_layout
from argo_env.site.spec import (
    AreaSpec,
    CheckpointSpec,
    FloorSpec,
    PipeSpec,
    PlaceSpec,
    Point,
    PumpSpec,
    Rect,
    SiteSpec,
    VesselSpec,
)

GROUND_Z = -0.03  # m
_PIPE = 0.06  # m, radius of a riser
_OVERHEAD = 2.25  # m above a deck, where pipes cross; people have 2.1 m of headroom

Refused = Collection[tuple[int, int]]
"""Positions where a checkpoint can't be read, each as the numbers of its floor and its slot."""


def draw_site_and_slots(
    family: Family, attempt: int = 0, refused_slots: Refused = ()
) -> tuple[SiteSpec, dict[int, tuple[int, int]]]:
    """Draw the description of a site with a family's parameters, and where its checkpoints are.

    Equal arguments give equal results. The robot may not be able to drive on the site.

    Args:
        family: Parameters of the site, with the seed.
        attempt: Number of the draw; another one gives another site.
        refused_slots: Floors and slots that must have no checkpoint.

    Returns:
        The description, and the numbers of the floor and the slot of each checkpoint, by its id.

    Raises:
        ArgoError: The checkpoints do not fit on the site.
    """
    layout = draw_layout(family, generator(family.seed, "layout", attempt))
    width, depth = (float(edge) for edge in family.size)
    chosen = _choose_slots(family, attempt, layout, refused_slots)
    checkpoints, risers = _checkpoints(family, attempt, layout, chosen)
    random = generator(family.seed, "clutter", attempt)
    vessels, free = _vessels(family, layout, random)
    floors = tuple(
        _floor(family, layout, number, free, checkpoints[number - 1], random)
        for number in range(1, family.floors + 1)
    )
    east = 6.0 if family.stairs != Stairs.STRAIGHT else 0.0
    spec = SiteSpec(
        name=str(family),
        title=f"Generated site, seed {family.seed}",
        storey=layout.storey,
        ground=(-MARGIN, -MARGIN, width + max(MARGIN, east), depth + MARGIN),
        ground_z=GROUND_Z,
        towers=layout.towers,
        floors=floors,
        columns=_columns(width, depth),
        pipes=(*risers, *_overhead(family, layout, random)),
        vessels=vessels,
        areas=(
            AreaSpec(number=1, dock=(2.05, -2.05, 180.0)),
            AreaSpec(number=2, dock=(round(width - 2.05, 2), round(depth + 2.05, 2), 0.0)),
        ),
        places=(PlaceSpec(name="front of the site", pose=(width / 2, -2.05, 90.0)),),
    )
    return spec, dict(enumerate(((f, s) for f, slots in chosen for s in slots), start=1))


def _floor(
    family: Family,
    layout: Layout,
    number: int,
    free: tuple[Rect, ...],
    checkpoints: tuple[CheckpointSpec, ...],
    random: np.random.Generator,
) -> FloorSpec:
    width, depth = (float(edge) for edge in family.size)
    z = round((number - 1) * layout.storey, 6)
    if number == 1:
        return FloorSpec(
            number=1,
            z=z,
            walkways={"slab": (-1.5, -0.5, width + 0.5, depth + 0.5)},
            railed=False,
            barriers=_fences(family, width, depth, random),
            pumps=_pumps(family, layout.fields, random),
            checkpoints=checkpoints,
        )
    walkways = dict(layout.ring)
    for crossing in layout.crossings:
        walkways |= crossing
    openings: dict[str, Rect] = {}
    for index, (x0, y0, x1, y1) in enumerate(free, start=1):
        if random.random() < 0.4 * family.clutter:
            # A platform from the south aisle into the field, with a hatch where there is room.
            north = round(y0 + 0.1 * random.integers(20, max(21, int(5 * (y1 - y0)))), 1)
            walkways[f"platform {index}"] = (x0, y0, x1, north)
            if x1 - x0 > 3.5 and north - y0 > 3.0:
                x, y = round((x0 + x1) / 2, 1), round(north - 1.3, 1)
                openings[f"hatch {index}"] = (x - 0.3, y - 0.3, x + 0.3, y + 0.3)
    return FloorSpec(
        number=number, z=z, walkways=walkways, openings=openings, checkpoints=checkpoints
    )


def _vessels(
    family: Family, layout: Layout, random: np.random.Generator
) -> tuple[tuple[VesselSpec, ...], tuple[Rect, ...]]:
    """Draw upright vessels, each in a field of its own; return them and the fields left free."""
    vessels: list[VesselSpec] = []
    free: list[Rect] = []
    for x0, y0, x1, y1 in layout.fields:
        most = min((x1 - x0) / 2, 1.6) - 0.9
        if most < 0.3 or random.random() >= family.clutter:
            free.append((x0, y0, x1, y1))
            continue
        radius = round(float(random.uniform(0.3, most)), 2)
        y = round(float(random.uniform(y0 + 1.5 + radius, y1 - 1.5 - radius)), 1)
        length = round(family.floors * layout.storey - 0.5, 3)
        center = (round((x0 + x1) / 2, 2), y, length / 2)
        name = f"vessel V-{101 + len(vessels)}"
        vessels.append(VesselSpec(name=name, center=center, radius=radius, length=length))
    return tuple(vessels), tuple(free)


def _pumps(
    family: Family, fields: tuple[Rect, ...], random: np.random.Generator
) -> tuple[PumpSpec, ...]:
    pumps: list[PumpSpec] = []
    for x0, y0, x1, _ in fields:
        if x1 - x0 < 3.6 or random.random() >= family.clutter:
            continue
        # In the south of the field, as vessels keep a larger distance from its ends.
        x, y = random.uniform(x0 + 1.5, x1 - 1.5), y0 + 1.0
        yaw = float(random.choice([0.0, 180.0]))
        name = f"pump P-{301 + len(pumps)}"
        pumps.append(PumpSpec(name=name, center=(round(float(x), 1), round(y, 1)), yaw=yaw))
    return tuple(pumps)


def _fences(
    family: Family, width: float, depth: float, random: np.random.Generator
) -> dict[str, tuple[Point, ...]]:
    """Draw fences south and north of the slab, each with a gate."""
    fences: dict[str, tuple[Point, ...]] = {}
    for side, y in (("south", -1.2), ("north", depth + 1.2)):
        if random.random() < family.clutter:
            gate = round(float(random.uniform(2.0, width - 4.0)), 1)
            fences[f"fence {side}-west"] = ((gate, y), (0.5, y))
            fences[f"fence {side}-east"] = ((width - 0.5, y), (gate + 2.0, y))
    return fences


def _overhead(family: Family, layout: Layout, random: np.random.Generator) -> tuple[PipeSpec, ...]:
    """Draw overhead pipes, each from south to north through one field."""
    pipes: list[PipeSpec] = []
    for floor in range(family.floors):
        for x0, y0, x1, y1 in layout.fields:
            if random.random() < 0.5 * family.clutter:
                x = round(float(random.uniform(x0 + 0.4, x1 - 0.4)), 2)
                z = round(floor * layout.storey + _OVERHEAD, 3)
                name = f"pipe {len(pipes) + 1}"
                pipes.append(PipeSpec(name=name, points=((x, y0 + 0.5, z), (x, y1 - 0.5, z))))
    return tuple(pipes)


def _columns(width: float, depth: float) -> tuple[Point, ...]:
    """Return the columns: outside the rims of the decks, at the corners."""
    return tuple((x, y) for x in (0.2, width - 0.2) for y in (-0.15, depth + 0.15))


def _choose_slots(
    family: Family, attempt: int, layout: Layout, refused_slots: Refused
) -> list[tuple[int, list[int]]]:
    """Return each floor with the slots that have a checkpoint there, in ascending order.

    Raises Invalid if a floor has too few slots.
    """
    random = generator(family.seed, "slots", attempt)
    per_floor = [
        family.checkpoints // family.floors + (k < family.checkpoints % family.floors)
        for k in range(family.floors)
    ]
    order = random.permutation(len(layout.slots)).tolist()
    # A riser passes all floors. A quarter more slots than a floor needs makes the floors differ.
    usual = set(order[: max(per_floor) + 2 + max(per_floor) // 4])
    floors = []
    for floor, count in enumerate(per_floor, start=1):
        mixed = random.permutation(order).tolist()
        wanted = [s for s in mixed if s in usual] + [s for s in order if s not in usual]
        chosen = [s for s in wanted if (floor, s) not in refused_slots][:count]
        if len(chosen) < count:
            most = len(layout.slots) * family.floors
            raise Invalid(
                f"site `{family}`: {family.checkpoints} checkpoints do not fit beside its aisles,"
                f" where there are about {most} places; ask for fewer, or for more floors or a"
                " larger size"
            )
        floors.append((floor, sorted(chosen)))
    return floors


def _checkpoints(
    family: Family, attempt: int, layout: Layout, chosen: list[tuple[int, list[int]]]
) -> tuple[list[tuple[CheckpointSpec, ...]], tuple[PipeSpec, ...]]:
    """Return each floor's checkpoints, numbered from floor to floor upwards, and their risers."""
    offsets = generator(family.seed, "offsets", attempt).uniform(0.15, 0.4, len(layout.slots))
    beside = offsets.round(2).tolist()
    number = 0
    floors = []
    for floor, slots in chosen:
        placed = []
        for slot in slots:
            number += 1
            draws = generator(family.seed, "checkpoint", attempt, floor, slot)
            placed.append(_checkpoint(number, layout.slots[slot], beside[slot], draws))
        floors.append(tuple(placed))
    top = round(family.floors * layout.storey - 0.3, 3)
    risers = []
    for slot in sorted({s for _, slots in chosen for s in slots}):
        x, y = _at(layout.slots[slot], beside[slot] + MOUNT_LENGTH)
        name = f"riser {slot + 1}"
        risers.append(PipeSpec(name=name, points=((x, y, GROUND_Z), (x, y, top)), radius=_PIPE))
    return floors, tuple(risers)


def _at(slot: Slot, beside: float) -> Point:
    """Return the point `beside` m from the edge of the aisle, outward as `slot.out`."""
    return round(slot.x + slot.out[0] * beside, 3), round(slot.y + slot.out[1] * beside, 3)


def _checkpoint(
    number: int, slot: Slot, beside: float, random: np.random.Generator
) -> CheckpointSpec:
    kind = list(CheckpointKind)[int(random.integers(len(CheckpointKind)))]
    position = (*_at(slot, beside), round(float(random.uniform(0.2, 2.0)), 2))
    # The face looks towards the aisle.
    yaw = {(0, -1): 90.0, (0, 1): -90.0, (-1, 0): 0.0, (1, 0): 180.0}[slot.out]
    return CheckpointSpec(
        id=number,
        kind=kind,
        name=f"{kind} {number}",
        position=position,
        yaw=yaw,
        nominal=_nominal(kind, random),
    )


def _nominal(kind: CheckpointKind, random: np.random.Generator) -> Interval:
    if kind == CheckpointKind.VALVE:
        low = float(random.choice([0.0, 40.0, 85.0]))
        return Interval(low=low, high=low + (10.0 if low == 40.0 else 5.0))
    share = float(random.integers(5, 65)) / 100
    scale = 10.0 if kind == CheckpointKind.PRESSURE_GAUGE else 100.0
    return Interval(low=round(share * scale, 2), high=round((share + 0.25) * scale, 2))
