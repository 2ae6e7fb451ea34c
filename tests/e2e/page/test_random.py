"""Random keys in the list: after each, the page shows the mission that the service has."""

import random
from typing import Any

import pytest
from playwright.sync_api import expect

from tests.argo_planner.service.served import Served
from tests.conftest import FIRST_SEED, examples
from tests.e2e.page.person import Person
from tests.e2e.page.test_list import open_mission, plan  # noqa: F401

pytestmark = pytest.mark.long

KEYS = (
    *("ArrowDown", "ArrowUp", "Shift+ArrowDown", "Shift+ArrowUp", "Home", "End"),
    *("Alt+ArrowUp", "Alt+ArrowDown", "Alt+ArrowLeft", "Alt+ArrowRight"),
    *("Delete", "Control+z", "Control+z", "Control+y", "Control+c", "Control+v", "Control+v"),
    *("g", "m", "Escape"),
)


def expected_rows(mission: dict[str, Any]) -> list[tuple[str, int]]:
    """Return the rows that the list has to show: names and depths, a group before its tasks."""
    at = {task["name"]: index for index, task in enumerate(mission["tasks"])}
    spans = [(g["name"], at[g["start"]], at[g["end"]]) for g in mission["groups"]]
    rows = []
    for index, task in enumerate(mission["tasks"]):
        around = sum(first < index <= last for _, first, last in spans)
        begun = [one for one in spans if one[1] == index]
        for deeper, (name, _, _) in enumerate(
            sorted(begun, key=lambda one: (-one[2], len(one[0])))
        ):
            rows.append((name.rpartition("/")[2], 1 + around + deeper))
        rows.append((task["name"], 1 + around + len(begun)))
    return rows


def shown_rows(person: Person) -> list[tuple[str, int]]:
    script = """() => {
        const rows = [...document.querySelector("argo-app").shadowRoot
            .querySelector("argo-list").shadowRoot.querySelectorAll("[role=treeitem]")];
        rows.sort((a, b) => a.dataset.index - b.dataset.index);
        return rows.map((row) => [
            row.dataset.name, Number(row.ariaLevel)]);
    }"""
    return [(name, level) for name, level in person.evaluate(script)]


def expect_same(person: Person, service: Served, id: str) -> None:
    expect(person.save_status).to_have_text("Saved")
    person.wait_until(
        lambda: shown_rows(person) == expected_rows(service.mission(id)),
        f"{shown_rows(person)} is {expected_rows(service.mission(id))}",
    )


@pytest.mark.parametrize(("seed", "steps"), [(7, 10), (8 + FIRST_SEED, examples(400))])
def test_the_list_shows_the_mission(browsers, address, service, plan, seed, steps) -> None:  # noqa: F811
    ann = open_mission(browsers, address, plan, viewport={"width": 1400, "height": 2400})
    ann.context.grant_permissions(["clipboard-read", "clipboard-write"])
    chosen = random.Random(seed)
    for _ in range(steps):
        key = chosen.choice(KEYS)
        if len(service.mission(plan)["tasks"]) > 25 and key == "Control+v":
            key = "Delete"
        ann.focus(ann.page.get_by_role("tree"))
        ann.key(key)
        if key == "g":
            ann.key("Escape")
        if key == "m":
            expect(ann.page.locator("argo-add input")).to_be_focused()
            ann.type(str(chosen.randint(1, 20)))
            ann.key("Enter", "Escape")
        expect_same(ann, service, plan)
    ann.page.reload()
    expect(ann.page.get_by_role("treeitem").first).to_be_visible()
    expect_same(ann, service, plan)
