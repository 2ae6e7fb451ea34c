"""Several people at one mission, and a person whose connection is cut."""

from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import ALL, Served
from tests.conftest import examples
from tests.e2e.page.person import Proxy
from tests.e2e.page.test_list import expect_order, open_mission, plan, row, task_names

pytestmark = pytest.mark.long

__all__ = ["plan"]


def test_edits_and_selections_of_others_appear(browsers, address, plan) -> None:
    ann, bob = (open_mission(browsers, address, plan, name) for name in ("Ann", "Bob"))
    expect(ann.page.get_by_role("list", name="Also here")).to_contain_text("Bob")
    bob.click(row(bob, "B2"))
    expect(row(ann, "B2").get_by_label("selected by Bob")).to_be_visible()
    bob.key("Alt+ArrowUp")
    expect_order(ann, "START", "B2", "A1", "C4")
    bob.context.close()
    browsers.people.remove(bob)
    expect(row(ann, "B2").get_by_label("selected by Bob")).to_have_count(0)


def test_edits_of_different_tasks_are_both_applied(browsers, address, plan, service) -> None:
    ann, bob = (open_mission(browsers, address, plan, name) for name in ("Ann", "Bob"))
    for person, name in ((ann, "A1"), (bob, "C4")):
        person.click(row(person, name))
    ann.key("Delete")
    bob.key("Delete")
    for person in (ann, bob):
        expect_order(person, "START", "B2")
    assert task_names(service, plan) == ["START", "B2"]


def test_a_form_is_not_overwritten_by_others(browsers, address, plan, service) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    name = ann.page.get_by_label("Name", exact=True)
    name.fill("Gauge by the stairs")
    edit = {"kind": "change_task", "name": "A1", "retries": 2}
    assert service.command(plan, "*", edit).status_code == 200
    expect(ann.page.get_by_label("Retries")).to_have_value("2")
    expect(name).to_have_value("Gauge by the stairs")
    name.press("Enter")
    expect_order(ann, "START", "Gauge by the stairs", "B2", "C4")


def test_a_stale_edit_is_refused_with_the_change_that_came_first(browsers, plan, service) -> None:
    with Proxy(service.address) as proxy:
        ann = open_mission(browsers, f"http://{proxy.address}/?token={ALL}", plan, "Ann")
        ann.click(row(ann, "A1"))
        proxy.cut()
        expect(ann.save_status).to_contain_text("Offline")
        ann.key("Delete")
        bob = service.as_("Bob")
        edit = {"kind": "change_task", "name": "A1", "retries": 2}
        assert service.command(plan, "*", edit, client=bob).status_code == 200
        proxy.restore()
        log = ann.page.get_by_role("log")
        expect(log).to_contain_text("Bob changed A1")
        expect_order(ann, "START", "A1", "B2", "C4")
        ann.click(ann.button("Apply anyway"))
        expect_order(ann, "START", "B2", "C4")
        ann.clear_connection_problems()


def test_a_mission_is_not_closed_before_all_edits_are_sent(browsers, plan, service) -> None:
    with Proxy(service.address) as proxy:
        ann = open_mission(browsers, f"http://{proxy.address}/?token={ALL}", plan, "Ann")
        ann.click(row(ann, "A1"))
        proxy.cut()
        expect(ann.save_status).to_contain_text("Offline")
        ann.key("Delete")
        ann.click(ann.button("All missions"))
        expect(ann.page.get_by_role("log")).to_contain_text("has not been sent")
        expect(ann.page.get_by_role("tree")).to_be_visible()
        proxy.restore()
        expect_order(ann, "START", "B2", "C4")
        expect(ann.page.get_by_role("log")).not_to_contain_text("has not been sent")
        ann.click(ann.button("All missions"))
        expect(ann.button("New mission")).to_be_visible()
        assert task_names(service, plan) == ["START", "B2", "C4"]
        ann.clear_connection_problems()


def test_the_deletion_of_a_task_in_a_form_is_reported_with_the_typed_text(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    field = ann.page.get_by_label("Speed on the way there")
    field.click()
    ann.type("0.2")
    bob = service.as_("Bob")
    gone = {"kind": "remove_task", "name": "A1"}
    assert service.command(plan, "*", gone, client=bob).status_code == 200
    expect(ann.page.get_by_role("log")).to_contain_text("Bob has deleted or renamed A1")
    expect(ann.page.get_by_role("log")).to_contain_text("0.2")


def test_a_name_that_is_typed_stays_in_its_field_while_others_rename(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    name = ann.page.get_by_label("Name", exact=True)
    name.fill("")
    ann.type("Stairs ")
    rename = {"kind": "rename_task", "name": "A1", "new_name": "Bobs"}
    assert service.command(plan, "*", rename, client=service.as_("Bob")).status_code == 200
    expect(ann.page.get_by_role("alert")).to_contain_text("Bobs")
    expect(row(ann, "Bobs")).to_have_attribute("aria-selected", "true")
    expect(name).to_be_focused()
    ann.type("north")
    ann.key("Enter")
    expect_order(ann, "START", "Stairs north", "B2", "C4")
    expect(name).to_be_focused()
    expect(name).to_have_value("Stairs north")
    assert service.mission(plan)["designation"] != "north"


def test_a_name_that_is_typed_in_the_list_stays_there_while_others_rename(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    ann.key("F2")
    ann.type("gmnow ")
    rename = {"kind": "rename_task", "name": "A1", "new_name": "Bobs"}
    assert service.command(plan, "*", rename, client=service.as_("Bob")).status_code == 200
    details = ann.page.get_by_role("tabpanel", name="Details")
    expect(details.get_by_label("Name", exact=True)).to_have_value("Bobs")
    ann.type("gmnow")
    ann.key("Enter")
    expect_order(ann, "START", "gmnow gmnow", "B2", "C4")


def test_what_is_typed_after_the_deletion_of_the_task_goes_nowhere(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    ann.click(row(ann, "A1"))
    ann.page.get_by_label("Name", exact=True).fill("Stairs ")
    before = service.mission(plan)
    gone = {"kind": "remove_task", "name": "A1"}
    ann.key("n")
    assert service.command(plan, "*", gone, client=service.as_("Bob")).status_code == 200
    expect(ann.page.get_by_role("log")).to_contain_text("Bob has deleted or renamed A1")
    ann.key("o")
    ann.type("orth m")
    ann.key("Enter", "Delete")
    expect_order(ann, "START", "B2", "C4")
    expect(ann.page.get_by_role("log")).to_contain_text("Stairs n")
    now = service.mission(plan)
    assert now["designation"] == before["designation"]
    assert [task["name"] for task in now["tasks"]] == ["START", "B2", "C4"]


def test_the_focus_stays_after_a_rename(browsers, address, plan) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    ann.click(row(ann, "B2"))
    name = ann.page.get_by_label("Name", exact=True)
    name.fill("Stairs")
    name.press("Tab")
    following = ann.focused()
    expect_order(ann, "START", "A1", "Stairs", "C4")
    ann.page.wait_for_timeout(100)
    assert ann.focused() == following == "Checkpoint"
    expect(row(ann, "Stairs")).to_have_attribute("aria-selected", "true")


def test_a_key_after_the_deletion_of_the_mission_creates_nothing(
    browsers, address, plan, service
) -> None:
    ann = open_mission(browsers, address, plan, "Ann")
    before = len(service.client.get("/api/missions").json()["missions"])
    service.as_("Bob").delete(f"/api/missions/{plan}")
    expect(ann.page.get_by_role("log")).to_contain_text("has deleted the mission")
    expect(ann.button("New mission")).to_be_visible()
    ann.key("Enter")
    ann.page.wait_for_timeout(300)
    assert len(service.client.get("/api/missions").json()["missions"]) == before - 1


def test_obstacles_of_others_close_the_ground(ann, address, plan, service) -> None:
    box = {"id": "box", "name": "", "pose": {"x": 8, "y": 1.6, "z": 0, "yaw": 0}, "size": [1, 1, 1]}
    assert service.put_obstacles(box).status_code == 200
    ann.page.goto(f"{address}#/missions/{plan}")
    ann.wait_for_scene()
    ann.key("n")
    ann.wait_until(
        lambda: ann.evaluate("() => window.argo.standing(8, 1.6, 0, 0)") == "closed",
        "the ground is closed there",
    )
    service.put_obstacles().raise_for_status()


def work_offline(browsers: Any, service: Served, plan: str, seconds: float) -> None:
    """Assert that no work is lost while a person's connection is cut for some seconds."""
    with Proxy(service.address) as proxy:
        ann = open_mission(browsers, f"http://{proxy.address}/?token={ALL}", plan, "Ann")
        ann.wait_for_scene()
        ann.evaluate("() => { window.untouched = true }")
        camera = ann.evaluate("() => window.argo.camera()")
        ann.click(row(ann, "B2"))
        name = ann.page.get_by_label("Name", exact=True)
        name.fill("Half a na")
        proxy.cut()
        expect(ann.save_status).to_contain_text("Offline")
        edit = {"kind": "remove_task", "name": "C4"}
        assert service.command(plan, "*", edit).status_code == 200
        ann.page.wait_for_timeout(1000 * seconds)
        ann.click(row(ann, "A1"), modifiers=["Control"])
        ann.click(row(ann, "A1"), modifiers=["Control"])
        expect(name).to_have_value("B2")  # two tasks were selected meanwhile, so the form is new
        name.fill("Half a name")
        proxy.restore()
        expect_order(ann, "START", "A1", "B2")
        expect(ann.save_status).to_have_text("Saved")
        expect(row(ann, "B2")).to_have_attribute("aria-selected", "true")
        expect(name).to_have_value("Half a name")
        assert ann.evaluate("() => window.untouched")
        assert ann.evaluate("() => window.argo.camera()") == camera
        name.press("Enter")
        expect_order(ann, "START", "A1", "Half a name")
        ann.clear_connection_problems()


def test_a_short_time_offline_loses_nothing(browsers, service, plan) -> None:
    work_offline(browsers, service, plan, 3)


def test_a_long_time_offline_loses_nothing(browsers, service, plan) -> None:
    work_offline(browsers, service, plan, examples(60))
