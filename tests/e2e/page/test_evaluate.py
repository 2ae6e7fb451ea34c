"""Evaluations in the page: started, watched, stopped, and their failed runs replayed."""

import re
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.e2e.page.test_list import open_mission, plan, row

pytestmark = pytest.mark.long

__all__ = ["plan"]


def open_evaluation(browsers: Any, address: str, plan: str) -> Any:
    person = open_mission(browsers, address, plan)
    person.page.locator("#tab-evaluate").click()
    return person


def jobs(service: Any) -> Any:
    return service.client.get("/api/jobs").json()["jobs"]


def ended_runs(done: Any) -> int:
    """Return the number of ended runs that the page shows."""
    return int(done.inner_text().split(" ")[0].replace(",", ""))


def test_an_evaluation_shows_its_rate_and_replays_a_failed_run(
    browsers, address, plan, service
) -> None:
    ann = open_evaluation(browsers, address, plan)
    bob = open_evaluation(browsers, address, plan)
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
    # A reloaded page shows the same evaluation.
    page.reload()
    expect(row(ann, "C4")).to_be_visible()
    page.locator("#tab-evaluate").click()
    first = page.locator("#failing button").first
    expect(first).to_be_visible()
    key = first.get_attribute("data-key")
    (failed,) = (one for one in standing["failing"] if one["key"] == key)
    ann.click(first)
    replayed = page.locator("#evaluated")
    expect(replayed).to_contain_text(f"world {failed['seed']}")
    band = page.locator("argo-run-band #mode")
    expect(band).to_have_attribute("data-mode", "bad")
    expect(band).to_contain_text(failed["reason"])
    expect(page.locator("argo-run-time #back")).to_be_visible()
    expect(page.locator("argo-run a", has_text="report")).to_have_count(0)
    ann.click(page.locator("#to-evaluation"))
    expect(page.locator("#failing")).to_be_visible()
    # Whoever takes over the robot sees the run and not the replay.
    begun = service.run(plan, speed=1.0)
    assert begun.status_code in (201, 202), begun.text
    expect(page.locator("argo-run-badge")).to_contain_text("Driving autonomously")
    page.locator("#tab-evaluate").click()
    ann.click(first)
    expect(replayed).to_be_visible()
    ann.key("F9")
    expect(replayed).to_have_count(0)
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


def test_an_evaluation_is_stopped_and_resumed(browsers, address, plan, service) -> None:
    ann = open_evaluation(browsers, address, plan)
    page = ann.page
    page.locator("argo-evaluate-start select[name=worlds]").select_option("10000")
    ann.click(page.locator("#evaluate"))
    expect(page.locator("#rate")).to_be_visible()
    begin = page.locator("#evaluate")
    expect(begin).to_have_attribute("aria-disabled", "true")
    expect(page.locator("#why-not")).to_contain_text("is running: wait for it, or stop it")
    # Another mission can't be evaluated meanwhile; its page links to the running evaluation.
    other = service.post(f"/api/missions/{plan}/duplicate", name="another one").json()["id"]
    bob = open_evaluation(browsers, address, other)
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
    before = ended_runs(done)
    ann.click(page.locator("#go-on"))
    expect(result).to_have_attribute("data-state", "running")
    assert ended_runs(done) >= before
    ann.click(page.locator("#cancel"))
    expect(result).to_have_attribute("data-state", "cancelled")
    assert ended_runs(done) >= before
    # Another evaluation, started by another client.
    service.post(f"/api/missions/{plan}/evaluations", "*", worlds=3).raise_for_status()
    expect(page.locator("#done")).to_have_text("3 of 3 runs")
    expect(result).to_contain_text("No run failed.")
    # The previous one can still be viewed and deleted.
    which = page.locator("#which")
    expect(which.locator("option")).to_have_count(2)
    which.select_option(index=1)
    expect(result).to_have_attribute("data-state", "cancelled")
    ann.click(page.locator("#forget"))
    expect(which).to_have_count(0)
    expect(result).to_have_attribute("data-state", "done")
    assert len([one for one in jobs(service) if one["mission"] == plan]) == 1


def test_invalid_ranges_are_reported_before_an_evaluation_starts(
    browsers, address, plan, service
) -> None:
    before = len(jobs(service))
    ann = open_evaluation(browsers, address, plan)
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


@pytest.mark.long
def test_the_drive_follows_the_faults_and_a_refusal_stays(browsers, address, plan, service) -> None:
    ann = open_evaluation(browsers, address, plan)
    page = ann.page
    page.get_by_text("Evaluation settings").click()
    form = page.locator("argo-evaluate-start")
    form.locator("argo-faults select").select_option("gas_leak")
    form.locator("select[name=drive]").select_option("route")
    form.locator("select[name=worlds]").select_option("20")
    ann.click(page.locator("#evaluate"))
    expect(form.get_by_role("alert")).to_contain_text("choose another drive")
    expect(page.locator("argo-notices article")).to_have_count(0)
    form.locator("select[name=drive]").select_option("")
    with page.expect_request("**/evaluations") as sent:
        ann.click(page.locator("#evaluate"))
    assert sent.value.post_data_json["drive"] is None
    expect(page.locator("argo-evaluate-result")).to_contain_text("runs")
    expect(form.get_by_role("alert")).to_have_count(0)
    ann.wait_until(
        lambda: all(one["state"] != "running" for one in jobs(service)), "the evaluation ends"
    )
