"""For everyone: axe finds nothing serious, in both themes and languages, wide and narrow."""

from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import expect

from argo_planner.service.web import page
from tests.e2e.page.person import Person
from tests.e2e.page.test_list import plan, row

pytestmark = pytest.mark.long

__all__ = ["plan"]
AXE = Path(page.__file__).parents[2] / "page" / "node_modules" / "axe-core" / "axe.min.js"
THEME = "() => document.documentElement.dataset.theme"


def require_accessible(person: Person, where: str) -> None:
    """Assert that axe finds nothing serious or critical in either theme."""
    if not person.ask("() => 'axe' in window"):
        person.ask(AXE.read_text(encoding="utf-8"))
    theme = person.ask(THEME)
    require_nothing_serious(person, where)
    change_theme(person)
    assert person.ask(THEME) != theme
    require_nothing_serious(person, f"{where}, in the other theme")
    change_theme(person)
    assert person.ask(THEME) == theme


def change_theme(person: Person) -> None:
    """Press the button that changes the theme, without the focus or the pointer that go with a
    real press."""
    names = ("Dark colours", "Light colours", "Dunkle Farben", "Helle Farben")
    button = person.page.locator(",".join(f"argo-topbar [aria-label='{name}']" for name in names))
    button.evaluate("button => button.click()")
    # The page's style, and then what has changed in it, follow with the next frames.
    person.ask("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")


def require_nothing_serious(person: Person, where: str) -> None:
    """Assert that axe finds nothing serious or critical in what is shown."""
    found: list[dict[str, Any]] = person.ask(
        "() => axe.run(document, { resultTypes: ['violations'] }).then(r => r.violations)"
    )
    serious = [
        (one["id"], node["target"], node.get("failureSummary"))
        for one in found
        if one["impact"] in ("serious", "critical")
        for node in one["nodes"]
    ]
    assert not serious, (where, serious)


@pytest.mark.parametrize(("locale", "theme"), [("en-GB", "light"), ("de-DE", "dark")])
def test_planning_is_accessible(browsers, address, plan, locale, theme) -> None:
    ann = browsers.person(address, locale=locale, color_scheme=theme)
    ann.open()
    expect(ann.page.locator("argo-home button.main")).to_be_enabled()
    assert ann.ask(THEME) == theme
    require_accessible(ann, "the list of missions")
    ann.open(f"/missions/{plan}")
    ann.click(row(ann, "A1"))
    ann.idle()
    require_accessible(ann, "planning")
    for panel in ("script", "route", "evaluate", "run"):
        ann.click(ann.page.locator(f"#tab-{panel}"))
        require_accessible(ann, panel)
    ann.click(ann.page.locator("#tab-evaluate"))
    ann.page.locator("argo-evaluate-start summary").click()
    ann.page.locator("argo-evaluate-start argo-faults select").select_option("gas_leak")
    ann.page.locator("select[name=drive]").select_option("kinematic")
    ann.page.locator("argo-evaluate-start select[name=worlds]").select_option("20")
    ann.page.locator("input[name=require]").fill("50")
    require_accessible(ann, "what is asked of an evaluation")
    ann.page.locator("select[name=drive]").select_option("route")
    ann.click(ann.page.locator("argo-evaluate-start argo-faults button"))
    ann.click(ann.page.locator("#evaluate"))
    result = ann.page.locator("argo-evaluate-result section")
    expect(result).to_have_attribute("data-state", "done")
    require_accessible(ann, "what came of an evaluation")
    ann.key("?")
    require_accessible(ann, "the sheet of keys")


def test_a_phone_shows_the_run(browsers, address, plan) -> None:
    ann = browsers.person(address, viewport={"width": 400, "height": 800})
    ann.open(f"/missions/{plan}")
    ann.click(ann.page.locator("#tab-run"))
    ann.idle()
    require_accessible(ann, "a phone")
    assert ann.ask("() => document.documentElement.scrollWidth") <= 400
