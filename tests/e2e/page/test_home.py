"""The list of missions: examples, search, folders, templates, and runs."""

import re

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import SECRETS, wait_or_fail
from tests.e2e.page.person import Person

pytestmark = pytest.mark.long

ROUND = "Start in starting area 1.\nCheck checkpoint #8.\nCheck valve R18.\n"


def names(person: Person) -> list[str]:
    """Return the names of the listed missions, in order."""
    return person.page.locator("argo-missions tbody td:first-child > a").all_inner_texts()


def test_an_example_is_opened_as_a_copy_at_the_first_start(ann) -> None:
    """This test must come first: it needs a service without missions."""
    expect(ann.page.get_by_role("img", name="6 floors, 20 checkpoints")).to_be_visible()
    example = ann.page.get_by_role("button", name=re.compile("Conditions and rounds"))
    ann.focus(example)
    ann.key("Enter")
    expect(ann.page.get_by_role("treeitem")).to_have_count(6)
    ann.click(ann.button("All missions"))
    expect(ann.page.get_by_role("link", name="Conditions and rounds")).to_have_count(1)
    expect(ann.page.locator("argo-examples details")).to_have_count(1)


def test_missions_are_found_moved_to_folders_and_copied_by_keyboard(ann, service) -> None:
    service.imported(ROUND, filename="Night *round* ☀.txt")
    other = service.create("Evening")
    service.client.put(f"/api/missions/{other}/folder", json={"folder": "Weekly"})
    ann.page.reload()
    ann.focus(ann.page.get_by_label("Search for a mission"))
    ann.type("#8 *")
    expect(ann.page.locator("argo-missions tbody tr")).to_have_count(1)
    assert names(ann) == ["Night *round* ☀"]
    ann.focus(ann.button("Move Night *round* ☀ to a folder"))
    ann.key("Enter")
    expect(ann.page.get_by_role("dialog")).to_be_visible()
    ann.type("Daily")
    ann.key("Enter")
    expect(ann.page.get_by_role("log")).to_contain_text("is in the folder Daily")
    expect(ann.button("Daily 1")).to_be_visible()
    ann.page.get_by_label("Search for a mission").fill("")
    ann.focus(ann.button("Weekly 1"))
    ann.key("Enter")
    expect(ann.page.locator("argo-missions tbody tr")).to_have_count(1)
    assert names(ann) == ["Evening"]
    ann.focus(ann.button("Use Evening as a template"))
    ann.key("Enter")
    expect(ann.page.get_by_title("Rename the mission")).to_have_text("Evening (copy)")
    missions = service.client.get("/api/missions").json()["missions"]
    assert {one["name"]: one["folder"] for one in missions}["Evening (copy)"] == "Weekly"


def test_a_mission_that_somebody_else_has_moved_is_moved_only_on_request(ann, service) -> None:
    id = service.create("Shared")
    ann.page.reload()
    expect(ann.page.get_by_role("link", name="Shared")).to_be_visible()
    ann.click(ann.button("Move Shared to a folder"))
    bob = service.as_("bob")
    assert bob.put(f"/api/missions/{id}/folder", json={"folder": "Bob"}).status_code == 200
    ann.type("Ann")
    ann.key("Enter")
    expect(ann.page.get_by_role("log")).to_contain_text("Somebody else has moved Shared")
    expect(ann.page.locator("tr", has_text="Shared")).to_contain_text("Bob")
    ann.click(ann.button("Apply anyway"))
    expect(ann.page.locator("tr", has_text="Shared")).to_contain_text("Ann")


def test_a_run_opens_its_mission_at_that_run(ann, service) -> None:
    id = service.imported(ROUND, filename="driven.txt")
    runs = []
    for seed in (1, 2):
        run = service.run(id, drive="route", seed=seed, speed=None).json()["id"]
        runs.append(run)
        wait_or_fail(
            lambda run=run: service.client.get(f"/api/runs/{run}").json()["status"] == "ended"
        )
    row = ann.page.locator("argo-missions tr", has_text="driven")
    expect(row).to_contain_text("Success")
    links = ann.page.locator("argo-latest-runs").get_by_role("link", name="driven")
    expect(links).to_have_count(2)
    ann.click(links.last)
    expect(ann.page.locator("#tab-run")).to_have_attribute("aria-selected", "true")
    expect(ann.page.locator("argo-run")).to_contain_text("Success")
    assert ann.page.url.endswith(f"/missions/{id}")


def test_viewers_see_all_and_change_nothing(browsers, service) -> None:
    service.create("For looking")
    viewer = browsers.person(f"http://{service.address}/?token={SECRETS['view']}")
    viewer.open()
    expect(viewer.page.get_by_role("link", name="For looking")).to_be_visible()
    for button in ("New mission", "Move For looking to a folder", "Use For looking as a template"):
        expect(viewer.button(button)).to_be_disabled()


def test_a_long_list_is_shown_in_parts(ann, service) -> None:
    for number in range(60):
        service.create(f"Many {number}")
    ann.page.reload()
    expect(ann.page.locator("argo-missions tbody tr")).to_have_count(50)
    ann.page.get_by_label("Search for a mission").fill("many 5")
    expect(ann.page.locator("argo-missions tbody tr")).to_have_count(15)
    ann.page.get_by_label("Search for a mission").fill("")
    ann.click(ann.page.locator("#more"))
    wait_or_fail(lambda: len(names(ann)) > 60)
