"""Inspections as pictures."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from argo_env.envs.drawing.floors import plans_of
from argo_env.envs.drawing.plan import Marker, Scene, Station, draw_scene
from argo_env.envs.drawing.sheet import Sheet, make_sheet
from argo_env.envs.drawing.way import Moment
from argo_env.envs.inspection_run import Inspection
from argo_env.navigation import Navigator

_LEGEND = {
    "open": "to be read",
    "done": "read, normal",
    "abnormal": "read, abnormal",
    "closed": "out of reach",
    "outside": "not asked for",
}


def draw_inspection(
    navigator: Navigator,
    run: Inspection,
    states: Sequence[str],
    chosen: int | None,
    end: int,
    headline: str,
) -> NDArray[np.uint8]:
    """The run so far: the state of each checkpoint, in the order of their numbers; the place that
    was `chosen` last, and the place in the order of the docks of the one where it has to `end`."""
    site = navigator.site
    way = [Moment(t, p.x, p.y, site.floor_at(p.z)) for t, p in run.trail]
    asked = {c.floor for c, s in zip(site.checkpoints, states, strict=True) if s != "outside"}
    markers = [
        Marker(c.position[0], c.position[1], c.floor, str(c.id), state, chosen=k == chosen)
        for k, (c, state) in enumerate(zip(site.checkpoints, states, strict=True))
    ]
    stations = []
    for k, number in enumerate(sorted(site.docks)):
        pose = site.docks[number]
        name = f"dock {number}, end" if k == end else f"dock {number}"
        stations.append(Station(pose.x, pose.y, site.floor_at(pose.z), name))
    used = asked | {s.floor for s in stations} | {spot.floor for spot in way}
    sheet = site_sheet(navigator, min(used), max(used), tuple(sorted(asked)))
    shown = [marker for marker in markers if marker.floor in sheet.panels]
    noticed = ", ".join(dict.fromkeys(kind.value.replace("_", " ") for kind in run.noticed))
    headline += f"    noticed: {noticed or 'nothing'}"
    kinds = {marker.state for marker in shown} | set(_LEGEND) - {"outside"}
    legend = {state: meaning for state, meaning in _LEGEND.items() if state in kinds}
    return draw_scene(sheet, Scene(headline, shown, stations, way, run.pose.yaw, legend))


@lru_cache(maxsize=8)
def site_sheet(navigator: Navigator, low: int, high: int, asked: tuple[int, ...]) -> Sheet:
    """The floors of a site from `low` to `high`; those that are not asked for are pale."""
    plans = [plan for plan in plans_of(navigator) if low <= plan.number <= high]
    return make_sheet(plans, [p.number for p in plans if p.number not in asked])
