"""Rows and cells of a table, in any format, as lines of a document.

Merged cells and headings in two rows are resolved here. What a row means is not decided here.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from unicodedata import normalize

from argo_compiler.script.documents.document import DocumentLine

_MARKED = re.compile(r"\s*(?:\(?[0-9]{1,3}[.)]\s|[-*•–]\s|[a-z][.)]\s)")
_BLANKS = re.compile(r"\s+")
_LABEL = re.compile(r"[^\d:]+:")
_FILL = "____"
"""for an empty cell behind a label with a colon"""
_MOST_PAIRS = 3
_MOST_FORM_ROWS = 15
_LONGEST_LABEL = 5
"""words"""


@dataclass(frozen=True)
class GridCell:
    """A cell of a table."""

    paragraphs: tuple[str, ...] = ()
    place: str = ""
    across: bool = False
    """whether it goes on from the cell at its left"""
    down: bool = False
    """whether it goes on from the cell above"""
    computed: bool = False

    @property
    def text(self) -> str:
        """The content in one line."""
        return " ".join(self.paragraphs)


@dataclass(frozen=True)
class GridRow:
    """A row of a table."""

    cells: tuple[GridCell, ...]
    place: str
    doubt: str = ""
    aside: str = ""


def paragraphs_of(content: str, wrapped: bool = False) -> tuple[str, ...]:
    """Return the paragraphs of a cell in single blanks. `wrapped`: its lines are broken by width,
    so that only a list makes paragraphs."""
    lines = tuple(clean for line in content.split("\n") if (clean := cleaned(line)))
    if wrapped and not (lines and sum(map(_is_marked, lines)) > 1):
        return (" ".join(lines),) if lines else ()
    found: list[str] = []
    for line in lines:
        if wrapped and found and not _is_marked(line) and _is_marked(found[-1]):
            found[-1] += f" {line}"
        else:
            found.append(line)
    return tuple(found)


def cleaned(content: str) -> str:
    """Return the content of a cell in single blanks, without signs that cut a row."""
    return _BLANKS.sub(" ", normalize("NFC", content).replace("|", "/")).strip()


def _is_marked(text: str) -> bool:
    return _MARKED.match(text) is not None


def grid_lines(rows: Sequence[GridRow], table: int) -> Iterator[DocumentLine]:
    """Yield the lines of a table."""
    rows = _without_empty_columns(list(_headed(_filled_down(rows))))
    pairs = _is_form(rows)
    begun = False
    barred = any(map(_has_empty_end, rows))
    for row in rows:
        held = [(i, cell) for i, cell in enumerate(row.cells) if cell.text]
        if not held:
            yield DocumentLine()
            begun = False
        elif len(held) == 1 and (not begun or _is_heading(row, held[0][0])):
            yield from _text(row, held[0][1])
        elif any(len(c.paragraphs) > 1 and any(map(_is_marked, c.paragraphs)) for _, c in held):
            yield from _lists(row, [cell for _, cell in held])
        elif all(_LABEL.fullmatch(cell.text) for _, cell in held):
            said = "     ".join(f"{cell.text} {_FILL}" for _, cell in held)
            yield DocumentLine(said, row.place, doubt=row.doubt, aside=row.aside)
        elif pairs:
            for i in range(0, len(row.cells), 2):
                pair = row.cells[i : i + 2]
                if any(cell.text for cell in pair):
                    places = f"{pair[0].place}:{pair[1].place.rpartition('!')[2]}"
                    place = places if pair[0].place and "," not in pair[0].place else row.place
                    yield _row(replace(row, cells=pair, place=place), table)
        else:
            begun = True
            yield _row(row, table, barred)


def _has_empty_end(row: GridRow) -> bool:
    """Return True if the first or the last cell of a row with several is empty."""
    filled = [bool(cell.text) and not cell.across for cell in row.cells]
    return sum(filled) > 1 and not (filled[0] and filled[-1])


def _row(row: GridRow, table: int, barred: bool = False) -> DocumentLine:
    """Return the line of a row; with bars at both ends, which show where empty cells are, if it is
    `barred` as others of its table, or has such a cell itself."""
    parts: list[str] = []
    cells: list[tuple[int, str]] = []
    at = 0
    for cell in row.cells:
        text = "" if cell.across else cell.text
        cells.append((at, cell.place or row.place))
        parts.append(text)
        at += len(text) + 3
    barred = barred or not parts[0] or not parts[-1]
    text = " | ".join(parts)
    return DocumentLine(
        f"| {text} |" if barred else text,
        row.place,
        table=table,
        cells=tuple((start + 2 * barred, place) for start, place in cells),
        doubt=row.doubt,
        aside=row.aside,
        computed=frozenset(i for i, cell in enumerate(row.cells) if cell.computed),
    )


def _text(row: GridRow, cell: GridCell) -> Iterator[DocumentLine]:
    """Yield the paragraphs of a row with a single cell."""
    for paragraph in cell.paragraphs:
        yield DocumentLine(paragraph, row.place, doubt=row.doubt, aside=row.aside)


def _lists(row: GridRow, cells: Sequence[GridCell]) -> Iterator[DocumentLine]:
    """Yield the cells of a row one after the other, as one of them is a list."""
    for cell in cells:
        yield from _text(row, cell)


def _is_heading(row: GridRow, at: int) -> bool:
    """Return True if the only cell of a row goes over the whole table."""
    return len(row.cells) > 1 and all(c.across for i, c in enumerate(row.cells) if i > at)


def _filled_down(rows: Sequence[GridRow]) -> Iterator[GridRow]:
    """Yield the rows; a cell that is merged with the one above has its content."""
    above: tuple[GridCell, ...] = ()
    for row in rows:
        cells = tuple(
            replace(cell, paragraphs=above[i].paragraphs)
            if cell.down and not cell.text and i < len(above)
            else cell
            for i, cell in enumerate(row.cells)
        )
        above = cells
        yield replace(row, cells=cells)


def _headed(rows: Iterator[GridRow]) -> Iterator[GridRow]:
    """Yield the rows, with headings in two rows as one: `Normal range` over `from` and `to`."""
    above: GridRow | None = None
    for row in rows:
        if above is not None and _goes_on(above, row):
            above = _joined(above, row)
            continue
        if above is not None:
            yield above
        above = row
    if above is not None:
        yield above


def _goes_on(above: GridRow, row: GridRow) -> bool:
    """Return True if a row has the second part of the headings above: each cell goes on from the
    one above, or is one of several below a merged cell."""
    if len(above.cells) != len(row.cells) or not any(cell.down for cell in row.cells):
        return False
    merged = [
        cell.across or (i + 1 < len(above.cells) and above.cells[i + 1].across)
        for i, cell in enumerate(above.cells)
    ]
    below = [cell for cell, over in zip(row.cells, merged, strict=True) if over]
    others = [cell for cell, over in zip(row.cells, merged, strict=True) if not over]
    texts = [cell.text for cell in below if cell.text and not cell.down]
    plain = not any(character.isdigit() for text in texts for character in text)
    return bool(texts) and plain and all(cell.down or not cell.text for cell in others)


def _joined(above: GridRow, row: GridRow) -> GridRow:
    cells: list[GridCell] = []
    over = ""
    for upper, lower in zip(above.cells, row.cells, strict=True):
        over = over if upper.across else upper.text
        texts = [over] if lower.down or not lower.text else [over, lower.text]
        said = " ".join(filter(None, texts))
        cells.append(replace(upper, paragraphs=(said,) if said else (), across=False))
    first, last = above.place.partition(":")[0], row.place.rpartition(":")[2]
    place = f"{first}:{last}" if ":" in above.place else above.place
    return GridRow(tuple(cells), place, above.doubt or row.doubt, above.aside)


def _without_empty_columns(rows: list[GridRow]) -> list[GridRow]:
    """Return the rows without the columns at the end that are empty in all of them."""
    width = max((len(row.cells) for row in rows), default=0)
    filled = max(
        (i + 1 for row in rows for i, c in enumerate(row.cells) if c.text or c.across),
        default=0,
    )
    missing = {n: (GridCell(),) * (width - n) for n in range(width + 1)}
    return [replace(row, cells=(*row.cells, *missing[len(row.cells)])[:filled]) for row in rows]


def _is_form(rows: Sequence[GridRow]) -> bool:
    """Return True if a table is a form with pairs of a label and a value beside each other."""
    rows = [row for row in rows if any(cell.text for cell in row.cells)]
    width = len(rows[0].cells) if rows else 0
    if width not in range(4, 2 * _MOST_PAIRS + 1, 2) or not 2 <= len(rows) <= _MOST_FORM_ROWS:
        return False
    for column in range(0, width, 2):
        labels = [row.cells[column].text for row in rows]
        values = [row.cells[column + 1].text for row in rows]
        named = [label for label in labels if label]
        good = all(
            not any(map(str.isdigit, label)) and len(label.split()) <= _LONGEST_LABEL
            for label in named
        )
        if not good or len({*named}) < len(named) or len(named) < 2:
            return False
        if any(value and not label for label, value in zip(labels, values, strict=True)):
            return False
    return any(row.cells[column + 1].text for row in rows for column in range(0, width, 2))
