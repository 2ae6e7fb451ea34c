"""Plans of the floors of a site, seen from above, for drawings on the page."""

import json

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.model import Model
from argo_env.pictures.drawing.floors import floor_plans
from argo_env.planning.opening import OpenedSite
from argo_env.site.shapes import Role
from argo_env.site.spec import Rect

_PART = "floor-plans-1"
"""cached part; to be changed if a site gets other plans"""
_DIGITS = 2  # decimal places of all coordinates


class OutlinesOfRole(Model):
    """Outlines of all that has one role on a floor."""

    role: Role
    outlines: tuple[tuple[tuple[float, float], ...], ...]
    """corners of each outline, x and y in m"""


class DescribedFloorPlan(Model):
    """Plan of a floor: what stands on it, and its deck, as outlines from above."""

    number: int
    bounds: Rect
    """rectangle with all outlines and a margin, in m; equal for all floors but the lowest one"""
    shapes: tuple[OutlinesOfRole, ...]
    """in the order in which they are drawn, the lower ones first"""


def describe_floor_plan(site: OpenedSite, number: int) -> DescribedFloorPlan:
    """Return the plan of a floor, the same as in reports; raises NotFound if there is no floor."""
    site.site.floor(number)
    content = site.parts.load_or_make(_PART, lambda: _make_plans(site))[str(number)]
    return DescribedFloorPlan.model_validate_json(content.tobytes())


def _make_plans(site: OpenedSite) -> dict[str, NDArray[np.uint8]]:
    """Return the plans of all floors as JSON, by number."""
    plans = {}
    for plan in floor_plans(site.site):
        shapes = [{"role": role, "outlines": _rounded(parts)} for role, parts in plan.shapes]
        content = {"number": plan.number, "bounds": _rounded(plan.bounds), "shapes": shapes}
        plans[str(plan.number)] = np.frombuffer(json.dumps(content).encode(), np.uint8)
    return plans


def _rounded(numbers: object) -> object:
    """Return nested sequences of numbers as lists, with the numbers rounded."""
    if isinstance(numbers, float | int):
        return round(float(numbers), _DIGITS)
    assert isinstance(numbers, tuple)
    return [_rounded(part) for part in numbers]
