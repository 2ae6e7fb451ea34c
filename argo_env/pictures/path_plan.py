"""Picture of the floors of a site with the driven path, which needs no physics engine."""

import io
from pathlib import Path

from PIL import Image

from argo_compiler.files.atomic_write import write_atomically
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors
from argo_env.pictures.drawing.floors import floor_plans
from argo_env.pictures.drawing.path import PathPoint
from argo_env.pictures.drawing.plan import Marker, PlanDrawing, StationMark, draw_plan
from argo_env.pictures.drawing.sheet import make_sheet
from argo_env.pictures.motion import check_record_site
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site

_LEGEND = {"done": "read, normal", "abnormal": "read, abnormal", "outside": "not read"}


def write_path_plan(record: RunRecord, site: Site, robot: RobotSpec, file: Path) -> None:
    """Write a PNG of the floors of the site, with the driven path, coloured by time.

    Each checkpoint shows whether its last reading is nominal.

    Raises:
        ArgoError: The record is of another site or has no path, or the file can't be written.
    """
    check_record_site(record, site)
    states = {r.checkpoint: "done" if r.normal else "abnormal" for r in record.readings}
    markers = [
        Marker(c.position[0], c.position[1], c.floor, str(c.id), states.get(c.id, "outside"))
        for c in site.checkpoints
    ]
    docks = [
        StationMark(pose.x, pose.y, site.floor_at(pose.z), f"dock {number}")
        for number, pose in sorted(site.docks.items())
    ]
    path = [PathPoint(p.t, p.x, p.y, p.floor) for p in record.path]
    drawing = PlanDrawing(
        record.mission.designation or "Mission",
        markers,
        docks,
        path,
        record.path[-1].yaw,
        robot.footprint,
        _LEGEND,
    )
    content = io.BytesIO()
    Image.fromarray(draw_plan(make_sheet(floor_plans(site)), drawing)).save(content, "png")
    with reporting_write_errors(file, "the picture", CHOOSE_ANOTHER_PLACE):
        write_atomically(file, content.getvalue())
