"""Pictures of inspections."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from argo_env.envs.inspection_run import Inspection
from argo_env.pictures.drawing.path import PathPoint
from argo_env.pictures.drawing.plan import Marker, PlanDrawing, StationMark, draw_plan
from argo_env.pictures.drawing.sheet import site_sheet

_LEGEND = {
    "open": "to be read",
    "done": "read, normal",
    "abnormal": "read, abnormal",
    "closed": "out of reach",
    "outside": "not asked for",
}


def draw_inspection(
    scenario: str,
    run: Inspection,
    states: Sequence[str],
    chosen: int | None,
    end: int,
    headline: str,
) -> NDArray[np.uint8]:
    """Return a picture of the inspection so far, shape (720, 1280, 3).

    Args:
        scenario: Name or file of the site.
        run: The inspection.
        states: State of each checkpoint, in the order of their numbers: `open`, `done`, `abnormal`,
            `closed` or `outside`.
        chosen: Index of the checkpoint that was chosen last. It is None, or not below the number of
            checkpoints, if none was.
        end: Index of the end dock, in the order of the docks' numbers.
        headline: Text above the plan.
    """
    site = run.navigator.site
    path = [PathPoint(t, p.x, p.y, site.floor_at(p.z)) for t, p in run.trail]
    requested = {c.floor for c, s in zip(site.checkpoints, states, strict=True) if s != "outside"}
    markers = [
        Marker(c.position[0], c.position[1], c.floor, str(c.id), state, chosen=k == chosen)
        for k, (c, state) in enumerate(zip(site.checkpoints, states, strict=True))
    ]
    stations = []
    for k, number in enumerate(sorted(site.docks)):
        pose = site.docks[number]
        name = f"dock {number}, end" if k == end else f"dock {number}"
        stations.append(StationMark(pose.x, pose.y, site.floor_at(pose.z), name))
    used = requested | {s.floor for s in stations} | {spot.floor for spot in path}
    sheet = site_sheet(scenario, min(used), max(used), tuple(sorted(requested)))
    shown = [marker for marker in markers if marker.floor in sheet.panels]
    noticed = ", ".join(
        dict.fromkeys(kind.value.replace("_", " ") for kind in run.kinds_noticed_so_far)
    )
    headline += f"    noticed: {noticed or 'nothing'}"
    footprint, heading = run.navigator.robot.footprint, run.pose.yaw
    return draw_plan(
        sheet, PlanDrawing(headline, shown, stations, path, heading, footprint, _LEGEND)
    )
