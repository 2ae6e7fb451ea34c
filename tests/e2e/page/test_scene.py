"""The site in 3D: clicks, the verdict of the ghost, obstacles, and the camera."""

import re
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.e2e.page.person import Person
from tests.e2e.page.test_list import expect_order, open_mission, plan, row

__all__ = ["plan"]
FREE = (8.0, 1.6, 0.0)
VESSEL = (3.05, 4.0, 0.0)


@pytest.fixture
def ann(browsers, address, plan) -> Person:
    ann = open_mission(browsers, address, plan)
    ann.wait_for_scene()
    return ann


def show_floor(ann: Person, number: int) -> None:
    """Show a floor and those below it only."""
    ann.click(
        ann.page.locator("argo-scene").get_by_role("radio", name=re.compile(f"Floor {number}"))
    )
    ann.wait_for_scene()


def checkpoint(service: Any, id: int) -> Any:
    checkpoints = service.client.get("/api/world").json()["checkpoints"]
    return next(one for one in checkpoints if one["id"] == id)


def test_a_checkpoint_is_measured_with_two_clicks(ann, service, plan) -> None:
    show_floor(ann, 1)
    ann.click(ann.project(*checkpoint(service, 3)["position"]))
    ann.click(ann.page.locator("argo-scene").get_by_role("button", name=re.compile("^Measure")))
    expect_order(ann, "START", "A1", "B2", "C4", "MEASURE 3")
    assert service.mission(plan)["tasks"][-1]["object_id"] == "3"


@pytest.mark.long
def test_hidden_checkpoints_can_not_be_clicked(ann, service) -> None:
    above = checkpoint(service, 14)
    assert above["floor"] > 1
    show_floor(ann, 1)
    ann.click(ann.project(*above["position"]))
    expect(ann.page.get_by_text(above["name"], exact=False)).to_have_count(0)


@pytest.mark.long
def test_the_ghost_shows_verdicts_without_requests(ann, service) -> None:
    show_floor(ann, 1)
    world = service.client.get("/api/world").json()
    maps: list[str] = []
    ann.page.on("requestfinished", lambda r: "/standing/" in r.url and maps.append(r.url))
    ann.key("n")
    ann.page.mouse.move(*ann.project(*FREE))
    verdict = ann.page.locator("argo-scene #verdict")
    expect(verdict).to_contain_text("can stand")
    count = len(world["floors"]) * len(world["headings"])
    ann.wait_until(lambda: len(maps) == count, "the maps of all floors are read")
    asked: list[str] = []
    ann.page.on("request", lambda request: asked.append(request.url))
    ann.page.mouse.move(*ann.project(*VESSEL))
    expect(verdict).to_contain_text("too near")
    ann.page.mouse.move(*ann.project(*FREE))
    expect(verdict).to_contain_text("can stand")
    assert asked == []


@pytest.mark.long
def test_a_click_where_the_robot_can_not_stand_places_nothing(ann) -> None:
    show_floor(ann, 1)
    ann.key("n")
    ann.page.mouse.move(*ann.project(*FREE))
    expect(ann.page.locator("argo-scene #verdict")).to_contain_text("can stand")
    ann.click(ann.project(*VESSEL))
    ann.click(ann.project(*FREE))
    expect_order(ann, "START", "A1", "B2", "C4", "WAYPOINT 1")
    ann.page.mouse.click(*ann.project(*FREE), button="right")
    expect(ann.page.locator("argo-scene #verdict")).to_be_hidden()


@pytest.mark.long
def test_a_chosen_floor_fits_the_view(ann, service) -> None:
    ann.wait_for_scene()
    for _ in range(4):
        ann.click(ann.button("Zoom in"))
    floor = service.client.get("/api/world").json()["floors"][1]
    show_floor(ann, floor["number"])
    for x0, y0, x1, y1 in floor["plates"]:
        for corner in ((x0, y0), (x1, y0), (x1, y1), (x0, y1)):
            seen = ann.evaluate("p => window.argo.project(...p)", [*corner, floor["z"]])
            assert seen["visible"], corner


@pytest.mark.long
def test_a_frame_selects_tasks(ann, service) -> None:
    show_floor(ann, 1)
    points = [ann.project(*checkpoint(service, id)["position"]) for id in (1, 2, 4)]
    (left, top), (right, bottom) = (
        [pick(axis) for axis in zip(*points, strict=True)] for pick in (min, max)
    )
    mouse = ann.page.mouse
    seen = ann.evaluate("() => window.argo.camera()")
    mouse.move(left - 6, top - 6)
    ann.page.keyboard.down("Shift")
    mouse.down()
    mouse.move(right, bottom)
    expect(ann.page.locator("argo-scene #frame")).to_be_visible()
    mouse.move(right + 6, bottom + 6)
    mouse.up()
    ann.page.keyboard.up("Shift")
    for name in ("A1", "B2", "C4"):
        expect(row(ann, name)).to_have_attribute("aria-selected", "true")
    assert ann.evaluate("() => window.argo.camera()") == seen


@pytest.mark.long
def test_railings_can_be_hidden(ann) -> None:
    def triangles() -> int:
        ann.wait_for_scene()
        return int(ann.evaluate("() => window.argo.figures().triangles"))

    drawn = triangles()
    ann.click(ann.button("Display settings"))
    box = ann.page.get_by_label("Railings")
    box.uncheck()
    ann.wait_until(lambda: triangles() < drawn, "fewer triangles are drawn")
    fewer = triangles()
    box.check()
    ann.wait_until(lambda: triangles() > fewer, "more triangles are drawn again")


@pytest.mark.long
def test_a_drag_moves_the_camera_and_is_no_click(ann) -> None:
    show_floor(ann, 1)
    ann.key("n")
    before = ann.evaluate("() => window.argo.camera()")
    x, y = ann.project(*FREE)
    ann.page.mouse.move(x, y)
    ann.page.mouse.down()
    ann.page.mouse.move(x + 30, y + 10, steps=5)
    ann.page.mouse.up()
    ann.wait_for_scene()
    expect_order(ann, "START", "A1", "B2", "C4")
    assert ann.evaluate("() => window.argo.camera()") != before


@pytest.mark.long
def test_v_moves_the_camera_to_the_selection(ann) -> None:
    ann.click(row(ann, "C4"))
    before = ann.evaluate("() => window.argo.camera()")
    ann.key("v")
    ann.wait_until(lambda: ann.evaluate("() => window.argo.camera()") != before, "the camera moves")
    ann.wait_for_scene()


@pytest.mark.long
def test_an_obstacle_closes_the_ground(ann, service) -> None:
    show_floor(ann, 1)
    ann.key("o")
    ann.click(ann.project(8.0, 1.2, 0.0))
    ann.click(ann.project(9.0, 2.0, 0.0))
    form = ann.page.locator("argo-scene argo-obstacle-form")
    form.get_by_role("button").first.click()
    ann.wait_until(
        lambda: service.client.get("/api/world/obstacles").json()["obstacles"],
        "the service has the obstacle",
    )
    ann.wait_until(lambda: ann.evaluate("() => true"), "the page answers")
    ann.key("n")
    ann.wait_until(
        lambda: ann.evaluate("() => window.argo.standing(8.5, 1.6, 0, 0)") == "closed",
        "the ground is closed there",
    )
    service.put_obstacles().raise_for_status()


@pytest.mark.long
def test_an_obstacle_is_added_by_keys_alone(ann, service) -> None:
    show_floor(ann, 1)
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("o", "Shift+ArrowLeft", "Enter", "Shift+ArrowRight", "Shift+ArrowUp", "Enter")
    expect(ann.page.locator("argo-obstacle-form #name")).to_be_focused()
    ann.type("Box")
    ann.key("Enter")
    (box,) = ann.wait_until(
        lambda: service.client.get("/api/world/obstacles").json()["obstacles"],
        "the service has the obstacle",
    )
    assert box["name"] == "Box"
    assert box["size"][:2] == [0.5, 0.5]
    service.put_obstacles().raise_for_status()


@pytest.mark.long
def test_the_tool_is_moved_and_closed_by_keys(ann) -> None:
    show_floor(ann, 1)
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("n", "ArrowUp")
    expect(ann.page.locator("argo-scene #verdict")).to_be_visible()
    ann.key("Escape")
    expect(ann.page.get_by_role("tree")).to_be_focused()
