"""Documents that the tests make: workbooks, text documents and PDF files, as bytes."""

from collections.abc import Callable, Sequence
from io import BytesIO
from typing import Any

from docx import Document as WordDocument
from docx.oxml import parse_xml
from docx.oxml.ns import nsdecls
from openpyxl import Workbook
from openpyxl.comments import Comment
from openpyxl.styles import Font
from reportlab.lib import colors
from reportlab.lib.pagesizes import A4
from reportlab.lib.styles import getSampleStyleSheet
from reportlab.pdfgen.canvas import Canvas
from reportlab.platypus import SimpleDocTemplate, Table, TableStyle

ROUND = (
    ("CP", "Instrument", "Floor", "Normal", "Unit", "Reading", "Remarks"),
    (1, "Pressure gauge 1", 1, "3 - 7", "bar", None, None),
    (2, "Liquid level gauge 1", 1, "20 - 80", "%", None, None),
    (5, "Valve R12", 2, "closed", "°", None, None),
)
"""a sheet that agrees with the site"""
STYLE = getSampleStyleSheet()["BodyText"]


def workbook(
    rows: Sequence[Sequence[Any]] = ROUND, change: Callable[[Workbook], None] = lambda _: None
) -> bytes:
    """Return a workbook with one sheet, `Round`."""
    book = Workbook()
    sheet = book.active
    assert sheet is not None
    sheet.title = "Round"
    for row in rows:
        sheet.append(list(row))
    change(book)
    stream = BytesIO()
    book.save(stream)
    return stream.getvalue()


def word(fill: Callable[[Any], None]) -> bytes:
    """Return a text document."""
    document = WordDocument()
    fill(document)
    stream = BytesIO()
    document.save(stream)
    return stream.getvalue()


def element(xml: str) -> Any:
    """Return an element of a text document; `w:` are its own names."""
    start, _, rest = xml.partition(" ") if " " in xml.split(">")[0] else (xml.split(">")[0], "", "")
    if rest:
        return parse_xml(f"{start} {nsdecls('w')} {rest}")
    return parse_xml(f"{start} {nsdecls('w')}{xml[len(start) :]}")


def pdf(draw: Callable[[Canvas], None], **options: Any) -> bytes:
    """Return a PDF file that is drawn on a canvas."""
    stream = BytesIO()
    canvas = Canvas(stream, pagesize=A4, invariant=1, **options)
    draw(canvas)
    canvas.save()
    return stream.getvalue()


def pdf_table(rows: Sequence[Sequence[str]], spans: Sequence[tuple[int, int]] = ()) -> bytes:
    """Return a PDF file with a table drawn by lines; `spans` are rows of which the first cell goes
    over all columns, with the number of columns."""
    table = Table([list(row) for row in rows])
    style: list[tuple[Any, ...]] = [("GRID", (0, 0), (-1, -1), 0.5, colors.black)]
    style += [("SPAN", (0, row), (width - 1, row)) for row, width in spans]
    table.setStyle(TableStyle(style))
    stream = BytesIO()
    SimpleDocTemplate(stream, invariant=1).build([table])
    return stream.getvalue()


def write_columns(canvas: Canvas, y: float, cells: Sequence[str]) -> None:
    """Write cells in one line, each in its column."""
    for x, text in zip((50, 100, 260, 340, 420), cells, strict=False):
        canvas.drawString(x, y, text)


def furnish(book: Workbook) -> None:
    """Give a workbook what a reader has to look at: merged and hidden cells, formulas, comments."""
    sheet = book.active
    assert sheet is not None
    sheet.merge_cells("E2:E3")
    sheet.row_dimensions[4].hidden = True
    sheet.column_dimensions["G"].hidden = True
    sheet["H2"] = "=A2*2"
    sheet["B3"].font = Font(strike=True)
    sheet["B2"].comment = Comment("later", "a person")
    book.create_sheet("Legend").append(["PG", "pressure gauge"])


def fill_with_all(document: Any) -> None:
    """Give a text document lists, tables, changes, a comment and a footer."""
    document.sections[0].footer.paragraphs[0].text = "Form 7"
    document.add_paragraph("Check #1.", style="List Number")
    document.add_paragraph("Check #2.", style="List Bullet").add_run("twice").font.strike = True
    document.add_comment(document.add_paragraph("Check #3.").runs, text="?", author="a")
    change = '<w:del w:id="1" w:author="a"><w:r><w:delText>R9</w:delText></w:r></w:del>'
    document.add_paragraph("Check R12.")._p.append(element(change))
    table = document.add_table(rows=3, cols=3)
    table.cell(0, 0).merge(table.cell(0, 1))
    table.cell(1, 2).merge(table.cell(2, 2)).text = "bar"


def draw_columns(canvas: Canvas) -> None:
    """Draw two pages with a header, and two columns of text."""
    for page in (1, 2):
        canvas.drawString(50, 815, f"Round, page {page} of 2")
        for x in (50, 330):
            for i in range(4):
                canvas.drawString(x, 700 - 14 * i, f"{i}. Read pressure gauge {i} and then R{i}")
        canvas.showPage()
