"""Faults of walkways: bricks, missing ground plates and blocked stairs.

They exist from the start of the run: they change the site's solids before the world is made, so
that rays, contacts, pictures and dynamics all use the same solids.
"""

import cmath
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.il import EventKind
from argo_env.faults.fault import Fault, Sign, in_unit
from argo_env.seeding import draw
from argo_env.site import Site
from argo_env.site.shapes import Box, Element, Role, Solid, Vector, half_extents
from argo_env.site.spec import FlightSpec, FloorSpec, Point, Rect, TowerSpec
from argo_env.site.stairs import flight_run

PLATE = 0.6  # m, edge of a ground plate
BARRIER = (0.06, 1.0)  # m, thickness and height of a barrier
_BARRIER_DISTANCE = 0.25  # m from the nosing to the barrier
_RIM_DISTANCE = 0.35  # m from a drawn position to the rim of its walkway, if possible
_TOUCHING = 1e-6  # m
_BESIDE = 0.5  # m beside an obstacle or the edge of a hole within which it may be detected
_DRAWS = 100  # positions that are drawn at most until one is free
_TURNING_ROOM = 0.65  # m about the middle of a docked robot, which it needs to turn
_STATION = 0.6  # m ahead of the middle of a docked robot, where its station is
_SAME_LEVEL = 1.0  # m between a floor and the ground, up to which docks are on the floor
_Length = Annotated[float, Field(gt=0, le=1.5)]  # m; larger things don't fit on a walkway


class Brick(Fault):
    """A solid object lies on a walkway."""

    sign: ClassVar[Sign] = Sign(EventKind.POSITIVE_OBSTACLE, "terrain")
    needs_world: ClassVar[bool] = True
    kind: Literal["brick"] = "brick"
    floor: int | None = Field(default=None, ge=1)
    """number of the floor that it lies on"""
    place: Point | None = Field(default=None, json_schema_extra=in_unit("m"))
    """m, x and y of its middle; `floor` must be given too"""
    size: tuple[_Length, _Length, _Length] = Field(
        default=(0.3, 0.2, 0.2), json_schema_extra=in_unit("m")
    )
    """m, along its own axes, at most 1.5"""
    yaw: float | None = Field(default=None, json_schema_extra=in_unit("deg"))
    """deg"""

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:
        return {"floor": [floor.number for floor in site.spec.floors]}

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        for _ in range(1 if self.place else _DRAWS):
            floor, place = _choose_position(site, rng, self.floor, self.place, lowest=1)
            if not any(_contains(r, place) for r in floor.walkways.values()):
                x, y = place
                raise Invalid(
                    Message(
                        "there is no walkway at ({x:g}, {y:g}) of floor {number}",
                        x=x,
                        y=y,
                        number=floor.number,
                    )
                )
            yaw = draw(rng, -90.0, 90.0, 1)
            resolved = self._copy_with(floor=floor.number, place=place).fill_unset(yaw=yaw)
            area = resolved._covered_dock(site, floor)
            if area is None:
                return resolved
        raise Invalid(
            Message(
                "a brick at ({place:g}, {place_2:g}) of floor {number} lies over the dock "
                "of starting area {area}, where the robot has to stand: give another "
                "`place`, or a smaller `size`",
                place=place[0],
                place_2=place[1],
                number=floor.number,
                area=area,
            )
        )

    def _covered_dock(self, site: Site, floor: FloorSpec) -> int | None:
        """Return the number of the starting area whose dock the brick blocks, or None."""
        assert self.place is not None
        assert self.yaw is not None
        if abs(floor.z - site.spec.ground_z) > _SAME_LEVEL:
            return None
        turn = cmath.rect(1.0, -math.radians(self.yaw))
        half_length, half_width = self.size[0] / 2, self.size[1] / 2
        for area, dock in site.docks.items():
            for ahead in (0.0, _STATION):
                offset = (
                    complex(dock.x, dock.y) + cmath.rect(ahead, dock.yaw) - complex(*self.place)
                )
                in_brick_axes = offset * turn
                distance = math.hypot(
                    max(abs(in_brick_axes.real) - half_length, 0.0),
                    max(abs(in_brick_axes.imag) - half_width, 0.0),
                )
                if distance < _TURNING_ROOM:
                    return area
        return None

    def site_elements_with_fault(self, site: Site) -> tuple[Element, ...]:
        assert self.floor is not None
        assert self.place is not None
        assert self.yaw is not None
        z = site.floor(self.floor).z + self.size[2] / 2
        box = Box((*self.place, z), self.size, (0.0, 0.0, math.radians(self.yaw)))
        return (*site.elements, Element(_new_name(site, "brick"), Role.STRUCTURE, (box,), "brick"))

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        return _is_beside_added_solids(self, place, site)


class MissingPlate(Fault):
    """A plate of an upper floor's deck is missing: a hole."""

    sign: ClassVar[Sign] = Sign(EventKind.NEGATIVE_OBSTACLE, "terrain")
    needs_world: ClassVar[bool] = True
    kind: Literal["missing_plate"] = "missing_plate"
    floor: int | None = Field(default=None, ge=1)
    """number of the floor; the lowest has no plates"""
    rect: Rect | None = Field(default=None, json_schema_extra=in_unit("m"))
    """m, [x0, y0, x1, y1]; `floor` must be given too; drawn: a square of 0.6 m"""

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:
        return {"floor": [floor.number for floor in site.spec.floors if floor.railed]}

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        centre = None
        if self.rect is not None:
            x0, y0, x1, y1 = self.rect
            centre = ((x0 + x1) / 2, (y0 + y1) / 2)
        floor, (x, y) = _choose_position(site, rng, self.floor, centre, lowest=2)
        if not floor.railed:
            raise Invalid(
                Message(
                    "floor {number} is a slab on the ground and has no plates; choose a higher "
                    "floor",
                    number=floor.number,
                )
            )
        half = PLATE / 2
        drawn = tuple(round(v, 3) for v in (x - half, y - half, x + half, y + half))
        resolved = self._copy_with(floor=floor.number, rect=self.rect or drawn)
        if resolved.site_elements_with_fault(site) == site.elements:
            raise Invalid(
                Message(
                    "there is no deck at ({x:g}, {y:g}) of floor {number}",
                    x=x,
                    y=y,
                    number=floor.number,
                )
            )
        return resolved

    def site_elements_with_fault(self, site: Site) -> tuple[Element, ...]:
        assert self.floor is not None
        assert self.rect is not None
        z, rect = site.floor(self.floor).z, self.rect
        return tuple(
            replace(e, solids=tuple(p for s in e.solids for p in _cut_out(s, rect, z)))
            if e.role is Role.DECK
            else e
            for e in site.elements
        )

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        if place is None or self.rect is None:
            return False
        (x, y, z), (x0, y0, x1, y1) = place, self.rect
        beside = x0 - _BESIDE <= x <= x1 + _BESIDE and y0 - _BESIDE <= y <= y1 + _BESIDE
        return beside and site.floor_at(z) == self.floor


class BlockedStairs(Fault):
    """Barriers block both ends of a stairway from one floor to the next."""

    sign: ClassVar[Sign] = Sign(EventKind.POSITIVE_OBSTACLE, "terrain")
    needs_world: ClassVar[bool] = True
    kind: Literal["blocked_stairs"] = "blocked_stairs"
    tower: str | None = None
    """name of the stair tower"""
    floor: int | None = Field(default=None, ge=1)
    """the lower one of the two floors"""

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:
        towers = [tower.name for tower in site.spec.towers]
        return {"tower": towers, "floor": [floor.number for floor in site.spec.floors[:-1]]}

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        towers, floors = [t.name for t in site.spec.towers], site.spec.floors[:-1]
        if not towers or not floors:
            raise NotFound(Message("site {site} has no stairs", site=site.name))
        tower = towers[int(rng.integers(len(towers)))]
        floor = floors[int(rng.integers(len(floors)))].number
        if self.tower is not None and self.tower not in towers:
            raise NotFound(
                Message(
                    "site {site} has no stair tower `{tower}`; there are: {towers}",
                    site=site.name,
                    tower=self.tower,
                    towers=Listing(towers),
                )
            )
        if self.floor is not None and self.floor not in [f.number for f in floors]:
            raise NotFound(
                Message(
                    "site {site} has no stairs up from floor {floor}",
                    site=site.name,
                    floor=self.floor,
                )
            )
        return self.fill_unset(tower=tower, floor=floor)

    def site_elements_with_fault(self, site: Site) -> tuple[Element, ...]:
        assert self.floor is not None
        tower = next(t for t in site.spec.towers if t.name == self.tower)
        barriers = _barriers(tower, site.floor(self.floor).z)
        name = _new_name(site, Message("barrier of the {tower}", tower=self.tower))
        return (*site.elements, Element(name, Role.STRUCTURE, barriers, "brick"))

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        return _is_beside_added_solids(self, place, site)


def _is_beside_added_solids(fault: Fault, place: Vector | None, site: Site) -> bool:
    """Return True if `place` is in or near a solid that the fault adds; False if it is None."""
    if place is None:
        return False
    centre, planned = np.array(place), {element.name for element in site.elements}
    return any(
        bool(np.all(np.abs(centre - solid.center) <= half_extents(solid) + _BESIDE))
        for element in fault.site_elements_with_fault(site)
        if element.name not in planned
        for solid in element.solids
    )


def _barriers(tower: TowerSpec, base: float) -> tuple[Solid, ...]:
    """Return barriers across the foot of the lowest flight and the top of the highest one.

    `base` is the height (m) of the floor from which the tower leads up.
    """
    first = min(tower.flights, key=lambda f: f.foot[2])
    last = max(tower.flights, key=lambda f: f.foot[2] + f.risers * f.rise)
    return (
        _barrier(first, base, -_BARRIER_DISTANCE, 0.0),
        _barrier(last, base, flight_run(last) + _BARRIER_DISTANCE, last.risers * last.rise),
    )


def _barrier(flight: FlightSpec, base: float, along: float, up: float) -> Solid:
    """Return an upright panel across a flight of stairs.

    Args:
        flight: flight that the panel is as wide as.
        base: height (m) of the floor that the flight's description is relative to.
        along: horizontal distance (m) of the panel from the flight's first nosing, uphill.
        up: height (m) of the panel's lower edge above the first nosing.
    """
    yaw, (thickness, height) = math.radians(flight.yaw), BARRIER
    x, y, z = flight.foot
    center = (
        x + along * math.cos(yaw), y + along * math.sin(yaw), base + z + up + height / 2,
    )  # fmt: skip
    return Box(center, (thickness, flight.width, height), (0.0, 0.0, yaw))


def _cut_out(solid: Solid, rect: Rect, z: float) -> tuple[Solid, ...]:
    """Cut the rectangle out of a plate with its top at `z`, which leaves up to four parts.

    Other solids are returned unchanged.
    """
    if not isinstance(solid, Box) or solid.rpy != (0.0, 0.0, 0.0):
        return (solid,)
    (x, y, centre), (length, width, thickness) = solid.center, solid.size
    if abs(centre + thickness / 2 - z) > _TOUCHING:
        return (solid,)
    x0, y0, x1, y1 = x - length / 2, y - width / 2, x + length / 2, y + width / 2
    a0, b0, a1, b1 = max(x0, rect[0]), max(y0, rect[1]), min(x1, rect[2]), min(y1, rect[3])
    if a1 - a0 <= _TOUCHING or b1 - b0 <= _TOUCHING:
        return (solid,)
    remaining = ((x0, y0, x1, b0), (x0, b1, x1, y1), (x0, b0, a0, b1), (a1, b0, x1, b1))
    return tuple(
        Box(((c0 + c1) / 2, (d0 + d1) / 2, centre), (c1 - c0, d1 - d0, thickness))
        for c0, d0, c1, d1 in remaining
        if c1 - c0 > _TOUCHING and d1 - d0 > _TOUCHING
    )


def _choose_position(
    site: Site, rng: np.random.Generator, number: int | None, place: Point | None, lowest: int
) -> tuple[FloorSpec, Point]:
    """Return the floor of the given number and the given position, drawing those that are None.

    A floor is drawn from those numbered `lowest` or higher, a position on one of its walkways.
    """
    floors = [f for f in site.spec.floors if f.number >= lowest]
    if not floors:
        raise NotFound(Message("site {site} has no upper floor", site=site.name))
    drawn = floors[int(rng.integers(len(floors)))]
    if number is None and place is not None:
        raise Invalid("a position needs a floor: give the `floor` as well")
    floor = drawn if number is None else site.floor(number)
    x0, y0, x1, y1 = list(floor.walkways.values())[int(rng.integers(len(floor.walkways)))]
    x, y = (
        float(rng.uniform(a + m, b - m))
        for a, b, m in (
            (x0, x1, min(_RIM_DISTANCE, (x1 - x0) / 2)),
            (y0, y1, min(_RIM_DISTANCE, (y1 - y0) / 2)),
        )
    )  # fmt: skip
    return floor, (round(x, 3), round(y, 3)) if place is None else place


def _contains(rect: Rect, place: Point) -> bool:
    return rect[0] <= place[0] <= rect[2] and rect[1] <= place[1] <= rect[3]


def _new_name(site: Site, name: str) -> str:
    known = {element.name for element in site.elements}
    names = (name if k == 1 else f"{name} {k}" for k in range(1, len(known) + 2))
    return next(n for n in names if n not in known)
