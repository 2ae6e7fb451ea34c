"""Elements of a site, split by floor."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

from argo_env.site.shapes import Box, Cylinder, Element, Role, Solid, half_extents
from argo_env.site.site import Site

UNDER_DECK = 0.25  # m below a floor's height that belong to it: its plates and beams
_CUT_ROLES = frozenset({Role.VESSEL, Role.PIPE, Role.STRUCTURE})


def storeys(site: Site) -> dict[int, tuple[Element, ...]]:
    """Return the elements of each floor, by the floor's number.

    Upright solids of vessels, pipes and the structure are cut where they pass from storey to
    storey, so such an element may be on several floors. All else belongs as a whole to the floor in
    whose storey its lowest point is.
    """
    bases = {floor.number: floor.z - UNDER_DECK for floor in site.spec.floors}
    by_floor: dict[int, list[Element]] = {number: [] for number in bases}
    for element in site.elements:
        if element.role not in _CUT_ROLES:
            low = min(s.center[2] - float(half_extents(s)[2]) for s in element.solids)
            by_floor[_floor(low, bases)].append(element)
            continue
        parts: dict[int, list[Solid]] = {}
        for solid in element.solids:
            for piece in _cut(solid, sorted(bases.values())[1:]):
                low = piece.center[2] - float(half_extents(piece)[2])
                parts.setdefault(_floor(low, bases), []).append(piece)
        for number, solids in parts.items():
            by_floor[number].append(replace(element, solids=tuple(solids)))
    return {number: tuple(elements) for number, elements in by_floor.items()}


def _floor(low: float, bases: Mapping[int, float]) -> int:
    # The tolerance of a micrometre is for parts that lie on each other and share a height.
    return max([n for n, base in bases.items() if base <= low + 1e-6], default=min(bases))


def _cut(solid: Solid, heights: list[float]) -> list[Solid]:
    """Return an upright solid in pieces, cut at the heights (m); other solids are not cut."""
    if abs(solid.rotation()[2, 2]) < 1.0 - 1e-9:
        return [solid]
    x, y, z = solid.center
    half = float(half_extents(solid)[2])
    inside = [h for h in heights if z - half + 1e-3 < h < z + half - 1e-3]
    edges = [z - half, *inside, z + half]
    pieces: list[Solid] = []
    for low, high in pairwise(edges):
        center = (x, y, (low + high) / 2)
        if isinstance(solid, Cylinder):
            pieces.append(replace(solid, center=center, length=high - low))
        else:
            size = (solid.size[0], solid.size[1], high - low)
            pieces.append(Box(center, size, solid.rpy))
    return pieces
