"""Rows of sheets that people fill in: tables with columns of any heading, checklists, labels with
dots behind them.

What a row asks for is not decided here, as that needs the site's names. A row is cut into cells,
and each cell has a role, by the heading of its column or by what it contains.
"""

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from argo_compiler.script.documents.signs import BLANK, RULE
from argo_compiler.script.documents.source import ScriptText, Source, join
from argo_compiler.script.sentences.words.prose import Prose, phrase_pattern

SHEET_HEADINGS = "the headings of columns"
"""what the line of a sheet's headings is set aside as"""
ROW = "\ue001"
"""the text of a row where sentences are read"""


class CellRole(StrEnum):
    """Role of a cell in a row of a sheet."""

    NUMBER = "number"
    """of the row or of the item"""
    CHECKPOINT = "checkpoint"
    """the number of a checkpoint, perhaps without a word"""
    NAME = "name"
    ACTION = "action"
    FLOOR = "floor"
    KIND = "kind"
    UNIT = "unit"
    LOW = "low"
    HIGH = "high"
    NORMAL = "normal"
    """the normal range, or the position that a valve must have"""
    FILL = "fill"
    """to be filled in by a person"""
    REPORT = "report"
    """what is reported, such as `pressure in bar`"""
    POINTS = "points"
    REMARK = "remark"
    REACTION = "reaction"
    """what is done if the reading is not normal"""
    ORDER = "order"
    """the place of the row in the order, or when it is done"""
    PRIORITY = "priority"
    WINDOW = "window"
    """minutes from and to which it is done"""
    OTHER = "other"
    """unknown: told by its content"""


@dataclass(frozen=True)
class Cell:
    """A cell of a row."""

    role: CellRole
    text: ScriptText
    filled: bool = False
    """whether it is filled in, where other rows have nothing"""
    column: int | None = None
    """the index of its heading; None: it has none"""


@dataclass(frozen=True)
class FormRow:
    """A row of a sheet, cut into its cells."""

    place: ScriptText
    """the whole line"""
    cells: tuple[Cell, ...]
    box: str | None = None
    """what stands in the box before it, such as `x`; None: there is no box"""
    is_heading: bool = False
    """whether it has the headings of the columns"""
    labelled: bool = False
    """whether it is no more than a label and a value"""
    doubt: str = ""
    """why it may not be meant, such as that it is hidden in its document"""
    filled_below: tuple[ScriptText, ...] = ()
    """for headings: the cells below times of day that are filled in"""
    computed: bool = False
    """whether all numbers in it are computed by a spreadsheet"""
    headed_at: int | None = None
    """the offset of the first of its headings; None: it has none"""

    def cell_in(self, column: int) -> Cell | None:
        """Return the cell below a heading; None if it is empty."""
        return next((cell for cell in self.cells if cell.column == column), None)


Columns = list[tuple[int, CellRole]]
"""where the headings of columns begin, as offsets in the source, and what the columns hold"""
_BOXES = re.compile(r"[□☐]|\[\s+\]")
"""within a line, where `[]` may be a list without items: `with joints []`"""
_QUOTED = re.compile(r'"[^"]*"')
_MARK = r"\s*(?:[-*•]\s+|[0-9]{1,3}\s*[.):]?\s+)?"
"""a bullet, or the number of a row"""
_BOX = re.compile(rf"{_MARK}(\[[ xX*✓v~-]?\]|\(\s?[xX✓✔]?\s?\)|[□☐☑☒✓✔✗✘])\s*")
_OPEN_BOX = re.compile(rf"{_MARK}(?:\[\s?\]|[□☐]|\(\s*\))")
_OF_FORMS = re.compile(r"[\[□☐☑☒✓✔✗✘_…]|~~|\.{4}|\(\s?[xX]?\s?\)")
"""a line without such signs has no box and no blank, and nothing of it is struck"""
_CUTTING = re.compile(r"[|\t;,…]|\.{3}|\s\s")
"""a line without such signs has one cell"""
_STRUCK = re.compile(r"~~[^~]+~~")
_LEADER = re.compile(r"\s*(?:\.{3,}|…+)\s*")
_CUTS = {
    "|": re.compile(r"\|"),
    "\t": re.compile(r"\t+"),
    "\t ": re.compile(r"\t"),
    ";": re.compile(";"),
    ",": re.compile(","),
    "  ": re.compile(r"\s{2,}|\t"),
}
_QUOTED = re.compile(r'"[^"]*"')
_LONGEST_HEADING = 5
"""words"""
_FEWEST_SIGNS = {";": 1, ",": 2}
_LOOSE = tuple(_FEWEST_SIGNS)
"""signs that cut rows below headings that they cut, and are signs of sentences elsewhere"""
_BLANK_CELL = re.compile(r"_{2,}|\.{4,}")
_STEP_MARK = re.compile(r"^(?:[0-9]{1,3}|[a-z])[.)]\s+")
"""the number of a step, behind which many blanks make no cells"""
_SENTENCE = re.compile(r"[a-zäöüß)][.!?]\s{2,}[A-ZÄÖÜ]")
_ENDED = re.compile(r"[!?]$|\w{4,}\.$")
"""at the end of a sentence, rather than of `n. a.`"""
_BOX_SIGN = r"\[[ xX*✓✔]?\]|[□☐☑☒✓✔]"
_OPTION = re.compile(rf"({_BOX_SIGN})\s*([^\[\]□☐☑☒✓✔|]+)")
_OPTIONS = re.compile(rf"[\s|]*([^:\[\]|]{{1,40}}:)\s*(?:(?:{_BOX_SIGN})\s*[^\[\]□☐☑☒✓✔|]+)+[\s|]*")
"""a label, and options with a box before each"""
_KEYED = re.compile(r"\s*([^\W\d]\w{2,40})\s?[,;=]\s?([^,;=]{1,60})")
_LONGEST = 2000
"""characters of a row"""
_DEEP = 8
"""blanks before a line that goes on from the cell above it"""
_UNIT_OF_LABEL = re.compile(r"(.+?)\s*[(\[](s|sec|seconds|min|minutes|h|hours)[)\]]", re.IGNORECASE)
_CLOCK = re.compile(r"\d{1,2}[:.]\d{2}(?:\s*h)?")
_READING = re.compile(r"-?\d+(?:[.,]\d+)?")
_MOST_CELLS = 30
_MOST_ROWS = 10_000


@dataclass(frozen=True)
class Forms:
    """The rows of sheets in a script, by the numbers of their lines."""

    rows: Mapping[int, FormRow]
    texts: Mapping[int, ScriptText]
    """lines that say what a field says: `Start: starting area 2`; empty for a line that goes on
    from the one above"""


def forms(
    source: Source,
    taken: Mapping[int, ScriptText],
    prose: Prose,
    is_plain: Callable[[ScriptText], bool],
) -> Forms:
    """Return the rows of sheets in a script; lines that are `taken` are none, and neither are those
    that `is_plain` tells to make sense without columns."""
    rows: dict[int, FormRow] = {}
    texts = {
        number: text
        for number in source.unclear
        if number not in taken and (text := _simple_field(source.line_text(number), prose))
    }
    taken = {**taken, **texts}
    columns_of: dict[int | None, Columns | None] = {}
    """by the table of a document, which sections may part"""
    cut_rows: dict[int, tuple[int, list[Cell]]] = {}
    headed: set[int] = set()
    for at, (group, cut) in enumerate(_groups(source, taken, prose)):
        table = _table_of(source, group[0])
        bars = cut == "|" and _bars(source, group)
        sign = "\t " if cut == "\t" and _has_single_tabs(source, group) else cut
        lines = [(number, _cells(source.line_text(number), sign, bars)) for number in group]
        if cut == "  ":
            lines = list(_wrapped(lines, source, texts))
        heads = [_headings(found, prose) for _, found in lines]
        headless = not any(heads)
        columns = None if table is None else columns_of.get(table)
        for i, ((number, found), headings) in enumerate(zip(lines, heads, strict=True)):
            line = source.line_text(number)
            doubt = _doubt_of(source, number)
            if RULE.fullmatch(line.content):
                texts[number] = line[:0]
            elif headings is not None:
                columns = columns_of[table] = headings
                ends = next((k for k in range(i + 1, len(heads)) if heads[k] is not None), None)
                below = _below_times(found, [cells for _, cells in lines[i + 1 : ends]], cut)
                rows[number] = FormRow(
                    line.strip(), tuple(found), is_heading=True, filled_below=below
                )
            elif (field := _field(found, prose)) is not None and not doubt:
                texts[number] = field
            elif cut in ("\t", ",") and headless:
                continue  # text recognition cuts words by tabs, and sentences have commas
            else:
                cells = _with_roles(found, columns, cut)
                if columns is not None and cut in _LOOSE and len(cells) > len(columns):
                    doubt = doubt or "this row has more cells than there are headings"
                said = _instruction(cells, is_plain)
                if said is not None and not doubt:
                    texts[number] = said
                elif columns is not None or table is not None or not is_plain(line):
                    cut_rows[number] = (at if table is None else -table, cells)
                    headed |= {number} if columns is not None and cut != "  " else set()
                    at_heading = columns[0][0] if columns else None
                    row = _row(line, cells, cut)
                    rows[number] = replace(row, headed_at=at_heading, doubt=doubt)
    for number, cells in _with_filled(cut_rows, headed).items():
        filled = tuple(cell for cell in cells if cell.text.content)
        if rows[number].box is None and not rows[number].is_heading:
            rows[number] = replace(rows[number], cells=filled)
        rows[number] = replace(rows[number], computed=_is_computed(source, number))
    for number in source.unclear:
        line = source.line_text(number)
        content = line.content
        known = number in rows or number in texts or number in taken
        if known or len(content) > _LONGEST or len(rows) > _MOST_ROWS:
            continue
        if source.document is None and not _OF_FORMS.search(content):
            continue
        boxed, struck = _BOX.match(content), _STRUCK.search(content)
        doubt = _doubt_of(source, number) if content.strip() else ""
        ticked = boxed and not _OPEN_BOX.match(content)
        blank = BLANK.search(_QUOTED.sub("", content))
        boxes = _OPEN_BOX.match(content) or _BOXES.search(content)
        if doubt or blank or ticked or struck or (boxes and not is_plain(line)):
            cells = _cells(line, "  ")
            rows[number] = replace(_row(line, cells, "  "), doubt=doubt)
    return Forms(rows, texts)


def _below_times(
    headings: Sequence[Cell], rows: Sequence[Sequence[Cell]], cut: str
) -> tuple[ScriptText, ...]:
    """Return the numbers in the columns of times of day, in the rows up to the next headings."""
    times = [i for i, cell in enumerate(headings) if _CLOCK.fullmatch(cell.text.content)]
    if cut == "  " or len(times) < 2:
        return ()
    cells = [row[i].text for i in times for row in rows if i < len(row)]
    return tuple(text for text in cells if _READING.fullmatch(text.content))


def _table_of(source: Source, number: int) -> int | None:
    """Return the table of a document that a line is a row of; None for other lines."""
    origin = source.origin(number) if number <= len(source.lines) else None
    if origin is None or not source.line_text(number).content.strip():
        return None  # also for a row that only explains a short form
    return origin.table


def _doubt_of(source: Source, number: int) -> str:
    origin = source.origin(number)
    return "" if origin is None else origin.doubt


def _is_computed(source: Source, number: int) -> bool:
    """Return True if a spreadsheet computes all numbers in a row that has some."""
    origin = source.origin(number)
    if origin is None or not origin.computed:
        return False
    starts = [start for start, _ in origin.cells]
    parts = zip(starts, [*starts[1:], len(origin.text)], strict=True)
    numbers = {i for i, (a, b) in enumerate(parts) if any(map(str.isdigit, origin.text[a:b]))}
    return bool(numbers) and numbers <= origin.computed


def _instruction(
    cells: Sequence[Cell], is_plain: Callable[[ScriptText], bool]
) -> ScriptText | None:
    """Return the text of a row of which one cell is a sentence, and the others are its number or
    empty: `3 | Check valve R31. Then wait a minute. |`."""
    said = [cell for cell in cells if cell.text.content and cell.role is not CellRole.NUMBER]
    if len(said) != 1 or said[0].role not in (CellRole.ACTION, CellRole.OTHER):
        return None
    text = said[0].text
    prose = text.content.endswith(".") and text.content.count(" ") >= 2
    if not prose and not (said[0].role is CellRole.ACTION and is_plain(text)):
        return None
    number = next((cell.text for cell in cells if cell.role is CellRole.NUMBER), text[:0])
    if not number.content.strip(".").isdecimal():
        return text
    mark = number[: len(number.content.rstrip("."))]
    return join([mark, ScriptText(". ", [text.first] * 2, text.source), text], "")


def _with_filled(
    rows: Mapping[int, tuple[int, list[Cell]]], headed: Collection[int]
) -> dict[int, list[Cell]]:
    """Return the cells of rows, by line; marked are those that are filled in while other rows of
    the table have nothing there, or something else."""
    filled: dict[tuple[int, int], list[str]] = defaultdict(list)
    for table, cells in rows.values():
        for i, cell in enumerate(cells):
            filled[table, i].append(cell.text.content.lower())

    blanks = {
        column: 2 * sum(_BLANK_CELL.fullmatch(text) is not None for text in said) >= len(said)
        for column, said in filled.items()
    }
    differing = {column for column, said in filled.items() if len({*said}) > 1}

    def told(cell: Cell, number: int, column: tuple[int, int]) -> Cell:
        role = CellRole.FILL if blanks[column] and cell.role is CellRole.OTHER else cell.role
        if role is CellRole.FILL or (role is CellRole.OTHER and number in headed):
            differs = bool(cell.text.content) and column in differing
            return replace(cell, role=role, filled=differs)
        return cell

    return {
        number: [told(cell, number, (table, i)) for i, cell in enumerate(cells)]
        for number, (table, cells) in rows.items()
    }


def _wrapped(
    lines: Sequence[tuple[int, list[Cell]]], source: Source, texts: dict[int, ScriptText]
) -> Iterator[tuple[int, list[Cell]]]:
    """Yield rows of two cells with the lines below that stand under the second one, as its text was
    broken; those become empty."""
    last: tuple[int, list[Cell]] | None = None
    for number, cells in lines:
        line = source.lines[number - 1]
        indent = len(line) - len(line.lstrip())
        if last is not None and indent >= _DEEP and len(last[1]) == 2:
            first, value = last[1]
            listed = value.text.content.endswith(":")
            if abs(_column(source, value.text.first) - indent - 1) <= 1 and not listed:
                whole = join([value.text, source.line_text(number).strip()])
                last = (last[0], [first, replace(value, text=whole)])
                texts[number] = source.line_text(number)[:0]
                continue
        if last is not None:
            yield last
        last = (number, cells)
    if last is not None:
        yield last


def _field(cells: Sequence[Cell], prose: Prose) -> ScriptText | None:
    """Return two cells as a field, `Start: starting area 2`, if the first is a field's label; with
    a unit in brackets behind it, that is the value's."""
    if len(cells) != 2 or not all(cell.text.content for cell in cells):
        return None
    label, value = (cell.text for cell in cells)
    if value.content.startswith(":"):
        return None
    named = _UNIT_OF_LABEL.fullmatch(label.content)
    said = label[: named.end(1)] if named is not None else label
    said = said[: len(said.content.rstrip(" :"))]
    if prose.label.fullmatch(f"{said.content}:") is None:
        return None
    colon = ScriptText(": ", [said.last, value.first], label.source)
    unit = value[-1:].replaced(f" {named[2]}") if named is not None else value[:0]
    return join([said, colon, value, unit], "")


def _simple_field(line: ScriptText, prose: Prose) -> ScriptText | None:
    """Return a line of which one option is ticked, `Start area: [ ] 1 [x] 2`, or with a key as data
    files have them, `start_area,2`, as a field; None for another line."""
    if len(line.content) > _LONGEST:
        return None
    if (boxed := _OPTIONS.fullmatch(line.content)) is not None:
        options = list(_OPTION.finditer(line.content, boxed.end(1)))
        ticked = [one for one in options if one[1].strip("[] □☐")]
        if len(options) > 1 and len(ticked) == 1:
            label = line[boxed.start(1) : boxed.end(1)].strip()
            return join([label, line[ticked[0].start(2) : ticked[0].end(2)].strip()])
    if (keyed := _KEYED.fullmatch(line.content)) is not None:
        words = keyed[1].replace("_", " ").strip()
        unit = next((u for u in ("min", "s", "h") if words.endswith(f" {u}")), "")
        words = words.removesuffix(unit).strip()
        if prose.label.fullmatch(f"{words}:") is not None:
            value = line[keyed.start(2) : keyed.end(2)].strip()
            said = f"{value.content} {unit}".strip() if unit else value.content
            label = line[keyed.start(1) : keyed.end(1)].replaced(f"{words}: ")
            return join([label, value.replaced(said)], "")
    return None


def _row(line: ScriptText, cells: Sequence[Cell], cut: str) -> FormRow:
    box = _BOX.match(line.content)
    mark: str | None = None
    if box is not None:
        mark = box[1].strip("[]()□☐ ").lower()
        first = cells[0].text
        inner = _BOX.match(first.content)
        rest = first[inner.end() :].strip() if inner is not None else first
        cells = [replace(cells[0], text=rest), *cells[1:]]
    elif _STRUCK.search(line.content):
        mark = "-"
    labelled = len(cells) == 2 and cut in (".", ";", "  ", "|")
    return FormRow(line.strip(), tuple(c for c in cells if c.text.content), mark, labelled=labelled)


def _groups(
    source: Source, taken: Mapping[int, ScriptText], prose: Prose
) -> Iterator[tuple[list[int], str]]:
    """Yield the numbers of lines, one below the other, that are cut into cells alike."""
    group: list[int] = []
    cut = ""
    table: int | None = None
    loose = False
    """whether headings, rather than the signs of each line, show what cuts the lines"""
    for number in (*source.unclear, len(source.lines) + 1):
        if group and number > group[-1] + 1:
            if len(group) > 1 or _is_pair(source, group, cut):
                yield group, cut
            group, cut = [], ""
        line = source.line_text(number).content if number <= len(source.lines) else ""
        here = "" if number in taken else _cut_of(line)
        begins = "" if number in taken else _cut_of_headings(line, source, number, prose)
        of = None if number in taken else _table_of(source, number)
        if of is not None or table is not None:
            if group and (of != table or number in taken):
                yield group, cut
                group, cut = [], ""
            table = of
            if of is not None:
                group.append(number)
                cut = "|"
                continue
        rule = cut == "|" and line.strip() and RULE.fullmatch(line)
        deep = cut == "  " and line.strip() and len(line) - len(line.lstrip()) >= _DEEP
        goes_on = loose and number not in taken and cut in line and not _ENDED.search(line.strip())
        ends = line.strip()[:1] + line.strip()[-1:]
        alike = bool(group) and line.count("|") == source.lines[group[0] - 1].count("|")
        goes_on |= cut == "|" and "|" in line and (ends.count("|") == 1 or alike)  # `valve R25 |`
        apart = bool(begins) and begins != cut
        if group and not apart and (here == cut or rule or deep or goes_on):
            loose = loose or bool(begins)
            group.append(number)
            continue
        if len(group) > 1 or _is_pair(source, group, cut):
            yield group, cut
        here, loose = begins or here, bool(begins)
        group, cut = ([number], here) if here else ([], "")


def _cut_of(line: str) -> str:
    if not _CUTTING.search(line.strip()) or len(line) > _LONGEST:
        return ""
    inner = _STEP_MARK.sub("", line.strip())
    if _SENTENCE.search(inner):
        return ""
    if "|" in inner.strip("|"):
        return "|"
    if "\t" in inner:
        return "\t"
    if inner.count(";") >= 1 and not _ENDED.search(inner) and not re.search(r"\S;\s", inner):
        return ";"
    if inner.count(",") >= 2 and not re.search(r",\s", inner) and not inner.endswith("."):
        return ","
    if _LEADER.search(inner) and re.match(r"(?:[^\W\d]|#).*?\s*\.{4,}\s*[^\s.]", inner):
        return "."
    return "  " if '"' not in inner and re.search(r"\S\s{2,}\S", inner) else ""


def _is_pair(source: Source, group: Sequence[int], cut: str) -> bool:
    """Return True for a single line of two cells with a bar between them, which no quotes hold."""
    line = _QUOTED.sub("", source.lines[group[0] - 1]) if group else ""
    return cut == "|" and line.strip(" |").count("|") == 1


def _cut_of_headings(line: str, source: Source, number: int, prose: Prose) -> str:
    """Return the sign that cuts a line into headings of columns, as in `Point; Floor; Priority`,
    where sentences have it as well; empty for another line."""
    stripped = line.strip()
    if len(line) > _LONGEST or stripped.endswith((":", ".", "!", "?")):
        return ""
    for cut in _LOOSE:
        parts = line.split(cut)
        short = all(0 < len(part.split()) <= _LONGEST_HEADING for part in parts)
        if len(parts) > _FEWEST_SIGNS[cut] and short:
            cells = _cells(source.line_text(number), cut)
            if _headings(cells, prose) is not None:
                return cut
    return ""


def _bars(source: Source, group: Sequence[int]) -> bool:
    """Return True if bars at both ends of lines are borders; else the cell before one is empty."""
    if source.document is not None:
        return True
    return all(source.lines[number - 1].lstrip().startswith("|") for number in group)


def _has_single_tabs(source: Source, group: Sequence[int]) -> bool:
    """Return True if each tab begins a cell, so that one between two others is empty: no line has
    more of them than the first one, which has no two side by side."""
    first = source.lines[group[0] - 1]
    most = first.count("\t")
    return "\t\t" not in first and all(source.lines[n - 1].count("\t") <= most for n in group)


def _cells(line: ScriptText, cut: str, bars: bool = True) -> list[Cell]:
    """Return the cells of a line, each with blanks stripped; empty ones as well."""
    content = line.content
    start, end = len(content) - len(content.lstrip()), len(content.rstrip())
    if cut == "|" and bars:
        start += content[start:end].startswith("|")
        end -= content[start:end].endswith("|")
    pattern = _LEADER if cut == "." else _CUTS[cut]
    cells: list[Cell] = []
    at = start
    for found in pattern.finditer(content, start, end):
        if len(cells) >= _MOST_CELLS:
            break
        cells.append(Cell(CellRole.OTHER, line[at : found.start()].strip()))
        at = found.end()
    cells.append(Cell(CellRole.OTHER, line[at:end].strip()))
    return cells


def _headings(cells: Sequence[Cell], prose: Prose) -> Columns | None:
    """Return the columns, if a line has their headings."""
    said = [cell for cell in cells if cell.text.content]
    roles = [_role(cell, prose) for cell in said]
    known = sum(role is not None for role in roles)
    if len(said) < 2 or known < 2 or 2 * known < len(said):
        return None
    # `Valve R25 | yes | no` and `4 | valve | ok` are rows.
    telling = any(role not in (None, CellRole.FILL) for role in roles)
    if not telling or any(_READING.fullmatch(cell.text.content) for cell in said):
        return None

    def role_of(cell: Cell) -> CellRole:
        heading = cell.text.content
        if phrase_pattern(prose.form["history"]).search(heading) is not None:
            return CellRole.OTHER
        role = _role(cell, prose) or prose.role_by_last_words(heading)
        return CellRole(role or CellRole.OTHER)

    return [(cell.text.first, role_of(cell)) for cell in cells]


def _role(cell: Cell, prose: Prose) -> str | None:
    """Return what the column of a heading holds; of `Tag / point` what its first known part is."""
    heading = cell.text.content
    parts = [heading, *heading.split("/")]
    return next((role for part in parts if (role := prose.role(part)) is not None), None)


def _with_roles(cells: Sequence[Cell], columns: Columns | None, cut: str) -> list[Cell]:
    """Return the cells with the roles of their columns; between blanks a cell belongs to the column
    that begins nearest to it."""
    if columns is None or not cells:
        return list(cells)
    if cut != "  ":
        known = zip(cells, columns, strict=False)
        headed = [replace(c, role=role, column=i) for i, (c, (_, role)) in enumerate(known)]
        return headed + list(cells[len(headed) :])
    source = cells[0].text.source
    starts = [(_column(source, first), i, role) for i, (first, role) in enumerate(columns)]

    def under(cell: Cell) -> Cell:
        at = _column(source, cell.text.first)
        _, column, role = min(starts, key=lambda start: abs(start[0] - at))
        return replace(cell, role=role, column=column)

    return [under(cell) if cell.text.content else cell for cell in cells]


def _column(source: Source, offset: int) -> int:
    return source.span(offset, offset + 1).column
