"""The frame of the page: list of missions, import, names, deletion, rights, languages, focus."""

import json
from pathlib import Path

import pytest
from playwright.sync_api import expect

from argo_compiler.analysis import Analysis
from argo_compiler.analysis.results import Bound, Bounds, Verdict
from argo_compiler.il import Mission
from argo_planner.service.jobs.analysis import AnalysisFound, Analyst
from tests.argo_planner.service.served import SECRETS

HOSTILE = '"><img src=x onerror=alert(1)>{{7*7}}${7*7}'
SCRIPT = Path(__file__).parents[3] / "scenarios" / "umad" / "missions" / "mission_1.txt"


def test_a_mission_is_created_renamed_deleted_and_restored(ann, service) -> None:
    ann.click(ann.button("New mission"))
    expect(ann.save_status).to_have_text("Saved")
    ann.click(ann.page.get_by_title("Rename the mission"))
    ann.page.keyboard.type("Night round")
    ann.key("Enter")
    expect(ann.page.get_by_title("Rename the mission")).to_have_text("Night round")
    ann.click(ann.button("All missions"))
    ann.click(ann.button("Delete Night round"))
    expect(ann.page.get_by_role("link", name="Night round")).to_have_count(0)
    ann.click(ann.button("Undo"))
    expect(ann.page.get_by_role("link", name="Night round")).to_have_count(1)
    names = [one["name"] for one in service.client.get("/api/missions").json()["missions"]]
    assert "Night round" in names


@pytest.mark.long
def test_the_import_asks_for_areas_that_a_script_does_not_name(ann, service) -> None:
    ann.page.set_input_files("#file", SCRIPT)
    ann.page.get_by_label("Start area").select_option("1")
    ann.page.get_by_label("End area").select_option("2")
    ann.click(ann.button("Import"))
    expect(ann.save_status).to_have_text("Saved")
    id = ann.page.url.rpartition("/")[2]
    mission = service.mission(id)
    assert (mission["start_area"], mission["end_area"]) == (1, 2)


def test_a_mission_with_an_error_is_refused_with_its_message(ann, tmp_path) -> None:
    wrong = tmp_path / "wrong.json"
    wrong.write_text('{"version": 4, "tasks": [{"name": "A", "action": "DANCE"}]}', "utf-8")
    ann.page.set_input_files("#file", wrong)
    log = ann.page.get_by_role("log")
    expect(log).to_contain_text("wrong.json can't be imported")
    expect(log).to_contain_text("tasks[0].action")
    assert ann.page.url.endswith("/")


@pytest.mark.long
def test_hostile_names_are_text(ann, service) -> None:
    id = service.create(HOSTILE)
    task = {"kind": "add_task", "task": {"name": HOSTILE, "action": "WAYPOINT", "pose": POSE}}
    assert service.command(id, 1, task).status_code == 200
    ann.open(f"/missions/{id}")
    expect(ann.page.get_by_title("Rename the mission")).to_have_text(HOSTILE)
    expect(ann.page.get_by_role("treeitem").filter(has_text=HOSTILE)).to_have_count(1)
    assert ann.page.locator("img[src=x]").count() == 0


@pytest.mark.long
def test_viewers_can_not_edit(browsers, service) -> None:
    id = service.create("For looking")
    viewer = browsers.person(f"http://{service.address}/?token={SECRETS['view']}")
    viewer.open(f"/missions/{id}")
    expect(viewer.page.get_by_title("Rename the mission")).to_be_disabled()
    viewer.key("m")
    expect(viewer.page.locator("argo-add [role=combobox]")).to_have_count(0)
    expect(viewer.page.get_by_label("Designation")).to_be_disabled()


def test_the_content_security_policy_has_no_unsafe_sources(ann) -> None:
    response = ann.page.request.get(ann.address)
    policy = response.headers["content-security-policy"]
    assert "unsafe-eval" not in policy
    assert "unsafe-inline" not in policy.partition("script-src")[2].partition(";")[0]


def test_the_overview_of_shortcuts_opens_and_closes(ann) -> None:
    ann.key("?")
    expect(ann.page.get_by_role("dialog")).to_contain_text("navigation tool")
    ann.key("Escape")
    expect(ann.page.get_by_role("dialog")).to_have_count(0)


def test_the_page_is_german_in_a_german_browser(browsers, address) -> None:
    otto = browsers.person(address, "otto", locale="de-DE")
    otto.open()
    expect(otto.button("Neue Mission")).to_be_visible()


WIDTHS = (360, 800, 1100, 1400, 1900)
"""px, from a phone to a large screen"""
WIDE = Analysis(
    diagnostics=(),
    tasks=(),
    groups=(),
    ends=Verdict.POSSIBLE,
    duration=Bounds(least=Bound(value=3_920.0), most=Bound(value=44_321.0)),
    energy=Bounds(least=Bound(value=12.34), most=Bound(value=None)),
)
"""results of an analysis whose texts are long"""
CUT_TEXTS = """() => {
    const strip = document.querySelector("argo-app").shadowRoot.querySelector("argo-strip");
    const totals = strip.shadowRoot.querySelector("argo-totals");
    const { right } = strip.getBoundingClientRect();
    const isCut = (e) => e.clientWidth > 0 && e.scrollWidth > e.clientWidth;
    const isOutside = (e) => e.getBoundingClientRect().right > right;
    // The names in the bar become shorter with its legs; their labels are complete.
    const all = [strip, ...strip.shadowRoot.querySelectorAll(":not(.bar, .bar *, .unseen)"),
        ...totals.shadowRoot.querySelectorAll("*")];
    return all.filter((e) => isCut(e) || isOutside(e)).map((e) => e.textContent.trim());
}"""


def test_no_text_of_the_strip_is_cut(browsers, address, service, monkeypatch) -> None:
    async def find_wide_bounds(_: Analyst, __: Mission, revision: int) -> AnalysisFound:
        return AnalysisFound(revision=revision, analysis=WIDE)

    monkeypatch.setattr(Analyst, "analyse_revision", find_wide_bounds)
    ann = browsers.person(address)
    script = SCRIPT.with_name("protocol_3.txt").read_text(encoding="utf-8")
    ann.open(f"/missions/{service.imported(script)}")
    bounds = ann.page.locator("argo-totals .bounds")
    for language, label in (("en", "All executions:"), ("de", "Alle Abläufe:")):
        ann.page.locator("argo-settings select").evaluate(
            "(select, to) => { select.value = to; select.dispatchEvent(new Event('change')) }",
            language,
        )
        expect(bounds).to_contain_text(label)
        expect(bounds.locator("button")).to_have_count(2)
        for width in WIDTHS:
            ann.page.set_viewport_size({"width": width, "height": 850})
            assert ann.evaluate(CUT_TEXTS) == [], f"{language}, {width} px"


POSE = json.loads('{"x": 3.05, "y": 1.55, "z": 0.0, "yaw": 0.0}')


@pytest.mark.long
def test_the_focus_is_never_lost(ann) -> None:
    """If the focused element disappears, the focus moves to one beside it."""
    focused = """() => {
        let at = document.activeElement;
        while (at?.shadowRoot?.activeElement) at = at.shadowRoot.activeElement;
        return at?.getAttribute("aria-label") ?? at?.textContent.trim() ?? "";
    }"""

    def expect_focus(label: str) -> None:
        ann.wait_until(lambda: label in ann.evaluate(focused), f"the focus is on {label}")

    ann.focus(ann.button("New mission"))
    ann.key("Enter")
    expect(ann.page.get_by_role("tree")).to_be_focused()
    name = ann.page.locator("argo-topbar button.name")
    ann.focus(name)
    ann.key("Enter")
    ann.type("Rounds")
    ann.key("Enter")
    expect(name).to_have_text("Rounds")
    expect(name).to_be_focused()
    ann.focus(ann.page.get_by_role("button", name="Display settings"))
    ann.key("Enter", "Tab", "Escape")
    expect_focus("Display settings")
    ann.focus(ann.page.get_by_role("button", name="Mission: copy"))
    ann.key("Enter", "Tab", "Escape")
    expect(ann.page.locator("argo-mission-menu [popover]")).to_be_hidden()
    expect_focus("Mission: copy")
    ann.focus(ann.page.get_by_role("tree"))
    for _ in range(2):
        ann.key("Control+v")  # nothing has been copied that could be pasted
        expect(ann.page.locator("argo-notices article")).to_have_count(1)
        ann.focus(ann.button("Dismiss"))
        ann.key("Enter")
        expect(ann.page.locator("argo-notices article")).to_have_count(0)
        ann.focus(ann.page.get_by_role("tree"))
