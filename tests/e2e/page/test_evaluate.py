"""The evaluation of the mission in the page: begun, watched, ended, its failures replayed."""

import re
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.e2e.page.test_list import at, plan, row

pytestmark = pytest.mark.long

__all__ = ["plan"]


def opened(browsers: Any, address: str, plan: str) -> Any:
    person = at(browsers, address, plan)
    person.page.locator("#tab-evaluate").click()
    return person


def jobs(service: Any) -> Any:
    return service.client.get("/api/jobs").json()["jobs"]


def runs_in(done: Any) -> int:
    """How many runs have ended, as the page says."""
    return int(done.inner_text().split(" ")[0].replace(",", ""))


def test_rates_close_in_and_a_failing_run_is_replayed(browsers, address, plan, service) -> None:
    ann = opened(browsers, address, plan)
    bob = opened(browsers, address, plan)
    page = ann.page
    page.get_by_text("Evaluation settings").click()
    page.get_by_label("Charge at the start (%), from").fill("0.1")
    page.get_by_label("Charge at the start (%), to").fill("2")
    page.get_by_label("Required success rate").fill("50")
    page.locator("argo-evaluate-start select[name=worlds]").select_option("20")
    ann.click(page.locator("#evaluate"))
    result = page.locator("argo-evaluate-result section")
    expect(result).to_have_attribute("data-state", "done")
    standing = service.client.get(f"/api/jobs/{jobs(service)[0]['id']}").json()["standing"]
    assert 0 < standing["outcomes"]["failure"] < 20
    expect(page.locator("#rate")).to_contain_text(f"{100 * standing['rate']['value']:g} %")
    expect(page.locator("#done")).to_have_text("20 of 20 runs")
    verdict = re.compile("Success in at least 50 %: (met|not met|undecided)")
    expect(page.locator(".verdict")).to_contain_text(verdict)
    kind = "valid although the requirement decides when to stop"
    expect(page.locator("#kind")).to_contain_text(kind)
    expect(bob.page.locator("#rate")).to_have_text(page.locator("#rate").inner_text())
    # What had happened by then is there when the page is read again.
    page.reload()
    expect(row(ann, "C4")).to_be_visible()
    page.locator("#tab-evaluate").click()
    first = page.locator("#failing button").first
    expect(first).to_be_visible()
    key = first.get_attribute("data-key")
    (failed,) = (one for one in standing["failing"] if one["key"] == key)
    ann.click(first)
    told = page.locator("#evaluated")
    expect(told).to_contain_text(f"world {failed['seed']}")
    band = page.locator("argo-run-band #mode")
    expect(band).to_have_attribute("data-mode", "bad")
    expect(band).to_contain_text(failed["reason"])
    expect(page.locator("argo-run-time #back")).to_be_visible()
    expect(page.locator("argo-run a", has_text="report")).to_have_count(0)
    ann.click(page.locator("#to-evaluation"))
    expect(page.locator("#failing")).to_be_visible()
    # Who takes the robot over sees the robot, and not the replay.
    begun = service.run(plan, speed=1.0)
    assert begun.status_code in (201, 202), begun.text
    expect(page.locator("argo-run-badge")).to_contain_text("Driving autonomously")
    page.locator("#tab-evaluate").click()
    ann.click(first)
    expect(told).to_be_visible()
    ann.key("F9")
    expect(told).to_have_count(0)
    expect(page.locator("argo-run-band")).to_contain_text("You control the robot")
    stopped = service.post(f"/api/runs/{begun.json()['id']}/requests", kind="stop", id="end")
    assert stopped.status_code == 202, stopped.text
    page.locator("#tab-evaluate").click()
    with ann.context.expect_page() as opening:
        ann.click(page.get_by_role("link", name="Report with all tables and pictures"))
    report = opening.value
    report.wait_for_load_state()
    assert report.evaluate("() => document.styleSheets.length") > 0
    assert report.locator("svg").count() > 0
    report.close()


def test_an_evaluation_is_ended_and_goes_on(browsers, address, plan, service) -> None:
    ann = opened(browsers, address, plan)
    page = ann.page
    page.locator("argo-evaluate-start select[name=worlds]").select_option("10000")
    ann.click(page.locator("#evaluate"))
    expect(page.locator("#rate")).to_be_visible()
    begin = page.locator("#evaluate")
    expect(begin).to_have_attribute("aria-disabled", "true")
    expect(page.locator("#why-not")).to_contain_text("is running: wait for it, or stop it")
    # Another mission can't be evaluated meanwhile, and leads here.
    other = service.post(f"/api/missions/{plan}/duplicate", name="another one").json()["id"]
    bob = opened(browsers, address, other)
    expect(bob.page.locator("#why-not")).to_contain_text("is being evaluated, started by")
    bob.click(bob.page.locator("#why-not a"))
    expect(bob.page.locator("#rate")).to_be_visible()
    done = page.locator("#done")
    expect(page.locator("#kind")).to_contain_text("preliminary until all runs are done")
    ann.click(page.locator("#cancel"))
    result = page.locator("argo-evaluate-result section")
    expect(result).to_have_attribute("data-state", "cancelled")
    expect(page.locator("#kind")).to_contain_text("valid for any reason to stop")
    expect(page.get_by_role("link", name="Report with all tables and pictures")).to_be_visible()
    expect(begin).to_have_attribute("aria-disabled", "false")
    before = runs_in(done)
    ann.click(page.locator("#go-on"))
    expect(result).to_have_attribute("data-state", "running")
    assert runs_in(done) >= before
    ann.click(page.locator("#cancel"))
    expect(result).to_have_attribute("data-state", "cancelled")
    assert runs_in(done) >= before
    # By somebody else, in another way.
    service.post(f"/api/missions/{plan}/evaluations", "*", worlds=3).raise_for_status()
    expect(page.locator("#done")).to_have_text("3 of 3 runs")
    expect(result).to_contain_text("No run failed.")
    # The one before can still be looked at, and deleted.
    which = page.locator("#which")
    expect(which.locator("option")).to_have_count(2)
    which.select_option(index=1)
    expect(result).to_have_attribute("data-state", "cancelled")
    ann.click(page.locator("#forget"))
    expect(which).to_have_count(0)
    expect(result).to_have_attribute("data-state", "done")
    assert len([one for one in jobs(service) if one["mission"] == plan]) == 1


def test_ranges_that_make_no_sense_are_told_at_once(browsers, address, plan, service) -> None:
    before = len(jobs(service))
    ann = opened(browsers, address, plan)
    page = ann.page
    page.get_by_text("Evaluation settings").click()
    expect(page.get_by_label("Also without faults")).to_be_hidden()
    page.locator("argo-evaluate-start argo-faults select").select_option("gas_leak")
    expect(page.get_by_label("Also without faults")).to_be_visible()
    page.get_by_label("Robot speed (%), from").fill("90")
    page.get_by_label("Robot speed (%), to").fill("50")
    ann.click(page.locator("#evaluate"))
    expect(page.locator("argo-evaluate-start .wrong")).to_contain_text(
        "enter both values, the smaller one first"
    )
    assert len(jobs(service)) == before
