"""What was found, and the battery's charge, in the report."""

import re
from xml.etree import ElementTree

import pytest

from argo_compiler.il import EventKind
from argo_env.events.process import GasLeakFault, PlatformAlarm
from argo_env.record import Anomaly
from argo_env.report.charge import charge_curve
from argo_env.report.html import page


def anomaly(t, kind=EventKind.GAS_LEAK, place=None, floor=None):
    return Anomaly(t=t, kind=kind, detail="a <hiss> & more", source="gas", place=place, floor=floor)


def charged(record, charges):
    """The record with these charges along its path, by turns."""
    path = tuple(
        s.model_copy(update={"charge": charges(k / max(1, len(record.path) - 1))})
        for k, s in enumerate(record.path)
    )
    return record.model_copy(update={"path": path})


def section(text, id):
    return re.search(rf'<section id="{id}">.*?</section>', text, re.DOTALL)[0]


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


def test_faults_that_did_not_happen(simple, site):
    assert "did not happen" not in page(simple, site)
    faults = (GasLeakFault(at=1.0), GasLeakFault(at=500.0), PlatformAlarm(at=900.0))
    text = page(simple.model_copy(update={"faults": faults}), site)
    assert "gas leak, gas leak (did not happen), platform alarm (did not happen)" in text
    told = re.findall(r'<p class="note missed">(.*?)</p>', section(text, "anomalies"))
    assert told == [
        "Fault gas leak did not happen: begins at 500 s, the mission ended at 18 s",
        "Fault platform alarm did not happen: begins at 900 s, the mission ended at 18 s",
    ]


def test_what_is_said_of_reading_the_mission_holds_for_any_source(simple, site):
    assert "1 finding in what the mission was read from" in section(page(simple, site), "warnings")
    # As of a script that is right, a mission's .json or a bag: the record does not tell which.
    text = section(page(simple.model_copy(update={"diagnostics": ()}), site), "warnings")
    assert "taken as it was written" in text
    assert "script" not in text.lower()
    assert "import" not in text.lower()


def test_no_curve_without_a_battery(simple):
    bare = charged(simple, lambda _: None)
    assert charge_curve(bare) is None


@pytest.mark.parametrize("charges", [lambda s: 1 - s, lambda s: s, lambda _: 0.5])
def test_the_curve_stays_in_its_frame_and_tells_both_ends(simple, site, charges):
    record = charged(simple, charges)
    curve = charge_curve(record)
    first, last = 100 * charges(0.0), 100 * charges(1.0)
    assert f"{first:.1f} % at the start, {last:.1f} % at the end" in curve.get("aria-label")
    line = next(e for e in curve.iter() if e.get("class") == "charge").get("d")
    points = [tuple(map(float, p.split(","))) for p in line.removeprefix("M").split()]
    assert all(12 <= y <= 108 for _, y in points)
    assert [x for x, _ in points] == sorted(x for x, _ in points)
    assert points[0][1] == pytest.approx(108 - 0.96 * first, abs=0.1)
    assert points[-1][1] == pytest.approx(108 - 0.96 * last, abs=0.1)
    assert ElementTree.tostring(curve, encoding="unicode") in page(record, site)
