"""Workbooks of spreadsheet programs (.xlsx): the cells as a person sees them."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import date, datetime, time, timedelta
from io import BytesIO
from typing import TYPE_CHECKING, Any

from argo_compiler.base.errors import Invalid
from argo_compiler.script.documents.document import Document, DocumentLine, DocumentNote
from argo_compiler.script.documents.grid import GridCell, GridRow, grid_lines, paragraphs_of

if TYPE_CHECKING:
    from openpyxl.cell.cell import Cell
    from openpyxl.worksheet.worksheet import Worksheet

_MOST_ROWS = 20_000
_MOST_COLUMNS = 200
_ERROR = re.compile(r"#(?:REF|N/A|NAME\?|VALUE|DIV/0|NUM|NULL)!?")
_PADDED = re.compile(r"0{2,9}")
_QUOTED_PARTS = re.compile(r'"[^"]*"|\\.')
_STRUCK = "this row has words that are struck through"
_HIDDEN = "this row is hidden in the sheet"


@dataclass
class _Sheet:
    """A sheet while it is read."""

    sheet: "Worksheet"
    values: "Worksheet | None"
    """with what formulas have computed; None: the workbook has no formulas"""
    prefix: str
    """before the names of cells; empty in a workbook with one sheet"""
    notes: list[DocumentNote]

    def place(self, first: str, last: str = "") -> str:
        return f"{self.prefix}{first}" + (f":{last}" if last and last != first else "")


def read_workbook(content: bytes, name: str) -> Document:
    """Return the document in a workbook.

    Raises:
        Invalid: It has no cells with content, or far too many.
        Exception: The file is damaged; `openpyxl` raises errors of many types.
    """
    import openpyxl

    book = openpyxl.load_workbook(BytesIO(content), rich_text=True)
    sheets = [s for s in book.worksheets if s.sheet_state == "visible" and _has_content(s)]
    formulas = any(cell.data_type == "f" for sheet in sheets for cell in _cells(sheet))
    notes = [
        DocumentNote("this sheet is hidden, and is not read", sheet.title)
        for sheet in book.worksheets
        if sheet.sheet_state != "visible" and _has_content(sheet)
    ]
    computed = openpyxl.load_workbook(BytesIO(content), data_only=True) if formulas else None
    if computed is not None and not _has_results(sheets, computed):
        message = "the formulas have no results in this file: open it in a spreadsheet program, "
        notes.append(DocumentNote(f"{message}and save it again", sheets[0].title))
    lines: list[DocumentLine] = []
    table = 0
    for part, sheet in enumerate(sheets):
        if sheet.max_row > _MOST_ROWS or sheet.max_column > _MOST_COLUMNS:
            last = sheet.dimensions.split(":")[-1]
            raise Invalid(
                f"{name}: the sheet {sheet.title} has cells as far as {last}; at most {_MOST_ROWS} "
                f"rows and {_MOST_COLUMNS} columns are read: delete what is not needed"
            )
        prefix = f"{sheet.title}!" if len(sheets) > 1 else ""
        values = computed[sheet.title] if computed is not None else None
        reading = _Sheet(sheet, values, prefix, notes)
        if lines:
            lines.append(DocumentLine(part=part))
        if len(sheets) > 1:
            # The title of the whole is in the first sheet; the names of others are headings.
            why = "" if part else "the name of a sheet"
            place = f"name of sheet {sheet.title}"
            lines.append(DocumentLine(f"{sheet.title}:", place, part=part, aside=why))
        for rows in _blocks(reading):
            table += 1
            lines += [_in_part(line, part) for line in grid_lines(rows, table)]
            lines.append(DocumentLine(part=part))
    return Document(tuple(lines), tuple(notes), tuple(sheet.title for sheet in sheets))


def _in_part(line: DocumentLine, part: int) -> DocumentLine:
    return DocumentLine(**{**vars(line), "part": part})


def _cells(sheet: "Worksheet") -> "list[Cell]":
    return [cell for _, cell in sorted(sheet._cells.items())]


def _has_content(sheet: "Worksheet") -> bool:
    return any(cell.value is not None for cell in sheet._cells.values())


def _has_results(sheets: "Sequence[Worksheet]", computed: Any) -> bool:
    """Return True if a program has computed the formulas; the result of one may be empty."""
    return any(
        computed[sheet.title][cell.coordinate].value is not None
        for sheet in sheets
        for cell in _cells(sheet)
        if cell.data_type == "f"
    )


def _blocks(reading: _Sheet) -> Iterator[list[GridRow]]:
    """Yield the rows of a sheet, cut where rows are empty."""
    sheet = reading.sheet
    covered = _merged(sheet)
    hidden = _hidden_columns(sheet)
    by_row: dict[int, list[int]] = {}
    for (row, column), cell in sheet._cells.items():
        if cell.value is not None or cell.comment is not None:
            by_row.setdefault(row, []).append(column)
    for row, column in covered:
        if row in by_row:
            by_row[row].append(column)
        elif covered[row, column][1]:  # goes on from a row above
            by_row[row] = [column]
    _note_hidden_columns(reading, hidden, by_row)
    columns = [
        column
        for column in range(1, max((max(c) for c in by_row.values()), default=0) + 1)
        if column not in hidden
    ]
    group: list[GridRow] = []
    last = 0
    for row in sorted(by_row):
        made = _row(reading, row, columns, covered)
        if not any(cell.text or cell.down for cell in made.cells):
            continue
        if group and row > last + 1:
            yield group
            group = []
        group.append(made)
        last = row
    if group:
        yield group


def _merged(sheet: "Worksheet") -> dict[tuple[int, int], tuple[bool, bool]]:
    """Return the cells that go on from others: whether from the left, and whether from above."""
    found: dict[tuple[int, int], tuple[bool, bool]] = {}
    for area in sheet.merged_cells.ranges:
        rows = range(area.min_row, min(area.max_row, area.min_row + _MOST_ROWS) + 1)
        columns = range(area.min_col, min(area.max_col, area.min_col + _MOST_COLUMNS) + 1)
        for row in rows:
            for column in columns:
                if (row, column) != (area.min_row, area.min_col):
                    found[row, column] = (column > area.min_col, row > area.min_row)
    return found


def _hidden_columns(sheet: "Worksheet") -> set[int]:
    found: set[int] = set()
    for dimension in sheet.column_dimensions.values():
        if dimension.hidden and dimension.min is not None and dimension.max is not None:
            found |= {*range(dimension.min, min(dimension.max, _MOST_COLUMNS) + 1)}
    return found


def _note_hidden_columns(reading: _Sheet, hidden: set[int], by_row: dict[int, list[int]]) -> None:
    from openpyxl.utils import get_column_letter

    for column in sorted(hidden):
        rows = [row for row, columns in by_row.items() if column in columns]
        if rows:
            letter = get_column_letter(column)
            place = reading.place(f"{letter}{min(rows)}", f"{letter}{max(rows)}")
            reading.notes.append(DocumentNote("this column is hidden, and is not read", place))


def _row(
    reading: _Sheet,
    row: int,
    columns: Sequence[int],
    covered: dict[tuple[int, int], tuple[bool, bool]],
) -> GridRow:
    from openpyxl.utils import get_column_letter

    sheet = reading.sheet
    doubt = _HIDDEN if sheet.row_dimensions[row].hidden else ""
    cells: list[GridCell] = []
    for column in columns:
        at = f"{get_column_letter(column)}{row}"
        across, down = covered.get((row, column), (False, False))
        cell = sheet._cells.get((row, column))
        if across or down or cell is None:
            cells.append(GridCell((), reading.place(at), across=across, down=down))
            continue
        text, struck = _text(reading, cell, at)
        if struck and text:
            doubt = doubt or _STRUCK
        if cell.comment is not None and cell.comment.text.strip():
            said = " ".join(cell.comment.text.split())[:200]
            doubt = doubt or f"the comment at {at} is `{said}`"
        cells.append(
            GridCell(paragraphs_of(text), reading.place(at), computed=cell.data_type == "f")
        )
    used = [i for i, cell in enumerate(cells) if cell.text or cell.across or cell.down] or [0, -1]
    first, last = (f"{get_column_letter(columns[i])}{row}" for i in (used[0], used[-1]))
    return GridRow(tuple(cells), reading.place(first, last), doubt)


def _text(reading: _Sheet, cell: "Cell", at: str) -> tuple[str, bool]:
    """Return what a cell shows, and whether all of it is struck through."""
    from openpyxl.cell.rich_text import CellRichText, TextBlock

    value: Any = cell.value
    if cell.data_type == "f":
        value = reading.values[at].value if reading.values is not None else None
    if isinstance(value, CellRichText):
        struck = [isinstance(p, TextBlock) and bool(p.font.strike) for p in value]
        if any(struck) and not all(struck):
            gone = "".join(str(p) for p, s in zip(value, struck, strict=True) if s).strip()
            reading.notes.append(
                DocumentNote(f"`{gone}` is struck through, and is not read", reading.place(at))
            )
            kept = (str(p) for p, s in zip(value, struck, strict=True) if not s)
            return "".join(kept), False
        return str(value), all(struck)
    text = _shown(value, str(cell.number_format or ""))
    if isinstance(value, str) and _ERROR.fullmatch(value):
        reading.notes.append(DocumentNote(f"this formula has an error: {value}", reading.place(at)))
    return text, bool(cell.font is not None and cell.font.strike)


def _shown(value: Any, number_format: str) -> str:
    """Return a value as a person reads it."""
    match value:
        case None:
            return ""
        case bool():
            return "yes" if value else "no"
        case datetime() if value.time() == time() and not re.search("[hHsS]", number_format):
            return value.date().isoformat()
        case datetime():
            return value.strftime("%Y-%m-%d %H:%M")
        case date():
            return value.isoformat()
        case time():
            return value.strftime("%H:%M")
        case timedelta():
            minutes = round(value.total_seconds() / 60)
            return f"{minutes // 60:02}:{minutes % 60:02}"
        case int() | float():
            return _number(value, number_format)
    return str(value)


def _number(value: float, number_format: str) -> str:
    percent = "%" in _QUOTED_PARTS.sub("", number_format)
    shown = value * 100 if percent else value
    plain = f"{shown:.10g}"
    if _PADDED.fullmatch(number_format) and float(value).is_integer() and value >= 0:
        plain = plain.zfill(len(number_format))
    return f"{plain} %" if percent else plain
