"""Protocol #2 of the thesis' study (section 5.1), planned and run by a person with few inputs."""

import re
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import Served
from tests.e2e.page.person import Person
from tests.e2e.page.test_list import expect_order, row

MAX_INPUTS = 40
"""allowed inputs; each undo, redo or reorder adds one"""
FRONT = (8.05, -2.05, -0.03)
CORNERS = ((2, 2), (15, 1), (15, 11), (4, 10))
PLANNED = ("START", "Round", *(f"WAYPOINT {n}" for n in range(1, 5)), "MEASURE 2", "MEASURE 14")


def expect_planned(ann: Person, service: Served, start: Any, corners: Any) -> str:
    """Assert that the mission is the protocol's, also after a reload; return its id.

    The start and the four corners, which are waypoints, are given as x and y (m).
    """
    expect_order(ann, *PLANNED)
    expect(ann.save_status).to_have_text("Saved")
    ann.page.reload()
    expect_order(ann, *PLANNED)
    id = ann.page.url.rpartition("/")[2]
    mission = service.mission(id)
    (group,) = mission["groups"]
    assert (group["start"], group["end"]) == ("WAYPOINT 1", "WAYPOINT 4")
    assert (group["max_repeat_count"], group["max_repeat_duration"]) == (0, 600)
    poses = {task["name"]: task["pose"] for task in mission["tasks"]}
    for name, (x, y) in zip(("START", *PLANNED[2:6]), (start, *corners), strict=True):
        assert abs(poses[name]["x"] - x) < 0.6
        assert abs(poses[name]["y"] - y) < 0.6
    return id


def expect_success(ann: Person, service: Served, id: str) -> None:
    """Let the run go as fast as possible, and assert that it succeeds."""
    ann.page.locator("#speed").select_option("null")

    def run() -> Any:
        return next(r for r in service.client.get("/api/runs").json()["runs"] if r["plan"] == id)

    ann.wait_until(lambda: run()["status"] == "ended", "the run ends")
    ended = run()
    assert ended["headline"] is not None
    done = {task["task"]: task["done"] for task in ended["tasks"]}
    assert done["MEASURE 2"] == done["MEASURE 14"] == 1
    expect(ann.page.locator("argo-run")).to_contain_text(re.compile("success", re.IGNORECASE))


def run_with_handover(press: Any) -> None:
    """Start the run, take over and give back; `press` presses the button with a label."""
    press("Start the run")
    press("Take over")
    press("Give back")


@pytest.mark.long
def test_by_mouse(ann, service, capsys) -> None:
    ann.click(ann.button("New mission"))
    ann.wait_for_scene()
    ann.click(ann.page.locator("argo-scene").get_by_role("radio", name=re.compile("Floor 1")))
    ann.wait_for_scene()
    ann.key("n")
    ann.click(ann.project(*FRONT))
    expect_order(ann, "START")
    for number, (x, y) in enumerate(CORNERS, start=1):
        ann.wait_for_scene()
        ann.click(ann.project(x, y, 0.0))
        expect(row(ann, f"WAYPOINT {number}")).to_have_count(1)
    ann.click(row(ann, "WAYPOINT 1"))
    ann.click(row(ann, "WAYPOINT 4"), modifiers=["Shift"])
    ann.key("g")
    expect(ann.page.get_by_label("For at most")).to_be_focused()
    ann.type("10m")
    ann.key("Enter", "Escape")
    ann.key("m")
    for number in ("14", "2"):
        ann.type(number)
        ann.key("Enter")
        expect(row(ann, f"MEASURE {number}")).to_have_attribute("aria-selected", "true")
    ann.key("Escape")
    ann.key("Delete")
    expect(row(ann, "MEASURE 2")).to_have_count(0)
    ann.click(row(ann, "Round"))
    ann.key("m")
    ann.type("2")
    ann.key("Enter")
    id = expect_planned(ann, service, FRONT[:2], CORNERS)
    ann.click(ann.page.get_by_role("tab", name="Run"))

    def press(name: str) -> None:
        button = ann.page.locator("argo-run").get_by_role("button", name=name, exact=True)
        expect(button).to_be_enabled()
        ann.click(button)

    run_with_handover(press)
    with capsys.disabled():
        print(f"\nprotocol #2 by mouse, run included: {ann.inputs} inputs")
    assert ann.inputs <= MAX_INPUTS
    expect_success(ann, service, id)


@pytest.mark.long
def test_by_keys_alone(ann, service, capsys) -> None:
    expect(ann.button("New mission")).to_be_focused()
    ann.key("Enter")
    expect(ann.button("Add")).to_be_enabled()
    ann.key("w")
    for place in ("f", "c", "c", "c", "c"):  # the front of the site, and the next free corner
        ann.type(place)
        ann.key("Enter")
    expect_order(ann, "START", *PLANNED[2:6])
    expect(row(ann, "WAYPOINT 4")).to_have_attribute("aria-selected", "true")
    ann.key("Escape", "Shift+ArrowUp", "Shift+ArrowUp", "Shift+ArrowUp", "g")
    expect(ann.page.get_by_label("For at most")).to_be_focused()
    ann.type("10m")
    ann.key("Enter", "Escape", "m")
    for number in ("14", "2"):
        ann.type(number)
        ann.key("Enter")
    expect_order(ann, *PLANNED[:6], "MEASURE 14", "MEASURE 2")
    expect(row(ann, "MEASURE 2")).to_have_attribute("aria-selected", "true")
    ann.key("Escape", "Delete")
    expect(row(ann, "MEASURE 2")).to_have_count(0)
    ann.key("m")
    ann.type("2")
    ann.key("Enter")
    expect(row(ann, "MEASURE 2")).to_have_attribute("aria-selected", "true")
    ann.key("Escape", "Alt+ArrowUp")
    world = service.client.get("/api/world").json()
    front = next(p["pose"] for p in world["places"] if p["name"].startswith("front"))
    corners = [(c["x"], c["y"]) for c in world["floors"][0]["corners"]]
    id = expect_planned(ann, service, (front["x"], front["y"]), corners)
    planned = ann.inputs

    def press(name: str) -> None:
        button = ann.page.locator("argo-run").get_by_role("button", name=name, exact=True)
        if name == "Take over":
            expect(button).to_be_enabled()
            ann.key("F9")
            return
        if name == "Start the run":
            ann.key("F8")
        expect(button).to_be_enabled()
        expect(button).to_be_focused()
        ann.key("Enter")

    run_with_handover(press)
    with capsys.disabled():
        print(f"\nprotocol #2 by keys: {planned} inputs, run included {ann.inputs}")
    assert ann.inputs <= MAX_INPUTS + 1  # a reorder
    expect_success(ann, service, id)
