"""Runs in the page: edits during supervision, the view from another mission, and the report."""

from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import ALL
from tests.e2e.page.person import Proxy
from tests.e2e.page.test_list import expect_order, open_mission, plan, row

__all__ = ["plan"]


def runs(service: Any) -> Any:
    return service.client.get("/api/runs").json()["runs"]


def panel(person: Any) -> Any:
    return person.page.locator("argo-run")


@pytest.mark.long
def test_the_run_continues_with_edits_and_its_report_is_readable(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan)
    ann.key("F8")
    expect(ann.button("Start the run")).to_be_focused()
    expect(ann.button("Start the run")).to_be_enabled()
    ann.key("Enter")
    expect(ann.button("Take over")).to_be_enabled()
    ann.key("F9")
    expect(panel(ann)).to_contain_text("You control the robot")
    expect(ann.button("Give back")).to_be_focused()
    ann.click(row(ann, "C4"))
    ann.key("Delete")
    expect_order(ann, "START", "A1", "B2")
    ann.page.locator("#speed").select_option("null")
    edited = ann.button("Give back with edits")
    expect(ann.page.locator("argo-run-controls button.main")).to_have_text("Give back with edits")
    ann.click(edited)
    ann.wait_until(lambda: runs(service)[0]["status"] == "ended", "the run ends")
    assert [task["task"] for task in runs(service)[0]["tasks"]] == ["A1", "B2"]
    address_of = f"/api/runs/{runs(service)[0]['id']}/report/report.html"
    ann.wait_until(
        lambda: service.client.get(address_of).status_code == 200, "the report has been made"
    )
    with ann.context.expect_page() as opening:
        ann.click(ann.page.get_by_role("link", name="Open the report"))
    report = opening.value
    report.wait_for_url("**/report.html")
    report.wait_for_load_state()
    assert report.evaluate("() => document.styleSheets.length") > 0
    assert report.evaluate("() => getComputedStyle(document.body).fontFamily") != "Times"
    report.close()


@pytest.mark.long
def test_the_run_of_another_mission_does_not_offer_tasks_of_this_one(
    browsers, address, plan, service
) -> None:
    begun = service.run(plan, speed=0.5)
    assert begun.status_code == 201, begun.text
    run = begun.json()["id"]
    other = service.create("Another", service.mission(plan))
    ann = open_mission(browsers, address, other)
    ann.page.locator("#tab-run").click()
    take_over = ann.button("Take over")
    expect(take_over).to_be_enabled()
    ann.click(take_over)
    expect(ann.button("Give back")).to_be_enabled()
    expect(ann.page.locator("argo-run-hand #task")).to_have_count(0)
    service.post(f"/api/runs/{run}/requests", kind="stop", id="end").raise_for_status()
    ann.wait_until(lambda: runs(service)[0]["status"] == "ended", "the run ends")


@pytest.mark.long
def test_without_a_connection_the_state_of_the_robot_is_unknown(browsers, plan, service) -> None:
    run = service.run(plan, speed=0.5).json()["id"]
    with Proxy(service.address) as proxy:
        ann = open_mission(browsers, f"http://{proxy.address}/?token={ALL}", plan)
        ann.page.locator("#tab-run").click()
        band = panel(ann).locator("#mode")
        badge = ann.page.locator("argo-run-badge")
        expect(band).to_have_attribute("data-mode", "autonomous")
        known = band.locator(".word").inner_text()
        proxy.cut()
        expect(band).to_have_attribute("data-mode", "unknown")
        expect(band.locator(".word")).to_contain_text("Unknown since")
        expect(band.locator(".what")).to_contain_text(f"No connection. Last known: {known}")
        expect(badge).to_contain_text("Unknown since")
        colours = "e => ['--tone', '--dim'].map((n) => getComputedStyle(e).getPropertyValue(n))"
        tone, dim = band.evaluate(colours)
        assert tone == dim
        panel(ann).locator("argo-run-events").scroll_into_view_if_needed()
        expect(band).to_be_in_viewport(ratio=1)
        proxy.restore()
        expect(band).to_have_attribute("data-mode", "autonomous")
        expect(badge).to_contain_text(known)
        ann.clear_connection_problems()
    service.post(f"/api/runs/{run}/requests", kind="stop", id="end").raise_for_status()
