"""A site storey by storey: what belongs to each floor."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise

from argo_env.site.shapes import Box, Cylinder, Element, Role, Solid, half_extents
from argo_env.site.site import Site

UNDER_DECK = 0.25  # m below a floor that belongs to it: its plates and beams
_CUT_ROLES = frozenset({Role.VESSEL, Role.PIPE, Role.STRUCTURE})


def storeys(site: Site) -> dict[int, tuple[Element, ...]]:
    """The elements of each floor, by its number; upright parts that pass through are cut."""
    bases = {floor.number: floor.z - UNDER_DECK for floor in site.spec.floors}
    found: dict[int, list[Element]] = {number: [] for number in bases}
    for element in site.elements:
        if element.role not in _CUT_ROLES:
            low = min(s.center[2] - float(half_extents(s)[2]) for s in element.solids)
            found[_floor(low, bases)].append(element)
            continue
        parts: dict[int, list[Solid]] = {}
        for solid in element.solids:
            for piece in _cut(solid, sorted(bases.values())[1:]):
                low = piece.center[2] - float(half_extents(piece)[2])
                parts.setdefault(_floor(low, bases), []).append(piece)
        for number, solids in parts.items():
            found[number].append(replace(element, solids=tuple(solids)))
    return {number: tuple(elements) for number, elements in found.items()}


def _floor(low: float, bases: Mapping[int, float]) -> int:
    # A micrometre, since parts that lie on each other share a height.
    return max([n for n, base in bases.items() if base <= low + 1e-6], default=min(bases))


def _cut(solid: Solid, heights: list[float]) -> list[Solid]:
    """An upright solid in pieces between the heights (m); others stay whole."""
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
