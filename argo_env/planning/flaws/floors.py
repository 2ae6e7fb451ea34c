"""Floors that can't be reached, and floors that can be reached but not patrolled."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.listing import listed
from argo_env.navigation import Navigator
from argo_env.navigation.lattice import MARGIN
from argo_env.planning.checking import unserved_floors
from argo_env.planning.flaws.flaw import ASIDE, Flaw, Mark, between, place
from argo_env.planning.flaws.standing import Standing
from argo_env.planning.patrols import APART, patrol_corners
from argo_env.site.spec import LEDGE, FloorSpec, TowerSpec, away
from argo_env.site.stairs import mouths

TURN = 1.4  # m by 1.4 m, in which the robot turns with room to spare
WALKWAY = 0.7  # m
_CORNERS = ("south-west", "south-east", "north-east", "north-west")


def floor_flaws(standing: Standing, navigator: Navigator) -> list[Flaw]:
    """The lowest floor that can't be reached, and those that can but not patrolled."""
    floors = navigator.site.spec.floors
    flaws, lost = [], lost_floors(standing)
    if lost:
        first, *above = lost
        flaw = _unreached(standing, floors, first)
        message = flaw.message
        if above:
            many = "floors" if len(above) > 1 else "floor"
            message += f"; {many} {listed(above)} can't be reached either"
        flaws.append(Flaw(message, flaw.marks))
    return flaws + [
        _unpatrolled(navigator, floors[number - 1])
        for number in unserved_floors(navigator)
        if number not in lost
    ]


def lost_floors(standing: Standing) -> list[int]:
    """The numbers of the floors on which no place can be reached."""
    floors = standing.site.spec.floors
    return [f.number for f in floors if not standing.reached[standing.on(f)].any()]


def _unreached(standing: Standing, floors: Sequence[FloorSpec], number: int) -> Flaw:
    floor = floors[number - 1]
    flaw = _no_stand(standing, floor)
    if flaw is None and number == 1:
        flaw = _no_entry(standing, floor)
    elif flaw is None:
        flaw = _no_stairs(standing, floors[number - 2], floor)
    return Flaw(
        f"floor {number} can't be reached from docking station {standing.first_dock}: "
        f"{flaw.message}",
        flaw.marks,
    )


def _no_stand(standing: Standing, floor: FloorSpec) -> Flaw | None:
    if standing.on(floor).any():
        return None
    name, rect = max(floor.walkways.items(), key=lambda item: min(_size(item[1])))
    wide = min(_size(rect))
    why = (
        f"its widest walkway, `{name}`, is {wide:.2f} m wide; make it {WALKWAY} m at least"
        if wide < WALKWAY
        else f"the robot can stand nowhere on it; keep {WALKWAY} m by 1 m of deck free"
    )
    return Flaw(why, (_middle(floor, rect),))


def _no_entry(standing: Standing, floor: FloorSpec) -> Flaw:
    """Why the lowest floor can't be reached from the ground."""
    spec, robot = standing.site.spec, standing.lattice.robot
    up = floor.z - spec.ground_z
    there = standing.places[standing.on(floor)]
    dock = standing.places[standing.docks[standing.first_dock or 1] or 0]
    goal = there[np.argmin(np.hypot(*(there - dock)[:, :2].T))]
    if up > robot.max_step:
        return Flaw(
            f"it lies {up:.2f} m above the ground, and the robot climbs steps of "
            f"{robot.max_step:g} m; lower its `z`, or raise `ground_z`",
            (Mark(floor.number, float(goal[0]), float(goal[1])),),
        )
    here = standing.nearest_reached(*goal.tolist())
    if here is None:
        here = dock
    goal = there[np.argmin(np.hypot(*(there - here)[:, :2].T))]
    stands = _stands(standing, here, goal)
    if "railing" in stands and floor.railed:
        remedy = "leave the railing out where the way leads in (`gates`), or give `railed: false`"
    else:
        remedy = f"clear a way of {WALKWAY} m"
    return Flaw(
        f"the nearest place that can be reached is {place(*here[:2])} on the ground, "
        f"{math.dist(here[:2], goal[:2]):.1f} m from {place(*goal[:2])}{stands}; {remedy}",
        tuple(Mark(floor.number, float(p[0]), float(p[1])) for p in (here, goal)),
    )


def _no_stairs(standing: Standing, below: FloorSpec, floor: FloorSpec) -> Flaw:
    """Why no tower leads up to a floor from the one below, which can be reached."""
    towers = standing.site.spec.towers
    if not any(tower.flights for tower in towers):
        rect = next(iter(floor.walkways.values()))
        return Flaw(
            f"there are no stairs; give `towers` a flight that rises from floor {below.number} to "
            f"floor {floor.number}",
            (_middle(floor, rect),),
        )
    found = [
        _tower_end(tower, below, floor) or _climb(standing, tower, below, floor)
        for tower in towers
        if tower.flights
    ]
    return Flaw(
        "; ".join(flaw.message for flaw in found), tuple(m for flaw in found for m in flaw.marks)
    )


def _tower_end(tower: TowerSpec, below: FloorSpec, floor: FloorSpec) -> Flaw | None:
    """Where a tower begins or ends in the air between two floors, if it does."""
    levels = [
        (below.z, f"floor {below.number}", below.walkways),
        (floor.z, f"floor {floor.number}", floor.walkways),
        *((below.z + g.z, g.name, {g.name: g.rect}) for g in tower.landings),
    ]
    for flight in tower.flights:
        for verb, (z, (x0, y0, x1, y1)) in zip(
            ("begins", "ends"), mouths(flight, below.z), strict=True
        ):
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            marks = (Mark(floor.number if verb == "ends" else below.number, x, y),)
            begins = f"{tower.name}: its flight `{flight.name}` {verb} in the air, at {place(x, y)}"
            if below.number > 1:
                begins += f" above floor {below.number}, where the tower is repeated"
            joined = [(name, rects) for level, name, rects in levels if abs(level - z) <= 2 * LEDGE]
            if not joined:
                return Flaw(
                    f"{begins} and {z - below.z:.2f} m above floor {below.number}, where there is "
                    "neither floor nor landing; add a landing of that `z`, or change its risers",
                    marks,
                )
            gap, part, name = min(
                (away(rect, x, y), part, name)
                for name, rects in joined
                for part, rect in rects.items()
            )
            if gap > ASIDE:
                whole = name if part == name else f"`{part}` of {name}"
                return Flaw(
                    f"{begins}, {gap:.2f} m from {whole}, the nearest deck of that height; let one "
                    "reach there, or move the flight's `foot`",
                    marks,
                )
    return None


def _climb(standing: Standing, tower: TowerSpec, below: FloorSpec, floor: FloorSpec) -> Flaw:
    """How far the robot gets on a tower that joins two floors, and what ends it."""
    robot = standing.lattice.robot
    for flight in tower.flights:
        narrow = 2 * (robot.footprint.half_width + MARGIN)
        _, (x0, y0, x1, y1) = mouths(flight, below.z)[0]
        marks = (Mark(below.number, (x0 + x1) / 2, (y0 + y1) / 2),)
        if flight.width < narrow:
            return Flaw(
                f"{tower.name}: its flight `{flight.name}` is {flight.width:g} m wide; make it "
                f"{WALKWAY} m at least",
                marks,
            )
        if flight.rise > robot.max_step:
            return Flaw(
                f"{tower.name}: the steps of its flight `{flight.name}` rise {flight.rise:g} m, "
                f"and the robot climbs {robot.max_step:g} m; give it more `risers`",
                marks,
            )
    lowest = min(tower.flights, key=lambda flight: flight.foot[2])
    yaw, (x, y) = math.radians(lowest.yaw), lowest.foot[:2]
    before = x - TURN / 2 * math.cos(yaw), y - TURN / 2 * math.sin(yaw)
    top = _highest(standing, tower, below, floor)
    if top is None:
        here = standing.nearest_reached(*before, below.z)
        assert here is not None  # the floor below is reached
        return Flaw(
            f"{tower.name}: its foot at {place(x, y)} can't be driven up; the nearest place that "
            f"can be reached is {place(*here[:2])}, {math.dist(here[:2], (x, y)):.1f} m away"
            f"{_stands(standing, here, (*before, below.z))}; leave {TURN} m by {TURN} m free "
            "before the foot, to turn in",
            (Mark(below.number, x, y), Mark(below.number, float(here[0]), float(here[1]))),
        )
    return Flaw(
        f"{tower.name}: it can be driven from floor {below.number} up to {place(*top[:2])}, "
        f"{top[2] - below.z:.2f} m up, and no farther; leave {TURN} m by {TURN} m free after each "
        f"flight, to turn in, and {robot.driving_height:.1f} m above the steps",
        (Mark(standing.site.floor_at(float(top[2])), float(top[0]), float(top[1])),),
    )


def _stands(standing: Standing, here: NDArray[np.float64], there: Sequence[float]) -> str:
    things = between(standing.site, here, np.array(there), standing.lattice.robot.driving_height)
    return f", and between stands {things}" if things else ""


def _highest(
    standing: Standing, tower: TowerSpec, below: FloorSpec, floor: FloorSpec
) -> NDArray[np.float64] | None:
    """The highest place between two floors, on the tower, that can be reached."""
    x, y, z = standing.places.T
    corners = [
        corner
        for flight in tower.flights
        for _, (x0, y0, x1, y1) in mouths(flight, below.z)
        for corner in ((x0, y0), (x1, y1))
    ]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    climbed = standing.reached & (z > below.z + 0.1) & (z < floor.z + 0.1)
    climbed &= (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])
    found = standing.places[climbed]
    return found[np.argmax(found[:, 2])] if len(found) else None


def _unpatrolled(navigator: Navigator, floor: FloorSpec) -> Flaw:
    """Which corners of a floor are too narrow for a patrol."""
    corners = patrol_corners(navigator, floor.number)
    rects = np.array(list(floor.walkways.values()))
    (x0, y0), (x1, y1) = rects[:, :2].min(axis=0), rects[:, 2:].max(axis=0)
    message = (
        f"floor {floor.number} can be reached, but not patrolled: that takes three places to turn, "
        f"{APART:g} m apart, and there "
    )
    turning = [place(x, y) for x, y, _ in corners]
    message += f"is {turning[0]}" if len(turning) == 1 else f"are {listed(turning or ['none'])}"
    least = APART + TURN
    if x1 - x0 < least or y1 - y0 < least:
        return Flaw(
            f"{message}: it is {x1 - x0:.2f} m by {y1 - y0:.2f} m as a whole; make it "
            f"{least:g} m by {least:g} m at least",
            (Mark(floor.number, (x0 + x1) / 2, (y0 + y1) / 2),),
        )
    marks, narrow = [], []
    for name, (x, y) in zip(_CORNERS, ((x0, y0), (x1, y0), (x1, y1), (x0, y1)), strict=True):
        if any(math.dist((x, y), corner[:2]) < APART for corner in corners):
            continue
        part, rect = min(floor.walkways.items(), key=lambda item: away(item[1], x, y))
        if away(rect, x, y) > TURN:
            continue  # no deck there
        x, y = min(max(x, rect[0]), rect[2]), min(max(y, rect[1]), rect[3])
        marks.append(Mark(floor.number, float(x), float(y)))
        narrow.append(
            f"the {name} corner, {place(x, y)}, where `{part}` is {min(_size(rect)):.2f} m wide"
        )
    return Flaw(
        f"{message}; too narrow, or not free: {'; '.join(narrow) or 'the rest'}; give it "
        f"{TURN} m by {TURN} m to turn in",
        tuple(marks),
    )


def _size(rect: Sequence[float]) -> tuple[float, float]:
    return rect[2] - rect[0], rect[3] - rect[1]


def _middle(floor: FloorSpec, rect: Sequence[float]) -> Mark:
    return Mark(floor.number, (rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2)
