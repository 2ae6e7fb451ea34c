"""The page from 320 px (1280 px at 400 % zoom, WCAG 1.4.10) to 1920 px, in both languages."""

from typing import Any

import pytest
from playwright.sync_api import expect

from tests.e2e.page.person import Person

pytestmark = pytest.mark.long

SIZES = ((320, 256), (400, 800), (720, 450), (820, 1180), (1024, 768), (1280, 800), (1920, 1080))
NARROW = 720
"""px: the list is a drawer on narrower pages"""

SCRIPT = """Mission Protocol
Designation: Nightly round of all floors with a remarkably long name, as sites use them
Maximum duration: 30 minutes

1. Set the starting point in starting area 1.
2. Check checkpoint #4, retry twice.
3. Check checkpoint #1. If checkpoint #1 is above 7, go to step 8.
4. Patrol floor 1 for 2 minutes.
5. Check checkpoint #8.
6. Check checkpoint #13.
7. Repeat steps 5 to 6 3 times.
8. Check checkpoint #14, not later than 20 minutes after the start.
9. Return to the docking station in starting area 2.
If the battery is low, return to the docking station, wait until the battery is charged to 30 %,
and resume.
"""

# Returns what of a part of the page a person can't reach: it sticks out of the window, or something
# else lies over its middle.
UNREACHABLE = """(within) => {
    const all = [];
    const collect = (root) => {
        for (const one of root.querySelectorAll("*")) {
            all.push(one);
            if (one.shadowRoot) collect(one.shadowRoot);
        }
    };
    collect(document);
    const isShown = (one) => one.checkVisibility({ visibilityProperty: true })
        && one.getClientRects().length > 0;
    const label = (one) => (one.getAttribute("aria-label") ?? one.textContent).trim().slice(0, 60)
        + ` <${one.localName} ${one.className}>`;
    const at = (x, y) => {
        let found = document.elementFromPoint(x, y);
        while (found?.shadowRoot?.elementFromPoint(x, y)) {
            const inner = found.shadowRoot.elementFromPoint(x, y);
            if (inner === found) break;
            found = inner;
        }
        return found;
    };
    const holds = (one, found) => {
        for (let now = found; now !== null; now = now.parentNode ?? now.host ?? null)
            if (now === one) return true;
        return one.labels instanceof NodeList && [...one.labels].some((two) => two.contains(found));
    };
    const problems = [];
    const wide = document.documentElement.scrollWidth;
    if (wide > innerWidth) problems.push(`the page is ${wide} px wide`);
    const part = document.querySelector("argo-app").shadowRoot.querySelector(within);
    for (const one of all.filter((one) => isShown(one) && holds(part, one))) {
        const { overflowX } = getComputedStyle(one);
        if (["auto", "scroll"].includes(overflowX) && one.scrollWidth > one.clientWidth + 1)
            problems.push(`scrolls sideways: ${label(one)}`);
        if (!one.matches("button, input, select, textarea, summary, a, [role=tree]")) continue;
        if (one.matches(".bar button")) continue; // the table below has the same legs
        one.scrollIntoView({ block: "center", inline: "nearest" });
        const { left, right, top, bottom } = one.getBoundingClientRect();
        const y = (Math.max(top, 1) + Math.min(bottom, innerHeight - 1)) / 2;
        const found = at((left + right) / 2, y) ?? document.body;
        if (left < -1 || right > innerWidth + 1) problems.push(`outside: ${label(one)}`);
        else if (!holds(one, found)) problems.push(`covered: ${label(one)} by ${label(found)}`);
    }
    return problems;
}"""


def choose_language(person: Person, language: str) -> None:
    person.page.locator("argo-settings select").evaluate(
        "(select, to) => { select.value = to; select.dispatchEvent(new Event('change')) }",
        language,
    )
    expect(person.page.locator("html")).to_have_attribute("lang", language)


@pytest.fixture
def ann(browsers: Any, address: str, service: Any) -> Person:
    """Return a person who has opened a mission with long names."""
    ann: Person = browsers.person(address)
    ann.open(f"/missions/{service.imported(SCRIPT, filename='nightly.txt')}")
    expect(ann.page.get_by_role("treeitem")).to_have_count(13)
    ann.wait_for_scene()
    return ann


@pytest.mark.parametrize(
    ("language", "sizes"),
    [("en", SIZES[:2]), ("de", SIZES)],  # German has the longer words
)
def test_everything_can_be_reached(ann, language, sizes) -> None:
    page = ann.page
    choose_language(ann, language)
    page.locator("argo-strip summary").click()
    found = {}
    for width, height in sizes:
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_timeout(100)
        found[width, "top bar"] = ann.evaluate(UNREACHABLE, "argo-topbar")
        for panel in ("properties", "script", "route", "evaluate", "run"):
            page.locator(f"#tab-{panel}").click()
            found[width, panel] = ann.evaluate(UNREACHABLE, "main")
        if width < NARROW:
            page.locator("argo-topbar button.list").click()
            found[width, "list"] = ann.evaluate(UNREACHABLE, "argo-list")
            page.keyboard.press("Escape")
            expect(page.locator("argo-list .tree")).to_be_hidden()
        for unfold in ("argo-scene-bar .unfold button", "argo-scene-floors .unfold button"):
            button = page.locator(unfold)
            if button.is_visible():
                button.click()
                found[width, unfold] = ann.evaluate(UNREACHABLE, "argo-scene")
                button.click()
    assert not {at: problems for at, problems in found.items() if problems}
