"""The search for an order in the page."""

import pytest
from playwright.sync_api import expect

from tests.e2e.page.test_list import open_mission, plan

pytestmark = pytest.mark.long

__all__ = ["plan"]


def test_a_duration_with_several_meanings_is_asked_about_before_the_search(
    browsers, address, plan, service
) -> None:
    service.command(plan, "*", {"kind": "set_header", "order": "any"}).raise_for_status()
    ann = open_mission(browsers, address, plan, "Ann")
    page = ann.page
    page.locator("#tab-route").click()
    page.get_by_text("Requirements", exact=True).click()
    panel = page.locator("argo-route")
    budget = panel.get_by_label("Maximum duration")
    budget.fill("1:30")
    ann.click(ann.button("Find the best order"))
    question = panel.get_by_role("alert")
    expect(question.get_by_role("button")).to_have_text(["90 s", "1 h 30 min"])
    expect(budget).to_be_focused()
    ann.click(question.get_by_role("button", name="1 h 30 min"))
    expect(budget).to_have_value("1 h 30 min")
    with page.expect_request("**/orders") as sent:
        ann.click(ann.button("Find the best order"))
    assert sent.value.post_data_json["requirements"]["budget"] == 5400
    panel.get_by_label("not before").fill("10 min")
    panel.get_by_label("done by").fill("22:00")
    ann.click(panel.get_by_role("button", name="Add").last)
    expect(question.get_by_role("button")).to_have_text(["22 min", "22 h"])
    panel.get_by_label("done by").fill("1h30")
    ann.click(panel.get_by_role("button", name="Add").last)
    expect(panel).to_contain_text("10 min – 1 h 30 min")
