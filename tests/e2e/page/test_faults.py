"""Faults of runs and evaluations in the page: described, placed, shown and refused."""

from typing import Any

import pytest
from playwright.sync_api import expect

from tests.e2e.page.person import Person
from tests.e2e.page.test_list import open_mission, plan

__all__ = ["plan"]


def open_settings(ann: Person, panel: str) -> Any:
    """Open the settings of a run or an evaluation, and return the faults in them."""
    ann.page.locator(f"#tab-{panel}").click()
    start = {"run": "argo-run-start", "evaluate": "argo-evaluate-start"}[panel]
    ann.focus(ann.page.locator(f"{start} summary").first)
    ann.key("Enter")
    return ann.page.locator(f"{start} argo-faults")


def add(faults: Any, kind: str) -> Any:
    """Add a fault of a kind, and return its fields."""
    faults.locator("#add-fault").select_option(kind)
    fields = faults.locator(".fields")
    expect(fields).to_be_visible()
    return fields


def enter(ann: Person, field: Any, text: str) -> None:
    ann.focus(field)
    ann.key("Control+a")
    ann.type(text)
    ann.key("Enter")


@pytest.mark.long
def test_a_fault_has_a_time_a_place_and_a_size_by_keyboard(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan)
    faults = open_settings(ann, "run")
    fields = add(faults, "gas_leak")
    enter(ann, fields.get_by_label("Begins at"), "1:30 min")
    fields.get_by_label("Place", exact=True).select_option("4")
    expect(ann.page.locator('.label[data-key="fault:0"]')).to_have_text("⚠ gas leak")
    enter(ann, fields.get_by_label("z", exact=True), "99")
    expect(faults.get_by_role("alert")).to_contain_text("22.5 m")
    enter(ann, fields.get_by_label("z", exact=True), "1.2")
    rate = fields.get_by_label("Rate of the leak")
    enter(ann, rate, "2")
    expect(faults.get_by_role("alert")).to_have_text("Enter more than 0 kg/s, at most 1 kg/s.")
    ann.click(ann.button("Start the run"))
    expect(ann.page.locator("argo-run-start")).to_contain_text("A fault is not complete")
    expect(rate).to_be_focused()
    enter(ann, rate, "0,02")
    expect(faults.locator("li")).to_contain_text("Rate of the leak: 0.02 kg/s")
    ann.page.locator("#tab-script").click()
    expect(ann.page.locator('.label[data-key="fault:0"]')).to_have_count(0)
    faults = open_settings(ann, "run")
    add(faults, "emergency_stop")
    ann.focus(ann.button("Remove emergency stop"))
    ann.key("Enter")
    with ann.page.expect_request("**/runs") as sent:
        ann.click(ann.button("Start the run"))
    (fault,) = sent.value.post_data_json["faults"]
    x, y, _ = next(
        one["position"]
        for one in service.client.get("/api/world").json()["checkpoints"]
        if one["id"] == 4
    )
    assert fault == {"kind": "gas_leak", "at": 90, "place": [x, y, 1.2], "rate": 0.02}
    ann.click(ann.button("Stop immediately"))
    expect(ann.page.locator("argo-run #mode")).to_contain_text("Ended")


@pytest.mark.long
def test_a_fault_is_placed_by_clicks_in_the_site(browsers, address, plan) -> None:
    ann = open_mission(browsers, address, plan)
    ann.wait_for_scene()
    faults = open_settings(ann, "evaluate")
    fields = add(faults, "brick")
    place = faults.get_by_role("button", name="Click in the site")
    ann.click(place)
    ann.click(ann.project(7.0, -1.0, -0.03))
    expect(faults.get_by_role("alert")).to_contain_text("There is no ground at this place")
    expect(place).to_be_focused()
    ann.key("Enter", "Escape")
    expect(place).to_have_attribute("aria-pressed", "false")
    ann.click(ann.page.locator("argo-scene-floors").get_by_label("Floor 1"))
    ann.wait_for_scene()
    ann.click(place)
    ann.click(ann.project(5.0, 1.5, 0.0))
    expect(faults.get_by_role("alert")).to_have_count(0)
    assert float(fields.get_by_label("x", exact=True).input_value()) == pytest.approx(5, abs=0.2)
    enter(ann, fields.get_by_label("height"), "0.4")
    fields = add(faults, "connection_loss")
    ann.click(place)
    for corner in ((6.0, 5.0, 0.0), (4.0, 3.0, 0.0)):
        ann.click(ann.project(*corner))
    expect(fields.get_by_label("Floor")).to_have_value("1")
    assert float(fields.get_by_label("x from").input_value()) == pytest.approx(4, abs=0.2)
    with ann.page.expect_request("**/evaluations") as sent:
        ann.click(ann.page.locator("#evaluate"))
    brick, loss = sent.value.post_data_json["faults"]
    assert (brick["kind"], brick["floor"], brick["size"]) == ("brick", 1, [0.3, 0.2, 0.4])
    assert (loss["kind"], len(loss["rect"])) == ("connection_loss", 4)
    expect(ann.page.locator("argo-evaluate-result table")).to_contain_text("0.3 × 0.2 × 0.4 m")
    ann.click(ann.page.locator("argo-evaluate-result #cancel"))
    expect(ann.page.locator("argo-evaluate-result section")).to_have_attribute(
        "data-state", "cancelled"
    )
