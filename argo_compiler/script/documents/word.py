"""Documents of word processors (.docx): paragraphs and tables as they count, with list numbers.

Words that are struck through, or deleted by a tracked change, are not read; a note names them. Of
these programs' files `python-docx` opens the parts; which text counts is decided here.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from typing import TYPE_CHECKING, Any

from argo_compiler.script.documents.document import Document, DocumentLine, DocumentNote
from argo_compiler.script.documents.grid import GridCell, GridRow, cleaned, grid_lines

if TYPE_CHECKING:
    from docx.document import Document as WordDocument

_W = "{http://schemas.openxmlformats.org/wordprocessingml/2006/main}"
_W14 = "{http://schemas.microsoft.com/office/word/2010/wordml}"
_MC = "{http://schemas.openxmlformats.org/markup-compatibility/2006}"
_FOOTNOTES = "http://schemas.openxmlformats.org/officeDocument/2006/relationships/footnotes"
_SYMBOLS = {
    "F0A8": "☐", "F06F": "☐", "F071": "☐", "F0FE": "☒", "F078": "☒", "F0FD": "☒", "F052": "☑",
    "F0FC": "✓", "F0FB": "✗", "F0B7": "•", "F0A7": "▪",
}  # fmt: skip
"""characters of the symbol fonts"""
_OFF = frozenset(["0", "false", "off", "none"])
_MARK = re.compile(r"\s*(?:\(?[0-9]{1,3}[.)]|[-*•]|[a-z][.)])?\s*")
_GAPS = re.compile(r" *\t *| {2,}")
_COLUMN_GAP = "    "
_MOST_DEEP = 40
_ROMAN = ((10, "x"), (9, "ix"), (5, "v"), (4, "iv"), (1, "i"))


@dataclass
class _Words:
    """The text of a paragraph while it is read."""

    kept: list[str] = field(default_factory=list)
    struck: list[str] = field(default_factory=list)
    deleted: list[str] = field(default_factory=list)
    inserted: list[str] = field(default_factory=list)
    hidden: list[str] = field(default_factory=list)
    hidden_styles: frozenset[str] = frozenset()
    """names of the styles whose text a person does not see"""
    comments: list[str] = field(default_factory=list)
    """numbers of comments"""
    boxes: list[Any] = field(default_factory=list)
    """contents of text boxes"""

    @property
    def text(self) -> str:
        return "".join(self.kept)


@dataclass(frozen=True)
class _Paragraph:
    text: str
    struck: bool = False
    """whether all of it is struck through"""
    doubt: str = ""
    boxes: tuple[Any, ...] = ()


def read_word(content: bytes, _: str) -> Document:
    """Return the document in a file of a word processor.

    Raises:
        Exception: The file is damaged; `python-docx` raises errors of many types.
    """
    import docx

    return _Reader(docx.Document(BytesIO(content))).document()


class _Reader:
    """Reads one document. Mutable: lists are numbered, and paragraphs counted, on the way."""

    def __init__(self, document: "WordDocument") -> None:
        self.word = document
        self.notes: list[DocumentNote] = []
        self.lists = _Lists(document)
        self.hidden_styles = _hidden_styles(document)
        self.comments = _comments(document)
        self.paragraphs = self.tables = self.boxes = 0

    def document(self) -> Document:
        lines = [*self._margins("header"), *self._blocks(self.word.element.body)]
        lines += [*self._footnotes(), *self._margins("footer")]
        return Document(tuple(lines), tuple(self.notes))

    def _blocks(self, parent: Any, place: str = "") -> Iterator[DocumentLine]:
        """Yield the lines of paragraphs and tables; `place` is that of a text box."""
        for child in parent:
            if child.tag == f"{_W}p":
                yield from self._paragraph(child, place)
            elif child.tag == f"{_W}tbl":
                self.tables += 1
                yield DocumentLine()
                yield from grid_lines([*self._rows(child, f"table {self.tables}")], self.tables)
                yield DocumentLine()
            elif child.tag in (f"{_W}sdt", f"{_W}sdtContent", f"{_W}ins", f"{_W}customXml"):
                yield from self._blocks(child, place)

    def _paragraph(self, element: Any, place: str) -> Iterator[DocumentLine]:
        self.paragraphs += not place
        where = place or f"paragraph {self.paragraphs}"
        read = self._read(element, where)
        indent, mark = self.lists.mark(element) if read.text.strip() else ("", "")
        text = _GAPS.sub(_gap, read.text.strip().replace("\xa0", " "))
        if not text and not place:
            self.paragraphs -= 1
        for i, line in enumerate(text.split("\n")):
            said = f"{indent}{mark}{line.strip()}" if i == 0 else f"{indent}{line.strip()}"
            if read.struck and line.strip():
                said = f"{indent}~~{mark}{line.strip()}~~"
            yield DocumentLine(said.rstrip(), where if line.strip() else "", doubt=read.doubt)
        for box in read.boxes:
            self.boxes += 1
            yield from self._blocks(box, f"text box {self.boxes}")

    def _rows(self, table: Any, place: str) -> Iterator[GridRow]:
        """Yield the rows of a table; of tables inside its cells only the texts."""
        for number, row in enumerate(_within(table, "tr"), start=1):
            where = f"{place}, row {number}"
            cells: list[GridCell] = []
            properties = row.find(f"{_W}trPr")
            deleted = properties is not None and properties.find(f"{_W}del") is not None
            doubt = "this row is deleted by a tracked change" if deleted else ""
            if _is_on(properties, "hidden"):
                doubt = doubt or "this row is hidden in the document"
            cells += [GridCell()] * _number(properties, "gridBefore")
            for cell in _within(row, "tc"):
                made, why = self._cell(cell, f"{where}, column {len(cells) + 1}")
                doubt = doubt or why
                cells += made
            yield GridRow(tuple(cells), where, doubt)

    def _cell(self, cell: Any, where: str) -> tuple[list[GridCell], str]:
        properties = cell.find(f"{_W}tcPr")
        merge = None if properties is None else properties.find(f"{_W}vMerge")
        down = merge is not None and merge.get(f"{_W}val") != "restart"
        doubt = ""
        texts: list[str] = []
        for element in cell.iter(f"{_W}p"):
            if any(parent.tag.endswith("}txbxContent") for parent in element.iterancestors()):
                continue
            read = self._read(element, where)
            if not read.text.strip():
                continue
            doubt = doubt or read.doubt
            if read.struck:
                doubt = "this row has words that are struck through"
            _, mark = self.lists.mark(element)
            texts += [
                said
                for i, line in enumerate(read.text.split("\n"))
                if (said := cleaned(f"{mark if i == 0 else ''}{line}"))
            ]
        first = GridCell(tuple(texts), where, down=down)
        span = max(_number(properties, "gridSpan"), 1)
        rest = [GridCell((), where, across=True, down=down)] * min(span - 1, 100)
        return [first, *rest], doubt

    def _read(self, element: Any, place: str) -> _Paragraph:
        words = _Words(hidden_styles=self.hidden_styles)
        _collect(element, words, "", 0)
        text = words.text
        for gone, how in (
            (words.struck, "struck through"),
            (words.deleted, "deleted"),
            (words.hidden, "hidden"),
        ):
            said = " ".join("".join(gone).split())
            if said and (text.strip() or how != "struck through"):
                self.notes.append(DocumentNote(f"`{said}` is {how}, and is not read", place))
        if said := " ".join("".join(words.inserted).split()):
            self.notes.append(DocumentNote(f"`{said}` is a tracked change, and is read", place))
        struck = "".join(words.struck)
        found = [self.comments[number] for number in words.comments if number in self.comments]
        doubt = f"a comment says `{found[0]}`" if found else ""
        if struck.strip() and not _MARK.sub("", text, count=1).strip():
            return _Paragraph(struck, True, doubt, tuple(words.boxes))
        return _Paragraph(text, False, doubt, tuple(words.boxes))

    def _margins(self, which: str) -> Iterator[DocumentLine]:
        """Yield the texts at the head or at the foot of all pages."""
        met: set[str] = set()
        for section in self.word.sections:
            part = getattr(section, which)
            if part.is_linked_to_previous:
                continue
            for element in part._element.iter(f"{_W}p"):
                words = _Words(hidden_styles=self.hidden_styles)
                _collect(element, words, "", 0)
                text = " ".join(words.text.split())
                if text and text not in met:
                    met.add(text)
                    yield DocumentLine(text, f"page {which}", aside=f"the {which} of the pages")

    def _footnotes(self) -> Iterator[DocumentLine]:
        from lxml import etree

        for relation in self.word.part.rels.values():
            if relation.reltype != _FOOTNOTES or relation.is_external:
                continue
            root = etree.fromstring(relation.target_part.blob, _parser())
            notes = [n for n in root.iter(f"{_W}footnote") if n.get(f"{_W}type") is None]
            for number, note in enumerate(notes, start=1):
                yield from self._blocks(note, f"footnote {number}")


def _gap(found: re.Match[str]) -> str:
    """Return what stands for tabs or blanks: two blanks are one, as where a word was taken out."""
    return " " if found[0] == "  " else _COLUMN_GAP


def _parser() -> Any:
    from lxml import etree

    return etree.XMLParser(resolve_entities=False, no_network=True)


def _comments(document: "WordDocument") -> dict[str, str]:
    try:
        found = [(str(c.comment_id), " ".join(c.text.split())) for c in document.comments]
    except (AttributeError, KeyError):
        return {}
    return {number: text[:200] for number, text in found if text}


def _within(parent: Any, tag: str) -> Iterator[Any]:
    """Yield rows of a table or cells of a row, also those inside content controls."""
    for child in parent:
        if child.tag == f"{_W}{tag}":
            yield child
        elif child.tag in (f"{_W}sdt", f"{_W}sdtContent", f"{_W}ins"):
            yield from _within(child, tag)


def _number(properties: Any, tag: str) -> int:
    found = None if properties is None else properties.find(f"{_W}{tag}")
    value = "" if found is None else found.get(f"{_W}val") or ""
    return int(value) if value.isdecimal() and int(value) <= 100 else 0


def _is_on(properties: Any, *tags: str) -> bool:
    for tag in tags:
        found = None if properties is None else properties.find(f"{_W}{tag}")
        if found is not None and (found.get(f"{_W}val") or "").lower() not in _OFF:
            return True
    return False


def _collect(element: Any, words: _Words, change: str, depth: int) -> None:
    """Add the text below an element; `change` is the tracked change that it is part of."""
    if depth > _MOST_DEEP:
        return
    for child in element:
        tag = child.tag if isinstance(child.tag, str) else ""
        name = tag.rpartition("}")[2]
        if name in ("del", "moveFrom"):
            _collect(child, words, "deleted", depth + 1)
        elif name in ("ins", "moveTo"):
            _collect(child, words, change or "inserted", depth + 1)
        elif name == "r":
            _collect_run(child, words, change)
        elif name in ("commentRangeStart", "commentReference"):
            words.comments.append(child.get(f"{_W}id") or "")
        elif name == "sdt":
            _collect_control(child, words, change, depth)
        elif name not in ("pPr", "rPr", "txbxContent"):
            _collect(child, words, change, depth + 1)


def _collect_control(control: Any, words: _Words, change: str, depth: int) -> None:
    """Add the text of a content control; one that shows how to fill it in is a blank."""
    properties = control.find(f"{_W}sdtPr")
    if properties is not None and properties.find(f"{_W}showingPlcHdr") is not None:
        words.kept.append("____")
        return
    content = control.find(f"{_W}sdtContent")
    if content is not None:
        _collect(content, words, change, depth + 1)


def _hidden_styles(document: "WordDocument") -> frozenset[str]:
    """Return the names of the styles whose text is hidden, or that are based on such a style."""
    elements = {style.style_id: style.element for style in document.styles}
    hidden = {name for name, one in elements.items() if _is_on(one.find(f"{_W}rPr"), "vanish")}
    for _ in range(_MOST_DEEP):
        based = {
            name
            for name, one in elements.items()
            if _named(one, "basedOn") in hidden and not _has(one.find(f"{_W}rPr"), "vanish")
        }
        if based <= hidden:
            break
        hidden |= based
    return frozenset(hidden)


def _named(properties: Any, tag: str) -> str:
    """Return what a property names, such as a style; empty if it is not there."""
    found = None if properties is None else properties.find(f"{_W}{tag}")
    return "" if found is None else found.get(f"{_W}val") or ""


def _has(properties: Any, tag: str) -> bool:
    return properties is not None and properties.find(f"{_W}{tag}") is not None


def _is_hidden(run: Any, properties: Any, hidden_styles: frozenset[str]) -> bool:
    """Return True if a person does not see a run: by itself, or by its style or paragraph's."""
    if _has(properties, "vanish"):
        return _is_on(properties, "vanish")
    own = _named(properties, "rStyle")
    paragraph = next(run.iterancestors(f"{_W}p"), None)
    of_paragraph = None if paragraph is None else paragraph.find(f"{_W}pPr")
    return bool({own, _named(of_paragraph, "pStyle")} & hidden_styles)


def _collect_run(run: Any, words: _Words, change: str) -> None:
    properties = run.find(f"{_W}rPr")
    into = words.kept
    if change == "deleted":
        into = words.deleted
    elif _is_hidden(run, properties, words.hidden_styles):
        into = words.hidden
    elif _is_on(properties, "strike", "dstrike"):
        into = words.struck
    for child in run:
        name = child.tag.rpartition("}")[2] if isinstance(child.tag, str) else ""
        text = ""
        if name in ("t", "delText"):
            text = child.text or ""
        elif name == "tab":
            text = "\t"
        elif name in ("br", "cr"):
            text = "\n"
        elif name == "noBreakHyphen":
            text = "-"
        elif name == "sym":
            text = _SYMBOLS.get((child.get(f"{_W}char") or "").upper(), "")
        elif name == "fldChar":
            text = _form_field(child)
        elif name == "commentReference":
            words.comments.append(child.get(f"{_W}id") or "")
        elif name in ("drawing", "pict", "AlternateContent"):
            words.boxes += _text_boxes(child)
        into.append(text)
        if change == "inserted" and into is words.kept:
            words.inserted.append(text)


def _form_field(field_: Any) -> str:
    """Return the box of a check box of an old form."""
    box = next(field_.iter(f"{_W}checkBox"), None)
    if box is None:
        return ""
    ticked = _is_on(box, "checked") or (box.find(f"{_W}checked") is None and _is_on(box, "default"))
    return "☒ " if ticked else "☐ "


def _text_boxes(element: Any) -> list[Any]:
    """Return the contents of text boxes, each once: a file has them for old programs again."""
    chosen = [element]
    if element.tag == f"{_MC}AlternateContent":
        chosen = [child for child in element if child.tag == f"{_MC}Choice"] or [*element][:1]
    return [box for one in chosen for box in one.iter(f"{_W}txbxContent")]


class _Lists:
    """The numbers, letters and bullets of lists, which are not in the text of paragraphs."""

    def __init__(self, document: "WordDocument") -> None:
        self.levels = _levels(document)
        self.styles = {s.style_id: s.element for s in document.styles}
        self.counts: dict[str, dict[int, int]] = defaultdict(dict)

    def mark(self, paragraph: Any) -> tuple[str, str]:
        """Return the indentation and the mark of a paragraph, `   ` and `a) `."""
        number, level = self._list_of(paragraph)
        if number is None or number not in self.levels:
            return "", ""
        abstract, levels = self.levels[number]
        form, text, start = levels.get(level, ("bullet", "", 1))
        counts = self.counts[abstract]
        counts[level] = counts.get(level, start - 1) + 1
        for deeper in [one for one in counts if one > level]:
            del counts[deeper]
        indent = "   " * level
        if form == "none" or (not text and form != "bullet"):
            return indent, ""
        if form == "bullet":
            return indent, "- "

        def counted(found: re.Match[str]) -> str:
            at = int(found[1]) - 1
            own, _, first = levels.get(at, ("decimal", "", 1))
            return _counted(counts.get(at, first), own)

        said = re.sub(r"%([1-9])", counted, text).strip()
        return indent, f"{said} "

    def _list_of(self, paragraph: Any) -> tuple[str | None, int]:
        """Return the number of the list of a paragraph, its own or its style's, and the level."""
        properties = paragraph.find(f"{_W}pPr")
        level: int | None = None
        for _ in range(10):
            if properties is None:
                return None, 0
            found = properties.find(f"{_W}numPr")
            if found is not None:
                at, list_ = found.find(f"{_W}ilvl"), found.find(f"{_W}numId")
                if level is None and at is not None:
                    level = _whole(at.get(f"{_W}val"))
                if list_ is not None:
                    return list_.get(f"{_W}val"), level or 0
            named = properties.find(f"{_W}pStyle")
            if named is None and properties.getparent().tag == f"{_W}style":
                named = properties.getparent().find(f"{_W}basedOn")
            style = None if named is None else self.styles.get(named.get(f"{_W}val"))
            properties = None if style is None else style.find(f"{_W}pPr")
            if style is not None and properties is None:
                return None, 0
        return None, 0


_Level = tuple[str, str, int]
"""format, text such as `%1.`, and first number"""


def _levels(document: "WordDocument") -> dict[str, tuple[str, dict[int, _Level]]]:
    """Return the levels of lists by the lists' numbers, each with the name of what is counted."""
    try:
        root = document.part.numbering_part.element
    except (KeyError, NotImplementedError):
        return {}
    abstract: dict[str, dict[int, _Level]] = {}
    for one in root.iter(f"{_W}abstractNum"):
        levels = {_whole(level.get(f"{_W}ilvl")): _level(level) for level in one.iter(f"{_W}lvl")}
        abstract[one.get(f"{_W}abstractNumId") or ""] = levels
    found: dict[str, tuple[str, dict[int, _Level]]] = {}
    for one in root.iter(f"{_W}num"):
        of = one.find(f"{_W}abstractNumId")
        name = "" if of is None else of.get(f"{_W}val") or ""
        number = one.get(f"{_W}numId") or ""
        levels = dict(abstract.get(name, {}))
        begins = False
        for override in one.iter(f"{_W}lvlOverride"):
            at, start = _whole(override.get(f"{_W}ilvl")), override.find(f"{_W}startOverride")
            if start is not None and at in levels:
                begins = True
                levels[at] = (*levels[at][:2], _whole(start.get(f"{_W}val")))
        found[number] = (f"num {number}" if begins else name, levels)
    return found


def _level(level: Any) -> _Level:
    def value(tag: str, default: str) -> str:
        found = level.find(f"{_W}{tag}")
        return default if found is None else found.get(f"{_W}val") or ""

    return value("numFmt", "decimal"), value("lvlText", ""), _whole(value("start", "1"))


def _whole(text: str | None) -> int:
    return int(text) if text is not None and text.isdecimal() else 0


def _counted(number: int, form: str) -> str:
    if form in ("lowerLetter", "upperLetter"):
        letter = chr(ord("a") + (number - 1) % 26)
        return letter if form == "lowerLetter" else letter.upper()
    if form in ("lowerRoman", "upperRoman") and 0 < number < 40:
        said = ""
        for value, letters in _ROMAN:
            while number >= value:
                said += letters
                number -= value
        return said if form == "lowerRoman" else said.upper()
    return f"{number:02}" if form == "decimalZero" else str(number)
