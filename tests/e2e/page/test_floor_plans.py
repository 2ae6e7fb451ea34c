"""Floor plans and the mission sheet: by keyboard, from the menu, and on paper."""

import base64
import re

import pytest
from playwright.sync_api import expect

from tests.e2e.page.person import Person
from tests.e2e.page.test_access import require_accessible

pytestmark = pytest.mark.long

SCRIPT = """Start in starting area 1.
Check checkpoint #4.
Wait 20 s.
Check checkpoint #8, retry twice.
Return to the docking station in starting area 2.
"""
ROUNDS = """1. Start in starting area 1.
2. Check checkpoint #4.
3. Repeat step 2 twice.
4. Check checkpoint #1.
"""
PRESSES = "() => { window.printed = 0; window.print = () => { window.printed += 1 } }"


@pytest.fixture
def opened(ann: Person, service) -> Person:
    """Return a person in a mission on two floors, with its paths."""
    ann.open(f"/missions/{service.imported(SCRIPT, filename='Two floors.txt')}")
    expect(ann.page.locator("argo-strip #total-distance")).to_be_visible()
    return ann


def badges(person: Person) -> list[str]:
    """Return the numbers of tasks in the drawing, in their order."""
    texts = person.page.locator("argo-floor-plans .room .badge text").all_text_contents()
    return [text.strip() for text in texts]


def test_plans_of_floors_are_shown_and_left_by_keyboard(opened: Person) -> None:
    opened.key("p")
    plans = opened.page.locator("argo-floor-plans")
    expect(plans.get_by_role("img", name="Plan of floor 1 with the tasks 1, 2, 5")).to_be_visible()
    assert sorted(badges(opened)) == ["1", "2", "5"]
    expect(plans.locator("svg.floor").first).to_contain_text("#4 valve R25")
    expect(plans.locator("aside")).to_contain_text("Without a place")
    opened.key("PageUp")
    expect(plans.get_by_role("img", name="Plan of floor 2 with the tasks 4")).to_be_visible()
    assert badges(opened) == ["4"]
    opened.key("m", "Delete")  # keys of the list, which is hidden
    expect(opened.page.locator("argo-add [role=combobox]")).to_have_count(0)
    require_accessible(opened, "floor plans")
    opened.key("Escape")
    expect(plans).to_have_count(0)
    expect(opened.page.get_by_role("treeitem")).to_have_count(5)


def test_the_sheet_has_the_numbers_of_the_script(ann: Person, service) -> None:
    ann.open(f"/missions/{service.imported(ROUNDS, filename='Rounds.txt')}")
    expect(ann.page.get_by_role("treeitem")).to_have_count(4)
    ann.key("p")
    ann.click(ann.page.locator("#sheet"))
    rows = ann.page.locator("argo-mission-sheet tbody tr")
    expect(rows.locator("td.number")).to_have_text(["1", "3", "2", "4"])


def test_the_mission_sheet_is_printed_on_white_paper(opened: Person) -> None:
    opened.click(opened.button("Mission: copy, print, export, versions"))
    opened.click(opened.page.locator("#open-sheet"))
    sheet = opened.page.locator("argo-mission-sheet")
    numbers = sheet.locator("tbody td.number")
    expect(numbers).to_have_text(["1", "2", "3", "4", "5"])
    expect(sheet.locator("figcaption")).to_have_text(["Floor 1", "Floor 2"])
    expect(sheet.locator("pre")).to_contain_text("Check checkpoint #8, retry twice.")
    expect(sheet.locator("tr", has_text="pressure gauge 5 (#8)")).to_contain_text("2 – 4 bar")
    require_accessible(opened, "the mission sheet")
    opened.evaluate(PRESSES)
    opened.click(opened.page.locator("#print"))
    opened.wait_until(lambda: opened.evaluate("() => window.printed"), "the sheet is printed")
    client = opened.context.new_cdp_session(opened.page)
    printed = client.send("Page.printToPDF", {"preferCSSPageSize": True})
    content = base64.b64decode(printed["data"])
    assert len(re.findall(rb"/Type\s*/Page\b", content)) == 2
    opened.page.emulate_media(media="print")
    for hidden in ("argo-topbar", "argo-list", "argo-floor-plans .bar"):
        expect(opened.page.locator(hidden).first).to_be_hidden()
    opened.page.emulate_media(media="screen")
    opened.key("F8")
    expect(opened.page.locator("argo-run")).to_be_visible()
