"""The frame of the page: list of missions, import, names, deletion, rights, languages, focus."""

import json
import re
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


FAULTY = {
    "version": 4,
    "site": "umad",
    "max_duration": 5.0,
    "tasks": [
        {
            "name": "A",
            "action": "MEASURE",
            "object_id": "4",
            "retries": 200,
            "transitions": [{"target": "B"}],
        },
        {"name": "B", "action": "WAIT", "wait": {"event": "all_clear"}, "velocity": 0.3},
    ],
    "groups": [{"name": "G", "start": "B", "end": "B", "max_repeat_count": 1, "every": 60.0}],
    "reactions": [
        {"event": "gas_leak", "response": "safe_area", "pose": {"x": 3.05, "y": 1.55, "z": 0.0},
         "until": "all_clear"},
    ],
}  # fmt: skip
ENGLISH = re.compile(
    r"\b(the|has|have|is|are|of|not|leads?|give|remove|choose|without|which|its?|gas_leak|MEASURE"
    r"|WAIT|START|[a-z]+_[a-z_]+)\b"
)
"""words of English messages, and identifiers"""


def test_problems_of_a_mission_are_german_on_the_german_page(browsers, address, service) -> None:
    answer = service.client.post("/api/missions", json={"name": "Runde", "mission": FAULTY})
    assert answer.status_code == 201, answer.text
    otto = browsers.person(address, "otto", locale="de-DE")
    otto.open(f"/missions/{answer.json()['id']}")
    problems = otto.page.locator("argo-problems li")
    expect(problems.filter(has_text="Gasleck").first).to_be_attached()
    expect(problems.filter(has_text="Höchstdauer von 5 s").first).to_be_attached()
    texts = problems.all_text_contents()
    assert len(texts) > 5
    assert [text for text in texts if ENGLISH.search(text)] == []


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
    totals = ann.page.locator("argo-totals")
    for language, label in (("en", "Each task once:"), ("de", "Jede Aufgabe einmal:")):
        ann.page.locator("argo-settings select").evaluate(
            "(select, to) => { select.value = to; select.dispatchEvent(new Event('change')) }",
            language,
        )
        expect(totals).to_contain_text(label)
        expect(totals.locator(".totals button")).to_have_count(2)
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


SHOWN = """() => {
    const found = [];
    const walk = (node) => {
        if (node.nodeType === Node.TEXT_NODE && node.data.trim() !== "")
            found.push(node.data.trim());
        if (node.nodeType !== Node.ELEMENT_NODE) return;
        if (node.matches("style, argo-scene, [hidden]")) return;
        if (node.matches("input, select, textarea")) found.push([node.value, node.checked]);
        if (node.matches("details, [aria-expanded]")) found.push([node.open, node.ariaExpanded]);
        for (const part of (node.shadowRoot ?? node).childNodes) walk(part);
    };
    walk(document.querySelector("argo-app"));
    return found;
}"""
"""all texts and values that the page shows, but for the scene"""


@pytest.mark.long
def test_a_mission_looks_the_same_after_another_one(browsers, address, service) -> None:
    """Typed settings, folded groups and the camera of one mission are not those of the next."""
    text = "Start in starting area 1.\nPatrol floor 1 twice.\nCheck #9.\n"
    first, second = service.imported(text), service.imported(text.replace("#9", "#12"))

    def look(person) -> tuple[list[str], ...]:
        person.wait_for_scene()
        expect(person.page.locator("#total-time")).to_be_visible()
        expect(person.page.locator("argo-totals .totals button")).to_have_count(2)
        found = []
        for panel in ("properties", "script", "route", "evaluate", "run", "properties"):
            person.page.locator(f"#tab-{panel}").click()
            person.page.wait_for_timeout(300)
            found.append(person.evaluate(SHOWN))
        return *found, person.evaluate("() => window.argo.camera()")

    bob = browsers.person(address, "bob")
    bob.open(f"/missions/{second}")
    alone = look(bob)
    bob.context.close()
    browsers.people.remove(bob)

    ann = browsers.person(address, "bob")
    ann.open(f"/missions/{first}")
    look(ann)
    page = ann.page
    page.locator("argo-list .fold").first.click()
    page.get_by_role("treeitem").first.click()
    ann.key("v")
    page.locator("#tab-route").click()
    page.get_by_text("Requirements", exact=True).click()
    page.locator("argo-route").get_by_label("Maximum duration").fill("soon")
    page.locator("#tab-run").click()
    page.get_by_text("Run settings").click()
    page.locator("argo-run-start argo-faults select").select_option("gas_leak")
    page.locator("#tab-evaluate").click()
    page.get_by_text("Evaluation settings").click()
    page.locator("argo-evaluate-start argo-faults select").select_option("gas_leak")
    page.locator("argo-evaluate-start select[name=worlds]").select_option("1000")
    page.get_by_label("Floor 2", exact=True).click()
    ann.key("Control+c")
    ann.go(f"/missions/{second}")
    expect(page.locator("argo-list")).to_contain_text("#12")
    assert look(ann) == alone
