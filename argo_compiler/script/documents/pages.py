"""Documents in pages (PDF with text): paragraphs and tables by where their words stand.

Tables that are drawn by lines become rows. Other text becomes lines, in one column or several, and
words far apart in a line keep their distance, as in a sheet whose columns are aligned by blanks.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from io import BytesIO
from typing import Any

from argo_compiler.base.errors import Invalid
from argo_compiler.script.documents.document import Document, DocumentLine
from argo_compiler.script.documents.grid import GridCell, GridRow, grid_lines, paragraphs_of

_MOST_PAGES = 200
_MOST_CHARACTERS = 1_000_000
_PICTURE_SHARE = 0.3
"""of a page, from which a picture on a page without text is the page"""
_MARGIN_SHARE = 0.1
"""of a page, at its head and at its foot, in which text may be the same on all pages"""
_FAR = 2.0
"""heights of a line between the text and a line in the margin of the page"""
_GAP = 1.3
"""heights of letters from which words in one line stand apart"""
_GUTTER = 10.0
"""width in points between columns of text"""
_LONG_LINE = 15
"""average number of characters in a line of a column of text"""
_LONG_PARAGRAPH = 40
"""characters of a line that may go on in the next one with a capital"""
_MARKED = re.compile(r"\(?[0-9]{1,3}[.):]|[-*•–▪●○■□☐☑☒✓]|[a-zA-Z][.)]")
_SENTENCE_END = (".", "!", "?", ":", ";")
_PAGE_NUMBER = re.compile(
    r"\b(?:page|p\.|sheet|seite|s\.|blatt)\s*\d+|\b\d+\s*(?:/|of|von)\s*\d+\s*$|^\W*\d+\W*$",
    re.IGNORECASE,
)


@dataclass(frozen=True)
class _Word:
    text: str
    x0: float
    x1: float
    top: float
    bottom: float
    size: float
    at: int
    """index in the order in which the file has the words"""


@dataclass(frozen=True)
class _Item:
    """A line of text, or a table."""

    words: tuple[_Word, ...]
    table: Any = None

    @property
    def x0(self) -> float:
        return float(self.table.bbox[0]) if self.table else min(w.x0 for w in self.words)

    @property
    def x1(self) -> float:
        return float(self.table.bbox[2]) if self.table else max(w.x1 for w in self.words)

    @property
    def top(self) -> float:
        return float(self.table.bbox[1]) if self.table else min(w.top for w in self.words)

    @property
    def bottom(self) -> float:
        return float(self.table.bbox[3]) if self.table else max(w.bottom for w in self.words)

    @property
    def size(self) -> float:
        return max((w.size for w in self.words), default=0.0)

    @property
    def text(self) -> str:
        return " ".join(w.text for w in self.words)


@dataclass(frozen=True)
class _Page:
    number: int
    width: float
    height: float
    items: tuple[_Item, ...]
    """from top to bottom"""


def read_pages(content: bytes, name: str) -> Document:
    """Return the document in a PDF file.

    Raises:
        Invalid: It is encrypted, is a scan without text, or is too long.
        Exception: The file is damaged; `pdfplumber` raises errors of many types.
    """
    import pdfplumber
    from pdfminer.pdfdocument import PDFEncryptionError, PDFPasswordIncorrect
    from pdfplumber.utils.exceptions import PdfminerException

    try:
        opened = pdfplumber.open(BytesIO(content))
    except PdfminerException as error:
        reason = error.args[0] if error.args else None
        if isinstance(reason, PDFPasswordIncorrect | PDFEncryptionError):
            raise Invalid(
                f"{name} is encrypted: save it without a password, or write its steps as a script"
            ) from None
        raise
    with opened as pdf:
        if len(pdf.pages) > _MOST_PAGES:
            raise Invalid(
                f"{name} has {len(pdf.pages)} pages; at most {_MOST_PAGES} are read: is it the "
                "right file?"
            )
        pages: list[_Page] = []
        count = 0
        for page in pdf.pages:
            count += len(page.chars)
            if count > _MOST_CHARACTERS:
                raise Invalid(
                    f"{name} has more than {_MOST_CHARACTERS} characters: is it the right file?"
                )
            _require_text(page, name)
            pages.append(_page(page))
            page.close()
    return _Reader(pages).document()


def _require_text(page: Any, name: str) -> None:
    """Raise Invalid if a page is only a picture, such as a scan."""
    if any(char["text"].strip() for char in page.chars):
        return
    area = sum(float(i["width"]) * float(i["height"]) for i in page.images)
    if area > _PICTURE_SHARE * float(page.width) * float(page.height):
        raise Invalid(
            f"{name} has a picture without text on page {page.page_number}, such as a scan: write "
            "its steps as a script, or save it with text"
        )


def _page(page: Any) -> _Page:
    tables = [t for t in page.find_tables() if len(t.rows) > 1 or len(t.rows[0].cells) > 1]
    tables = [table for table in tables if len(table.cells) > 1]
    boxes = [table.bbox for table in tables]
    words = [
        _Word(w["text"], w["x0"], w["x1"], w["top"], w["bottom"], w["size"], at)
        for at, w in enumerate(
            page.extract_words(use_text_flow=True, extra_attrs=["size"], keep_blank_chars=False)
        )
        if w["upright"] and not any(_inside(w, box) for box in boxes)
    ]
    items = [*(_Item((), table) for table in tables), *_lines(words)]
    width, height = float(page.width), float(page.height)
    return _Page(page.page_number, width, height, tuple(sorted(items, key=lambda i: i.top)))


def _inside(word: dict[str, Any], box: Sequence[float]) -> bool:
    x, y = (word["x0"] + word["x1"]) / 2, (word["top"] + word["bottom"]) / 2
    return bool(box[0] <= x <= box[2] and box[1] <= y <= box[3])


def _lines(words: Sequence[_Word]) -> Iterator[_Item]:
    """Yield the words by the lines that they stand in."""
    line: list[_Word] = []
    for word in sorted(words, key=lambda w: ((w.top + w.bottom) / 2, w.x0)):
        if line:
            middle = (word.top + word.bottom) / 2
            first = line[0]
            if not first.top <= middle <= first.bottom:
                yield _Item(tuple(sorted(line, key=lambda w: w.x0)))
                line = []
        line.append(word)
    if line:
        yield _Item(tuple(sorted(line, key=lambda w: w.x0)))


class _Reader:
    """Reads the pages. Mutable: a table goes on over several pages."""

    def __init__(self, pages: Sequence[_Page]) -> None:
        self.pages = pages
        self.table = 0
        self.headings: list[str] = []
        """of the last table"""
        self.columns: list[float] = []

    def document(self) -> Document:
        lines: list[DocumentLine] = []
        margins = _margins(self.pages)
        for page in self.pages:
            body = [item for item in page.items if (page.number, item.top) not in margins]
            outside = [item for item in page.items if (page.number, item.top) in margins]
            at_head = [item for item in outside if item.top < page.height / 2]
            lines += [_margin_line(item, page, margins, "head") for item in at_head]
            lines.append(DocumentLine())
            count = 0
            for column in _columns(body):
                for made in self._column(column, page, count):
                    count += bool(made.text.strip()) and made.table is None
                    lines.append(made)
            at_foot = [item for item in outside if item not in at_head]
            lines += [_margin_line(item, page, margins, "foot") for item in at_foot]
        return Document(tuple(lines))

    def _column(self, items: Sequence[_Item], page: _Page, count: int) -> Iterator[DocumentLine]:
        """Yield the lines of a column, from top to bottom."""
        text: list[_Item] = []
        for item in items:
            if item.table is None:
                text.append(item)
                continue
            for made in _paragraphs(text, page, count):
                count += bool(made.text)
                yield made
            text = []
            yield DocumentLine()
            yield from self._table(item, page)
            yield DocumentLine()
        yield from _paragraphs(text, page, count)

    def _table(self, item: _Item, page: _Page) -> Iterator[DocumentLine]:
        rows = _grid(item.table, page.number)
        texts = [cell.text for cell in rows[0].cells]
        again = self.table > 0 and any(texts) and texts == self.headings
        if again:
            rows[0] = replace(rows[0], aside="the headings of columns, again")
        elif not self._continues(item, page):
            self.table += 1
            self.headings = texts
        self.columns = [cell[0] for cell in item.table.rows[0].cells if cell]
        yield from grid_lines(rows, self.table)

    def _continues(self, item: _Item, page: _Page) -> bool:
        """Return True if a table at the head of a page goes on from the one before."""
        columns = [cell[0] for cell in item.table.rows[0].cells if cell]
        alike = len(columns) == len(self.columns) > 1 and all(
            abs(a - b) < 2 for a, b in zip(columns, self.columns, strict=True)
        )
        above = [other for other in page.items if other.table and other.top < item.top]
        return page.number > 1 and alike and not above


def _grid(table: Any, page: int) -> list[GridRow]:
    """Return the rows of a drawn table, with what is merged."""
    starts = sorted({cell[0] for cell in table.cells})
    texts = table.extract()
    headed = len(texts) > 1 and not _has_figures(texts[0]) and any(map(_has_figures, texts[1:]))
    rows: list[GridRow] = []
    for r, (row, said) in enumerate(zip(table.rows, texts, strict=True)):
        place = (
            f"page {page}, headings"
            if headed and r == 0
            else f"page {page}, row {r + (not headed)}"
        )
        top = row.bbox[1]
        cells: list[GridCell] = []
        for c, (cell, text) in enumerate(zip(row.cells, said, strict=True)):
            where = f"{place}, column {c + 1}"
            if cell is not None:
                cells.append(GridCell(paragraphs_of(text or "", wrapped=True), where))
                continue
            x = starts[c] + 0.5
            over = [o for o in table.cells if o[0] <= x < o[2] and o[1] <= top + 0.5 < o[3]]
            down = bool(over) and over[0][1] < top - 0.5
            across = bool(over) and over[0][0] < starts[c] - 0.5
            cells.append(GridCell((), where, across=across, down=down))
        rows.append(GridRow(tuple(cells), place))
    return rows


def _has_figures(texts: Sequence[str | None]) -> bool:
    return any(character.isdigit() for text in texts for character in text or "")


# ---- what is the same on all pages


def _margin_line(
    item: _Item, page: _Page, reasons: Mapping[tuple[int, float], str], where: str
) -> DocumentLine:
    place = f"page {page.number}, {where}"
    return DocumentLine(item.text, place, aside=reasons[page.number, item.top])


def _margins(pages: Sequence[_Page]) -> dict[tuple[int, float], str]:
    """Return the lines at the head and at the foot of pages that are no part of the text, by page
    and place; each with the reason.

    They are the same on several pages, but for the page's number, and stand apart from the text.
    """
    alike: Counter[tuple[bool, int, str]] = Counter()
    for page in pages:
        alike.update({_margin_key(item, page) for item in page.items})
    found: dict[tuple[int, float], str] = {}
    for page in pages:
        repeated = [
            item.table is None and alike[_margin_key(item, page)] > 1 for item in page.items
        ]
        for item in _at_edge(page.items, repeated, page):
            found[page.number, item.top] = "the header of the pages"
        for item in _at_edge(page.items[::-1], repeated[::-1], page):
            found[page.number, item.top] = "the footer of the pages"
        for item in page.items[-1:]:
            low = item.table is None and item.top > (1 - _MARGIN_SHARE) * page.height
            if low and len(page.items) > 1 and _is_apart(item, page):
                found.setdefault((page.number, item.top), "a line at the foot of the page")
    return found


def _margin_key(item: _Item, page: _Page) -> tuple[bool, int, str]:
    text = _PAGE_NUMBER.sub("#", item.text)
    return item.top < page.height / 2, round(item.top / 3), text


def _at_edge(items: Sequence[_Item], repeated: Sequence[bool], page: _Page) -> Sequence[_Item]:
    """Return the items at an edge of a page, the first ones, that are on several pages; behind the
    last one there is a gap."""
    most = 0
    for i, (item, again) in enumerate(zip(items, repeated, strict=True)):
        edge = min(item.bottom, page.height - item.top)
        if not again or edge > _MARGIN_SHARE * page.height:
            break
        behind = items[i + 1] if i + 1 < len(items) else None
        gap = (
            page.height
            if behind is None
            else max(behind.top - item.bottom, item.top - behind.bottom)
        )
        if gap > item.bottom - item.top:
            most = i + 1
    return items[:most]


def _is_apart(item: _Item, page: _Page) -> bool:
    """Return True if a line at the foot stands far from the text, in smaller letters."""
    body = [other for other in page.items if other.bottom < item.top and other.words]
    above = max((o.bottom for o in page.items if o.bottom < item.top), default=0.0)
    sizes = Counter(round(o.size, 1) for o in body for _ in o.words)
    usual = sizes.most_common(1)[0][0] if sizes else 0.0
    return item.top - above > _FAR * (item.bottom - item.top) and item.size < usual - 0.4


# ---- columns


def _columns(items: Sequence[_Item]) -> Iterator[list[_Item]]:
    """Yield the parts of a page in the order in which they are read."""
    best: tuple[int, int, int, float] | None = None
    for x in _gutters(items):
        for start, end in _runs(items, x):
            pairs = sum(1 for item in items[start:end] if item.x0 < x < item.x1)
            if (
                pairs > 2
                and _are_columns(items[start:end], x)
                and (best is None or pairs > best[0])
            ):
                best = (pairs, start, end, x)
    if best is None:
        yield list(items)
        return
    _, start, end, x = best
    if items[:start]:
        yield list(items[:start])
    left, right = _sides(items[start:end], x)
    yield from _columns(left)
    yield from _columns(right)
    if items[end:]:
        yield from _columns(items[end:])


def _gutters(items: Sequence[_Item]) -> list[float]:
    """Return the middles of wide gaps inside lines."""
    found: set[int] = set()
    for item in items:
        for a, b in zip(item.words, item.words[1:], strict=False):
            if b.x0 - a.x1 >= _GUTTER:
                found.add(round(b.x0 - 2))
    return sorted(map(float, found))


def _runs(items: Sequence[_Item], x: float) -> Iterator[tuple[int, int]]:
    """Yield the ranges of items of which no word and no table stands across `x`."""
    start = 0
    for i, item in enumerate([*items, None]):
        if item is not None and not _crosses(item, x):
            continue
        if i > start:
            yield start, i
        start = i + 1


def _crosses(item: _Item, x: float) -> bool:
    if item.table is not None:
        return item.x0 < x < item.x1
    return any(word.x0 < x < word.x1 for word in item.words)


def _sides(items: Sequence[_Item], x: float) -> tuple[list[_Item], list[_Item]]:
    sides: tuple[list[_Item], list[_Item]] = ([], [])
    for item in items:
        if item.table is not None:
            sides[item.x0 >= x].append(item)
            continue
        for side in (0, 1):
            words = tuple(word for word in item.words if (word.x0 >= x) == bool(side))
            if words:
                sides[side].append(replace(item, words=words))
    return sides


def _are_columns(items: Sequence[_Item], x: float) -> bool:
    """Return True if two columns are text to be read one after the other, and no table: the file
    has all words of one before those of the other, and the lines are long."""
    left, right = _sides([item for item in items if item.table is None], x)
    if len(left) < 3 or len(right) < 3:
        return False
    last = max(word.at for item in left for word in item.words)
    first = min(word.at for item in right for word in item.words)
    lengths = [sum(len(item.text) for item in side) / len(side) for side in (left, right)]
    return last < first and min(lengths) >= _LONG_LINE


# ---- paragraphs


def _paragraphs(items: Sequence[_Item], page: _Page, count: int) -> Iterator[DocumentLine]:
    """Yield the lines of a column; lines that its width has broken are joined."""
    if not items:
        return
    right = max(item.x1 for item in items)
    texts = _aligned(items)
    group: list[int] = []
    for i, item in enumerate(items):
        if group and _goes_on(items[group[-1]], item, right, texts[i]):
            group.append(i)
            continue
        if group:
            count += 1
            yield _line(group, texts, page, count)
            above = items[group[-1]]
            if item.top - above.bottom > 1.5 * (above.bottom - above.top):
                yield DocumentLine()
        group = [i]
    yield _line(group, texts, page, count + 1)


def _line(group: Sequence[int], texts: Sequence[str], page: _Page, count: int) -> DocumentLine:
    first, *others = (texts[i] for i in group)
    said = first
    for text in others:
        part = text.strip()
        broken = said.endswith("-") and said[-2:-1].isalpha() and part[:1].islower()
        said = said[:-1] + part if broken else f"{said} {part}"
    return DocumentLine(said, f"page {page.number}, line {count}")


def _goes_on(above: _Item, below: _Item, right: float, text: str) -> bool:
    """Return True if a line is the rest of the one above, that did not fit into the column."""
    height = above.bottom - above.top
    if below.top - above.bottom > 0.6 * height or _MARKED.match(below.words[0].text):
        return False
    if "  " in text.strip() or above.text.endswith(_SENTENCE_END):
        return False
    if abs(above.size - below.size) > 0.6:
        return False
    first = below.words[0]
    full = above.x1 + 0.25 * above.size + (first.x1 - first.x0) > right
    return (full and len(above.text) >= _LONG_PARAGRAPH) or first.text[:1].islower()


def _aligned(items: Sequence[_Item]) -> list[str]:
    """Return lines in which words stand as far apart as on the page, in letters of one width."""
    words = [word for item in items for word in item.words]
    letters = sum(len(word.text) for word in words)
    width = sum(word.x1 - word.x0 for word in words) / max(letters, 1) or 1.0
    left = min(word.x0 for word in words)
    found: list[str] = []
    for item in items:
        said = " " * round((item.words[0].x0 - left) / width)
        before: _Word | None = None
        for word in item.words:
            if before is not None:
                apart = word.x0 - before.x1 > _GAP * max(before.size, 1.0)
                column = round((word.x0 - left) / width)
                said += " " * max(column - len(said), 2) if apart else " "
            said += word.text
            before = word
        found.append(said)
    return found
