"""The battery's charge along the simulated time."""

import numpy as np

from argo_env.report.svg import Node, drawing, node, polyline, simplify
from argo_env.report.timeline import LABELS, WIDTH, time_axis
from argo_env.run.record import RunRecord

HEIGHT = 96.0  # px of the curve
TOP = 12.0  # px above it
LOW = 20.0  # %, where the robot calls the battery low


def charge_curve(record: RunRecord) -> Node | None:
    """The charge in percent under the timeline, on the same time axis; None if none was noted."""
    points = [(s.t, 100.0 * s.charge) for s in record.path if s.charge is not None]
    if len(points) < 2:
        return None
    end = max([record.result.duration, *(run.end for run in record.tasks), 1.0])
    px = (WIDTH - LABELS - 20) / end
    bottom = TOP + HEIGHT

    def at(t: float, percent: float) -> tuple[float, float]:
        return LABELS + t * px, bottom - HEIGHT * percent / 100.0

    line = np.array([at(*point) for point in points])
    kept = line[simplify(line, 0.3)].tolist()
    area = [(kept[0][0], bottom), *kept, (kept[-1][0], bottom)]
    marks = time_axis(end, px, TOP, bottom)
    for percent in (0, 50, 100):
        x, y = at(0.0, percent)
        marks.append(node("path", d=f"M{x:.1f},{y:.1f}H{WIDTH - 20:g}", class_="row"))
        marks.append(node("text", x=x - 8, y=y + 4, text=f"{percent} %", class_="axis end"))
    x, y = at(0.0, LOW)
    marks.append(node("path", d=f"M{x:.1f},{y:.1f}H{WIDTH - 20:g}", class_="low-charge"))
    marks.append(node("text", x=0.0, y=TOP + HEIGHT / 2 + 4, text="battery", class_="label"))
    first, last = points[0][1], points[-1][1]
    return drawing(
        WIDTH,
        bottom + 24,
        f"Charge of the battery: {first:.1f} % at the start, {last:.1f} % at the end",
        *marks,
        node("path", d=polyline(area, closed=True), class_="charge-area"),
        node("path", d=polyline(kept), class_="charge"),
        class_="drawing timeline",
    )
