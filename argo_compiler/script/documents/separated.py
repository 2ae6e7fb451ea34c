"""Files of separated values (CSV): commas, semicolons or tabs, with quoted cells."""

import csv
import re
from collections import Counter
from collections.abc import Iterator

from argo_compiler.base.errors import Invalid
from argo_compiler.script.documents.document import Document, DocumentLine
from argo_compiler.script.documents.grid import GridCell, GridRow, grid_lines, paragraphs_of

SUFFIXES = (".csv", ".tsv")
_CUTS = (";", "\t", ",", "|")
_NO_CUT = "\x1f"
"""of a file whose lines are sentences with commas"""
_EVEN = 0.5
"""share of the records that have the same number of cells"""
_NAMED_CUT = re.compile(r"sep=(.)\r?\n", re.IGNORECASE)
"""first line that spreadsheet programs understand"""
_COMMENT = re.compile(r"\s*(?:#(?!\d)|//)\s*(\S.*)")
_LONGEST_CELL = 100_000
"""characters"""
_MOST_SAMPLED = 200
"""records by which the sign between the cells is found"""

Record = tuple[int, int, list[str]]
"""numbers of the first and the last line, and the cells"""


def read_separated(text: str, name: str) -> Document:
    """Return the document in the text of a file of separated values.

    Raises:
        Invalid: A quotation mark is not closed, or a cell is far too long.
    """
    text = text.removeprefix("\ufeff")
    named = _NAMED_CUT.match(text)
    skipped = 0
    if named is not None:
        text, skipped = text[named.end() :], 1
    cut = named[1] if named is not None else _cut_of(text, name)
    lines: list[DocumentLine] = []
    group: list[GridRow] = []
    table = 0

    def end_table() -> None:
        nonlocal table
        if group:
            table += 1
            lines.extend(grid_lines(group, table))
            group.clear()

    for first, last, cells in _records(text, cut, name):
        place = (
            f"line {first + skipped}"
            if first == last
            else f"lines {first + skipped} to {last + skipped}"
        )
        said = [cell for cell in cells if cell.strip()]
        begun = said and _COMMENT.fullmatch(cells[0]) is not None
        comment = _COMMENT.fullmatch(cut.join(cells).strip(f" {cut}")) if begun else None
        if comment is not None and not group:
            lines.append(DocumentLine(comment[1], place, aside="a comment"))
        elif not said:
            end_table()
            lines.append(DocumentLine())
        else:
            group.append(
                GridRow(
                    tuple(
                        GridCell(paragraphs_of(cell), f"{place}, column {i}")
                        for i, cell in enumerate(cells, start=1)
                    ),
                    place,
                )
            )
    end_table()
    return Document(tuple(lines))


def _cut_of(text: str, name: str) -> str:
    """Return the sign that cuts most records into the same number of cells."""

    def evenness(cut: str) -> tuple[float, int]:
        counts: Counter[int] = Counter()
        for _, _, cells in _records(text, cut, name, strict=False):
            if any(cell.strip() for cell in cells):
                counts[len(cells)] += 1
            if counts.total() >= _MOST_SAMPLED:
                break
        several = [(n, count) for n, count in counts.items() if n > 1]
        if not several:
            return 0.0, 0
        columns, count = max(several, key=lambda found: (found[1], found[0]))
        return count / counts.total(), columns

    best = max(_CUTS, key=evenness)
    return best if evenness(best)[0] >= _EVEN else _NO_CUT


def _records(text: str, cut: str, name: str, strict: bool = True) -> Iterator[Record]:
    csv.field_size_limit(_LONGEST_CELL)
    reader = csv.reader(text.splitlines(keepends=True), delimiter=cut, strict=strict)
    first = 1
    while True:
        try:
            cells = next(reader)
        except StopIteration:
            return
        except csv.Error as error:
            if not strict:
                return
            problem = (
                "a quotation mark is not closed, or has text behind it"
                if "limit" not in str(error)
                else f"a cell has more than {_LONGEST_CELL} characters"
            )
            raise Invalid(f"{name}, line {first}: {problem}; correct this line") from None
        yield first, reader.line_num, cells
        first = reader.line_num + 1
