"""The site in 3D: what a click hits, what the ghost says, obstacles, and the camera."""

import re
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.e2e.page.person import Person
from tests.e2e.page.test_list import at, order, plan, row

__all__ = ["plan"]
FREE = (8.0, 1.6, 0.0)
VESSEL = (3.05, 4.0, 0.0)


@pytest.fixture
def ann(browsers, address, plan) -> Person:
    ann = at(browsers, address, plan)
    ann.idle()
    return ann


def floor(ann: Person, number: int) -> None:
    """Shows a floor, and those below it only."""
    ann.click(
        ann.page.locator("argo-scene").get_by_role("radio", name=re.compile(f"Floor {number}"))
    )
    ann.idle()


def checkpoint(service: Any, id: int) -> Any:
    found = service.client.get("/api/world").json()["checkpoints"]
    return next(one for one in found if one["id"] == id)


def test_a_checkpoint_is_measured_with_two_clicks(ann, service, plan) -> None:
    floor(ann, 1)
    ann.click(ann.at(*checkpoint(service, 3)["position"]))
    ann.click(ann.page.locator("argo-scene").get_by_role("button", name=re.compile("^Measure")))
    order(ann, "START", "A1", "B2", "C4", "MEASURE 3")
    assert service.mission(plan)["tasks"][-1]["object_id"] == "3"


@pytest.mark.long
def test_what_is_hidden_is_not_hit(ann, service) -> None:
    above = checkpoint(service, 14)
    assert above["floor"] > 1
    floor(ann, 1)
    ann.click(ann.at(*above["position"]))
    expect(ann.page.get_by_text(above["name"], exact=False)).to_have_count(0)


@pytest.mark.long
def test_the_ghost_says_where_the_robot_can_stand_without_asking(ann, service) -> None:
    floor(ann, 1)
    world = service.client.get("/api/world").json()
    maps: list[str] = []
    ann.page.on("requestfinished", lambda r: "/standing/" in r.url and maps.append(r.url))
    ann.key("n")
    ann.page.mouse.move(*ann.at(*FREE))
    verdict = ann.page.locator("argo-scene #verdict")
    expect(verdict).to_contain_text("can stand")
    count = len(world["floors"]) * len(world["headings"])
    ann.until(lambda: len(maps) == count, "the maps of all floors are read")
    asked: list[str] = []
    ann.page.on("request", lambda request: asked.append(request.url))
    ann.page.mouse.move(*ann.at(*VESSEL))
    expect(verdict).to_contain_text("too near")
    ann.page.mouse.move(*ann.at(*FREE))
    expect(verdict).to_contain_text("can stand")
    assert asked == []


@pytest.mark.long
def test_a_click_where_it_can_not_stand_places_nothing(ann) -> None:
    floor(ann, 1)
    ann.key("n")
    ann.page.mouse.move(*ann.at(*FREE))
    expect(ann.page.locator("argo-scene #verdict")).to_contain_text("can stand")
    ann.click(ann.at(*VESSEL))
    ann.click(ann.at(*FREE))
    order(ann, "START", "A1", "B2", "C4", "WAYPOINT 1")
    ann.page.mouse.click(*ann.at(*FREE), button="right")
    expect(ann.page.locator("argo-scene #verdict")).to_be_hidden()


@pytest.mark.long
def test_a_drag_is_the_camera_and_no_click(ann) -> None:
    floor(ann, 1)
    ann.key("n")
    before = ann.ask("() => window.argo.camera()")
    x, y = ann.at(*FREE)
    ann.page.mouse.move(x, y)
    ann.page.mouse.down()
    ann.page.mouse.move(x + 30, y + 10, steps=5)
    ann.page.mouse.up()
    ann.idle()
    order(ann, "START", "A1", "B2", "C4")
    assert ann.ask("() => window.argo.camera()") != before


@pytest.mark.long
def test_v_glides_to_what_is_selected(ann) -> None:
    ann.click(row(ann, "C4"))
    before = ann.ask("() => window.argo.camera()")
    ann.key("v")
    ann.until(lambda: ann.ask("() => window.argo.camera()") != before, "the camera moves")
    ann.idle()


@pytest.mark.long
def test_an_obstacle_closes_the_ground(ann, service) -> None:
    floor(ann, 1)
    ann.key("o")
    ann.click(ann.at(8.0, 1.2, 0.0))
    ann.click(ann.at(9.0, 2.0, 0.0))
    form = ann.page.locator("argo-scene argo-obstacle-form")
    form.get_by_role("button").first.click()
    ann.until(
        lambda: service.client.get("/api/world/obstacles").json()["obstacles"], "it stands there"
    )
    ann.until(lambda: ann.ask("() => true"), "the page answers")
    ann.key("n")
    ann.until(
        lambda: ann.ask("() => window.argo.standing(8.5, 1.6, 0, 0)") == "closed",
        "the ground is closed there",
    )
    service.put_obstacles().raise_for_status()


@pytest.mark.long
def test_an_obstacle_is_put_up_by_keys_alone(ann, service) -> None:
    floor(ann, 1)
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("o", "Shift+ArrowLeft", "Enter", "Shift+ArrowRight", "Shift+ArrowUp", "Enter")
    expect(ann.page.locator("argo-obstacle-form #name")).to_be_focused()
    ann.type("Box")
    ann.key("Enter")
    (box,) = ann.until(
        lambda: service.client.get("/api/world/obstacles").json()["obstacles"], "it stands there"
    )
    assert box["name"] == "Box"
    assert box["size"][:2] == [0.5, 0.5]
    service.put_obstacles().raise_for_status()


@pytest.mark.long
def test_the_tool_is_moved_by_keys_at_once_and_put_away(ann) -> None:
    floor(ann, 1)
    ann.focus(ann.page.get_by_role("tree"))
    ann.key("n", "ArrowUp")
    expect(ann.page.locator("argo-scene #verdict")).to_be_visible()
    ann.key("Escape")
    expect(ann.page.get_by_role("tree")).to_be_focused()
