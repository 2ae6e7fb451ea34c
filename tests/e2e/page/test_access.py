"""Accessibility: axe finds no serious violations, in both themes and languages, wide and narrow."""

import re
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
    """Assert that axe finds no serious or critical violation in either theme."""
    if not person.evaluate("() => 'axe' in window"):
        person.evaluate(AXE.read_text(encoding="utf-8"))
    theme = person.evaluate(THEME)
    require_no_violations(person, where)
    change_theme(person)
    assert person.evaluate(THEME) != theme
    require_no_violations(person, f"{where}, in the other theme")
    change_theme(person)
    assert person.evaluate(THEME) == theme


def change_theme(person: Person) -> None:
    """Press the button that changes the theme, without moving the focus or the pointer."""
    names = ("Dark colours", "Light colours", "Dunkle Farben", "Helle Farben")
    button = person.page.locator(",".join(f"argo-topbar [aria-label='{name}']" for name in names))
    button.evaluate("button => button.click()")
    # The page takes on the new style within the next frames.
    person.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")


def require_no_violations(person: Person, where: str) -> None:
    """Assert that axe finds no serious or critical violation in the current theme."""
    violations: list[dict[str, Any]] = person.evaluate(
        "() => axe.run(document, { resultTypes: ['violations'] }).then(r => r.violations)"
    )
    serious = [
        (one["id"], node["target"], node.get("failureSummary"))
        for one in violations
        if one["impact"] in ("serious", "critical")
        for node in one["nodes"]
    ]
    assert not serious, (where, serious)


@pytest.mark.parametrize(("locale", "theme"), [("en-GB", "light"), ("de-DE", "dark")])
def test_planning_is_accessible(browsers, address, plan, locale, theme) -> None:
    ann = browsers.person(address, locale=locale, color_scheme=theme)
    ann.open()
    expect(ann.page.locator("argo-home button.main")).to_be_enabled()
    assert ann.evaluate(THEME) == theme
    expect(ann.page.get_by_role("img")).to_be_visible()
    require_accessible(ann, "the list of missions")
    ann.open(f"/missions/{plan}")
    ann.click(row(ann, "A1"))
    ann.wait_for_scene()
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
    require_accessible(ann, "the settings of an evaluation")
    ann.page.locator("select[name=drive]").select_option("route")
    ann.click(ann.page.get_by_role("button", name=re.compile("^Remove|entfernen$")).last)
    ann.click(ann.page.locator("#evaluate"))
    result = ann.page.locator("argo-evaluate-result section")
    expect(result).to_have_attribute("data-state", "done")
    require_accessible(ann, "the results of an evaluation")
    ann.key("?")
    require_accessible(ann, "the overview of keyboard shortcuts")


def test_a_run_on_a_phone_is_accessible(browsers, address, plan) -> None:
    ann = browsers.person(address, viewport={"width": 400, "height": 800})
    ann.open(f"/missions/{plan}")
    ann.click(ann.page.locator("#tab-run"))
    ann.wait_for_scene()
    require_accessible(ann, "a phone")
    assert ann.evaluate("() => document.documentElement.scrollWidth") <= 400
