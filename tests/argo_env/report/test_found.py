"""The report shows findings, faults, waits and the battery's charge."""

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from argo_compiler.base.model import Pose
from argo_compiler.il import EventKind, Mission
from argo_env.faults.plant import GasLeakFault, PlatformAlarm
from argo_env.report.html import page
from argo_env.report.timeline import draw_charge_curve
from argo_env.report.track import shift_right
from argo_env.run.record import FROM_READING, Anomaly, Interruption, anomaly_from_reading
from tests.mission_writing import drive


def anomaly(t, kind=EventKind.GAS_LEAK, place=None, floor=None):
    return Anomaly(t=t, kind=kind, detail="a <hiss> & more", source="gas", place=place, floor=floor)


def charged(record, charges):
    """Return the record with a charge for each sample; `charges` maps its share of the path."""
    path = tuple(
        s.model_copy(update={"charge": charges(k / max(1, len(record.path) - 1))})
        for k, s in enumerate(record.path)
    )
    return record.model_copy(update={"path": path})


@pytest.fixture
def simple(simple):
    """Return the record without its abnormal reading, which would be a finding as well."""
    return simple.model_copy(update={"readings": simple.readings[:1]})


def section(text, id, tag="section"):
    return re.search(rf'<{tag} id="{id}">.*?</{tag}>', text, re.DOTALL)[0]


def test_abnormal_readings_of_one_moment_are_findings_of_their_own(simple):
    """A finding has the value of its checkpoint, and a reading without an anomaly is one too."""
    first, second, third = (
        simple.readings[0].model_copy(
            update={"checkpoint": k, "name": f"gauge {k}", "value": 8.0 + k, "normal": False}
        )
        for k in (1, 2, 3)
    )
    other = anomaly(first.t).model_copy(update={"source": FROM_READING})
    found = (anomaly_from_reading(second), other, anomaly_from_reading(first))
    record = simple.model_copy(update={"readings": (first, second, third), "anomalies": found})
    assert [(f.number, f.what.partition(":")[0]) for f in record.findings] == [
        (1, "gauge 2 (#2) abnormal"),
        (2, "gas leak"),
        (3, "gauge 1 (#1) abnormal"),
        (None, "gauge 3 (#3) abnormal"),
    ]
    assert [record.abnormal_reading(one) for one in found] == [second, None, first]


def test_place_on_an_unknown_floor_names_no_floor():
    place = (1.0, 2.0, 3.0)
    assert anomaly(1.0, place=place, floor=2).whereabouts == "on floor 2 at (1.00, 2.00, 3.00)"
    assert anomaly(1.0, place=place).whereabouts == "at (1.00, 2.00, 3.00)"
    noticed = anomaly(1.0).model_copy(update={"noticed_from": place})
    assert noticed.whereabouts == "noticed from (1.00, 2.00, 3.00)"
    told = noticed.model_copy(update={"source": "told"})
    assert told.whereabouts == "reported while the robot was at (1.00, 2.00, 3.00)"


def test_nothing_found(simple, site):
    text = page(simple, site)
    assert "Nothing out of the ordinary was found" in section(text, "anomalies")
    assert 'class="found"' not in text


def test_each_finding_has_a_row_and_a_number_where_it_was(simple, site):
    where = simple.path[0]
    found = (
        anomaly(1.0),
        anomaly(1.01, EventKind.NEGATIVE_OBSTACLE, (where.x, where.y, where.z), where.floor),
        anomaly(simple.result.duration, EventKind.ALL_CLEAR),
    )
    text = page(simple.model_copy(update={"anomalies": found}), site)
    table = section(text, "anomalies")
    assert table.count("<tr>") == 1 + len(found)
    assert "a &lt;hiss&gt; &amp; more" in table
    assert "<hiss>" not in text
    assert '<span class="mark over">all clear</span>' in table
    timeline = section(text, "timeline")
    assert timeline.count('class="found-line"') == len(found)
    # The second would cover the first one's number.
    assert re.findall(r'class="middle">(\d+)</text></g>', timeline)[-2:] == ["1", "3"]
    plan = section(text, "path")
    assert len(re.findall(r'<g class="found">', plan)) == 1


def test_the_headline_counts_the_rows_and_says_what_came_of_them(simple, site):
    text = page(simple, site)
    assert '<span class="badge notice">Done, 1 contact</span>' in text
    quiet = simple.model_copy(update={"contacts": ()})
    assert '<span class="badge good">Success</span>' in page(quiet, site)
    told = anomaly(1.0, floor=1).model_copy(
        update={"source": "told", "noticed_from": (1.0, 2.0, 0.0)}
    )
    over = told.model_copy(update={"t": 9.0, "kind": EventKind.ALL_CLEAR})
    text = page(quiet.model_copy(update={"anomalies": (told, over)}), site)
    assert '<span class="badge notice">Done, 1 finding</span>' in text
    assert "<p>Gas leak at 00:01 (no reaction answers it), over at 00:09. All check" in text
    table = section(text, "anomalies")
    assert table.count('class="mark finding"') == 1
    assert "<td>no reaction answers it, over at 00:09</td>" in table
    assert "<td>reported while the robot was on floor 1 at (1.00, 2.00, 0.00)</td>" in table
    assert '<td data-name="found by">told</td>' in table


def test_a_run_that_was_interrupted_is_not_shown_as_if_it_had_ended(simple, site):
    fields = {"success": False, "ended": False, "docked": False}
    result = simple.result.model_copy(update=fields)
    text = section(page(simple.model_copy(update={"result": result}), site), "summary", "header")
    assert '<span class="badge notice">Interrupted</span>' in text
    assert '<div class="tile "><b>not yet</b><span>docked at the end</span></div>' in text
    assert "<dd>not at its end</dd>" in text
    stopped = result.model_copy(update={"ended": True})
    text = section(page(simple.model_copy(update={"result": stopped}), site), "summary", "header")
    assert '<div class="tile bad"><b>no</b><span>docked at the end</span></div>' in text
    assert "<dd>stopped</dd>" in text


def test_a_finding_without_a_place_has_a_mark_of_its_own(simple, site):
    at = simple.path[0]
    leak = Anomaly(
        t=1.0, kind=EventKind.GAS_LEAK, detail="a hiss", source="gas",
        noticed_from=(at.x, at.y, at.z), floor=at.floor,
    )  # fmt: skip
    text = page(simple.model_copy(update={"anomalies": (leak,)}), site)
    said = f"noticed from floor {at.floor} at ({at.x:.2f}, {at.y:.2f}, {at.z:.2f})"
    assert f"<td>{said}</td>" in section(text, "anomalies")
    path = section(text, "path")
    assert 'class="found"' not in path
    assert path.count('<g class="noticed">') == 1
    assert "◇" in path
    assert "◇" not in page(simple, site)


def test_the_end_of_a_finding_is_not_counted(simple, site):
    def tiles(*kinds):
        found = tuple(anomaly(k + 1.0, kind) for k, kind in enumerate(kinds))
        text = page(simple.model_copy(update={"anomalies": found}), site)
        return re.findall(r'<div class="tile (\w+)"><b>(\d+)</b><span>findings?</span>', text)

    assert tiles(EventKind.GAS_LEAK, EventKind.ALL_CLEAR) == [("notice", "1")]
    assert tiles(EventKind.ALL_CLEAR) == [("good", "0")]


def test_faults_that_did_not_happen(simple, site):
    assert "did not happen" not in page(simple, site)
    faults = (GasLeakFault(at=1.0), GasLeakFault(at=500.0), PlatformAlarm(at=900.0))
    text = page(simple.model_copy(update={"faults": faults}), site)
    assert "gas leak, gas leak (did not happen), platform alarm (did not happen)" in text
    messages = re.findall(r'<p class="note missed">(.*?)</p>', section(text, "anomalies"))
    assert messages == [
        "Fault gas leak did not happen: begins at 500 s, the mission ended at 18 s",
        "Fault platform alarm did not happen: begins at 900 s, the mission ended at 18 s",
    ]


def test_remarks_about_the_mission_suit_any_source(simple, site):
    assert "1 remark about the source of the mission" in section(page(simple, site), "warnings")
    # The source may be a correct script, a mission's .json or a bag: the record does not say.
    text = section(page(simple.model_copy(update={"diagnostics": ()}), site), "warnings")
    assert "used as written" in text
    assert "script" not in text.lower()
    assert "import" not in text.lower()


def test_no_curve_without_a_battery(simple):
    bare = charged(simple, lambda _: None)
    assert draw_charge_curve(bare) is None


@pytest.mark.parametrize("charges", [lambda s: 1 - s, lambda s: s, lambda _: 0.5])
def test_the_curve_stays_in_its_frame_and_states_both_ends(simple, site, charges):
    record = charged(simple, charges)
    curve = draw_charge_curve(record)
    first, last = 100 * charges(0.0), 100 * charges(1.0)
    assert f"{first:.1f} % at the start, {last:.1f} % at the end" in curve.get("aria-label")
    line = next(e for e in curve.iter() if e.get("class") == "charge").get("d")
    points = [tuple(map(float, p.split(","))) for p in line.removeprefix("M").split()]
    assert all(12 <= y <= 108 for _, y in points)
    assert [x for x, _ in points] == sorted(x for x, _ in points)
    assert points[0][1] == pytest.approx(108 - 0.96 * first, abs=0.1)
    assert points[-1][1] == pytest.approx(108 - 0.96 * last, abs=0.1)
    assert ElementTree.tostring(curve, encoding="unicode") in page(record, site)


def test_lines_of_opposite_directions_lie_beside_each_other():
    out = np.column_stack([np.linspace(0.0, 4.0, 81), np.zeros(81)])
    shifted = shift_right(np.vstack([out, out[::-1]]), 0.05)
    inner = (shifted[:, 0] > 0.2) & (shifted[:, 0] < 3.8)
    forth, back = shifted[:81][inner[:81]], shifted[81:][inner[81:]]
    assert forth[:, 1] == pytest.approx(-0.05)  # to the right of east lies the south
    assert back[:, 1] == pytest.approx(0.05)
    assert np.hypot(*(shifted - np.vstack([out, out[::-1]])).T) == pytest.approx(0.05)
    still = np.zeros((3, 2))
    assert (shift_right(still, 0.05) == still).all()


def test_waits_stand_between_the_runs_by_their_time(simple, site):
    pause = Interruption(start=8.0, end=14.0)  # the runs begin at 0, 6 and 12 s
    stood = simple.tasks[1].model_copy(update={"end": 9.0})
    record = simple.model_copy(
        update={
            "interruptions": (pause,),
            "tasks": (simple.tasks[0], stood, simple.tasks[2].model_copy(update={"start": 14.0})),
        }
    )
    table = section(page(record, site), "tasks")
    first = re.findall(r'<tr class="\w+"><td>(.*?)</td>', table)
    assert first == ["1", "8", "waits for a person (paused)", "6"]


def test_a_drive_into_the_station_is_shown_as_dock(make, site):
    dock = Pose(x=0.0, y=0.0, z=0.0, yaw=0.0)
    tasks = drive("there", "DOCK", pose=Pose(x=1.0, y=0.0, z=0.0)), drive("DOCK", pose=dock)
    text = page(make(Mission(tasks=tasks, dock=dock), ["there", "DOCK"]), site)
    rows = re.findall(r'<tr class="done"><td>(\w+)</td><td>(\w+)</td>', section(text, "tasks"))
    assert rows == [("there", "WAYPOINT"), ("DOCK", "DOCK")]
