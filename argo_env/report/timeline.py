"""Timeline with a row for each task and a bar for each of its executions, and charge curve."""

import math
from collections.abc import Iterator

import numpy as np

from argo_compiler.il import Action
from argo_env.formatting import min_sec_text
from argo_env.report.rounds import blocks_by_group
from argo_env.report.svg import Node, drawing, node, polyline, shorten, simplify
from argo_env.run.record import RunRecord, TaskRun

WIDTH = 1160.0  # px
LABELS = 210.0  # px for the names of the tasks
ROW = 24.0  # px
HEAD = 60.0  # px above the first row, for the rounds

_STEPS = (1, 2, 5, 10, 15, 30, 60, 120, 300, 600, 900, 1800, 3600)


def draw_timeline(record: RunRecord) -> Node:
    """Draw a timeline: a row for each task, with its executions as bars and its readings as dots.

    Rounds of groups, waits, time windows, interruptions and findings are marked.
    """
    begun = [(run.start, run.task) for run in record.tasks]
    begun += [(wait.start, wait.task) for wait in record.waits]
    rows = {name: i for i, name in enumerate(dict.fromkeys(name for _, name in sorted(begun)))}
    end = max([record.result.duration, *(run.end for run in record.tasks), 1.0])
    px = (WIDTH - LABELS - 20) / end
    bottom = HEAD + ROW * len(rows)
    parts = draw_time_axis(end, px, HEAD, bottom) + _rounds(record, px, bottom)
    parts += _interruptions(record, px, bottom)
    for name, row in rows.items():
        y = HEAD + ROW * row
        parts.append(node("path", d=f"M0,{y + ROW:g}h{WIDTH:g}", class_="row"))
        label = shorten(name, 30)
        parts.append(node("text", x=0.0, y=y + 16, text=label, title=name, class_="label"))
    for run in record.tasks:
        parts += _bars(run, HEAD + ROW * rows[run.task], px)
    for name, start, until, title in _waits(record):
        if name in rows:
            parts.append(_bar(start, until, HEAD + ROW * rows[name], px, "waiting", title))
    parts += _windows(record, rows, px)
    for reading in record.readings:
        if reading.task in rows:
            text = (
                f"{reading.name}: {reading.value:.4g} {reading.unit} at {min_sec_text(reading.t)}"
            )
            mark = node(
                "circle",
                title=text,
                cx=LABELS + reading.t * px,
                cy=HEAD + ROW * rows[reading.task] + ROW / 2,
                r=3.2,
                class_="moment" if reading.normal else "moment abnormal",
            )
            parts.append(mark)
    parts += _anomalies(record, px, bottom)
    return drawing(WIDTH, bottom + 24, "Tasks along the time", *parts, class_="drawing timeline")


def lacks_measuring_times(run: TaskRun) -> bool:
    """Return True if the task measures, and the record does not state when it did so."""
    return run.measuring is None and run.action is Action.MEASURE


def _bars(run: TaskRun, y: float, px: float) -> list[Node]:
    """Draw the bar of a run, and over it a darker one for each time that the robot measured."""
    text = (
        f"{run.task}: {min_sec_text(run.start)} to {min_sec_text(run.end)}, {run.outcome_in_words}"
    )
    text += f" ({run.reason})" if run.reason else ""
    untold = " untold" if lacks_measuring_times(run) else ""
    spans = [(run.start, run.end, f"run{untold} {run.outcome}", text)]
    for start, end in run.measuring or ():
        measuring = f"{run.task}: measuring, {min_sec_text(start)} to {min_sec_text(end)}"
        spans.append((start, end, f"measuring {run.outcome}", measuring))
    return [_bar(start, end, y, px, class_, title) for start, end, class_, title in spans]


def _bar(start: float, end: float, y: float, px: float, class_: str, title: str) -> Node:
    return node(
        "rect",
        title=title,
        x=LABELS + start * px,
        y=y + 4,
        width=max((end - start) * px, 1.5),
        height=ROW - 8,
        rx=2.0,
        class_=class_,
    )


def _waits(record: RunRecord) -> Iterator[tuple[str, float, float, str]]:
    """Yield the waits of the mission: the task of the row, start and end (s), and a text."""
    for wait in record.waits:
        span = f"{min_sec_text(wait.start)} to {min_sec_text(wait.end)}"
        text = f"{wait.task}: waits for {wait.what}, {span}"
        yield wait.task, wait.start, wait.end, text + (f": {wait.why}" if wait.why else "")
    for run in record.tasks:
        if run.early is not None:
            since, until = run.early
            yield (
                run.task,
                since,
                until,
                f"{run.task}: at its place, too early until {min_sec_text(until)}",
            )
    first = {c.name: c.initial for c in record.hfsm.composites[1:]}
    names = {leaf.id: leaf.task.name for leaf in record.hfsm.leaves}
    for round_run in record.rounds:
        until = round_run.awaited_until(record.result.duration)
        if until > round_run.since and round_run.due is not None:
            due = min_sec_text(round_run.due)
            title = f"round {round_run.number} of {round_run.group} is due at {due}"
            yield names[first[round_run.group]], round_run.since, until, title


def _windows(record: RunRecord, rows: dict[str, int], px: float) -> Iterator[Node]:
    """Yield a bracket over the row of each task with a time window, from its start to its end.

    Of several windows of a task, the last counts. All are cut at the end of the run.
    """
    end = record.result.duration
    for run in {run.task: run for run in record.windows}.values():
        if run.task not in rows or run.earliest > end:
            continue
        left, right = run.earliest, min(run.latest or math.inf, end)
        y = HEAD + ROW * rows[run.task] + 2
        line = f"M{LABELS + left * px:.1f},{y + 4:g}v-4H{LABELS + right * px:.1f}"
        line += "v4" if run.latest is not None and run.latest <= end else ""
        kind = "hard" if run.hard else "soft"
        until = "" if run.latest is None else f" to {min_sec_text(run.latest)}"
        title = f"{kind} time window, {min_sec_text(run.earliest)}{until}"
        yield node("path", d=line, title=title, class_="window" if run.hard else "window soft")


def draw_time_axis(end: float, px: float, top: float, bottom: float) -> list[Node]:
    """Draw vertical lines from `top` to `bottom` (px) with labels, at round times up to `end` (s).

    `px` is the width of 1 s in px.
    """
    step = next((s for s in _STEPS if s * px >= 60), 3600 * math.ceil(60 / (3600 * px)))
    marks = []
    for t in range(0, math.floor(end) + 1, step):
        x = LABELS + t * px
        marks.append(node("path", d=f"M{x:.1f},{top:g}V{bottom:g}", class_="grid"))
        marks.append(node("text", x=x, y=bottom + 16, text=min_sec_text(t), class_="axis middle"))
    return marks


def _interruptions(record: RunRecord, px: float, bottom: float) -> list[Node]:
    """Draw a band for each pause and reaction, and a line where the run was resumed.

    A run is resumed from its journal after its process died.
    """
    marks = []
    for interruption in record.interruptions:
        width = max((interruption.end - interruption.start) * px, 1.5)
        span = f"{min_sec_text(interruption.start)} to {min_sec_text(interruption.end)}"
        band = node(
            "rect",
            title=f"{interruption.cause}, {span}",
            x=LABELS + interruption.start * px,
            y=HEAD - 8,
            width=width,
            height=bottom - HEAD + 8,
            class_=f"interruption {'reaction' if interruption.event else 'pause'}",
        )
        marks.append(band)
    for t in record.resumed:
        line, when = f"M{LABELS + t * px:.1f},{HEAD - 8:g}V{bottom:g}", f"at {min_sec_text(t)}"
        marks.append(
            node("path", d=line, title=f"resumed from the journal {when}", class_="resumed")
        )
    return marks


def _anomalies(record: RunRecord, px: float, bottom: float) -> list[Node]:
    """Draw a line at each finding, with its number where there is room."""
    marks = []
    free_from = -math.inf
    for number, anomaly in enumerate(record.anomalies, start=1):
        x = LABELS + anomaly.t * px
        line, what = f"M{x:.1f},{HEAD - 8:g}V{bottom:g}", anomaly.kind.replace("_", " ")
        title = f"{number} {what}: {anomaly.detail}, {min_sec_text(anomaly.t)}"
        marks.append(node("path", d=line, title=title, class_="found-line"))
        if x > free_from:
            marks.append(draw_finding(x, HEAD - 8, number, "found"))
            free_from = x + 16
    return marks


def draw_finding(x: float, y: float, number: int, class_: str) -> Node:
    """Draw a diamond about a position in px, with the number of a finding.

    `class_` is `found` at the position of the finding, and `noticed` at the position of the robot
    when it noticed it.
    """
    return node(
        "g",
        node("path", d=f"M{x:.1f},{y - 9:.1f}l9,9l-9,9l-9,-9z"),
        node("text", x=x, y=y + 3.5, text=f"{number}", class_="middle"),
        class_=class_,
    )


def _rounds(record: RunRecord, px: float, bottom: float) -> list[Node]:
    """Draw the rounds of each visit to a group as bands of alternating shades, with numbers."""
    marks = []
    for block in blocks_by_group(record):
        if block.group is None:
            continue
        left, width = LABELS + block.start * px, (block.end - block.start) * px
        name = shorten(block.group, max(int(width / 7), 3))
        marks.append(node("text", x=left, y=14.0, text=name, class_="label group"))
        free_from = -math.inf
        for index, runs in enumerate(block.rounds, start=1):
            x, wide = LABELS + runs[0].start * px, (runs[-1].end - runs[0].start) * px
            shade = "odd" if index % 2 else "even"
            marks.append(
                node("rect", x=x, y=20.0, width=wide, height=bottom - 20, class_=f"round {shade}")
            )
            middle = x + wide / 2
            if middle - free_from > 18:
                text = node("text", x=middle, y=34.0, text=f"{index}", class_="axis middle")
                marks.append(text)
                free_from = middle
    return marks


HEIGHT = 96.0  # px of the curve
TOP = 12.0  # px above it
LOW = 20.0  # %, below which the robot reports a low battery


def draw_charge_curve(record: RunRecord) -> Node | None:
    """Draw the battery's charge in percent over time, with the same time axis as the timeline.

    Returns None if the record has fewer than two samples with a charge.
    """
    points = [(s.t, 100.0 * s.charge) for s in record.path if s.charge is not None]
    if len(points) < 2:
        return None
    end = max([record.result.duration, *(run.end for run in record.tasks), 1.0])
    px = (WIDTH - LABELS - 20) / end
    bottom = TOP + HEIGHT

    def at(t: float, percent: float) -> tuple[float, float]:
        return LABELS + t * px, bottom - HEIGHT * percent / 100.0

    line = np.array([at(*point) for point in points])
    curve = line[simplify(line, 0.3)].tolist()
    area = [(curve[0][0], bottom), *curve, (curve[-1][0], bottom)]
    marks = draw_time_axis(end, px, TOP, bottom)
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
        node("path", d=polyline(curve), class_="charge"),
        class_="drawing timeline",
    )
