"""A document as lines of text, each with its place in the file: a cell, a row, a page."""

from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from argo_compiler.diagnostics import Diagnostic, diagnostic_of


@dataclass(frozen=True)
class DocumentLine:
    """A paragraph, a row of a table, or a blank line."""

    text: str = ""
    """a row has a bar between each two of its cells"""
    place: str = ""
    """such as `Round!A7:F7`, `page 2, row 3` or `paragraph 4`"""
    table: int | None = None
    """number of the table to which a row belongs; None for text"""
    cells: tuple[tuple[int, str], ...] = ()
    """of a row: the offset at which each cell begins, and the place of the cell"""
    part: int = 0
    """number of the sheet, for workbooks"""
    aside: str = ""
    """reason why the line has no effect, such as `the header of the pages`"""
    doubt: str = ""
    """reason why the line may not be meant, such as `this row is hidden`"""
    computed: frozenset[int] = frozenset()
    """indices of the cells that the spreadsheet computes"""


@dataclass(frozen=True)
class DocumentNote:
    """Something in a document that is not among its lines, such as a hidden column."""

    message: str
    place: str


@dataclass(frozen=True)
class Document:
    """The content of a document, in the order in which it is read."""

    lines: tuple[DocumentLine, ...]
    notes: tuple[DocumentNote, ...] = ()
    parts: tuple[str, ...] = field(default=())
    """names of the sheets of a workbook"""

    @cached_property
    def text(self) -> str:
        """The lines as one text."""
        return "\n".join(line.text for line in self.lines)

    def line(self, number: int) -> DocumentLine:
        """Return a line by its number, from 1."""
        return self.lines[number - 1]

    def place_at(self, number: int, column: int | None = None) -> str:
        """Return the place of a line, or of the cell at a column of it; both count from 1."""
        line = self.line(number)
        if column is None or not line.cells:
            return line.place
        starts = [start for start, _ in line.cells]
        return line.cells[max(bisect_right(starts, column - 1) - 1, 0)][1]

    def placed(self, diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        """Return diagnostics about the text with their places in the document."""
        return tuple(self._placed(diagnostic) for diagnostic in diagnostics)

    def _placed(self, diagnostic: Diagnostic) -> Diagnostic:
        span = diagnostic.span
        if span is None or not 1 <= span.line <= len(self.lines):
            return diagnostic
        line = self.line(span.line)
        whole = span.length >= len(line.text.strip())
        place = self.place_at(span.line, None if whole else span.column)
        return diagnostic.model_copy(update={"place": place})

    def note_diagnostics(self) -> tuple[Diagnostic, ...]:
        """Return the notes as warnings."""
        return tuple(
            diagnostic_of("script.document", note.message).model_copy(update={"place": note.place})
            for note in self.notes
        )


def listed_places(places: Sequence[str]) -> str:
    """Return the first and the last of several places, `B3 to D7`; or the only one."""
    return places[0] if len(places) < 2 else f"{places[0]} to {places[-1]}"
