"""Documents of other programs: each line has its place; what may not be meant is asked about."""

from io import BytesIO
from pathlib import Path

import pytest
from docx.enum.style import WD_STYLE_TYPE
from openpyxl.comments import Comment
from openpyxl.styles import Font

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import ArgoError, Unavailable
from argo_compiler.base.limited_process import process_kept
from argo_compiler.diagnostics import to_text
from argo_compiler.script import (
    Document,
    Draft,
    DraftLine,
    LineState,
    decode_document,
    draft_text,
    import_script,
    read_decisions,
    read_document,
)
from tests.argo_compiler.script.conftest import measured_in
from tests.argo_compiler.script.documents_made import (
    ROUND,
    element,
    pdf,
    pdf_table,
    word,
    workbook,
    write_columns,
)


@pytest.fixture(autouse=True, scope="module")
def one_process():
    """Read all documents in the same process, as starting one takes long."""
    with process_kept():
        yield


def read(content: bytes, name: str) -> Document:
    document = decode_document(content, name)
    assert isinstance(document, Document)
    return document


def draft_of(content: bytes, name: str, catalog: Catalog, decisions=()) -> Draft:
    script = decode_document(content, name)
    return import_script(script, catalog, source_name=name, start_area=1, decisions=decisions)


def at(draft: Draft, place: str) -> DraftLine:
    found = [line for line in draft.lines if line.place == place]
    assert found, [line.place for line in draft.lines]
    return found[0]


def texts(document: Document) -> list[str]:
    return [line.text.strip() for line in document.lines if line.text.strip()]


# ---- workbooks


def test_rows_of_a_workbook_become_tasks(catalog: Catalog) -> None:
    draft = draft_of(workbook(), "round.xlsx", catalog)
    assert at(draft, "A3:E3").sentences == ("Check checkpoint 2.",)
    assert measured_in(draft.require_mission()) == ["1", "2", "5"]


def test_a_file_is_read_by_its_path(tmp_path: Path, catalog: Catalog) -> None:
    path = tmp_path / "round.xlsx"
    path.write_bytes(workbook())
    mission = import_script(read_document(path), catalog, start_area=1).require_mission()
    assert measured_in(mission) == ["1", "2", "5"]


def hide_row(book) -> None:
    book.active.row_dimensions[3].hidden = True


def strike_row(book) -> None:
    for cell in book.active[3]:
        cell.font = Font(strike=True)


def comment_row(book) -> None:
    book.active["B3"].comment = Comment("only on Mondays", "a person")


def fill_row(book) -> None:
    book.active["F3"] = 47


def mark_row(book) -> None:
    book.active["F3"] = "N/A"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (hide_row, "hidden"),
        (strike_row, "struck"),
        (comment_row, "only on Mondays"),
        (fill_row, "filled in"),
        (mark_row, "left out"),
    ],
)
def test_a_row_that_may_not_be_meant_is_asked_about(change, words: str, catalog: Catalog) -> None:
    draft = draft_of(workbook(change=change), "round.xlsx", catalog)
    (line,) = draft.left
    assert line.state is LineState.OPEN
    assert line.place.startswith("A3")
    assert words in line.reason
    assert ("Check checkpoint 2.",) in line.choices
    answered = draft_of(
        workbook(change=change), "round.xlsx", catalog, draft.set_aside([line.label])
    )
    assert measured_in(answered.require_mission()) == ["1", "5"]


def test_hidden_columns_and_sheets_are_not_read_but_reported(catalog: Catalog) -> None:
    def change(book) -> None:
        book.active.column_dimensions["H"].hidden = True
        for row in range(2, 5):
            book.active.cell(row, 8, 19)
        hidden = book.create_sheet("Old")
        hidden.append(["Check valve R9."])
        hidden.sheet_state = "hidden"

    draft = draft_of(workbook(change=change), "round.xlsx", catalog)
    told = {d.place for d in draft.diagnostics if d.code == "script.document"}
    assert told == {"H2:H4", "Old"}
    assert measured_in(draft.require_mission()) == ["1", "2", "5"]


def test_merged_headings_and_units_are_read(catalog: Catalog) -> None:
    rows = (
        ("CP", "Instrument", "Normal range", None, "Unit"),
        (None, None, "from", "to", None),
        (1, "Pressure gauge 1", 3, 9, "bar"),
        (3, "Pressure gauge 2", 3, 7, None),
    )

    def change(book) -> None:
        for area in ("A1:A2", "B1:B2", "C1:D1", "E1:E2", "E3:E4"):
            book.active.merge_cells(area)

    draft = draft_of(workbook(rows, change), "round.xlsx", catalog)
    assert at(draft, "A1:E2").state is LineState.SET_ASIDE
    told = [d for d in draft.diagnostics if d.code == "script.other-range"]
    assert ["3 to 9 here" in d.message for d in told] == [True]
    assert told[0].place == "A3:E3"
    assert measured_in(draft.require_mission()) == ["1", "3"]


def test_a_legend_and_a_list_of_tags_explain_and_are_no_tasks(catalog: Catalog) -> None:
    def change(book) -> None:
        tags = book.create_sheet("Tag list")
        tags.append(["Tag", "Checkpoint", "Name"])
        tags.append(["20-PI-1001", 1, "pressure gauge 1"])
        tags.append(["20-HV-1009", 19, "valve R9"])
        tags.append(["20-HV-1012", 5, "valve R12"])

    rows = (("Tag", "Reading"), ("20-PI-1001", None), ("20_HV_1012", None))
    draft = draft_of(workbook(rows, change), "round.xlsx", catalog)
    assert measured_in(draft.require_mission()) == ["1", "5"]


def test_a_tag_that_no_list_explains_is_open(catalog: Catalog) -> None:
    rows = (("Tag", "Normal", "Reading"), ("20-TI-2001", "40-60", None))
    draft = draft_of(workbook(rows), "round.xlsx", catalog)
    assert at(draft, "A2:B2").state is LineState.OPEN


@pytest.mark.parametrize(
    "rows",
    [
        (("Point", "Skip?", "Limits"), ("Pressure gauge 1", "yes", ""), ("Valve R12", "", "")),
        (
            ("CP", "Name", "Active", "Visit"),
            (1, "Pressure gauge 1", "no", "no"),
            (5, "", "yes", ""),
        ),
        (("Point", "Yes", "No"), ("Pressure gauge 1", "x", ""), ("Valve R12", "", "")),
    ],
)
def test_answers_in_a_row_are_asked_about_and_make_no_headings(rows, catalog: Catalog) -> None:
    draft = draft_of(workbook(rows), "round.xlsx", catalog)
    line = next(line for line in draft.lines if line.place.startswith("A2"))
    assert line.state is LineState.OPEN
    assert ("Check checkpoint 1.",) in line.choices


def test_sentences_with_commas_are_no_columns(catalog: Catalog) -> None:
    content = b"Start in starting area 1\nCheck #1\nWait 5 minutes, then check #3\nCheck #5\n"
    mission = import_script(decode_document(content, "steps.csv"), catalog).require_mission()
    assert measured_in(mission) == ["1", "3", "5"]


def test_times_of_day_as_columns_are_asked_about(catalog: Catalog) -> None:
    rows = (("Gauge", "Normal", "06:00", "14:00"), ("Pressure gauge 1", "3 - 7", 4.1, None))
    draft = draft_of(workbook(rows), "log.xlsx", catalog)
    line = draft.left[0]
    assert line.place == "A1:D1"
    assert "C2" in line.reason


# ---- text documents


def test_numbers_and_bullets_of_lists_are_read() -> None:
    def fill(document) -> None:
        document.add_paragraph("Check pressure gauge 1.", style="List Number")
        document.add_paragraph("Check valve R12.", style="List Number")
        document.add_paragraph("Go to step 1 at most once.", style="List Bullet")

    lines = texts(read(word(fill), "round.docx"))
    assert lines[0].startswith("1. Check")
    assert lines[1].startswith("2. Check")
    assert lines[2].startswith("- Go")


def test_corrected_words_count_and_are_reported(catalog: Catalog) -> None:
    def fill(document) -> None:
        paragraph = document.add_paragraph("Check valve ")
        paragraph.add_run("R31").font.strike = True
        paragraph.add_run("R12.")
        other = document.add_paragraph()
        other._p.append(
            element(
                '<w:del w:id="1" w:author="a"><w:r><w:delText>Check #3.</w:delText></w:r></w:del>'
            )
        )
        other._p.append(
            element('<w:ins w:id="2" w:author="a"><w:r><w:t>Check #1.</w:t></w:r></w:ins>')
        )

    draft = draft_of(word(fill), "round.docx", catalog)
    told = [d.message for d in draft.diagnostics if d.code == "script.document"]
    assert [word in text for word, text in zip(("R31", "#3", "#1"), told, strict=True)] == [
        True
    ] * 3
    assert measured_in(draft.require_mission()) == ["5", "1"]


def test_a_struck_paragraph_and_a_commented_one_are_asked_about(catalog: Catalog) -> None:
    def fill(document) -> None:
        document.add_paragraph("Check pressure gauge 1.")
        document.add_paragraph().add_run("Check valve R12.").font.strike = True
        commented = document.add_paragraph("Check valve R7.")
        document.add_comment(commented.runs, text="only if it is dry", author="a", initials="a")

    draft = draft_of(word(fill), "round.docx", catalog)
    assert [line.place for line in draft.left] == ["paragraph 2", "paragraph 3"]
    assert "only if it is dry" in draft.left[1].reason


def test_a_text_box_is_read_once(catalog: Catalog) -> None:
    box = "<w:txbxContent><w:p><w:r><w:t>Check valve R12.</w:t></w:r></w:p></w:txbxContent>"
    mc = 'xmlns:mc="http://schemas.openxmlformats.org/markup-compatibility/2006"'

    def fill(document) -> None:
        document.add_paragraph("Check pressure gauge 1.")._p.append(
            element(
                f"<w:r {mc}><mc:AlternateContent><mc:Choice Requires='x'><w:drawing>{box}"
                f"</w:drawing></mc:Choice><mc:Fallback><w:pict>{box}</w:pict></mc:Fallback>"
                "</mc:AlternateContent></w:r>"
            )
        )

    draft = draft_of(word(fill), "round.docx", catalog)
    assert measured_in(draft.require_mission()) == ["1", "5"]
    assert at(draft, "text box 1").text == "Check valve R12"


def test_rows_of_a_table_in_a_text_document(catalog: Catalog) -> None:
    def fill(document) -> None:
        document.sections[0].footer.paragraphs[0].text = "Form 7, check valve R9"
        table = document.add_table(rows=0, cols=3)
        for row in (
            ("No.", "Check", "Result"),
            ("1", "Pressure gauge 1", "☐ OK ☐ Not OK"),
            ("2", "Valve R12 closed", "☒ OK ☐ Not OK"),
            ("3", "Valve R7 closed", "☐ OK ☐ Not OK"),
        ):
            cells = table.add_row().cells
            for cell, text in zip(cells, row, strict=True):
                cell.text = text
        row = table.rows[3]._tr
        row.get_or_add_trPr().append(element('<w:del w:id="1" w:author="a"/>'))

    draft = draft_of(word(fill), "check.docx", catalog)
    assert at(draft, "table 1, row 2").sentences == ("Check checkpoint 1.",)
    assert "ticked" in at(draft, "table 1, row 3").reason
    assert "deleted" in at(draft, "table 1, row 4").reason
    assert at(draft, "page footer").state is LineState.SET_ASIDE


def test_pairs_of_labels_and_values_are_fields(catalog: Catalog) -> None:
    rows = (
        ("Permit", "none", "Priority", "2"),
        ("Robot starts from", "starting area 2", "Duration", "25 minutes"),
    )

    def fill(document) -> None:
        table = document.add_table(rows=0, cols=4)
        for row in rows:
            for cell, text in zip(table.add_row().cells, row, strict=True):
                cell.text = text
        document.add_paragraph("Check valve R12.")

    content = word(fill)
    draft = import_script(read(content, "order.docx"), catalog)
    draft = import_script(read(content, "order.docx"), catalog, decisions=draft.confirm())
    mission = draft.require_mission()
    assert (mission.start_area, mission.max_duration) == (2, 1500)


# ---- pages


def aligned(canvas) -> None:
    rows = [(str(row[0]), row[1], row[3], row[4], "____") for row in ROUND[1:]]
    for page, part in ((1, rows[:2]), (2, rows[2:])):
        canvas.setFont("Helvetica", 8)
        canvas.drawString(50, 815, "Shift round, check valve R9")
        canvas.drawString(50, 20, f"page {page} of 2")
        canvas.setFont("Helvetica", 10)
        write_columns(canvas, 780, ("CP", "Description", "Normal", "Unit", "Reading"))
        for i, row in enumerate(part, start=1):
            write_columns(canvas, 780 - 16 * i, row)
        canvas.showPage()


def test_a_table_without_lines_over_two_pages(catalog: Catalog) -> None:
    draft = draft_of(pdf(aligned), "round.pdf", catalog)
    assert measured_in(draft.require_mission()) == ["1", "2", "5"]
    assert at(draft, "page 2, head").reason == "the header of the pages"


def test_rows_that_look_alike_at_the_head_of_pages_are_no_page_header() -> None:
    def draw(canvas) -> None:
        for number, name in ((1, "Pressure gauge 1"), (3, "Pressure gauge 2")):
            for i, text in enumerate((f"{number}. {name}", "Check it.", "Wait 1 minute.")):
                canvas.drawString(50, 800 - 14 * i, text)
            canvas.showPage()

    lines = texts(read(pdf(draw), "round.pdf"))
    assert "1. Pressure gauge 1" in lines
    assert "3. Pressure gauge 2" in lines


def test_a_drawn_table_with_headings_over_its_rows(catalog: Catalog) -> None:
    rows = [
        ("CP", "Equipment", "Remarks"),
        ("Ground floor", "", ""),
        ("1", "Pressure gauge 1", ""),
        ("Second floor", "", ""),
        ("5", "Valve R12", "out of service"),
        ("6", "Pressure gauge 3", ""),
    ]
    draft = draft_of(pdf_table(rows, ((1, 3), (3, 3))), "round.pdf", catalog)
    assert at(draft, "page 1, row 4").sentences == ("Do not check checkpoint 5.",)
    done = draft_of(pdf_table(rows, ((1, 3), (3, 3))), "round.pdf", catalog, draft.confirm())
    assert measured_in(done.require_mission()) == ["1", "6"]


def test_columns_of_text_are_read_one_after_the_other() -> None:
    left = ["Check pressure gauge 1 and then", "valve R12, which is on floor 2.", "1. Then #8."]
    right = ["2. Read liquid level gauge 1.", "3. Read liquid level gauge 2.", "Then go home."]

    def draw(canvas) -> None:
        for x, lines in ((50, left), (330, right)):
            for i, text in enumerate(lines):
                canvas.drawString(x, 760 - 14 * i, text)

    lines = texts(read(pdf(draw), "bulletin.pdf"))
    assert lines[0] == "Check pressure gauge 1 and then valve R12, which is on floor 2."
    assert lines[1:] == ["1. Then #8.", *right]


# ---- separated values


@pytest.mark.parametrize(
    "content",
    [
        b"CP;Instrument;Min;Max;Reading\n1;Pressure gauge 1;3,0;7,0;\n5;Valve R12;;;\n",
        b'\xef\xbb\xbfCP,Instrument,Reading\r\n1,"Pressure gauge 1",\r\n5,"Valve\nR12",\r\n',
        b"CP\tInstrument\tReading\n1\tPressure gauge 1\t\n5\tValve R12\t\n",
        "sep=;\r\nCP;Instrument;Reading\r\n1;Pressure gauge 1;\r\n5;Valve R12;\r\n".encode(
            "utf-16"
        ),
        b"# an export; of 2 rows\n#,Instrument,Found\n1,Pressure gauge 1,\n2,Valve R12,\n",
    ],
    ids=["semicolons", "mark and quotes", "tabs", "named sign", "comment"],
)
def test_separated_values(content: bytes, catalog: Catalog) -> None:
    draft = draft_of(content, "round.csv", catalog)
    assert measured_in(draft.require_mission()) == ["1", "5"]


def test_a_step_in_a_cell_of_several_lines(catalog: Catalog) -> None:
    content = b'Step,Instruction,Result\n1,"Check #1.\nIf it is below 3 bar,\ncheck #3 too.",\n'
    draft = draft_of(content + b'2,"Wait 2 minutes, then check #1 again.",\n', "steps.csv", catalog)
    assert measured_in(draft.require_mission()) == ["1", "3", "1"]
    assert {line.place for line in draft.lines} >= {"lines 2 to 4", "line 5"}


# ---- places, decisions and messages


def test_messages_and_drafts_name_places_and_not_lines(catalog: Catalog) -> None:
    draft = draft_of(workbook(change=fill_row), "round.xlsx", catalog)
    shown = to_text(draft.diagnostics, "round.xlsx")
    assert "round.xlsx: A3:F3: error:" in shown
    assert "round.xlsx:3" not in shown
    written = draft_text(draft)
    assert "place: A3:F3" in written
    decided = written.replace("open:", "set aside by hand\nopen:")
    decisions = read_decisions(decided, "round.xlsx.draft")
    again = draft_of(workbook(change=fill_row), "round.xlsx", catalog, decisions)
    assert measured_in(again.require_mission()) == ["1", "5"]


# ---- what is refused


def scan(canvas) -> None:
    from PIL import Image
    from reportlab.lib.utils import ImageReader

    stream = BytesIO()
    Image.new("L", (200, 300), 128).save(stream, "PNG")
    canvas.drawImage(ImageReader(stream), 0, 0, 590, 840)


@pytest.mark.parametrize(
    ("content", "name", "words"),
    [
        (lambda: pdf(scan), "scan.pdf", "picture"),
        (lambda: pdf(aligned, encrypt="secret"), "locked.pdf", "encrypted"),
        (lambda: pdf(aligned)[:700], "half.pdf", "damaged"),
        (lambda: pdf(lambda canvas: canvas.showPage()), "blank.pdf", "without text"),
        (lambda: workbook(()), "blank.xlsx", "without text"),
        (lambda: word(lambda _: None), "blank.docx", "without text"),
        (lambda: b";;\n;;\n", "blank.csv", "no cells with text"),
        (lambda: b'a,"b\nc,d\n', "open.csv", "line 1"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_what_can_not_be_read_is_refused_in_one_line(content, name: str, words: str) -> None:
    with pytest.raises(ArgoError) as refused:
        decode_document(content(), name)
    message = str(refused.value)
    assert words in message
    assert name in message
    assert "\n" not in message


def test_a_missing_extra_is_named_with_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("argo_compiler.script.documents.reading.find_spec", lambda _: None)
    with pytest.raises(Unavailable, match=r"documents.*pip install") as refused:
        decode_document(workbook(), "round.xlsx")
    assert "\n" not in str(refused.value)


def test_hidden_words_are_reported_with_their_place() -> None:
    def fill(document) -> None:
        hidden = document.styles.add_style("Inner", WD_STYLE_TYPE.CHARACTER)
        hidden.font.hidden = True
        document.add_paragraph("Check #1.")
        document.add_paragraph("Check #4").add_run(" twice").font.hidden = True
        document.add_paragraph("Check #5. ").add_run("Not today.", style="Inner")
        table = document.add_table(rows=2, cols=2)
        for cell, text in zip(table._cells, ("Valve", "Remark", "R31", ""), strict=True):
            cell.text = text
        table.cell(1, 1).paragraphs[0].add_run("skip").font.hidden = True

    document = read(word(fill), "round.docx")
    assert [(note.message, note.place) for note in document.notes] == [
        ("`twice` is hidden, and is not read", "paragraph 2"),
        ("`Not today.` is hidden, and is not read", "paragraph 3"),
        ("`skip` is hidden, and is not read", "table 1, row 2, column 2"),
    ]


def test_a_hidden_row_of_a_text_document_is_asked_about(catalog: Catalog) -> None:
    def fill(document) -> None:
        table = document.add_table(rows=3, cols=2)
        texts = ("Point", "Floor", "PG 1", "1", "R12", "2")
        for cell, text in zip(table._cells, texts, strict=True):
            cell.text = text
        table.rows[2]._tr.get_or_add_trPr().append(element('<w:hidden w:val="1"/>'))

    line = draft_of(word(fill), "round.docx", catalog).lines[-1]
    assert (line.state, line.reason) == (LineState.OPEN, "this row is hidden in the document")


def test_rows_of_a_table_have_bars_alike() -> None:
    rows = (
        ("Seq.", "Point", "Normal", "Remark"),
        (10, "PG 1", "3-7", None),
        (20, "R12", None, "x"),
    )
    lines = texts(read(workbook(rows), "round.xlsx"))
    assert [line for line in lines if line] == [
        "| Seq. | Point | Normal | Remark |",
        "| 10 | PG 1 | 3-7 |  |",
        "| 20 | R12 |  | x |",
    ]


def test_the_order_of_rows_in_files_is_asked_about(catalog: Catalog) -> None:
    rows = (("Seq.", "Point", "If abnormal"), (20, "PG 1", None), (10, "R12", "return to dock"))
    separated = "\n".join(",".join(str(cell or "") for cell in row) for row in rows)
    for content, name in ((workbook(rows), "round.xlsx"), (separated.encode(), "round.csv")):
        draft = draft_of(content, name, catalog)
        assert draft.lines[0].reason == "`Seq.` can give another order of the rows"
        assert draft.lines[0].state is LineState.OPEN
        assert draft.lines[0].choices[0][0] == "Check checkpoint 5."
