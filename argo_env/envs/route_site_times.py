"""Travel times between the first dock and all checkpoints of a site, also without some stairs."""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Unreachable
from argo_env.envs.route_instance import Stair
from argo_env.navigation import Navigator
from argo_env.navigation.closed_areas import Blockage
from argo_env.planning import open_site
from argo_env.site.stairs import flight_run


@dataclass(frozen=True)
class SiteTimes:
    """Data from which instances on a site are made."""

    times: NDArray[np.float64]
    """travel times (s), the dock first"""
    positions: NDArray[np.float64]
    """x, y (m) and floor, likewise"""
    floors: int
    measuring_time: float
    """s"""


@lru_cache(maxsize=8)
def site_times(scenario: str) -> SiteTimes:
    """Return travel times between the first dock and all checkpoints of the site with this name.

    Raises ArgoError if there is no such site, or if a checkpoint can't be reached.
    """
    navigator = open_site(scenario).navigator
    site = navigator.site
    number = min(site.docks)
    dock = navigator.snap_keeping_heading(site.docks[number])
    times = navigator.travel_times([dock, *(c.id for c in site.checkpoints)])
    positions = [(dock.x, dock.y, site.floor_at(dock.z))]
    positions += [(c.position[0], c.position[1], c.floor) for c in site.checkpoints]
    measuring = navigator.robot.sensor.measuring_time
    return SiteTimes(times, np.array(positions), len(site.spec.floors), measuring)


@lru_cache(maxsize=8)
def site_stairs(scenario: str) -> tuple[Stair, ...]:
    """Return all stairs of a site, each as its tower's index and its lower floor's number."""
    spec = open_site(scenario).site.spec
    return tuple(
        (tower, floor.number) for tower in range(len(spec.towers)) for floor in spec.floors[:-1]
    )


@lru_cache(maxsize=64)
def site_times_without(scenario: str, blocked: tuple[Stair, ...]) -> NDArray[np.float64] | None:
    """Return the times of `site_times` if some stairs are blocked.

    Returns None if a checkpoint or the dock can't be reached then.
    """
    navigator = open_site(scenario).navigator
    site = navigator.site
    positions = [navigator.snap_keeping_heading(site.docks[min(site.docks)])]
    positions += [navigator.viewing_pose(c.id) for c in site.checkpoints]
    try:
        times = navigator_without(navigator, blocked).travel_times(positions)
    except Unreachable:
        return None
    return times if np.isfinite(times).all() else None


def navigator_without(navigator: Navigator, blocked: tuple[Stair, ...]) -> Navigator:
    """Return a navigator of the same site that avoids these stairs, blocked in their middle."""
    spec = navigator.site.spec
    base = {floor.number: floor.z for floor in spec.floors}
    blockages = []
    for tower, floor in blocked:
        flight = min(spec.towers[tower].flights, key=lambda f: f.foot[2])
        x, y, z = flight.foot
        along, half = flight_run(flight) / 2, flight.width / 4
        x += along * math.cos(math.radians(flight.yaw))
        y += along * math.sin(math.radians(flight.yaw))
        z += base[floor] + flight.risers * flight.rise / 2
        rect = (x - half, y - half, x + half, y + half)
        name = spec.towers[tower].name
        blockages.append(Blockage(rect, z, f"the {name} is blocked above floor {floor}"))
    return navigator.with_added_blockages(blockages)
