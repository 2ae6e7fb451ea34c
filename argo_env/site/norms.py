"""Checks of a site against ISO 14122-3 for stairs and the competition's rules for checkpoints.

A site that violates them can still be used; `argo sites` lists the violations. Stairs that end
above or below the next floor are a different matter: such a site is wrong.
"""

import math
from collections.abc import Iterator
from itertools import pairwise

from argo_env.site.spec import LEDGE, FloorSpec, SiteSpec, TowerSpec, distance_to_rect

PITCH = (20.0, 45.0)  # deg, of a flight
GOING = (0.21, 0.31)  # m
STRIDE = (0.60, 0.66)  # m, going + 2 rise
WIDTH = 0.8  # m, least width of a flight
LANDING = 0.8  # m, least length of a landing
HEIGHT = (0.2, 2.0)  # m of a checkpoint above its deck (thesis 1.2)
BESIDE = 0.5  # m, greatest distance of a checkpoint from the walkway (thesis 1.2)
_TOLERANCE = 1e-3  # m


def violations(spec: SiteSpec) -> list[str]:
    """Return a message for each violation of ISO 14122-3 or of the competition's rules.

    ISO 14122-3 applies to stairs, the rules of the competition to the positions of checkpoints.
    Stairs come first; both are in the order of the site's description.
    """
    stairs = [line for tower in spec.towers for line in _stairs(tower)]
    return [*stairs, *(line for floor in spec.floors for line in _checkpoints(floor))]


def height_errors(spec: SiteSpec) -> list[str]:
    """Return a message for each stair tower whose flights don't rise as much as floors are apart.

    The message names the lowest floor where the tower ends above or below the next one.
    """
    errors = []
    for tower in spec.towers:
        risen = sum(flight.risers * flight.rise for flight in tower.flights)
        for below, above in pairwise(spec.floors):
            wanted = above.z - below.z
            if abs(risen - wanted) > LEDGE:
                errors.append(
                    f"{tower.name}: its flights rise {risen:.3f} m, and floor {above.number} lies "
                    f"{wanted:.3f} m above floor {below.number}"
                )
                break
    return errors


def _stairs(tower: TowerSpec) -> Iterator[str]:
    for flight in tower.flights:
        pitch = math.degrees(math.atan2(flight.rise, flight.going))
        measures = (
            ("its pitch", pitch, PITCH, "deg"),
            ("its going", flight.going, GOING, "m"),
            ("going + 2 rise", flight.going + 2 * flight.rise, STRIDE, "m"),
        )
        for name, value, (low, high), unit in measures:
            if not low - _TOLERANCE <= value <= high + _TOLERANCE:
                yield (
                    f"{tower.name}, {flight.name}: {name} is {value:.3g} {unit}; ISO 14122-3 asks "
                    f"for {low:g} to {high:g} {unit}"
                )
        if flight.width < WIDTH - _TOLERANCE:
            yield (
                f"{tower.name}, {flight.name}: it is {flight.width:.3g} m wide; ISO 14122-3 asks "
                f"for {WIDTH:g} m"
            )
    for landing in tower.landings:
        x0, y0, x1, y1 = landing.rect
        if min(x1 - x0, y1 - y0) < LANDING - _TOLERANCE:
            yield (
                f"{tower.name}, {landing.name}: it is {min(x1 - x0, y1 - y0):.3g} m long; "
                f"ISO 14122-3 asks for {LANDING:g} m"
            )


def _checkpoints(floor: FloorSpec) -> Iterator[str]:
    for checkpoint in floor.checkpoints:
        x, y, height = checkpoint.position
        if not HEIGHT[0] - _TOLERANCE <= height <= HEIGHT[1] + _TOLERANCE:
            yield (
                f"checkpoint {checkpoint.id}: it is {height:.3g} m high; the rules ask for "
                f"{HEIGHT[0]:g} to {HEIGHT[1]:g} m"
            )
        beside = min(distance_to_rect(rect, x, y) for rect in floor.walkways.values())
        if beside > BESIDE + _TOLERANCE:
            yield (
                f"checkpoint {checkpoint.id}: it is {beside:.3g} m beside the walkway; the rules "
                f"ask for {BESIDE:g} m at most"
            )
