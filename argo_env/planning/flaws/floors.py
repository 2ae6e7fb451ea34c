"""Floors that can't be reached, and floors that can be reached but not patrolled."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.listing import listed
from argo_env.navigation import Navigator
from argo_env.navigation.lattice import MARGIN
from argo_env.planning.checking import unpatrolled_floors
from argo_env.planning.flaws.flaw import JOINT_GAP, Flaw, Mark, obstructions_between, position_text
from argo_env.planning.flaws.safe_states import SafeStates
from argo_env.planning.patrols import MIN_SPACING, patrol_corners
from argo_env.site.spec import LEDGE, FloorSpec, TowerSpec, distance_to_rect
from argo_env.site.stairs import flight_end_areas

TURNING_SPACE = 1.4  # m, edge of a square in which the robot turns easily
MIN_WIDTH = 0.7  # m, recommended least width of walkways, stairs and paths
_CORNERS = ("south-west", "south-east", "north-east", "north-west")


def floor_flaws(states: SafeStates, navigator: Navigator) -> list[Flaw]:
    """Return the flaws of floors: those that can't be reached, and those without a patrol.

    All floors that can't be reached have one flaw, which explains why the lowest of them can't.
    Each floor that can be reached but not patrolled has a flaw of its own.
    """
    floors = navigator.site.spec.floors
    flaws, unreached = [], unreached_floors(states)
    if unreached:
        first, *above = unreached
        flaw = _unreached_flaw(states, floors, first)
        message = flaw.message
        if above:
            noun = "floors" if len(above) > 1 else "floor"
            message += f"; {noun} {listed(above)} can't be reached either"
        flaws.append(Flaw(message, flaw.marks))
    return flaws + [
        _patrol_flaw(navigator, floors[number - 1])
        for number in unpatrolled_floors(navigator)
        if number not in unreached
    ]


def unreached_floors(states: SafeStates) -> list[int]:
    """Return the numbers of the floors on which the robot can't reach any state, ascending.

    It starts at the first docking station at which it can stand; without one, all floors count.
    """
    floors = states.site.spec.floors
    return [f.number for f in floors if not states.reached[states.is_on_floor(f)].any()]


def _unreached_flaw(states: SafeStates, floors: Sequence[FloorSpec], number: int) -> Flaw:
    floor = floors[number - 1]
    flaw = _standing_flaw(states, floor)
    if flaw is None and number == 1:
        flaw = _entry_flaw(states, floor)
    elif flaw is None:
        flaw = _stairs_flaw(states, floors[number - 2], floor)
    return Flaw(
        f"floor {number} can't be reached from docking station {states.lowest_usable_dock_number}: "
        f"{flaw.message}",
        flaw.marks,
    )


def _standing_flaw(states: SafeStates, floor: FloorSpec) -> Flaw | None:
    if states.is_on_floor(floor).any():
        return None
    name, rect = max(floor.walkways.items(), key=lambda item: min(_size(item[1])))
    width = min(_size(rect))
    reason = (
        f"its widest walkway, `{name}`, is {width:.2f} m wide; make it {MIN_WIDTH} m at least"
        if width < MIN_WIDTH
        else f"the robot can stand nowhere on it; keep {MIN_WIDTH} m by 1 m of deck free"
    )
    return Flaw(reason, (_center(floor, rect),))


def _entry_flaw(states: SafeStates, floor: FloorSpec) -> Flaw:
    """Return the reason why the lowest floor can't be reached from the ground."""
    spec, robot = states.site.spec, states.lattice.robot
    step = floor.z - spec.ground_z
    goals = states.positions[states.is_on_floor(floor)]
    dock = states.positions[states.docks[states.lowest_usable_dock_number or 1] or 0]
    goal = goals[np.argmin(np.hypot(*(goals - dock)[:, :2].T))]
    if step > robot.max_step:
        return Flaw(
            f"it lies {step:.2f} m above the ground, and the robot climbs steps of "
            f"{robot.max_step:g} m; lower its `z`, or raise `ground_z`",
            (Mark(floor.number, float(goal[0]), float(goal[1])),),
        )
    nearest = states.nearest_reached(*goal.tolist())
    if nearest is None:
        nearest = dock
    goal = goals[np.argmin(np.hypot(*(goals - nearest)[:, :2].T))]
    obstructions = _obstruction_text(states, nearest, goal)
    if "railing" in obstructions and floor.railed:
        remedy = "leave the railing out where the path leads in (`gates`), or give `railed: false`"
    else:
        remedy = f"clear a path {MIN_WIDTH} m wide"
    return Flaw(
        f"the nearest position that can be reached is {position_text(*nearest[:2])} on the ground, "
        f"{math.dist(nearest[:2], goal[:2]):.1f} m from {position_text(*goal[:2])}{obstructions}; "
        f"{remedy}",
        tuple(Mark(floor.number, float(p[0]), float(p[1])) for p in (nearest, goal)),
    )


def _stairs_flaw(states: SafeStates, below: FloorSpec, floor: FloorSpec) -> Flaw:
    """Return the reasons why no tower leads up to a floor from the one below, which is reached."""
    towers = states.site.spec.towers
    if not any(tower.flights for tower in towers):
        rect = next(iter(floor.walkways.values()))
        return Flaw(
            f"there are no stairs; give `towers` a flight that rises from floor {below.number} to "
            f"floor {floor.number}",
            (_center(floor, rect),),
        )
    flaws = [
        _tower_end_flaw(tower, below, floor) or _climb_flaw(states, tower, below, floor)
        for tower in towers
        if tower.flights
    ]
    return Flaw(
        "; ".join(flaw.message for flaw in flaws), tuple(m for flaw in flaws for m in flaw.marks)
    )


def _tower_end_flaw(tower: TowerSpec, below: FloorSpec, floor: FloorSpec) -> Flaw | None:
    """Return a flaw if a flight of a tower begins or ends in the air between two floors."""
    levels = [
        (below.z, f"floor {below.number}", below.walkways),
        (floor.z, f"floor {floor.number}", floor.walkways),
        *((below.z + g.z, g.name, {g.name: g.rect}) for g in tower.landings),
    ]
    for flight in tower.flights:
        for verb, (z, (x0, y0, x1, y1)) in zip(
            ("begins", "ends"), flight_end_areas(flight, below.z), strict=True
        ):
            x, y = (x0 + x1) / 2, (y0 + y1) / 2
            marks = (Mark(floor.number if verb == "ends" else below.number, x, y),)
            position = position_text(x, y)
            begins = f"{tower.name}: its flight `{flight.name}` {verb} in the air, at {position}"
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
                (distance_to_rect(rect, x, y), part, name)
                for name, rects in joined
                for part, rect in rects.items()
            )
            if gap > JOINT_GAP:
                whole = name if part == name else f"`{part}` of {name}"
                return Flaw(
                    f"{begins}, {gap:.2f} m from {whole}, the nearest deck of that height; let one "
                    "reach there, or move the flight's `foot`",
                    marks,
                )
    return None


def _climb_flaw(states: SafeStates, tower: TowerSpec, below: FloorSpec, floor: FloorSpec) -> Flaw:
    """Return the reason why the robot can't climb a tower that joins two floors."""
    robot = states.lattice.robot
    for flight in tower.flights:
        min_width = 2 * (robot.footprint.half_width + MARGIN)
        _, (x0, y0, x1, y1) = flight_end_areas(flight, below.z)[0]
        marks = (Mark(below.number, (x0 + x1) / 2, (y0 + y1) / 2),)
        if flight.width < min_width:
            return Flaw(
                f"{tower.name}: its flight `{flight.name}` is {flight.width:g} m wide; make it "
                f"{MIN_WIDTH} m at least",
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
    before = x - TURNING_SPACE / 2 * math.cos(yaw), y - TURNING_SPACE / 2 * math.sin(yaw)
    top = _highest_reached(states, tower, below, floor)
    if top is None:
        nearest = states.nearest_reached(*before, below.z)
        assert nearest is not None  # the floor below is reached
        obstructions = _obstruction_text(states, nearest, (*before, below.z))
        return Flaw(
            f"{tower.name}: its foot at {position_text(x, y)} can't be driven up; the nearest "
            f"position that can be reached is {position_text(*nearest[:2])}, "
            f"{math.dist(nearest[:2], (x, y)):.1f} m away{obstructions}; leave {TURNING_SPACE} m "
            f"by {TURNING_SPACE} m free before the foot, to turn in",
            (Mark(below.number, x, y), Mark(below.number, float(nearest[0]), float(nearest[1]))),
        )
    return Flaw(
        f"{tower.name}: the robot can drive from floor {below.number} up to "
        f"{position_text(*top[:2])}, {top[2] - below.z:.2f} m up, and no farther; leave "
        f"{TURNING_SPACE} m by {TURNING_SPACE} m free after each flight, to turn in, and "
        f"{robot.driving_height:.1f} m above the steps",
        (Mark(states.site.floor_at(float(top[2])), float(top[0]), float(top[1])),),
    )


def _obstruction_text(states: SafeStates, a: NDArray[np.float64], b: Sequence[float]) -> str:
    """Return the end of a sentence that names the things between two positions, or nothing."""
    height = states.lattice.robot.driving_height
    things = obstructions_between(states.site, a, np.array(b), height)
    return f", and between them is {things}" if things else ""


def _highest_reached(
    states: SafeStates, tower: TowerSpec, below: FloorSpec, floor: FloorSpec
) -> NDArray[np.float64] | None:
    """Return the highest reached position on a tower between two floors; None: there is none."""
    x, y, z = states.positions.T
    corners = [
        corner
        for flight in tower.flights
        for _, (x0, y0, x1, y1) in flight_end_areas(flight, below.z)
        for corner in ((x0, y0), (x1, y1))
    ]
    low, high = np.min(corners, axis=0), np.max(corners, axis=0)
    climbed = states.reached & (z > below.z + 0.1) & (z < floor.z + 0.1)
    climbed &= (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])
    positions = states.positions[climbed]
    return positions[np.argmax(positions[:, 2])] if len(positions) else None


def _patrol_flaw(navigator: Navigator, floor: FloorSpec) -> Flaw:
    """Return the flaw of a floor that can't be patrolled, with the corners that are too narrow."""
    corners = patrol_corners(navigator, floor.number)
    rects = np.array(list(floor.walkways.values()))
    (x0, y0), (x1, y1) = rects[:, :2].min(axis=0), rects[:, 2:].max(axis=0)
    message = (
        f"floor {floor.number} can be reached, but not patrolled: that takes three positions to "
        f"turn at, {MIN_SPACING:g} m apart, and there "
    )
    turning = [position_text(x, y) for x, y, _ in corners]
    message += f"is {turning[0]}" if len(turning) == 1 else f"are {listed(turning or ['none'])}"
    min_size = MIN_SPACING + TURNING_SPACE
    if x1 - x0 < min_size or y1 - y0 < min_size:
        return Flaw(
            f"{message}: it is {x1 - x0:.2f} m by {y1 - y0:.2f} m as a whole; make it "
            f"{min_size:g} m by {min_size:g} m at least",
            (Mark(floor.number, (x0 + x1) / 2, (y0 + y1) / 2),),
        )
    marks, narrow = [], []
    for name, (x, y) in zip(_CORNERS, ((x0, y0), (x1, y0), (x1, y1), (x0, y1)), strict=True):
        if any(math.dist((x, y), corner[:2]) < MIN_SPACING for corner in corners):
            continue
        part, rect = min(floor.walkways.items(), key=lambda item: distance_to_rect(item[1], x, y))
        if distance_to_rect(rect, x, y) > TURNING_SPACE:
            continue  # no deck there
        x, y = min(max(x, rect[0]), rect[2]), min(max(y, rect[1]), rect[3])
        marks.append(Mark(floor.number, float(x), float(y)))
        narrow.append(
            f"the {name} corner, {position_text(x, y)}, where `{part}` is "
            f"{min(_size(rect)):.2f} m wide"
        )
    return Flaw(
        f"{message}; too narrow, or not free: {'; '.join(narrow) or 'the rest'}; give it "
        f"{TURNING_SPACE} m by {TURNING_SPACE} m to turn in",
        tuple(marks),
    )


def _size(rect: Sequence[float]) -> tuple[float, float]:
    return rect[2] - rect[0], rect[3] - rect[1]


def _center(floor: FloorSpec, rect: Sequence[float]) -> Mark:
    return Mark(floor.number, (rect[0] + rect[2]) / 2, (rect[1] + rect[3]) / 2)
