"""Looks a site over: whether it can be driven, and what is in the way of it, such as docking
stations in which the robot can't stand and checkpoints that can't be read."""

import math
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import ArgoError
from argo_compiler.base.listing import listed
from argo_env.navigation import Navigator
from argo_env.navigation.stencil import HEADINGS
from argo_env.navigation.views import candidate_views, find_views, sight_target
from argo_env.planning.checking import unseen_checkpoints, unserved_floors
from argo_env.planning.flaws.flaw import Flaw, Mark, between, direction, in_the_way, place
from argo_env.planning.flaws.floors import floor_flaws, lost_floors
from argo_env.planning.flaws.standing import Standing
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.norms import height_errors
from argo_env.site.shapes import Vector, crossing


def dock_flaws(standing: Standing) -> list[Flaw]:
    """Those that are of no use, one by one."""
    flaws = [_no_stand(standing, n) for n, state in standing.docks.items() if state is None]
    for number, state in standing.docks.items():
        if state is not None and not standing.reached[state]:
            flaws.append(_no_way(standing, number))
    if not flaws and standing.first_dock is not None and _stuck(standing):
        flaws.append(_no_turn(standing, standing.first_dock))
    return flaws


def _stuck(standing: Standing) -> bool:
    """Whether the robot can turn all round nowhere."""
    return bool(np.bincount(standing.lattice.cell[standing.reached]).max() < HEADINGS)


def _no_turn(standing: Standing, number: int) -> Flaw:
    dock = standing.site.docks[number]
    return Flaw(
        f"docking station {number}: the robot can't get away from its `dock`, "
        f"{place(dock.x, dock.y)}, and back; leave 1.4 m by 1.4 m free there, to turn in, "
        f"also from the edges of the ground, {list(standing.site.spec.ground)}",
        (Mark(1, dock.x, dock.y),),
    )


def _no_stand(standing: Standing, number: int) -> Flaw:
    site, robot = standing.site, standing.lattice.robot
    dock, (x0, y0, x1, y1) = site.docks[number], site.spec.ground
    marks = (Mark(1, dock.x, dock.y),)
    here = f"docking station {number}: the robot can't stand at its `dock`, {place(dock.x, dock.y)}"
    inside = min(dock.x - x0, x1 - dock.x, dock.y - y0, y1 - dock.y)
    ground = f"the ground, {list(site.spec.ground)}"
    if inside < 0:
        return Flaw(f"{here}: that is outside of {ground}; move it, or enlarge `ground`", marks)
    reach = robot.footprint.radius
    if inside < reach:
        return Flaw(
            f"{here}: that is {inside:.2f} m from the edge of {ground}; keep {reach:.2f} m", marks
        )
    things = in_the_way(
        site,
        (dock.x - reach / 2, dock.y - reach / 2, dock.z + 0.05),
        (dock.x + reach / 2, dock.y + reach / 2, dock.z + robot.driving_height),
    )
    why = f": there is {things}" if things else ", which is no even ground"
    return Flaw(f"{here}{why}; move the station, or clear {2 * reach:.1f} m around it", marks)


def _no_way(standing: Standing, number: int) -> Flaw:
    dock = standing.site.docks[number]
    first = standing.first_dock
    message = f"there is no way from docking station {first} to docking station {number} and back"
    nearest = standing.nearest_reached(dock.x, dock.y, dock.z)
    marks = [Mark(1, dock.x, dock.y)]
    if nearest is not None:
        x, y, z = nearest.tolist()
        marks.append(Mark(standing.site.floor_at(z), x, y))
        state = standing.docks[number]
        height = standing.lattice.robot.driving_height
        things = between(standing.site, nearest, standing.places[state], height)
        message += (
            f": the nearest place that can be reached is {place(x, y)}, "
            f"{math.hypot(dock.x - x, dock.y - y):.1f} m away"
        )
        message += f", and between stands {things}" if things else ""
    return Flaw(f"{message}; clear a way of 0.7 m, or leave out one of the two areas", tuple(marks))


_SAMPLED = 100  # places from which is looked what hides a face


def checkpoint_flaws(standing: Standing, navigator: Navigator, lost: Collection[int]) -> list[Flaw]:
    """Those that can't be read; of floors that are `lost` in one line."""
    site = navigator.site
    unseen = [site.checkpoint(id) for id in unseen_checkpoints(navigator)]
    flaws = [_flaw(standing, navigator, one) for one in unseen if one.floor not in lost]
    for floor in lost:
        there = [one for one in unseen if one.floor == floor]
        if there:
            many = "checkpoints" if len(there) > 1 else "checkpoint"
            numbers = listed(one.id for one in there)
            message = f"{many} {numbers} on floor {floor} can't be read, as it can't be reached"
            flaws.append(Flaw(message, tuple(map(_mark, there))))
    return flaws


def _flaw(standing: Standing, navigator: Navigator, checkpoint: SiteCheckpoint) -> Flaw:
    message = f"checkpoint {checkpoint.id} ({checkpoint.name}) can't be read: "
    return Flaw(message + _why(standing, navigator, checkpoint), (_mark(checkpoint),))


def _why(standing: Standing, navigator: Navigator, checkpoint: SiteCheckpoint) -> str:
    site, sensor = navigator.site, navigator.robot.sensor
    x, y, z = sight_target(checkpoint).tolist()
    looks = f"its face looks {direction(checkpoint.yaw)} (`yaw` {math.degrees(checkpoint.yaw):.0f})"
    floor = site.floor(checkpoint.floor)
    over = z - floor.z - sensor.offset[2]
    if abs(over) > sensor.max_range:
        return (
            f"it is {z - floor.z:.1f} m above the deck, and the camera, {sensor.offset[2]:.2f} m "
            f"above it, reads from {sensor.min_range:g} to {sensor.max_range:g} m; hang it lower"
        )
    views = candidate_views(checkpoint, navigator.lattice)
    if len(views.states):
        hidden = _hiding(site, views.cameras, (x, y, z))
        return (
            f"{looks}, and {hidden} hides it from each of the {len(views.states)} poses before it; "
            "turn it, move it, or move what hides it"
        )
    elsewhere, _ = find_views(site, checkpoint, standing.lattice)
    if len(elsewhere):
        at = standing.places[elsewhere[0]]
        return (
            f"{looks}; it could be from {place(at[0], at[1])}, which can't be reached; turn it, or "
            "clear a way there"
        )
    asked = (
        f"{sensor.min_range:g} to {sensor.max_range:g} m from it and "
        f"{sensor.max_obliqueness:g}° off where it looks, at most"
    )
    here = standing.nearest_reached(x, y, floor.z)
    if here is None:
        return f"{looks}, and there is nowhere to stand {asked}; turn or move it"
    ahead = (here[0] - x) * math.cos(checkpoint.yaw) + (here[1] - y) * math.sin(checkpoint.yaw)
    behind = ", behind it" if ahead < 0 else ""
    return (
        f"{looks}, and there is nowhere to stand {asked}; the nearest place that can be reached is "
        f"{place(here[0], here[1])}, {math.dist(here[:2], (x, y)):.1f} m away{behind}; "
        f"{'turn' if behind else 'move'} it"
    )


def _hiding(site: Site, cameras: NDArray[np.float64], target: Vector) -> str:
    """What hides a point from most of the cameras, shape (n, 3)."""
    origins = cameras[:: max(1, len(cameras) // _SAMPLED)]
    low = np.minimum(origins.min(axis=0), target)
    high = np.maximum(origins.max(axis=0), target)
    near = set(map(id, site.solids.between(low, high)))
    hidden: dict[str, int] = {}
    for element in site.elements:
        behind = np.zeros(len(origins), dtype=bool)
        for solid in element.solids:
            if id(solid) in near:
                entry, leave = crossing(solid, origins, np.array(target) - origins)
                behind |= (entry <= 1.0) & (leave >= 0.0)
        hidden[element.name] = int(behind.sum())
    return max(hidden, key=lambda name: hidden[name])


def _mark(checkpoint: SiteCheckpoint) -> Mark:
    return Mark(checkpoint.floor, checkpoint.position[0], checkpoint.position[1])


@dataclass(frozen=True)
class SiteCheck:
    """What is wrong with a site, and where the robot can stand on it if something is."""

    flaws: tuple[Flaw, ...]
    standing: Standing | None = None


def look_over(navigator: Navigator) -> SiteCheck:
    """Looks for what the robot can't reach, from the docking stations and back."""
    site = navigator.site
    unled = _unled_places(navigator) if _docks_serve(navigator) else None
    if unled == [] and not (
        height_errors(site.spec) or unserved_floors(navigator) or unseen_checkpoints(navigator)
    ):
        return SiteCheck(())
    standing = Standing.of(navigator)
    if ends := height_errors(site.spec):
        # What can't be reached for that is found again once they are mended.
        return SiteCheck(tuple(Flaw(end) for end in ends), standing)
    if unled is None or dock_flaws(standing):
        return SiteCheck(tuple(dock_flaws(standing)), standing)
    flaws = (
        *floor_flaws(standing, navigator),
        *checkpoint_flaws(standing, navigator, lost_floors(standing)),
        *unled,
    )
    return SiteCheck(flaws, standing)


def _docks_serve(navigator: Navigator) -> bool:
    try:
        navigator.prepare()
    except ArgoError:
        return False
    return True


def _unled_places(navigator: Navigator) -> list[Flaw]:
    """The named places that the robot gets to no pose near of."""
    flaws = []
    for name, pose in navigator.site.places.items():
        try:
            navigator.snap(pose)
        except ArgoError as error:
            flaws.append(Flaw(f"place {name}: {error}; move it", (Mark(1, pose.x, pose.y),)))
    return flaws
