"""Two runs of a mission in the page, side by side, and their tables as files."""

import csv
import re
import time
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import Served
from tests.e2e.page.person import Person
from tests.e2e.page.test_access import require_accessible
from tests.e2e.page.test_list import open_mission, plan, row

__all__ = ["plan"]

HOSTILE = '=HYPERLINK("http://x")'


def finish_run(service: Served, plan: str, **order: Any) -> str:
    """Carry out a run of the mission, and return its id once it has a report."""
    begun = service.run(plan, drive="route", speed=None, **order)
    assert begun.status_code == 201, begun.text
    id: str = begun.json()["id"]
    while service.client.get(f"/api/runs/{id}/report/report.json").status_code == 404:
        time.sleep(0.1)
    return id


@pytest.fixture
def runs(service: Served, plan: str) -> list[str]:
    """Return the ids of two runs; one task was removed and one added between them."""
    first = finish_run(service, plan, values={"1": 2.0, "4": 10.0})
    task = {"name": HOSTILE, "action": "MEASURE", "object_id": "14"}
    edits: list[Any] = [{"kind": "remove_task", "name": "B2"}, {"kind": "add_task", "task": task}]
    assert service.command(plan, "*", *edits).status_code == 200
    fault = {"kind": "low_battery", "charge": 0.9}
    return [first, finish_run(service, plan, values={"1": 3.5, "4": 10.0}, faults=[fault])]


def open_comparison(browsers: Any, address: str, plan: str, **context: Any) -> Person:
    ann = open_mission(browsers, address, plan, **context)
    ann.page.locator("#tab-run").click()
    ann.focus(ann.page.locator("argo-run-compare summary"))
    ann.key("Enter")
    return ann


def table_row(ann: Person, table: str, name: str) -> Any:
    return ann.page.locator(f"argo-run-compare table#{table} tbody").filter(
        has_text=re.compile(rf"(^|\s){re.escape(name)}(\s|$)")
    )


@pytest.mark.long
def test_two_runs_of_different_revisions_are_compared(
    browsers, address, plan, runs, tmp_path
) -> None:
    ann = open_comparison(browsers, address, plan)
    gauge = table_row(ann, "readings", "#1")
    expect(gauge).to_contain_text("different")
    expect(gauge.locator("td").nth(2)).to_have_text("+1.5 bar")
    expect(table_row(ann, "readings", "#4")).not_to_contain_text("different")
    expect(table_row(ann, "readings", "#2").locator("td").nth(1)).to_have_text(
        "not in this revision"
    )
    expect(table_row(ann, "whole", "Revision of the mission").locator("td")).to_have_text(
        ["2", "3", ""]
    )
    expect(table_row(ann, "whole", "Faults").locator("td")).to_have_text(
        ["none", "low battery (Charge at the start: 90 %)", ""]
    )
    require_accessible(ann, "two compared runs")
    ann.page.locator("#only-different").focus()
    ann.key(" ")
    expect(table_row(ann, "readings", "#4")).to_have_count(0)
    expect(table_row(ann, "tasks", HOSTILE).locator("td").first).to_have_text(
        "not in this revision"
    )
    with ann.page.expect_download() as readings:
        ann.focus(ann.page.locator("#csv-readings"))
        ann.key("Enter")
    path = tmp_path / readings.value.suggested_filename
    readings.value.save_as(path)
    assert path.name == f"readings-{runs[0]}-{runs[1]}.csv"
    with path.open(newline="", encoding="utf-8") as file:
        rows = {line["checkpoint"]: line for line in csv.DictReader(file)}
    assert (rows["1"]["first run: value"], rows["1"]["second run: value"]) == ("2", "3.5")
    assert (rows["1"]["difference"], rows["1"]["unit"]) == ("1.5", "bar")
    assert rows["2"]["second run: result"] == "not in this revision"
    with ann.page.expect_download() as of_run:
        ann.click(ann.page.locator("#csv"))
    of_run.value.save_as(path)
    with path.open(newline="", encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert [(line["run"], line["checkpoint"]) for line in lines][:1] == [(runs[1], "1")]
    assert [line["task"] for line in lines if line["checkpoint"] == "14"] == [f"'{HOSTILE}"]
    ann.click(row(ann, "A1"))
    expect(ann.page.locator("argo-run-compare table#tasks")).to_be_visible()
