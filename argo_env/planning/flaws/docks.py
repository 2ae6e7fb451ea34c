"""Docking stations in which the robot can't stand, or from which it gets to no other."""

import math

import numpy as np

from argo_env.navigation.stencil import HEADINGS
from argo_env.planning.flaws.flaw import Flaw, Mark, between, in_the_way, place
from argo_env.planning.flaws.standing import Standing


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
