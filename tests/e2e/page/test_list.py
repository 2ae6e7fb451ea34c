"""The list of tasks and its forms, by mouse and by keys."""

import re
from itertools import pairwise
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import Served
from tests.e2e.page.person import Person

DOCK = {"x": 3.05, "y": -2.55, "z": -0.03, "yaw": 3.141592653589793}


@pytest.fixture
def plan(service: Served) -> str:
    """A mission with a start and three tasks."""
    id = service.create("Round")
    tasks: list[dict[str, Any]] = [{"name": "START", "action": "START", "pose": DOCK}]
    tasks += [{"name": n, "action": "MEASURE", "object_id": n[-1]} for n in ("A1", "B2", "C4")]
    edits = [{"kind": "add_task", "task": task} for task in tasks]
    assert service.command(id, 1, *edits).status_code == 200
    return id


@pytest.fixture
def ann(resident, plan) -> Person:
    resident.go(f"/missions/{plan}")
    expect_open(resident)
    return resident


def at(browsers: Any, address: str, plan: str, name: str = "ann", **context: Any) -> Person:
    """Open the mission of the plan for somebody, in a window of their own."""
    found: Person = browsers.person(address, name, **context)
    found.open(f"/missions/{plan}")
    expect_open(found)
    return found


def expect_open(person: Person) -> None:
    """Wait until the four tasks are there and can be edited."""
    expect(person.page.get_by_role("treeitem")).to_have_count(4)
    expect(person.button("Add")).to_be_enabled()


def tasks(service: Served, plan: str) -> list[str]:
    return [task["name"] for task in service.mission(plan)["tasks"]]


def row(person: Person, name: str) -> Any:
    return person.page.get_by_role("treeitem").filter(has_text=re.compile(rf"^\s*{name}"))


def order(person: Person, *names: str) -> None:
    """Waits until the list shows these rows."""
    expect(person.page.locator("argo-list [role=treeitem] .names > :first-child")).to_have_text(
        list(names)
    )


@pytest.mark.long
def test_checkpoints_are_added_by_keys_one_after_the_other(ann, service, plan) -> None:
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("End", "m")
    for number in ("14", "2"):
        ann.type(number)
        ann.key("Enter")
    order(ann, "START", "A1", "B2", "C4", "MEASURE 14", "MEASURE 2")
    expect(row(ann, "MEASURE 2")).to_have_attribute("aria-selected", "true")
    ann.key("Escape", "ArrowUp")
    expect(row(ann, "MEASURE 14")).to_have_attribute("aria-selected", "true")
    objects = [task["object_id"] for task in service.mission(plan)["tasks"][-2:]]
    assert objects == ["14", "2"]


def test_tasks_are_moved_by_keys_even_when_they_are_pressed_fast(ann, service, plan) -> None:
    ann.click(row(ann, "C4"))
    ann.key("Alt+ArrowUp", "Alt+ArrowUp")
    order(ann, "START", "C4", "A1", "B2")
    ann.key("Alt+ArrowDown")
    order(ann, "START", "A1", "C4", "B2")
    assert tasks(service, plan) == ["START", "A1", "C4", "B2"]


@pytest.mark.long
def test_a_group_is_made_left_entered_and_moved_as_a_whole(ann, service, plan) -> None:
    ann.click(row(ann, "A1"))
    ann.click(row(ann, "B2"), modifiers=["Shift"])
    ann.key("g")
    order(ann, "START", "Round", "A1", "B2", "C4")
    ann.click(row(ann, "C4"))
    ann.key("Alt+ArrowRight")
    group = expect(row(ann, "Round"))
    group.to_contain_text("3 tasks")
    ann.key("Alt+ArrowLeft")
    group.to_contain_text("2 tasks")
    ann.click(row(ann, "Round"))
    ann.key("Alt+ArrowDown")
    order(ann, "START", "C4", "Round", "A1", "B2")
    found = service.mission(plan)["groups"]
    assert [(g["name"], g["start"], g["end"]) for g in found] == [("Round", "A1", "B2")]
    ann.key("ArrowLeft")
    order(ann, "START", "C4", "Round")
    ann.key("ArrowRight")
    order(ann, "START", "C4", "Round", "A1", "B2")


@pytest.mark.long
def test_a_group_folds_though_a_task_in_it_is_selected(ann) -> None:
    ann.click(row(ann, "B2"))
    ann.key("g", "Escape")
    order(ann, "START", "A1", "Round", "B2", "C4")
    ann.click(row(ann, "B2"))
    ann.click(row(ann, "Round").locator(".fold"))
    order(ann, "START", "A1", "Round", "C4")
    ann.click(row(ann, "Round").locator(".fold"))
    order(ann, "START", "A1", "Round", "B2", "C4")


@pytest.mark.long
def test_several_tasks_are_dragged_at_once_into_a_group(ann, service, plan) -> None:
    ann.click(row(ann, "C4"))
    ann.key("g")
    order(ann, "START", "A1", "B2", "Round", "C4")
    ann.click(row(ann, "A1"))
    ann.click(row(ann, "B2"), modifiers=["Shift"])
    row(ann, "A1").drag_to(row(ann, "C4"), target_position={"x": 80, "y": 40})
    order(ann, "START", "Round", "C4", "A1", "B2")
    (group,) = service.mission(plan)["groups"]
    assert (group["start"], group["end"]) == ("C4", "B2")


@pytest.mark.long
def test_what_was_done_is_undone_and_done_again(ann) -> None:
    ann.click(row(ann, "B2"))
    ann.key("Delete")
    order(ann, "START", "A1", "C4")
    ann.key("Control+z")
    order(ann, "START", "A1", "B2", "C4")
    ann.key("Control+y")
    order(ann, "START", "A1", "C4")
    ann.click(ann.button("Undo"))
    order(ann, "START", "A1", "B2", "C4")


@pytest.mark.long
def test_tasks_are_copied_and_pasted(ann) -> None:
    ann.context.grant_permissions(["clipboard-read", "clipboard-write"])
    ann.click(row(ann, "A1"))
    ann.key("Control+c", "End", "Control+v")
    order(ann, "START", "A1", "B2", "C4", "A1 (2)")


@pytest.mark.long
def test_a_group_is_copied_with_what_it_says(ann, service, plan) -> None:
    ann.context.grant_permissions(["clipboard-read", "clipboard-write"])
    ann.click(row(ann, "A1"))
    ann.click(row(ann, "B2"), modifiers=["Shift"])
    ann.key("g")
    rounds = ann.page.get_by_label("Rounds")
    rounds.fill("3")
    rounds.press("Enter")
    ann.until(lambda: service.mission(plan)["groups"][0]["max_repeat_count"] == 3, "3 rounds")
    expect(ann.saved).to_have_text("Saved")
    ann.click(row(ann, "Round"))
    ann.key("Control+c", "Control+v")
    order(ann, "START", "Round", "A1", "B2", "Round (2)", "A1 (2)", "B2 (2)", "C4")
    groups = service.mission(plan)["groups"]
    assert [group["max_repeat_count"] for group in groups] == [3, 3]


@pytest.mark.long
def test_a_task_is_renamed_in_its_place_once(ann, service, plan) -> None:
    before = service.client.get(f"/api/missions/{plan}").json()["revision"]
    ann.click(row(ann, "B2"))
    ann.key("F2", "Control+a")
    ann.type("Pump")
    ann.key("Enter")
    order(ann, "START", "A1", "Pump", "C4")
    assert ann.ask("() => document.activeElement.tagName") == "ARGO-APP"
    assert service.client.get(f"/api/missions/{plan}").json()["revision"] == before + 1
    expect(ann.page.locator("argo-notices article")).to_have_count(0)
    ann.key("ArrowDown")
    expect(row(ann, "C4")).to_have_attribute("aria-selected", "true")


@pytest.mark.long
def test_a_name_that_is_refused_stays_in_the_field(ann) -> None:
    ann.click(row(ann, "B2"))
    ann.key("F2", "Control+a")
    ann.type("C4")
    ann.key("Enter")
    expect(ann.page.locator("argo-notices article")).to_contain_text("C4")
    field = ann.page.locator("argo-list input")
    expect(field).to_have_value("C4")
    expect(field).to_be_focused()
    ann.key("Escape")
    order(ann, "START", "A1", "B2", "C4")
    ann.key("Escape")
    expect(ann.page.locator("argo-notices article")).to_have_count(0)
    expect(row(ann, "B2")).to_have_attribute("aria-selected", "true")


@pytest.mark.long
def test_a_place_is_a_waypoint_where_something_is_planned(ann, service, plan) -> None:
    gone = {"kind": "remove_task", "name": "START"}
    assert service.command(plan, "*", gone).status_code == 200
    order(ann, "A1", "B2", "C4")
    ann.click(row(ann, "C4"))
    ann.key("w")
    ann.type("dock")
    ann.key("Enter")
    order(ann, "A1", "B2", "C4", "DOCK")
    assert service.mission(plan)["tasks"][-1]["action"] == "WAYPOINT"


def test_a_form_takes_times_as_people_write_them(ann, service, plan) -> None:
    ann.key("Escape")
    field = ann.page.get_by_label("Maximum duration")
    field.fill("soon")
    field.press("Enter")
    expect(ann.page.get_by_role("alert")).to_contain_text("1:30 or 10 min")
    expect(field).to_have_value("soon")
    field.fill("12 min 30")
    field.press("Enter")
    expect(ann.page.get_by_role("alert")).to_have_count(0)
    expect(field).to_have_value("12 min 30 s")
    assert service.mission(plan)["max_duration"] == 750


@pytest.mark.long
def test_a_condition_is_made_in_the_form(ann, service, plan) -> None:
    ann.click(row(ann, "A1"))
    ann.click(ann.button("Add a conditional transition"))
    ann.page.get_by_label("is", exact=True).select_option("MEASURED_VALUE_LESS")
    bound = ann.page.get_by_label("Value", exact=True)
    bound.fill("2,5")
    bound.press("Enter")
    then = ann.page.get_by_label("Continue with", exact=True).first
    then.select_option("C4")
    expect(row(ann, "A1")).to_contain_text("is below 2.5")

    def way():
        return service.mission(plan)["tasks"][1]["transitions"][0]

    ann.until(lambda: way()["target"] == "C4", "it goes on with C4")
    assert (way()["conditions"][0]["type"], way()["conditions"][0]["param1"]) == (
        "MEASURED_VALUE_LESS",
        2.5,
    )


def test_what_is_refused_is_said_at_the_field(ann, service, plan) -> None:
    ann.click(row(ann, "A1"))
    name = ann.page.get_by_label("Name", exact=True)
    name.fill("B2")
    name.press("Enter")
    expect(ann.page.get_by_role("alert")).to_contain_text("B2")
    expect(name).to_have_value("B2")
    assert tasks(service, plan) == ["START", "A1", "B2", "C4"]


def test_a_problem_leads_to_its_task_and_has_its_way_out(ann, service, plan) -> None:
    way = {
        "kind": "add_transition",
        "task": "A1",
        "at": 0,
        "transition": {
            "target": "C4",
            "conditions": [{"type": "MEASURED_VALUE_LESS", "object_id": "20", "param1": 1}],
        },
    }
    assert service.command(plan, "*", way).status_code == 200
    summary = ann.page.locator("argo-problems summary")
    expect(summary).to_contain_text("problem")
    ann.click(summary)
    ann.click(ann.button("Measure 20 first"))
    expect(row(ann, "MEASURE 20")).to_have_count(1)
    expect(ann.button("Measure 20 first")).to_have_count(0)


@pytest.mark.long
def test_two_thousand_tasks_open_and_scroll(browsers, address, service) -> None:
    many = [{"name": f"T{n}", "action": "MEASURE", "object_id": "1"} for n in range(2000)]
    for task, after in pairwise(many):
        task["transitions"] = [{"target": after["name"]}]
    id = service.create("Long", {"version": 3, "site": "umad", "tasks": many})
    ann = browsers.person(address)
    ann.open(f"/missions/{id}")
    expect(row(ann, "T0")).to_be_visible()
    assert ann.page.get_by_role("treeitem").count() < 100
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("End")
    expect(row(ann, "T1999")).to_be_visible()
    ann.key("Delete")
    expect(row(ann, "T1998")).to_have_attribute("aria-selected", "true")
