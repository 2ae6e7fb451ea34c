"""Page that shows a run."""

from functools import cache
from pathlib import Path

from jinja2 import Environment, StrictUndefined, Template
from markupsafe import Markup

from argo_compiler.export import to_mermaid
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Action, Mission
from argo_compiler.il.reserved import RETURN_TASK
from argo_env.formatting import min_sec_text
from argo_env.report.machine import draw_machine, is_drawable
from argo_env.report.plan import draw_floor, draw_side_view, visited_floors
from argo_env.report.rounds import (
    all_waits,
    blocks_by_group,
    merge_waits,
    repeat_rules,
    rounds_with_condition_values,
)
from argo_env.report.svg import Node, drawing, markup, node, replace_non_xml_characters
from argo_env.report.timeline import draw_charge_curve, draw_timeline, lacks_measuring_times
from argo_env.report.track import colour
from argo_env.run.causes import explain_false_all_clear, false_all_clears
from argo_env.run.record import Anomaly, Reading, RunRecord
from argo_env.site import Site
from argo_env.site.site import SCALES

BAR = 130.0  # px, width of the scale of a reading


def page(record: RunRecord, site: Site) -> str:
    """Return the whole report as one HTML page that needs no other file."""
    floors = visited_floors(record)
    task_blocks = blocks_by_group(record)
    idle_times = all_waits(record)
    others = [str(f.number) for f in site.spec.floors if f.number not in floors]
    return _template().render(
        style=_style(),
        record=record,
        headline=record.headline,
        site=site,
        found=_findings(record),
        untold=any(map(lacks_measuring_times, record.tasks)),
        missed=record.faults_not_begun,
        false_all_clears=[explain_false_all_clear(a) for a in false_all_clears(record, site)],
        failed=[t for t in record.tasks if t.outcome == "failed"],
        readings=[(reading, markup(_bar(reading))) for reading in record.readings],
        timeline=markup(draw_timeline(record)) if record.tasks or record.waits else None,
        waits=idle_times,
        rounds=rounds_with_condition_values(record),
        rules=repeat_rules(record),
        charge=None if (curve := draw_charge_curve(record)) is None else markup(curve),
        plans=[(n, markup(draw_floor(site, record, n))) for n in floors],
        unvisited=others,
        elevation=markup(draw_side_view(site, record)) if record.path else None,
        ramp=", ".join(colour(i / 6) for i in range(7)),
        blocks=list(zip(task_blocks, merge_waits(task_blocks, idle_times), strict=True)),
        docking=_docking(record.mission),
        machine=markup(draw_machine(record.hfsm)) if is_drawable(record.hfsm) else None,
        has_failure_transitions=any(leaf.failure or leaf.missed for leaf in record.hfsm.leaves),
        mermaid=to_mermaid(record.hfsm),
    )


def machine_page(hfsm: Hfsm) -> str:
    """Return an HTML page with only the drawing of a machine that `is_drawable`."""
    return f"<!DOCTYPE html><style>{_style()}</style><main>{markup(draw_machine(hfsm))}</main>"


@cache
def _style() -> Markup:
    return Markup(Path(__file__).with_name("report.css").read_text(encoding="utf-8").rstrip())


@cache
def _template() -> Template:
    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=lambda value: replace_non_xml_characters(value) if type(value) is str else value,
    )
    environment.filters["clock"] = min_sec_text
    text = Path(__file__).with_name("report.html.j2").read_text(encoding="utf-8")
    return environment.from_string(text)


def _findings(record: RunRecord) -> list[tuple[int | None, Anomaly]]:
    """Return a row for each finding and a further one for its end, if reported, sorted by time.

    A row is the number in the drawings and the anomaly. For an abnormal reading that no anomaly
    reports, the number is None, as no drawing shows it, and the anomaly is made from the reading.
    """
    findings = {finding.number: finding for finding in record.findings}
    rows: list[tuple[int | None, Anomaly]] = [
        (number, findings.get(number, anomaly))
        for number, anomaly in enumerate(record.anomalies, start=1)
    ]
    rows += [(None, finding) for finding in record.findings if finding.number is None]
    return sorted(rows, key=lambda row: row[1].t)


def _docking(mission: Mission) -> frozenset[str]:
    """Return the names of the tasks that drive into the docking station."""
    return frozenset(
        [RETURN_TASK]
        + [
            task.name
            for task in mission.tasks
            if task.action is Action.WAYPOINT and task.pose and task.pose == mission.dock
        ]
    )


def _bar(reading: Reading) -> Node:
    """Draw the value on the scale of its kind, with the nominal range as a band."""
    _, scale = SCALES[reading.kind]
    low, high = min(scale.low, reading.nominal.low), max(scale.high, reading.nominal.high)

    def at(value: float) -> float:
        share = (value - low) / (high - low) if high > low else 0.5
        return 4 + min(max(share, 0.0), 1.0) * (BAR - 8)

    band = at(reading.nominal.high) - at(reading.nominal.low)
    return drawing(
        BAR,
        18.0,
        f"{reading.value:.4g} {reading.unit} on a scale from {low:g} to {high:g}",
        node("rect", x=4.0, y=7.0, width=BAR - 8, height=4.0, rx=2.0, class_="scale"),
        node(
            "rect",
            x=at(reading.nominal.low),
            y=5.0,
            width=max(band, 2.0),
            height=8.0,
            rx=2.0,
            class_="band",
        ),
        node(
            "circle",
            cx=at(reading.value),
            cy=9.0,
            r=4.5,
            class_="value" if reading.normal else "value abnormal",
        ),
        class_="bar",
    )
