"""The list of tasks and its forms, with mouse and keyboard."""

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
    """Return the id of a mission with a start and three tasks."""
    id = service.create("Round")
    tasks: list[dict[str, Any]] = [{"name": "START", "action": "START", "pose": DOCK}]
    tasks += [{"name": n, "action": "MEASURE", "object_id": n[-1]} for n in ("A1", "B2", "C4")]
    edits = [{"kind": "add_task", "task": task} for task in tasks]
    assert service.command(id, 1, *edits).status_code == 200
    return id


@pytest.fixture
def ann(shared_person, plan) -> Person:
    shared_person.go(f"/missions/{plan}")
    expect_open(shared_person)
    return shared_person


def open_mission(
    browsers: Any, address: str, plan: str, name: str = "ann", **context: Any
) -> Person:
    """Return a person who has opened the mission, in a window of their own."""
    person: Person = browsers.person(address, name, **context)
    person.open(f"/missions/{plan}")
    expect_open(person)
    return person


def expect_open(person: Person) -> None:
    """Wait until the four tasks are shown and can be edited."""
    expect(person.page.get_by_role("treeitem")).to_have_count(4)
    expect(person.button("Add")).to_be_enabled()


def task_names(service: Served, plan: str) -> list[str]:
    return [task["name"] for task in service.mission(plan)["tasks"]]


def row(person: Person, name: str) -> Any:
    """Return the row of the task or group with a name."""
    return person.page.locator(f'argo-list [role=treeitem][data-name="{name}"]')


def expect_order(person: Person, *names: str) -> None:
    """Wait until the list shows the rows of the tasks and groups with these names."""
    rows = person.page.locator("argo-list [role=treeitem]")
    expect(rows).to_have_count(len(names))
    for at, name in enumerate(names):
        expect(rows.nth(at)).to_have_attribute("data-name", name)


@pytest.mark.long
def test_checkpoints_are_added_by_keys_one_after_the_other(ann, service, plan) -> None:
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("End", "m")
    for number in ("14", "2"):
        ann.type(number)
        ann.key("Enter")
    expect_order(ann, "START", "A1", "B2", "C4", "MEASURE 14", "MEASURE 2")
    expect(row(ann, "MEASURE 2")).to_have_attribute("aria-selected", "true")
    ann.key("Escape", "ArrowUp")
    expect(row(ann, "MEASURE 14")).to_have_attribute("aria-selected", "true")
    objects = [task["object_id"] for task in service.mission(plan)["tasks"][-2:]]
    assert objects == ["14", "2"]


def test_tasks_are_moved_by_keys_even_when_they_are_pressed_fast(ann, service, plan) -> None:
    ann.click(row(ann, "C4"))
    ann.key("Alt+ArrowUp", "Alt+ArrowUp")
    expect_order(ann, "START", "C4", "A1", "B2")
    ann.key("Alt+ArrowDown")
    expect_order(ann, "START", "A1", "C4", "B2")
    assert task_names(service, plan) == ["START", "A1", "C4", "B2"]


@pytest.mark.long
def test_a_group_is_created_left_entered_and_moved_as_a_whole(ann, service, plan) -> None:
    ann.click(row(ann, "A1"))
    ann.click(row(ann, "B2"), modifiers=["Shift"])
    ann.key("g")
    expect_order(ann, "START", "Round", "A1", "B2", "C4")
    ann.click(row(ann, "C4"))
    ann.key("Alt+ArrowRight")
    group = expect(row(ann, "Round"))
    group.to_contain_text("3 tasks")
    ann.key("Alt+ArrowLeft")
    group.to_contain_text("2 tasks")
    ann.click(row(ann, "Round"))
    ann.key("Alt+ArrowDown")
    expect_order(ann, "START", "C4", "Round", "A1", "B2")
    groups = service.mission(plan)["groups"]
    assert [(g["name"], g["start"], g["end"]) for g in groups] == [("Round", "A1", "B2")]
    ann.key("ArrowLeft")
    expect_order(ann, "START", "C4", "Round")
    ann.key("ArrowRight")
    expect_order(ann, "START", "C4", "Round", "A1", "B2")


@pytest.mark.long
def test_a_group_with_a_selected_task_can_be_folded(ann) -> None:
    ann.click(row(ann, "B2"))
    ann.key("g", "Escape")
    expect_order(ann, "START", "A1", "Round", "B2", "C4")
    ann.click(row(ann, "B2"))
    ann.click(row(ann, "Round").locator(".fold"))
    expect_order(ann, "START", "A1", "Round", "C4")
    ann.click(row(ann, "Round").locator(".fold"))
    expect_order(ann, "START", "A1", "Round", "B2", "C4")


@pytest.mark.long
def test_several_tasks_are_dragged_at_once_into_a_group(ann, service, plan) -> None:
    ann.click(row(ann, "C4"))
    ann.key("g")
    expect_order(ann, "START", "A1", "B2", "Round", "C4")
    ann.click(row(ann, "A1"))
    ann.click(row(ann, "B2"), modifiers=["Shift"])
    row(ann, "A1").drag_to(row(ann, "C4"), target_position={"x": 80, "y": 40})
    expect_order(ann, "START", "Round", "C4", "A1", "B2")
    (group,) = service.mission(plan)["groups"]
    assert (group["start"], group["end"]) == ("C4", "B2")


@pytest.mark.long
def test_edits_are_undone_and_redone(ann) -> None:
    ann.click(row(ann, "B2"))
    ann.key("Delete")
    expect_order(ann, "START", "A1", "C4")
    ann.key("Control+z")
    expect_order(ann, "START", "A1", "B2", "C4")
    ann.key("Control+y")
    expect_order(ann, "START", "A1", "C4")
    ann.click(ann.button("Undo"))
    expect_order(ann, "START", "A1", "B2", "C4")


@pytest.mark.long
def test_tasks_are_copied_and_pasted(ann) -> None:
    ann.context.grant_permissions(["clipboard-read", "clipboard-write"])
    ann.click(row(ann, "A1"))
    ann.key("Control+c", "End", "Control+v")
    expect_order(ann, "START", "A1", "B2", "C4", "A1 (2)")


@pytest.mark.long
def test_a_group_is_copied_with_its_settings(ann, service, plan) -> None:
    ann.context.grant_permissions(["clipboard-read", "clipboard-write"])
    ann.click(row(ann, "A1"))
    ann.click(row(ann, "B2"), modifiers=["Shift"])
    ann.key("g")
    rounds = ann.page.get_by_label("Rounds")
    rounds.fill("3")
    rounds.press("Enter")
    ann.wait_until(lambda: service.mission(plan)["groups"][0]["max_repeat_count"] == 3, "3 rounds")
    expect(ann.save_status).to_have_text("Saved")
    ann.click(row(ann, "Round"))
    ann.key("Control+c", "Control+v")
    expect_order(ann, "START", "Round", "A1", "B2", "Round (2)", "A1 (2)", "B2 (2)", "C4")
    groups = service.mission(plan)["groups"]
    assert [group["max_repeat_count"] for group in groups] == [3, 3]


@pytest.mark.long
def test_a_task_is_renamed_in_its_row_with_one_edit(ann, service, plan) -> None:
    before = service.client.get(f"/api/missions/{plan}").json()["revision"]
    ann.click(row(ann, "B2"))
    ann.key("F2", "Control+a")
    ann.type("Pump")
    ann.key("Enter")
    expect_order(ann, "START", "A1", "Pump", "C4")
    assert ann.evaluate("() => document.activeElement.tagName") == "ARGO-APP"
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
    expect_order(ann, "START", "A1", "B2", "C4")
    ann.key("Escape")
    expect(ann.page.locator("argo-notices article")).to_have_count(0)
    expect(row(ann, "B2")).to_have_attribute("aria-selected", "true")


@pytest.mark.long
def test_a_place_added_after_other_tasks_is_a_waypoint(ann, service, plan) -> None:
    gone = {"kind": "remove_task", "name": "START"}
    assert service.command(plan, "*", gone).status_code == 200
    expect_order(ann, "A1", "B2", "C4")
    ann.click(row(ann, "C4"))
    ann.key("w")
    ann.type("dock")
    ann.key("Enter")
    expect_order(ann, "A1", "B2", "C4", "DOCK")
    assert service.mission(plan)["tasks"][-1]["action"] == "WAYPOINT"


def test_a_form_reads_durations_as_scripts_do(ann, service, plan) -> None:
    ann.key("Escape")
    field = ann.page.get_by_label("Maximum duration")
    texts = {"1:30 h": 5400, "2:00 h": 7200, "1h30": 5400, "eine halbe Stunde": 1800, "10m": 600}
    for text, seconds in texts.items():
        field.fill(text)
        field.press("Enter")
        expect(field).not_to_have_value(text)
        expect(ann.page.get_by_role("alert")).to_have_count(0)
        assert service.mission(plan)["max_duration"] == seconds


def test_a_form_asks_about_a_duration_with_several_meanings(ann, service, plan) -> None:
    ann.key("Escape")
    field = ann.page.get_by_label("Maximum duration")
    question = ann.page.get_by_role("alert")
    duration = service.mission(plan)["max_duration"]
    for text, answers, chosen, seconds in (
        ("22:00", ["22 min", "22 h"], "22 h", 79200),
        ("10", ["10 s", "10 min", "10 h"], "10 min", 600),
    ):
        field.fill(text)
        field.press("Tab")
        expect(question.get_by_role("button")).to_have_text(answers)
        expect(field).to_have_value(text)
        assert service.mission(plan)["max_duration"] == duration
        question.get_by_role("button", name=chosen).click()
        expect(question).to_have_count(0)
        expect(field).to_have_value(chosen)
        duration = service.mission(plan)["max_duration"]
        assert duration == seconds


def test_a_form_refuses_text_that_is_no_duration(ann, service, plan) -> None:
    ann.key("Escape")
    before = service.mission(plan)["max_duration"]
    field = ann.page.get_by_label("Maximum duration")
    for text in ("1:90", "soon"):
        field.fill(text)
        field.press("Enter")
        expect(ann.page.get_by_role("alert")).to_contain_text("10 min or 1:30 h")
        expect(field).to_have_value(text)
    assert service.mission(plan)["max_duration"] == before


@pytest.mark.long
def test_all_checkpoints_of_a_floor_are_added_at_once(ann, service, plan) -> None:
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("End", "m")
    ann.type("floor 2")
    ann.key("Enter", "Escape")
    on_floor = [
        one for one in service.client.get("/api/world").json()["checkpoints"] if one["floor"] == 2
    ]
    assert len(on_floor) > 1
    expect(ann.page.get_by_role("treeitem")).to_have_count(4 + len(on_floor))
    measured = [task["object_id"] for task in service.mission(plan)["tasks"][4:]]
    assert sorted(measured, key=int) == [str(one["id"]) for one in on_floor]
    speed = ann.page.get_by_label("Speed on the way there")
    speed.fill("0.2")
    speed.press("Enter")
    ann.wait_until(
        lambda: (
            [task["velocity"] for task in service.mission(plan)["tasks"][4:]]
            == [0.2] * len(on_floor)
        ),
        "all of them have the speed",
    )


@pytest.mark.long
def test_the_list_is_filtered(ann, service, plan) -> None:
    many = [{"name": f"T{n}", "action": "MEASURE", "object_id": "1"} for n in range(40)]
    edits = [{"kind": "add_task", "task": task} for task in many]
    assert service.command(plan, "*", *edits).status_code == 200
    expect(ann.page.get_by_role("treeitem").nth(20)).to_be_attached()
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("/")
    ann.type("#1 t3")
    expect_order(ann, "T3", *(f"T{n}" for n in range(30, 40)))
    expect(ann.page.locator("argo-list .filter [role=status]")).to_have_text("11 of 44")
    ann.key("ArrowDown", "ArrowDown")
    expect(row(ann, "T30")).to_have_attribute("aria-selected", "true")
    ann.click(ann.button("Show all tasks"))
    expect(row(ann, "B2")).to_have_count(1)


ROUND = """Mission Protocol

1. Set the starting point in starting area 1.
2. Check checkpoint #4.
3. Check checkpoint #1. If checkpoint #1 is above 7, go to step 8.
4. Patrol floor 1 for 2 minutes.
5. Check checkpoint #8.
6. Check checkpoint #13.
7. Repeat steps 5 to 6 3 times.
8. Check checkpoint #14.
"""


@pytest.mark.long
def test_a_task_has_the_same_number_everywhere(shared_person, service) -> None:
    ann = shared_person
    id = service.imported(ROUND, filename="round.txt")
    ann.go(f"/missions/{id}")
    listed = ann.page.locator("argo-list [role=treeitem] .number")
    expect(listed).to_have_text(
        ["1", "2", "3", "4", "4.1", "4.2", "4.3", "4.4", "7", "5", "6", "8"]
    )
    expect(row(ann, "MEASURE 1")).to_contain_text("pressure gauge 1 (#1)")
    expect(row(ann, "MEASURE 1")).to_contain_text("floor 1 · > 7 bar → 8")
    expect(ann.page.locator("argo-list svg.branches g")).to_have_count(1)
    ann.page.locator("argo-strip summary").click()
    expect(ann.page.locator("argo-strip td:first-child")).to_contain_text(
        ["2 valve R25 (#4)", "3 pressure gauge 1 (#1)", "4.1", "8 valve R18 (#14)"]
    )
    ann.wait_for_scene()
    shown = ann.page.locator('argo-scene .label[data-key="checkpoint:14"] .numbers')
    expect(shown).to_have_text("8")
    ann.click(ann.page.locator("#tab-script"))
    expect(ann.page.locator("argo-script-sheet textarea")).to_have_value(
        re.compile(r"^8\. Check checkpoint #14", re.MULTILINE)
    )
    ann.click(ann.page.locator("#tab-properties"))


@pytest.mark.long
def test_a_condition_is_added_in_the_form(ann, service, plan) -> None:
    ann.click(row(ann, "A1"))
    ann.click(ann.button("Add a conditional transition"))
    ann.page.get_by_label("is", exact=True).select_option("MEASURED_VALUE_LESS")
    bound = ann.page.get_by_label("Value", exact=True)
    bound.fill("2,5")
    bound.press("Enter")
    then = ann.page.get_by_label("Continue with", exact=True).first
    then.select_option("C4")
    expect(row(ann, "A1")).to_contain_text("< 2.5 bar → 4")

    def transition():
        return service.mission(plan)["tasks"][1]["transitions"][0]

    ann.wait_until(lambda: transition()["target"] == "C4", "the transition leads to C4")
    assert (transition()["conditions"][0]["type"], transition()["conditions"][0]["param1"]) == (
        "MEASURED_VALUE_LESS",
        2.5,
    )


def test_a_refused_value_has_its_message_at_the_field(ann, service, plan) -> None:
    ann.click(row(ann, "A1"))
    name = ann.page.get_by_label("Name", exact=True)
    name.fill("B2")
    name.press("Enter")
    expect(ann.page.get_by_role("alert")).to_contain_text("B2")
    expect(name).to_have_value("B2")
    assert task_names(service, plan) == ["START", "A1", "B2", "C4"]


def test_a_problem_is_shown_with_its_remedy(ann, service, plan) -> None:
    transition = {
        "kind": "add_transition",
        "task": "A1",
        "at": 0,
        "transition": {
            "target": "C4",
            "conditions": [{"type": "MEASURED_VALUE_LESS", "object_id": "20", "param1": 1}],
        },
    }
    assert service.command(plan, "*", transition).status_code == 200
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
    id = service.create("Long", {"version": 4, "site": "umad", "tasks": many})
    ann = browsers.person(address)
    ann.open(f"/missions/{id}")
    expect(row(ann, "T0")).to_be_visible()
    assert ann.page.get_by_role("treeitem").count() < 100
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("End")
    expect(row(ann, "T1999")).to_be_visible()
    ann.key("Delete")
    expect(row(ann, "T1998")).to_have_attribute("aria-selected", "true")
