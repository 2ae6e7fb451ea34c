"""Display of missions, machines and records in notebooks."""

import sys
from html import unescape
from types import SimpleNamespace

import pytest

from argo_compiler import lower
from argo_env.notebooks import machine_html, mission_html, record_html, register_with_ipython
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from tests.argo_env.evaluation.conftest import short_mission


@pytest.fixture
def mission():
    return short_mission(limit=300.0)


def test_a_mission_is_a_table_of_its_tasks(mission):
    hostile = mission.model_copy(update={"designation": "<b>bold</b>"})
    shown = mission_html(hostile)
    assert "<td>GAUGE</td><td>MEASURE</td><td>1</td>" in shown
    assert "at most 300 s" in shown
    assert "&lt;b&gt;bold" in shown
    assert "<b>bold" not in shown


def test_a_machine_is_a_diagram(mission):
    shown = machine_html(lower(mission))
    assert shown.startswith("<iframe")
    assert "<svg" in unescape(shown)
    assert "GAUGE" in shown


def test_a_record_is_its_report(mission):
    record = simulate(RunSpec(mission=mission, drive="route"))
    shown = record_html(record)
    assert "sandbox" in shown
    assert "State machine" in unescape(shown)
    nowhere = record.model_copy(update={"site": "nowhere"})
    assert record_html(nowhere) == f"<p>{record.headline}</p>"


def test_ipython_is_told_where_it_runs(monkeypatch):
    told = []
    html = SimpleNamespace(for_type_by_name=lambda *what: told.append(what[:2]))
    shell = SimpleNamespace(display_formatter=SimpleNamespace(formatters={"text/html": html}))
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: shell))
    register_with_ipython()
    for module, name in told:
        assert hasattr(sys.modules[module], name)
    assert len(told) == 3
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(get_ipython=lambda: None))
    register_with_ipython()
