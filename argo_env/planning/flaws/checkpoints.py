"""Checkpoints that can't be read, and why."""

import math
from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.listing import listed
from argo_env.navigation import Navigator
from argo_env.navigation.views import find_views, possible_views, sight_target
from argo_env.planning.checking import unseen_checkpoints
from argo_env.planning.flaws.flaw import Flaw, Mark, direction, place
from argo_env.planning.flaws.standing import Standing
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Vector, crossing

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
    views = possible_views(checkpoint, navigator.lattice)
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
