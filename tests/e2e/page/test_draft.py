"""Drafts of scripts in the page: two columns, decisions at each line, keyboard only."""

import re

import pytest
from playwright.sync_api import expect

from tests.argo_compiler.script.documents_made import pdf, pdf_table, word, workbook
from tests.argo_planner.service.served import ALL, Served
from tests.e2e.page.person import Person, Proxy
from tests.e2e.page.test_access import require_accessible

SCRIPT = """Hi Lena,
Start in starting area 1.
I'd like to have valve R25.
Please keep it under 15 minutes.
Should it check R18 too?
Photograph pump 3.
Check checkpoint 5.
End in starting area 1.
"""


def upload(service: Served, script: str = SCRIPT) -> str:
    """Import a script with lines that are left, and return the id of its draft."""
    answer = service.client.post("/api/imports?filename=round.txt", content=script)
    assert answer.status_code == 202, answer.text
    id: str = answer.json()["id"]
    return id


ROWS = [
    ["CP", "Instrument", "Floor", "Normal", "Unit", "Reading", "Remarks"],
    ["1", "Pressure gauge 1", "1", "3 - 7", "bar", "", ""],
    ["5", "Valve R12", "2", "closed", "", "", "behind the pump"],
]
"""a sheet with a row that is asked about"""


def word_table(document) -> None:
    table = document.add_table(rows=0, cols=len(ROWS[0]))
    for row in ROWS:
        for cell, text in zip(table.add_row().cells, row, strict=True):
            cell.text = text


def scan(canvas) -> None:
    canvas.drawInlineImage("docs/images/planner-draft.png", 0, 0, 400, 300)


def choose_file(person: Person, name: str, content: bytes) -> None:
    """Choose a file in the list of missions."""
    file = {"name": name, "mimeType": "application/octet-stream", "buffer": content}
    person.page.locator("argo-import input[type=file]").set_input_files(file)


def line(person: Person, label: int | str) -> object:
    return person.page.locator(f"argo-draft [data-label='{label}']")


def expect_state(person: Person, label: int | str, state: str) -> None:
    expect(line(person, label)).to_have_attribute("data-state", state)


def expect_saved(person: Person, text: str = "Saved") -> None:
    expect(person.page.locator("#saved")).to_have_text(text)


@pytest.fixture
def draft(service: Served, shared_person: Person) -> Person:
    """Return a person at a new draft."""
    shared_person.go(f"/drafts/{upload(service)}")
    expect(line(shared_person, 3)).to_be_focused()
    return shared_person


def test_an_upload_becomes_a_mission_by_keyboard_alone(ann: Person) -> None:
    """From the file to the mission: each line that is left takes one key, or one and its words."""
    file = {"name": "round.txt", "mimeType": "text/plain", "buffer": SCRIPT.encode()}
    ann.page.locator("argo-import input[type=file]").set_input_files(file)
    expect(ann.page.locator("#left")).to_have_text("2 lines to confirm, 2 lines to answer")
    expect(line(ann, 3)).to_be_focused()
    expect(line(ann, 3)).to_contain_text("Check checkpoint 4.")
    expect(ann.page.locator("#plan")).to_be_disabled()
    ann.inputs = 0
    ann.key("c")
    expect(line(ann, 4)).to_be_focused()
    ann.key("c", "1", "e")
    expect(ann.page.locator("argo-draft form input")).to_be_focused()
    ann.type("Check checkpoint 6.")
    ann.key("Enter")
    expect(ann.page.locator("#left")).to_have_text("nothing left")
    expect_state(ann, 6, "understood")
    expect_saved(ann)
    expect(line(ann, 7)).to_contain_text("Check checkpoint #5")  # the step of the mission
    ann.key("Control+Enter")
    expect(ann.page.get_by_role("treeitem")).to_have_count(6)
    assert ann.inputs == 6 + len("Check checkpoint 6.")
    named = ann.page.get_by_role("treeitem").all_inner_texts()
    assert [number for text in named for number in re.findall(r"\(#(\d+)\)", text)] == [
        *("4", "14", "6", "5")
    ]
    ann.go("")
    expect(ann.page.locator("#drafts")).to_have_count(0)


def test_decisions_survive_a_reload(draft: Person) -> None:
    """Also those that the service has not answered when the page is closed."""
    draft.key("c")
    draft.page.reload()
    expect_state(draft, 3, "understood")
    expect(line(draft, 3)).to_contain_text("confirmed")
    expect_saved(draft)
    expect(draft.page.locator("#left")).to_have_text("1 line to confirm, 2 lines to answer")
    expect(line(draft, 4)).to_be_focused()


def test_a_text_that_is_not_understood_stays_in_its_field(draft: Person) -> None:
    """With the message beside it, while the person goes on with the next line."""
    draft.click(line(draft, 6).locator("button.say"))
    field = draft.page.locator("argo-draft form input")
    expect(field).to_have_value("Photograph pump 3")
    draft.key("Escape")
    expect(field).to_have_count(0)
    expect(line(draft, 6)).to_be_focused()
    draft.key("e", "Control+a", "Delete", "Enter")
    expect(field).to_be_focused()  # no empty sentence is sent
    draft.type("Chek the zorg.")
    draft.key("Enter")
    expect(line(draft, 3)).to_be_focused()
    expect(field).to_have_value("Chek the zorg.")
    expect(line(draft, 6).get_by_text("Argo does not understand")).to_have_count(1)
    expect_state(draft, 6, "open")
    expect(line(draft, 3)).to_be_focused()
    draft.page.reload()
    expect(line(draft, 3)).to_be_focused()
    draft.key("Shift+N", "e")
    expect(field).to_be_focused()
    expect(field).to_have_value("Chek the zorg.")
    draft.key("Escape")
    expect(field).to_have_count(0)
    expect(line(draft, 6)).to_contain_text("Chek the zorg.")
    draft.key("u")
    expect(line(draft, 6)).to_contain_text("`Photograph`")


@pytest.mark.long
def test_the_last_line_is_said_again_until_it_is_understood(draft: Person) -> None:
    draft.key("c", "c", "1", "e")
    draft.type("Chek the zorg.")
    draft.key("Enter")
    field = draft.page.locator("argo-draft form input")
    expect(line(draft, 6).get_by_text("Argo does not understand")).to_be_visible()
    expect(field).to_be_focused()
    expect(field).to_have_value("Chek the zorg.")
    draft.key("Control+a")
    draft.type("Check checkpoint 6.")
    draft.key("Enter")
    expect(draft.page.locator("#plan")).to_be_focused()
    expect(field).to_have_count(0)


@pytest.mark.long
def test_fields_of_several_lines_keep_their_texts(draft: Person) -> None:
    draft.key("e")
    draft.type("Read")
    draft.click(line(draft, 6).locator("button.say"))
    draft.type("Check checkpoint 6.")
    expect(line(draft, 3).locator("input")).to_have_value("Read")
    draft.key("Enter")
    expect_state(draft, 6, "understood")
    expect(line(draft, 3)).to_be_focused()
    expect(line(draft, 3).locator("input")).to_have_value("Read")


def test_a_note_stands_below_the_part_of_the_line_that_it_is_about(service, shared_person) -> None:
    text = "Start in starting area 1.\nCheck R12 tomorrow. Photograph the pump.\n"
    shared_person.go(f"/drafts/{upload(service, text)}")
    expect(line(shared_person, "2.1")).to_contain_text("`tomorrow` has no effect")
    expect(line(shared_person, "2.2")).to_be_focused()
    expect(line(shared_person, "2.2")).not_to_contain_text("has no effect")


def test_all_proposals_are_confirmed_at_once_and_decisions_undone(draft: Person) -> None:
    draft.key("Shift+C")
    expect(draft.page.locator("#left")).to_have_text("2 lines to answer")
    expect_saved(draft)
    draft.key("Control+z")
    expect(draft.page.locator("#left")).to_have_text("2 lines to confirm, 2 lines to answer")
    expect(line(draft, 3)).to_be_focused()
    draft.key("x")
    expect_state(draft, 3, "set aside")
    draft.key("ArrowUp")
    expect(line(draft, 3)).to_be_focused()
    draft.key("u")
    expect_state(draft, 3, "proposed")


def test_the_lines_are_no_trap_for_the_keyboard(draft: Person) -> None:
    """Tab leads through the buttons of one line only, and then out of the lines."""
    draft.key("n")
    expect(line(draft, 4)).to_be_focused()
    draft.key("Shift+N", "End")
    expect(line(draft, 8)).to_be_focused()
    draft.key("Home")
    expect(line(draft, 1)).to_be_focused()
    inside = "() => document.activeElement?.shadowRoot?.activeElement?.shadowRoot?.activeElement"
    for _ in range(8):
        draft.key("Tab")
        if not draft.evaluate(f"{inside}?.closest('[role=grid]') !== null"):
            break
    else:
        pytest.fail("eight times Tab do not leave the lines")


def test_lines_are_named_for_screen_readers(draft: Person) -> None:
    """State, words and meaning of a line are in its name, and each decision is announced."""
    expect(line(draft, 3)).to_have_accessible_name(
        "Line 3. proposed. I'd like to have valve R25. What it becomes: Check checkpoint 4."
    )
    draft.key("c")
    expect(draft.page.locator("argo-draft [role=status]").last).to_have_text(
        "Line 3 is confirmed. 3 left."
    )


def test_a_change_by_somebody_else_is_not_overwritten(service: Served, draft: Person) -> None:
    id = draft.page.url.rpartition("/")[2]
    acts = {"acts": [{"kind": "set_aside", "labels": ["3"]}]}
    at = f"/api/drafts/{id}/acts"
    assert service.client.post(at, json=acts, headers={"if-match": "*"}).status_code == 200
    draft.key("c")
    expect(draft.page.locator("argo-notices")).to_contain_text("Somebody else was faster")
    expect(draft.page.locator("argo-notices")).to_contain_text("Line 3: confirm")
    expect_state(draft, 3, "set aside")


@pytest.mark.long
def test_two_people_see_the_decisions_of_each_other(
    service: Served, draft: Person, browsers
) -> None:
    """While they do nothing; the line on which one works stays where it is."""
    bert = browsers.person(f"http://{service.address}/?token={ALL}", "bert", locale="de-DE")
    bert.open(draft.page.url.partition("#")[2])
    expect(line(bert, 3)).to_be_focused()
    bert.key("n", "n", "n", "e")
    bert.type("Photo")
    draft.key("c")
    expect_state(bert, 3, "understood")
    expect(bert.page.locator("argo-notices")).to_contain_text("über Zeile 3 entschieden")
    expect(bert.page.locator("argo-draft form input")).to_be_focused()
    expect(bert.page.locator("argo-draft form input")).to_have_value("Photo")
    bert.key("Escape", "x")
    expect_state(draft, 6, "set aside")
    draft.key("c", "1")
    expect(draft.page.locator("#plan")).to_be_enabled()
    draft.key("Control+Enter")
    expect(draft.page.get_by_role("treeitem")).to_have_count(5)
    expect(bert.page.locator("argo-home")).to_be_visible()
    expect(bert.page.locator("argo-notices")).to_contain_text("eine Mission gemacht")


@pytest.mark.long
def test_lines_that_name_nothing_are_listed_and_set_aside_together(service, shared_person) -> None:
    ann = shared_person
    named = "Photograph the pump\nCheck the zorg 7\nWave to the camera\nDo not hurry\n"
    script = f"Start in starting area 1.\n{named}Check checkpoint 5.\n"
    ann.go(f"/drafts/{upload(service, script)}")
    button = ann.page.locator("#set-aside-idle")
    expect(button).to_have_text(re.compile("Set aside 2 that name nothing"))
    expect(line(ann, 2)).to_be_focused()
    ann.key("Shift+X")
    listed = ann.page.locator("argo-draft dialog li")
    expect(listed).to_have_text(["Line 2: Photograph the pump", "Line 4: Wave to the camera"])
    ann.key("Escape")
    expect(listed).to_have_count(0)
    expect(line(ann, 2)).to_be_focused()
    expect_state(ann, 2, "open")
    ann.key("Shift+X")
    expect(ann.page.get_by_role("button", name="Set 2 lines aside")).to_be_focused()
    ann.key("Enter")
    expect_state(ann, 2, "set aside")
    expect_state(ann, 4, "set aside")
    expect_state(ann, 3, "open")
    expect(line(ann, 3)).to_be_focused()
    expect(button).to_have_count(0)
    expect_saved(ann)
    ann.key("Control+z")
    expect_state(ann, 2, "open")
    expect_state(ann, 4, "open")


def test_words_for_people_are_struck_out_as_a_whole(service, shared_person) -> None:
    sheet = "Tag | Name | Limit | Action\n1 | Pressure gauge 1 | 3 - 7 | alarm operator\n"
    shared_person.go(f"/drafts/{upload(service, sheet)}")
    expect(line(shared_person, 2).locator("mark")).to_have_text(["alarm operator"])
    expect(line(shared_person, 2)).to_contain_text("Not used: alarm operator")


def test_the_choice_of_a_file_is_one_tab_stop(shared_person: Person) -> None:
    page = shared_person.page
    opened: list[object] = []

    def note(dialog: object) -> None:
        opened.append(dialog)

    # The browser learns of the handler only after a moment: what is opened at once, no test sees.
    page.on("filechooser", note)
    button = shared_person.button("Choose a file…")
    shared_person.focus(button)
    shared_person.key("Tab")
    expect(button).not_to_be_focused()
    expect(page.locator("argo-import :focus")).to_have_count(0)
    shared_person.focus(button)
    page.wait_for_timeout(300)
    shared_person.key("Enter")
    shared_person.wait_until(lambda: opened, "a dialog to choose a file is opened")
    page.remove_listener("filechooser", note)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "make", "place"),
    [
        ("round.xlsx", lambda: workbook(ROWS), "A3:G3"),
        ("round.docx", lambda: word(word_table), "table 1, row 3"),
        ("round.pdf", lambda: pdf_table(ROWS), "page 1, row 2"),
        ("round.csv", lambda: "\n".join(map(",".join, ROWS)).encode(), "line 3"),
    ],
)
def test_documents_become_missions(shared_person: Person, name: str, make, place: str) -> None:
    """Their lines show the cells or pages that they are from."""
    ann = shared_person
    choose_file(ann, name, make())
    row = ann.page.locator("argo-draft .line.open")
    expect(row).to_be_focused()
    expect(row.locator(".place")).to_have_text(place)
    expect(row.get_by_role("button").nth(1)).to_have_text(re.compile("Check checkpoint 5."))
    ann.key("2")
    expect_saved(ann)
    ann.page.locator("#start-area").select_option("1")
    expect(ann.page.locator("#plan")).to_be_enabled()
    ann.key("Control+Enter")
    expect(ann.page.get_by_role("treeitem")).to_have_count(3)


@pytest.mark.parametrize(
    ("name", "make", "words"),
    [
        ("photo.png", lambda: b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "a picture"),
        ("scan.pdf", lambda: pdf(scan), "without text"),
        ("half.docx", lambda: word(word_table)[:700], "damaged"),
        ("half.xlsx", lambda: workbook(ROWS)[:-300], "damaged"),
        ("blank.xlsx", lambda: workbook([]), "without text"),
        ("old.doc", lambda: b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + bytes(600), "old Office"),
        ("empty.txt", lambda: b" \n", "is empty"),
    ],
)
def test_a_wrong_file_gets_one_message(shared_person: Person, name: str, make, words: str) -> None:
    choose_file(shared_person, name, make())
    expect_one_message(shared_person, name, words)


def test_a_file_that_is_too_large_gets_one_message(shared_person: Person) -> None:
    """It is made in the page, as a large one takes long from the test to the browser."""
    shared_person.page.locator("argo-import input[type=file]").evaluate(
        """input => {
            const files = new DataTransfer();
            files.items.add(new File([new Uint8Array(34_000_000).fill(32)], "large.txt"));
            input.files = files.files;
            input.dispatchEvent(new Event("change", { bubbles: true }));
        }"""
    )
    expect_one_message(shared_person, "large.txt", "larger than")


def expect_one_message(person: Person, name: str, words: str) -> None:
    """Expect one message about a file, and close it."""
    notice = person.page.locator("argo-notices article.bad")
    expect(notice).to_contain_text(words)
    expect(notice).to_have_count(1)
    expect(notice).to_contain_text(name)
    person.click(notice.get_by_role("button"))
    expect(person.page.locator("argo-home")).to_be_visible()


@pytest.mark.long
def test_decisions_without_a_connection_are_sent_later(service: Served, browsers) -> None:
    id = upload(service)
    with Proxy(service.address) as proxy:
        ann = browsers.person(f"http://{proxy.address}/?token={ALL}")
        ann.open(f"/drafts/{id}")
        expect(line(ann, 3)).to_be_focused()
        proxy.cut()
        line(ann, 3).press("c")
        expect_state(ann, 3, "understood")
        expect(ann.page.locator("argo-notices")).to_contain_text("doesn't respond")
        expect_saved(ann, "Saving …")
        proxy.restore()
        expect_saved(ann)
        lines = service.client.get(f"/api/drafts/{id}").json()["lines"]
        assert [one["act"] for one in lines if one["label"] == "3"] == ["confirmed"]
        ann.clear_connection_problems()


@pytest.mark.long
def test_the_draft_is_in_german(service: Served, browsers, address) -> None:
    bert = browsers.person(address, "bert", locale="de-DE")
    bert.open(f"/drafts/{upload(service)}")
    expect(bert.page.locator("#left")).to_have_text("2 Zeilen zu bestätigen, 2 Zeilen zu klären")
    expect(line(bert, 3)).to_be_focused()
    expect(line(bert, 3)).to_contain_text("vorgeschlagen")
    expect(line(bert, 1)).to_contain_text("ohne Wirkung: eine Anrede")
    expect(line(bert, 1).locator("[lang=en]")).to_have_count(0)
    expect(line(bert, 6)).to_contain_text("Argo versteht `Photograph` hier nicht")
    bert.key("c", "c", "x", "x")
    expect(bert.page.locator("#left")).to_have_text("nichts mehr offen")
    expect_saved(bert, "Gespeichert")
    expect(bert.page.locator("#plan")).to_be_enabled()
    bert.key("Control+Enter")
    expect(bert.page.get_by_role("treeitem")).to_have_count(4)


@pytest.mark.long
def test_a_script_without_areas_is_completed_by_choosing_them(service, shared_person) -> None:
    script = "Start: area 1 or 2\nI'd like to have valve R25.\nCheck checkpoint 5.\n"
    shared_person.go(f"/drafts/{upload(service, script)}")
    expect(line(shared_person, 2)).to_be_focused()
    shared_person.key("c")
    expect_saved(shared_person)
    expect(shared_person.page.locator("#plan")).to_be_disabled()
    shared_person.page.locator("#start-area").select_option("1")
    expect(shared_person.page.locator("#plan")).to_be_enabled()


@pytest.mark.long
def test_the_words_of_a_task_light_up(draft: Person) -> None:
    """In the list and in the imported text, by pointer and by keyboard."""
    draft.key("c", "c", "1", "x")
    expect_saved(draft)
    expect(draft.page.locator("#plan")).to_be_enabled()
    draft.key("Control+Enter")
    rows = draft.page.get_by_role("treeitem")
    expect(rows).to_have_count(5)
    draft.click(draft.page.locator("#tab-script"))
    draft.click(draft.page.get_by_role("button", name="Imported text"))
    words = draft.page.locator("argo-imported-script [role=option]")
    expect(words).to_have_text(
        [
            "Start in starting area 1",
            "I'd like to have valve R25.",
            "Should it check R18 too?",
            "Check checkpoint 5",
            "End in starting area 1",
        ]
    )
    rows.nth(1).hover()
    expect(words.nth(1)).to_have_class(re.compile("lit"))
    words.nth(2).hover()
    expect(rows.nth(2)).to_have_class(re.compile("lit"))
    expect(words.nth(1)).not_to_have_class(re.compile("lit"))
    draft.focus(draft.page.locator("argo-imported-script [role=listbox]"))
    draft.key("Home", "ArrowDown")
    expect(rows.nth(1)).to_have_attribute("aria-selected", "true")
    draft.focus(draft.page.get_by_role("tree"))
    draft.key("ArrowDown")
    expect(words.nth(2)).to_have_attribute("aria-selected", "true")


@pytest.mark.long
@pytest.mark.parametrize(("locale", "width"), [("en-GB", 1280), ("de-DE", 320)])
def test_drafts_are_accessible(service: Served, browsers, address, locale, width) -> None:
    ann = browsers.person(address, locale=locale, viewport={"width": width, "height": 800})
    ann.open(f"/drafts/{upload(service)}")
    expect(line(ann, 3)).to_be_focused()
    require_accessible(ann, f"a draft, {locale}, {width} px")
    ann.key("c", "x", "e")
    require_accessible(ann, f"a draft that is decided on, {locale}, {width} px")
    body = ann.page.locator("argo-draft")
    assert body.evaluate("view => view.scrollWidth <= view.clientWidth"), "it scrolls sideways"
