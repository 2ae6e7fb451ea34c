import re
from collections import Counter
from html.parser import HTMLParser
from itertools import pairwise
from xml.etree import ElementTree

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.il import Group, Mission
from argo_env.report import write_report
from argo_env.report.html import page
from argo_env.report.machine import MAX_STATES, draw_machine
from argo_env.report.rounds import blocks_by_group
from argo_env.run.record import RoundRun, RunRecord
from tests.mission_writing import measure
from tests.yard import in_order

SECTIONS = [
    "summary",
    "warnings",
    "readings",
    "timeline",
    "path",
    "tasks",
    "machine",
    "trace",
    "contacts",
]
VOID = {"meta", "br", "hr", "img", "input", "link"}


class Balance(HTMLParser):
    """Parser that collects attributes and checks that tags are closed in order."""

    def __init__(self, text):
        super().__init__()
        self.open, self.seen, self.attributes = [], Counter(), []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.seen[tag] += 1
        self.attributes += attrs
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.seen[tag] += 1
        self.attributes += attrs

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def classes(drawing, name):
    return [e for e in drawing.iter() if name in e.get("class", "").split()]


def svgs(text):
    return [ElementTree.fromstring(s) for s in re.findall(r"<svg.*?</svg>", text, re.DOTALL)]


@pytest.fixture(params=["simple", "patrol"])
def record(request):
    return request.getfixturevalue(request.param)


def test_json_reads_back(tmp_path, site, record):
    path = write_report(record, site, tmp_path / "new" / "folder")
    assert path == tmp_path / "new" / "folder" / "report.html"
    text = path.with_name("report.json").read_text(encoding="utf-8")
    assert RunRecord.model_validate_json(text) == record
    assert re.match(r'{"checksum":"[0-9a-f]{8}",\n', text)
    assert text.split("\n", 1)[1].startswith('  "version": 5,\n  "mission": {\n    "version": 4,')
    assert len(re.findall(r'^    {"t": .*"pitch"', text, re.MULTILINE)) == len(record.path)


def test_same_record_same_bytes(tmp_path, site, record):
    copy = RunRecord.model_validate_json(record.model_dump_json())
    first, second = (
        write_report(r, site, tmp_path / n).parent for r, n in ((record, "a"), (copy, "b"))
    )
    for name in ("report.html", "report.json"):
        assert (first / name).read_bytes() == (second / name).read_bytes()


def test_page_is_complete_small_and_self_contained(site, record):
    text = page(record, site)
    seen = Balance(text)
    assert [v for k, v in seen.attributes if k == "id" and v in SECTIONS] == SECTIONS
    assert not {"script", "link", "img", "iframe"} & set(seen.seen)
    assert not [k for k, _ in seen.attributes if k in {"src", "href", "xlink:href"}]
    assert not re.search(r"https?://|url\(|@import", text)
    assert len(text) < 1_500_000
    assert "UMAD (reconstruction)" in text


def test_drawings_are_well_formed(site, record):
    assert len(svgs(page(record, site))) >= 4


def test_floors(site, simple):
    text = page(simple, site)
    assert re.findall(r"<h3>(Floor \d)</h3>", text) == ["Floor 1", "Floor 2"]
    assert "Not visited: floors 3, 4, 5, 6." in text
    plans = [s for s in svgs(text) if "plan" in s.get("class").split()]
    for floor, plan in enumerate(plans, start=1):
        ids = {e.findtext("text") for e in classes(plan, "checkpoint")}
        assert ids == {str(c.id) for c in site.checkpoints if c.floor == floor}
    assert [len(classes(p, "site-ground")) for p in plans] == [1, 0]
    assert [len(classes(p, "contact")) for p in plans] == [1, 0]
    assert [len(classes(p, "start")) for p in plans] == [1, 0]
    assert all(classes(p, "track") and classes(p, "site-stair") for p in plans)


def test_abnormal_values_and_failed_tasks_are_flagged(site, simple):
    text = page(simple, site)
    assert re.findall(r'<tr class="abnormal"><td class="n">(\d+)', text) == ["6"]
    assert re.findall(r'<tr class="failed"><td>(\w+)', text) == ["8"]
    assert "no view of it" in text
    assert "left track" in text
    assert "read &#39;guage&#39; as &#39;gauge&#39;" in text
    assert "of at most 15:00" in text


def test_rounds_are_collapsed(site, patrol):
    text = page(patrol, site)
    assert "Group Patrol: 25 rounds, 100 task runs, 00:00 to 10:00" in text
    timeline = next(s for s in svgs(text) if "timeline" in s.get("class").split())
    assert len(classes(timeline, "run")) == 100
    assert len(classes(timeline, "round")) == 25


def test_timeline_distinguishes_driving_and_measuring(site, simple):
    spans = {0: ((3.0, 6.0),), 1: ((7.0, 8.0), (10.0, 12.0)), 2: ()}
    tasks = tuple(t.model_copy(update={"measuring": spans[n]}) for n, t in enumerate(simple.tasks))
    text = page(simple.model_copy(update={"tasks": tasks}), site)
    timeline = next(s for s in svgs(text) if "timeline" in s.get("class").split())
    runs, bars = classes(timeline, "run"), classes(timeline, "measuring")
    assert [run.get("class") for run in runs] == ["run done", "run failed", "run done"]
    assert [bar.get("class") for bar in bars] == ["measuring done", *2 * ["measuring failed"]]
    first, bar = runs[0], bars[0]
    assert float(bar.get("width")) == pytest.approx(float(first.get("width")) / 2, abs=0.1)
    assert bar.findtext("title") == "1: measuring, 00:03 to 00:06"
    for run, bar in zip([runs[0], runs[1], runs[1]], bars, strict=True):
        left, right = float(run.get("x")), float(run.get("x")) + float(run.get("width"))
        start = float(bar.get("x"))
        assert left <= start < start + float(bar.get("width")) <= right + 0.1
    assert "</i>driving</span>" in text
    assert "</i>measuring</span>" in text
    assert "</i>failed, driving and measuring</span>" in text
    assert "the record does not state when" not in text
    assert '<td class="n" data-name="measuring">3.0 s</td>' in text


def test_old_records_do_not_state_measuring_times(site, simple):
    text = page(simple, site)
    assert "the record does not state when" in text
    assert 'class="run untold done"' in text
    assert 'class="measuring' not in text


def test_scripts_can_not_put_markup_into_the_page(site, make):
    bad = "<script>alert('x')</script>\x01"
    task = measure(bad, object_id="1")
    record = make(Mission(designation=bad, tasks=(task,)), [bad], {0: ("failed", bad)})
    text = page(record, site)
    assert "<script" not in text
    assert "\x01" not in text
    assert "&lt;script&gt;" in text
    assert svgs(text)


def test_machine_shows_every_state_and_transition(record):
    drawing = draw_machine(record.hfsm)
    assert len(classes(drawing, "leaf")) == len(record.hfsm.leaves)
    assert len(classes(drawing, "composite")) == len(record.hfsm.composites)
    # One more, for the start of the mission.
    assert len(classes(drawing, "way")) == len(list(record.hfsm.transitions())) + 1
    kinds = Counter(w.get("class").split()[1] for w in classes(drawing, "way"))
    assert kinds == Counter([*(t.kind for t in record.hfsm.transitions()), "begin"])


def test_labels_of_transitions_are_apart(record):
    labels = [w.find("text") for w in classes(draw_machine(record.hfsm), "way")]
    heights = sorted(float(t.get("y")) for t in labels if t is not None)
    assert heights
    assert all(b - a >= 14 for a, b in pairwise(heights))


def test_large_machine_is_not_drawn(site, make):
    names = [f"t{i}" for i in range(MAX_STATES + 1)]
    tasks = tuple(
        measure(a, b, object_id="1") for a, b in zip(names, [*names[1:], names[0]], strict=True)
    )
    text = page(make(Mission(tasks=tasks), names[:2]), site)
    assert "too many for a drawing" in text
    assert "stateDiagram-v2" in text


def test_empty_run(site, make):
    task = measure("A", object_id="1")
    text = page(make(Mission(tasks=(task,)), []), site)
    for words in ("Nothing was measured", "No task was started", "No path was recorded"):
        assert words in text


def test_refusals(tmp_path, site, simple):
    (tmp_path / "file").write_text("")
    with pytest.raises(ArgoError, match="can't be written"):
        write_report(simple, site, tmp_path / "file" / "folder")
    with pytest.raises(ArgoError, match="site `else`"):
        write_report(simple.model_copy(update={"site": "else"}), site, tmp_path)


def test_jumps_and_inner_rounds_begin_no_round(make):
    names = ["1", "2", "3"]
    tasks = in_order(*map(measure, names))
    groups = (
        Group(name="Outer", start="1", end="3", max_repeat_count=2),
        Group(name="Outer/Inner", start="1", end="2", max_repeat_count=2),
    )
    record = make(Mission(tasks=tasks, groups=groups), ["1", "2", "1", "2", "3", "1", "2", "3"])
    began = [("Outer", 1, 0), ("Outer/Inner", 1, 0), ("Outer/Inner", 2, 2), ("Outer", 2, 5)]
    rounds = tuple(
        RoundRun(group=g, number=n, since=record.tasks[k].start, began=record.tasks[k].start)
        for g, n, k in began
    )
    (block,) = blocks_by_group(record.model_copy(update={"rounds": rounds}))
    assert [len(runs) for runs in block.rounds] == [5, 3]
