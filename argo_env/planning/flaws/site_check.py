"""Check of a site: docking stations, floors, checkpoints and named locations that are of no use."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.listing import listed
from argo_env.navigation import Navigator
from argo_env.navigation.stencil import HEADINGS
from argo_env.navigation.views import candidate_views, find_view_states_and_costs, sight_target
from argo_env.planning.checking import unpatrolled_floors, unseen_checkpoints
from argo_env.planning.flaws.flaw import (
    Flaw,
    Mark,
    compass_direction,
    obstructions_between,
    obstructions_in_box,
    position_text,
)
from argo_env.planning.flaws.floors import floor_flaws, unreached_floors
from argo_env.planning.flaws.safe_states import SafeStates
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.norms import height_errors
from argo_env.site.shapes import Solid, Vector, crossing


def dock_flaws(states: SafeStates) -> list[Flaw]:
    """Return a flaw for each docking station at which the robot can't stand, or that is cut off.

    A station is cut off if there is no path to it from the first usable one and back. If no station
    has such a flaw, but the robot can't turn anywhere, that is the only flaw.
    """
    flaws = [_unusable_dock(states, n) for n, state in states.docks.items() if state is None]
    for number, state in states.docks.items():
        if state is not None and not states.reached[state]:
            flaws.append(_unconnected_dock(states, number))
    if not flaws and states.lowest_usable_dock_number is not None and not _can_turn(states):
        flaws.append(_cramped_dock(states, states.lowest_usable_dock_number))
    return flaws


def _can_turn(states: SafeStates) -> bool:
    """Return True if there is a reached cell in which the robot can turn all round."""
    return bool(np.bincount(states.lattice.cell[states.reached]).max() >= HEADINGS)


def _cramped_dock(states: SafeStates, number: int) -> Flaw:
    dock = states.site.docks[number]
    return Flaw(
        f"docking station {number}: the robot can't get away from its `dock`, "
        f"{position_text(dock.x, dock.y)}, and back; leave 1.4 m by 1.4 m free there, to turn in, "
        f"also from the edges of the ground, {list(states.site.spec.ground)}",
        (Mark(1, dock.x, dock.y),),
    )


def _unusable_dock(states: SafeStates, number: int) -> Flaw:
    site, robot = states.site, states.lattice.robot
    dock, (x0, y0, x1, y1) = site.docks[number], site.spec.ground
    marks = (Mark(1, dock.x, dock.y),)
    position = position_text(dock.x, dock.y)
    fault = f"docking station {number}: the robot can't stand at its `dock`, {position}"
    inside = min(dock.x - x0, x1 - dock.x, dock.y - y0, y1 - dock.y)
    ground = f"the ground, {list(site.spec.ground)}"
    if inside < 0:
        return Flaw(f"{fault}: that is outside of {ground}; move it, or enlarge `ground`", marks)
    reach = robot.footprint.radius
    if inside < reach:
        return Flaw(
            f"{fault}: that is {inside:.2f} m from the edge of {ground}; keep {reach:.2f} m", marks
        )
    things = obstructions_in_box(
        site,
        (dock.x - reach / 2, dock.y - reach / 2, dock.z + 0.05),
        (dock.x + reach / 2, dock.y + reach / 2, dock.z + robot.driving_height),
    )
    why = f": there is {things}" if things else ", where the ground is not even"
    return Flaw(f"{fault}{why}; move the station, or clear {2 * reach:.1f} m around it", marks)


def _unconnected_dock(states: SafeStates, number: int) -> Flaw:
    dock = states.site.docks[number]
    first = states.lowest_usable_dock_number
    message = f"there is no path from docking station {first} to docking station {number} and back"
    nearest = states.nearest_reached(dock.x, dock.y, dock.z)
    marks = [Mark(1, dock.x, dock.y)]
    if nearest is not None:
        x, y, z = nearest.tolist()
        marks.append(Mark(states.site.floor_at(z), x, y))
        state = states.docks[number]
        height = states.lattice.robot.driving_height
        things = obstructions_between(states.site, nearest, states.positions[state], height)
        message += (
            f": the nearest position that can be reached is {position_text(x, y)}, "
            f"{math.hypot(dock.x - x, dock.y - y):.1f} m away"
        )
        message += f", and between them is {things}" if things else ""
    return Flaw(
        f"{message}; clear a path 0.7 m wide, or leave out one of the two areas", tuple(marks)
    )


_SAMPLED = 100  # camera positions from which hidden faces are checked


def checkpoint_flaws(
    states: SafeStates, navigator: Navigator, floors_with_single_flaw: Collection[int]
) -> list[Flaw]:
    """Return the flaws of checkpoints that can't be read.

    There is one for each such checkpoint, but only one for all on the same one of
    `floors_with_single_flaw`.
    """
    site = navigator.site
    unseen = [site.checkpoint(id) for id in unseen_checkpoints(navigator)]
    flaws = [
        _checkpoint_flaw(states, navigator, checkpoint)
        for checkpoint in unseen
        if checkpoint.floor not in floors_with_single_flaw
    ]
    for floor in floors_with_single_flaw:
        on_floor = [checkpoint for checkpoint in unseen if checkpoint.floor == floor]
        if on_floor:
            noun = "checkpoints" if len(on_floor) > 1 else "checkpoint"
            numbers = listed(checkpoint.id for checkpoint in on_floor)
            message = f"{noun} {numbers} on floor {floor} can't be read, as it can't be reached"
            flaws.append(Flaw(message, tuple(map(_mark, on_floor))))
    return flaws


def _checkpoint_flaw(states: SafeStates, navigator: Navigator, checkpoint: SiteCheckpoint) -> Flaw:
    message = f"checkpoint {checkpoint.id} ({checkpoint.name}) can't be read: "
    return Flaw(message + _explain_unseen(states, navigator, checkpoint), (_mark(checkpoint),))


def _explain_unseen(states: SafeStates, navigator: Navigator, checkpoint: SiteCheckpoint) -> str:
    """Return the reason why a checkpoint can't be read, with a remedy."""
    site, sensor = navigator.site, navigator.robot.sensor
    x, y, z = sight_target(checkpoint).tolist()
    looks = (
        f"its face looks {compass_direction(checkpoint.yaw)} "
        f"(`yaw` {math.degrees(checkpoint.yaw):.0f})"
    )
    floor = site.floor(checkpoint.floor)
    above_camera = z - floor.z - sensor.offset[2]
    if abs(above_camera) > sensor.max_range:
        return (
            f"it is {z - floor.z:.1f} m above the deck, and the camera, {sensor.offset[2]:.2f} m "
            f"above it, reads from {sensor.min_range:g} to {sensor.max_range:g} m; hang it lower"
        )
    views = candidate_views(checkpoint, navigator.lattice)
    if len(views.states):
        element = _find_hiding_element(site, views.cameras, (x, y, z))
        poses = f"the {len(views.states)} poses before it"
        if element is None:
            return f"{looks}, and it can't be seen from any of {poses}; turn or move it"
        if element.from_all:
            hidden = f"{element.name} hides it from each of {poses}"
        else:
            hidden = f"it can't be seen from any of {poses}; {element.name} hides it from some"
        return f"{looks}, and {hidden}; turn it, move it, or move what hides it"
    unreached_views, _ = find_view_states_and_costs(site, checkpoint, states.lattice)
    if len(unreached_views):
        view = states.positions[unreached_views[0]]
        return (
            f"{looks}; it is visible from {position_text(view[0], view[1])}, which can't be "
            "reached; turn it, or clear a path there"
        )
    limits = (
        f"{sensor.min_range:g} to {sensor.max_range:g} m from it and at most "
        f"{sensor.max_obliqueness:g}° off the direction in which it looks"
    )
    nearest = states.nearest_reached(x, y, floor.z)
    if nearest is None:
        return f"{looks}, and there is nowhere to stand {limits}; turn or move it"
    ahead = (nearest[0] - x) * math.cos(checkpoint.yaw)
    ahead += (nearest[1] - y) * math.sin(checkpoint.yaw)
    behind = ", behind it" if ahead < 0 else ""
    return (
        f"{looks}, and there is nowhere to stand {limits}; the nearest position that can be "
        f"reached is {position_text(nearest[0], nearest[1])}, "
        f"{math.dist(nearest[:2], (x, y)):.1f} m away{behind}; {'turn' if behind else 'move'} it"
    )


@dataclass(frozen=True)
class _HidingElement:
    """Element that hides a point from cameras."""

    name: str
    from_all: bool
    """whether it hides the point from each of the cameras"""


def _find_hiding_element(
    site: Site, cameras: NDArray[np.float64], target: Vector
) -> _HidingElement | None:
    """Return the element that hides a point from most of a sample of the cameras.

    `cameras` are their positions (m), shape (n, 3). Returns None if no element hides it from any
    camera of the sample.
    """
    sample = cameras[:: max(1, len(cameras) // _SAMPLED)]
    low = np.minimum(cameras.min(axis=0), target)
    high = np.maximum(cameras.max(axis=0), target)
    near = set(map(id, site.solids.touching_box(low, high)))
    solids = {
        element.name: [solid for solid in element.solids if id(solid) in near]
        for element in site.elements
    }
    counts = {
        name: int(_are_hidden(sample, target, own).sum()) for name, own in solids.items() if own
    }
    name = max(counts, key=lambda name: counts[name], default=None)
    if name is None or not counts[name]:
        return None
    return _HidingElement(name, bool(_are_hidden(cameras, target, solids[name]).all()))


def _are_hidden(
    cameras: NDArray[np.float64], target: Vector, solids: Sequence[Solid]
) -> NDArray[np.bool_]:
    """Return for each camera, shape (n,), whether one of the solids hides the target from it."""
    hidden = np.zeros(len(cameras), dtype=bool)
    for solid in solids:
        entry, leave = crossing(solid, cameras, np.array(target) - cameras)
        hidden |= (entry <= 1.0) & (leave >= 0.0)
    return hidden


def _mark(checkpoint: SiteCheckpoint) -> Mark:
    return Mark(checkpoint.floor, checkpoint.position[0], checkpoint.position[1])


@dataclass(frozen=True)
class SiteCheck:
    """The flaws of a site, and the states in which the robot can stand on it."""

    flaws: tuple[Flaw, ...]
    states: SafeStates | None = None
    """states in which the robot can stand; None: there are no flaws"""


def find_flaws(navigator: Navigator) -> SiteCheck:
    """Find everything on the navigator's site that the robot can't reach or read, and explain it.

    To reach means to get there from the docking stations and back. Errors that keep the robot from
    everything else, in the heights of stairs or at the docking stations, are reported alone.
    """
    site = navigator.site
    place_flaws = _place_flaws(navigator) if _can_use_docks(navigator) else None
    if place_flaws == [] and not (
        height_errors(site.spec) or unpatrolled_floors(navigator) or unseen_checkpoints(navigator)
    ):
        return SiteCheck(())
    states = SafeStates.from_navigator(navigator)
    if errors := height_errors(site.spec):
        # Anything that can't be reached for this reason is reported once the heights are correct.
        return SiteCheck(tuple(Flaw(error) for error in errors), states)
    if place_flaws is None or dock_flaws(states):
        return SiteCheck(tuple(dock_flaws(states)), states)
    flaws = (
        *floor_flaws(states, navigator),
        *checkpoint_flaws(states, navigator, unreached_floors(states)),
        *place_flaws,
    )
    return SiteCheck(flaws, states)


def _can_use_docks(navigator: Navigator) -> bool:
    try:
        navigator.prepare()
    except ArgoError:
        return False
    return True


def _place_flaws(navigator: Navigator) -> list[Flaw]:
    """Return a flaw for each named location that is not within SNAP_DISTANCE of a reachable one."""
    flaws = []
    for name, pose in navigator.site.places.items():
        try:
            navigator.snap_keeping_heading(pose)
        except ArgoError as error:
            flaws.append(Flaw(f"place {name}: {error}; move it", (Mark(1, pose.x, pose.y),)))
    return flaws
