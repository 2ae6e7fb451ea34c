"""Pictures of a suggested order: a plan of each floor with the written and the suggested path."""

import io
from collections.abc import Iterator, Sequence
from pathlib import Path as FilePath

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from argo_compiler.base.model import Pose
from argo_compiler.files.atomic_write import write_files_atomically
from argo_compiler.il import Action, Task
from argo_compiler.reorder.mission_problem import MissionProblem
from argo_compiler.route.evaluation import evaluate
from argo_compiler.route.problem import Tour
from argo_env.files.folders import CHOOSE_ANOTHER_PLACE, reporting_write_errors
from argo_env.formatting import min_sec_text
from argo_env.navigation import Navigator
from argo_env.pictures.drawing.floors import floor_plans
from argo_env.pictures.drawing.label_placement import LabelPlacer, draw_plate
from argo_env.pictures.drawing.path import (
    PathPoint,
    draw_any_stairs_taken,
    draw_lines_with_arrows,
    draw_thin_lines,
    path_lines,
)
from argo_env.pictures.drawing.sheet import (
    FINER,
    FOOT,
    INK,
    SIZE,
    SOFT,
    FloorSheet,
    font,
    make_sheet,
)
from argo_env.pictures.drawing.style import (
    draw_disc,
    draw_headline,
    paint_checkpoint,
    paint_station,
)
from argo_env.planning.travel import SiteTravel
from argo_env.report.track import colour
from argo_env.site import Site

_STEP = 0.1  # m between the points of a drawn path
_RADIUS = 11.0  # px
_STATION = 7.0  # px from the middle of a station's mark to its sides
_BAR = 120.0 * FINER  # px
_LEFT = 16.0 * FINER
_OLD = (120, 132, 145)


def possible_picture_names(site: Site) -> tuple[str, ...]:
    """Return the names of the files that `write_route` may write."""
    return tuple(_name(floor.number) for floor in site.spec.floors)


def write_route(
    planned: MissionProblem,
    route: Tour,
    navigator: Navigator,
    travel: SiteTravel,
    folder: FilePath,
) -> list[FilePath]:
    """Write `floor-<number>.png` for each floor of the written or the suggested path.

    `planned` has the written order, `route` is the suggested one. Rounds are drawn once, and tasks
    that are executed only in some cases are omitted.

    Returns:
        The paths of the files in the folder.

    Raises:
        ArgoError: A file can't be written.
    """
    site = navigator.site
    seconds = [
        evaluate(planned.problem, r).duration * planned.problem.unit
        for r in (planned.written, route)
    ]
    headline = f"{min_sec_text(seconds[0])} as written, {min_sec_text(seconds[1])} as suggested"
    if planned.mission.designation:
        headline = f"{planned.mission.designation}: {headline}"
    old = _path_points(planned, planned.written, navigator, travel)
    new = _path_points(planned, route, navigator, travel)
    floors = {point.floor for point in (*old, *new)}
    pictures = {}
    for plan in floor_plans(site):
        if plan.number not in floors:
            continue
        image = _draw_floor(
            make_sheet([plan]), plan.number, planned, route, old, new, travel, site, headline
        )
        content = io.BytesIO()
        Image.fromarray(image).save(content, "png")
        pictures[_name(plan.number)] = content.getvalue()
    with reporting_write_errors(folder, "the pictures", CHOOSE_ANOTHER_PLACE):
        write_files_atomically(folder, pictures)
    return [folder / name for name in pictures]


def _name(floor: int) -> str:
    return f"floor-{floor}.png"


def _path_points(
    planned: MissionProblem, route: Tour, navigator: Navigator, travel: SiteTravel
) -> list[PathPoint]:
    """Return the robot's positions over time, from its start to the mission's end."""
    here = travel.start_pose(planned.mission)
    site, robot = navigator.site, navigator.robot
    points = [PathPoint(0.0, here.x, here.y, site.floor_at(here.z))]
    for task in _tasks(planned, route):
        path = travel.plan_path(here, task)
        t = points[-1].t
        for motion in path.motions:
            takes = motion.duration(robot)
            count = max(1, round(motion.length / _STEP))
            for k in range(1, count + 1):
                p = motion.pose_at(k / count)
                points.append(PathPoint(t + takes * k / count, p.x, p.y, site.floor_at(p.z)))
            t += takes
        here = path.end
        points.append(
            PathPoint(t + travel.action_duration(task), here.x, here.y, site.floor_at(here.z))
        )
    return points


def _tasks(planned: MissionProblem, route: Tour) -> Iterator[Task]:
    """Yield the tasks that are always executed, in the order of `route`, then the END task.

    It is left out if the mission does not always end with one.
    """
    visits = planned.visits
    for visit in route.order:
        yield visits.leaf_task(visits.task_units[visit].entry)
    if visits.chain.end is not None:
        yield visits.leaf_task(visits.chain.end)


def _draw_floor(
    sheet: FloorSheet,
    floor: int,
    planned: MissionProblem,
    route: Tour,
    old: Sequence[PathPoint],
    new: Sequence[PathPoint],
    travel: SiteTravel,
    site: Site,
    headline: str,
) -> NDArray[np.uint8]:
    """Return the picture of a floor, red, green and blue, shape (720, 1280, 3).

    Args:
        sheet: Sheet with the plan of the floor; the picture is drawn on a copy.
        floor: Number of the floor.
        planned: Mission with its route problem.
        route: Suggested order; its positions number the checkpoints.
        old: Path in the written order, drawn thin.
        new: Path in the suggested order, drawn bold.
        travel: Travel times on the site, which give the mission's start.
        site: Site of the mission.
        headline: Text above the plan.
    """
    image = sheet.image.copy()
    draw = ImageDraw.Draw(image)
    labels = LabelPlacer(sheet)
    stations = _stations(planned, travel, site)
    for x, y, own_floor, _ in stations:
        if own_floor == floor:
            size = (_STATION + 1.0) * FINER
            labels.occupy(sheet.pixel_at(x, y, floor), size, size)
    size = (_RADIUS + 1.0) * FINER
    marks = []
    for visit in range(planned.problem.size):
        x, y, own_floor = _visit_position(planned, visit, site)
        if own_floor == floor:
            true = sheet.pixel_at(x, y, floor)
            marks.append((visit, true, labels.reserve_nearest(true, size, size, floor)))
    thin, bold = path_lines(sheet, old), path_lines(sheet, new)
    draw_thin_lines(draw, thin, _OLD)
    for line in bold:
        labels.avoid_path_if_possible(line.points)
    draw_lines_with_arrows(draw, bold)
    number_of = {visit: k + 1 for k, visit in enumerate(route.order)}
    for x, y, own_floor, _ in stations:
        if own_floor == floor:
            paint_station(draw, sheet.pixel_at(x, y, floor), _STATION)
    for visit, true, position in marks:
        if position != true:
            draw.line([true, position], fill=INK, width=2 * FINER)
            draw_disc(draw, true, 3.0 * FINER, INK)
        state = "open" if visit in number_of else "closed"
        paint_checkpoint(draw, position, _RADIUS, state, str(number_of.get(visit, "")))
    for visit, _, position in marks:
        draw_plate(draw, labels, position, planned.visits.names[visit], floor)
    for x, y, own_floor, name in stations:
        if own_floor == floor:
            draw_plate(draw, labels, sheet.pixel_at(x, y, floor), name, floor)
    draw_any_stairs_taken(draw, sheet, labels, new)
    draw_headline(draw, headline)
    _draw_legend(draw, bool(thin), bool(bold), len(number_of) < planned.problem.size)
    return np.asarray(image.reduce(FINER), dtype=np.uint8)


def _stations(
    planned: MissionProblem, travel: SiteTravel, site: Site
) -> list[tuple[float, float, int, str]]:
    """Return the start of the mission and, if it has one elsewhere, the end.

    Each is given as x, y (m), floor and name.
    """
    start = travel.start_pose(planned.mission)
    end = planned.visits.chain.end
    dock = None if end is None else planned.visits.leaf_task(end).pose
    first = (start.x, start.y, site.floor_at(start.z))
    if dock is None:
        return [(*first, "start")]
    if np.hypot(dock.x - start.x, dock.y - start.y) < 0.5 and abs(dock.z - start.z) < 0.5:
        return [(*first, "start, end")]
    return [(*first, "start"), (dock.x, dock.y, site.floor_at(dock.z), "end")]


def _visit_position(planned: MissionProblem, visit: int, site: Site) -> tuple[float, float, int]:
    """Return x, y (m) and floor of the checkpoint that a visit measures, or else of its pose."""
    task = planned.visits.leaf_task(planned.visits.task_units[visit].entry)
    if task.action is Action.MEASURE:
        checkpoint = site.checkpoint_for(task.object_id)
        return checkpoint.position[0], checkpoint.position[1], checkpoint.floor
    pose = task.pose or Pose(x=0.0, y=0.0, z=0.0)
    return pose.x, pose.y, site.floor_at(pose.z)


def _draw_legend(draw: ImageDraw.ImageDraw, old: bool, new: bool, dropped: bool) -> None:
    """Draw the legend of lines and discs.

    `old` and `new` state if these paths are drawn, `dropped` if visits are left out of the order.
    """
    y, face, x = (SIZE[1] - FOOT / 2) * FINER, font(12), _LEFT

    def draw_entry(text: str, x: float) -> float:
        draw.text((x, y), text, fill=SOFT, font=face, anchor="lm")
        return x + draw.textlength(text, font=face) + 16 * FINER

    if new:
        for k in range(round(_BAR / 2)):
            draw.line((x + k, y - 3 * FINER, x + k, y + 3 * FINER), fill=colour(2 * k / _BAR))
        x = draw_entry("path as suggested, from its start to its end", x + _BAR / 2 + 6 * FINER)
    if old:
        draw.line((x, y, x + 30 * FINER, y), fill=_OLD, width=round(1.5 * FINER))
        x = draw_entry("as written", x + 36 * FINER)
    paint_checkpoint(draw, (x + 8 * FINER, y), 8.0, "open", "3")
    x = draw_entry("position in the order", x + 21 * FINER)
    if dropped:
        paint_checkpoint(draw, (x + 8 * FINER, y), 8.0, "closed", "")
        draw_entry("left out", x + 21 * FINER)
