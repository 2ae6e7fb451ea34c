"""Several people at one mission, and a person whose line is cut."""

from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import ALL, Served
from tests.conftest import examples
from tests.e2e.page.person import Line
from tests.e2e.page.test_list import at, order, plan, row, tasks

pytestmark = pytest.mark.long

__all__ = ["plan"]


def test_edits_and_selections_of_others_appear(browsers, address, plan) -> None:
    ann, bob = (at(browsers, address, plan, name) for name in ("Ann", "Bob"))
    expect(ann.page.get_by_role("list", name="Also here")).to_contain_text("Bob")
    bob.click(row(bob, "B2"))
    expect(row(ann, "B2").get_by_label("selected by Bob")).to_be_visible()
    bob.key("Alt+ArrowUp")
    order(ann, "START", "B2", "A1", "C4")
    bob.context.close()
    browsers.people.remove(bob)
    expect(row(ann, "B2").get_by_label("selected by Bob")).to_have_count(0)


def test_edits_of_different_tasks_go_through_both(browsers, address, plan, service) -> None:
    ann, bob = (at(browsers, address, plan, name) for name in ("Ann", "Bob"))
    for person, name in ((ann, "A1"), (bob, "C4")):
        person.click(row(person, name))
    ann.key("Delete")
    bob.key("Delete")
    for person in (ann, bob):
        order(person, "START", "B2")
    assert tasks(service, plan) == ["START", "B2"]


def test_a_form_is_not_overwritten_by_others(browsers, address, plan, service) -> None:
    ann = at(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    name = ann.page.get_by_label("Name", exact=True)
    name.fill("Gauge by the stairs")
    edit = {"kind": "change_task", "name": "A1", "retries": 2}
    assert service.command(plan, "*", edit).status_code == 200
    expect(ann.page.get_by_label("Retries")).to_have_value("2")
    expect(name).to_have_value("Gauge by the stairs")
    name.press("Enter")
    order(ann, "START", "Gauge by the stairs", "B2", "C4")


def test_a_stale_edit_says_what_was_changed(browsers, plan, service) -> None:
    with Line(service.address) as line:
        ann = at(browsers, f"http://{line.address}/?token={ALL}", plan, "Ann")
        ann.click(row(ann, "A1"))
        line.cut()
        expect(ann.saved).to_contain_text("Offline")
        ann.key("Delete")
        bob = service.as_("Bob")
        edit = {"kind": "change_task", "name": "A1", "retries": 2}
        assert service.command(plan, "*", edit, client=bob).status_code == 200
        line.mend()
        log = ann.page.get_by_role("log")
        expect(log).to_contain_text("Bob changed A1")
        order(ann, "START", "A1", "B2", "C4")
        ann.click(ann.button("Apply anyway"))
        order(ann, "START", "B2", "C4")
        ann.complaints[:] = [said for said in ann.complaints if "WebSocket connection" not in said]


def test_a_mission_is_not_left_before_all_is_sent(browsers, plan, service) -> None:
    with Line(service.address) as line:
        ann = at(browsers, f"http://{line.address}/?token={ALL}", plan, "Ann")
        ann.click(row(ann, "A1"))
        line.cut()
        expect(ann.saved).to_contain_text("Offline")
        ann.key("Delete")
        ann.click(ann.button("All missions"))
        expect(ann.page.get_by_role("log")).to_contain_text("has not been sent")
        expect(ann.page.get_by_role("tree")).to_be_visible()
        line.mend()
        order(ann, "START", "B2", "C4")
        expect(ann.page.get_by_role("log")).not_to_contain_text("has not been sent")
        ann.click(ann.button("All missions"))
        expect(ann.button("New mission")).to_be_visible()
        assert tasks(service, plan) == ["START", "B2", "C4"]
        ann.complaints[:] = [said for said in ann.complaints if "WebSocket connection" not in said]


def test_who_deletes_what_one_works_on_is_told_with_what_was_typed(
    browsers, address, plan, service
) -> None:
    ann = at(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    field = ann.page.get_by_label("Speed on the way there")
    field.click()
    ann.type("0.2")
    bob = service.as_("Bob")
    gone = {"kind": "remove_task", "name": "A1"}
    assert service.command(plan, "*", gone, client=bob).status_code == 200
    expect(ann.page.get_by_role("log")).to_contain_text("Bob has deleted or renamed A1")
    expect(ann.page.get_by_role("log")).to_contain_text("0.2")


def test_a_mission_that_is_deleted_leaves_nothing_under_the_next_key(
    browsers, address, plan, service
) -> None:
    ann = at(browsers, address, plan, "Ann")
    before = len(service.client.get("/api/missions").json()["missions"])
    service.as_("Bob").delete(f"/api/missions/{plan}")
    expect(ann.page.get_by_role("log")).to_contain_text("has deleted the mission")
    expect(ann.button("New mission")).to_be_visible()
    ann.key("Enter")
    ann.page.wait_for_timeout(300)
    assert len(service.client.get("/api/missions").json()["missions"]) == before - 1


def test_obstacles_that_were_put_up_meanwhile_are_heard_of(ann, address, plan, service) -> None:
    box = {"id": "box", "name": "", "pose": {"x": 8, "y": 1.6, "z": 0, "yaw": 0}, "size": [1, 1, 1]}
    assert service.put_obstacles(box).status_code == 200
    ann.page.goto(f"{address}#/missions/{plan}")
    ann.idle()
    ann.key("n")
    ann.until(
        lambda: ann.ask("() => window.argo.standing(8, 1.6, 0, 0)") == "closed",
        "the ground is closed there",
    )
    service.put_obstacles().raise_for_status()


def away(browsers: Any, service: Served, plan: str, seconds: float) -> None:
    """Somebody works on while their line is cut for a time, and nothing of theirs is lost."""
    with Line(service.address) as line:
        ann = at(browsers, f"http://{line.address}/?token={ALL}", plan, "Ann")
        ann.idle()
        ann.ask("() => { window.untouched = true }")
        camera = ann.ask("() => window.argo.camera()")
        ann.click(row(ann, "B2"))
        name = ann.page.get_by_label("Name", exact=True)
        name.fill("Half a na")
        line.cut()
        expect(ann.saved).to_contain_text("Offline")
        edit = {"kind": "remove_task", "name": "C4"}
        assert service.command(plan, "*", edit).status_code == 200
        ann.page.wait_for_timeout(1000 * seconds)
        ann.click(row(ann, "A1"), modifiers=["Control"])
        ann.click(row(ann, "A1"), modifiers=["Control"])
        expect(name).to_have_value("B2")  # two were selected meanwhile: the form is a new one
        name.fill("Half a name")
        line.mend()
        order(ann, "START", "A1", "B2")
        expect(ann.saved).to_have_text("Saved")
        expect(row(ann, "B2")).to_have_attribute("aria-selected", "true")
        expect(name).to_have_value("Half a name")
        assert ann.ask("() => window.untouched")
        assert ann.ask("() => window.argo.camera()") == camera
        name.press("Enter")
        order(ann, "START", "A1", "Half a name")
        # The browser says so itself while there is no line.
        ann.complaints[:] = [said for said in ann.complaints if "WebSocket connection" not in said]


def test_a_short_time_offline_loses_nothing(browsers, service, plan) -> None:
    away(browsers, service, plan, 3)


def test_a_long_time_offline_loses_nothing(browsers, service, plan) -> None:
    away(browsers, service, plan, examples(60))
