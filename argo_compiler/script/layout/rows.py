"""ScriptTables: a heading for each column, then a step in each row.

Columns are cut by bars, tabs, semicolons or commas, or by blanks under the headings. A row becomes
the sentence that says the same: `3. checkpoint #2 (liquid level gauge 1) with priority 3`.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from argo_compiler.script.documents.signs import RULE, is_to_fill, place_in_order
from argo_compiler.script.documents.source import Diagnostics, ScriptText, Source, quotes
from argo_compiler.script.layout.asides import Asides, ask_of_remark
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.lexicon import expand
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.prose import Prose

COLUMN_HEADINGS = "column headings"
"""what the line of a table's headings is taken for"""
_NUMBER = re.compile(r"[0-9]{1,6}")
_TIMES = frozenset(["BEFORE", "AFTER", "UNTIL", "IF_TIME", "DAY"])
"""words of these types in a cell say when something is done"""
_NOT_APPLICABLE = frozenset(["n/a", "na", "n.a.", "entfällt", "entf."])
_MOST_COLUMNS = 12
_MOST_ROWS = 10_000
"""of all tables of a script"""
_CUTS = ("|", "\t", ";", "  ", ",")
_PATTERNS = {cut: re.compile(r"\s{2,}" if cut == "  " else re.escape(cut)) for cut in _CUTS}
_SCALED = re.compile(
    r"(?P<heading>[^(\[:,;-]+?)[\s(\[:,;-]+(?P<number>[0-9]+)(?P<said>[^0-9]+)(?:[0-9].*)?"
)


def _greatest_first(heading: str, prose: Prose) -> bool | None:
    """Return whether a heading such as `Priority (1 = highest)` says that the greatest number is
    the most important; None if it says nothing of that."""
    found = _SCALED.fullmatch(heading.strip())
    if found is None or prose.column(found["heading"]) != "priority":
        return None
    highest = prose.is_highest(found["said"])
    return None if highest is None else highest is not (int(found["number"]) <= 1)


@dataclass(frozen=True)
class _Heading:
    """A column: what it holds, and where its heading begins."""

    holds: str
    start: int
    greatest_first: bool | None = None
    """which of the numbers in it is the most important; None: that is not said"""


@dataclass(frozen=True)
class ScriptTables:
    """The tables of a script."""

    rows: dict[int, ScriptText] = field(default_factory=dict)
    """by the number of a line, what it becomes; nothing for headings and rules"""
    headings: list[ScriptText] = field(default_factory=list)
    """the lines of headings"""


def tables(source: Source, understanding: Understanding, diagnostics: Diagnostics) -> ScriptTables:
    """Read the tables of a script."""
    all_ = ScriptTables()
    found = all_.rows
    if not any(cut in source.text for cut in _CUTS):
        return all_
    rows = _Rows(understanding, diagnostics)
    headings: list[_Heading] | None = None
    cut = ""
    for number, line in enumerate(source.lines, start=1):
        if headings is not None and not (cut in line or RULE.fullmatch(line)):
            headings = None
        if headings is None:
            cut = _cut_of(line)
            if cut:
                text = source.line_text(number)
                headings = rows.headings(text, cut)
                below = _below(source, number, cut)
                if headings is not None and any(is_to_fill(row.content) for row in below):
                    headings = None  # a sheet that a person fills in
                below = _below(source, number, cut)
                if headings is not None and rows.has_places(text, headings, cut, below):
                    headings = None  # a sheet, whose order is asked about
                if source.origin(number) is not None and not _is_list_of_tasks(headings):
                    headings = None
                if headings is not None:
                    found[number] = text[:0]
                    all_.headings.append(text.strip())
                    rows.begin(headings, cut, _below(source, number, cut))
        elif len(found) > _MOST_ROWS:
            message = f"tables have more than {_MOST_ROWS} rows; the rest is not read"
            span = source.line_text(number).span()
            diagnostics.error("too-long", message, span, "split the mission into several scripts")
            break
        elif RULE.fullmatch(line):
            found[number] = source.line_text(number)[:0]
        else:
            found[number] = rows.sentence(source.line_text(number), headings, cut)
    return all_


def _is_list_of_tasks(headings: "list[_Heading] | None") -> bool:
    """Return True if a table of a document says of its tasks what no sheet to fill in does."""
    held = {heading.holds for heading in headings or ()}
    return bool(held & {"priority", "optional", "needed", "speed", "condition"})


def _below(source: Source, number: int, cut: str) -> Iterator[ScriptText]:
    """The rows of a table below the line of its headings."""
    for at in range(number + 1, len(source.lines) + 1):
        if cut not in source.lines[at - 1] or at > number + _MOST_ROWS:
            return
        yield source.line_text(at)


def _cut_of(line: str) -> str:
    """What cuts the columns of a line; nothing where there are none."""
    if len(line) > 2000:
        return ""
    inner = line.strip()
    if "|" in inner.strip("|") or (inner.startswith("|") and inner.endswith("|")):
        return "|"
    return next((cut for cut in _CUTS if cut in inner and cut != "|"), "")


class _Rows:
    """Makes sentences of rows. Mutable: a script may have several tables."""

    def __init__(self, understanding: Understanding, diagnostics: Diagnostics) -> None:
        self.understanding = understanding
        self.prose = understanding.language.prose
        self.asides = Asides(understanding)
        self.diagnostics = diagnostics
        self.greatest_first: bool | None = None
        """of the priorities in the table"""
        self.asked = False
        """whether it has been asked which scale is meant"""
        self.greatest = 0

    def headings(self, text: ScriptText, cut: str) -> list[_Heading] | None:
        """The columns, if a line has the headings of a table."""
        first = _PATTERNS[cut].split(text.content.strip(), 1)[0].strip('" \t')
        if cut != "|" and first and self.prose.column(first) is None:
            return None
        cells = list(_cells(text, cut))
        scales = {at: _greatest_first(cell.content, self.prose) for at, cell in cells}
        known = [
            ("priority" if scales[at] is not None else self.prose.column(cell.content), at, cell)
            for at, cell in cells
            if cell.content
        ]
        if not (2 if cut in ";," else 1) <= len(known) <= _MOST_COLUMNS:
            return None
        strange = [cell for holds, _, cell in known if holds is None]
        if strange:
            return None
        held = {holds for holds, _, _ in known}
        if not held & {"checkpoint", "object", "action"}:
            return None
        by_start = {at: holds or "nothing" for holds, at, _ in known}
        return [_Heading(by_start.get(at, "nothing"), at, scales[at]) for at, _ in cells]

    def has_places(
        self, text: ScriptText, headings: list[_Heading], cut: str, rows: Iterator[ScriptText]
    ) -> bool:
        """Return True if a column such as `Order` gives the rows another order."""
        cells = dict(_cells(text, cut))
        ordering = pattern(r"\b<ordering>\b")
        named = [h for h in headings if ordering.search(cells[h.start].content)]
        if len(named) != 1:
            return False
        found = [_by_column(row, headings, cut).get(named[0].holds) for row in rows]
        places = [place_in_order(cell.content) for cell in found if cell is not None]
        numbers = [place for place in places if place is not None]
        return bool(numbers) and (named[0].holds == "action" or numbers != sorted(numbers))

    def begin(self, headings: list[_Heading], cut: str, rows: Iterator[ScriptText]) -> None:
        """Looks at the priorities of all rows: what each is worth hangs on the others."""
        column = next((heading for heading in headings if heading.holds == "priority"), None)
        if column is not None:
            found = (_by_column(row, headings, cut).get("priority") for row in rows)
            said = [cell.content for cell in found if cell]
            self.greatest_first, self.asked = column.greatest_first, False
            self.greatest = max((int(c) for c in said if _NUMBER.fullmatch(c)), default=0)

    def sentence(self, text: ScriptText, headings: list[_Heading], cut: str) -> ScriptText:
        """The sentence of a row."""
        cells = _by_column(text, headings, cut)
        named = cells.get("object") if "checkpoint" in cells else None
        if named is not None and self.asides.orders_row(named):
            ask_of_remark(cells.pop("object"), self.diagnostics)
        remark = cells.get("remark")
        if remark is not None and not (self.asides.asks(remark) or self.asides.bids(remark)):
            self._note(cells.pop("remark"))
        if "nothing" in cells:
            self._note(cells["nothing"])
        if "done" in cells:
            self._done(cells["done"])
        action = cells.get("action")
        if action is not None and action.content.lower() in expand(self.prose.form["nothing"]):
            self._ask_of_cell(cells.pop("action"))
        number = cells.get("number")
        mark: list[str | ScriptText] = ["- "]
        if number is not None and _NUMBER.fullmatch(number.content.strip(" .)#")):
            mark = [number.content.strip(" .)#"), ". "]
        elif number is not None:
            self._note(number)
        wholes = [
            [_joined([*mark, *parts], text) for parts in self._readings(placed)]
            for placed in self._on_floor(cells)
        ]
        behind = len("".join(map(str, mark)))
        fitting = (w for ws in wholes for w in ws if self.understanding.fits(w[behind:]))
        return next(fitting, wholes[0][0])

    def _on_floor(self, cells: dict[str, ScriptText]) -> list[dict[str, ScriptText]]:
        """The cells with the floor said of the checkpoint, so that one on another is found."""
        floor = cells.get("floor")
        named = next((key for key in ("checkpoint", "object") if key in cells), None)
        if floor is None:
            return [cells]
        if named is None:
            self._note(floor)
            return [cells]
        says = (self.prose.say["floor"], self.prose.say["on"])
        return [{**cells, named: _joined([cells[named], f" {said} ", floor])} for said in says]

    def _done(self, cell: ScriptText) -> None:
        """Asks about a step that may be done already."""
        if cell.content.lower() in expand(self.prose.no):
            self._warn_of_remark(cell)
            return
        message = f"`{cell.content}` can mean that this is done already"
        hint = "remove the column, or the rows that are done"
        self.diagnostics.error("ambiguous-cell", message, cell.span(), hint)

    def _ask_of_cell(self, cell: ScriptText) -> None:
        """Ask about a row whose cell may leave it out, such as `-` under `Action`."""
        message = f"`{cell.content}` can mean that this row is not a task"
        hint = "remove the row, or what stands in this column"
        self.diagnostics.error("ambiguous-cell", message, cell.span(), hint)

    def _note(self, aside: ScriptText) -> None:
        times = _TIMES.isdisjoint(self.asides.understanding.types(aside))
        ordered = self.asides.orders_row(aside)
        if not times or ordered or self.asides.corrects(aside) or self.asides.bids(aside):
            ask_of_remark(aside, self.diagnostics)
            return
        if aside.content.lower() in _NOT_APPLICABLE:
            self._ask_of_cell(aside)
            return
        self._warn_of_remark(aside)

    def _warn_of_remark(self, aside: ScriptText) -> None:
        message = f"`{aside.content}` is taken for a remark and has no effect"
        self.diagnostics.warning("no-effect", message, aside.span())

    def _readings(self, cells: dict[str, ScriptText]) -> Iterator[list[str | ScriptText]]:
        """The sentences that the cells may stand for, the most likely first."""
        behind = list(self._behind(cells))
        verb: list[str | ScriptText] = [cells["action"], " "] if "action" in cells else []
        point, object_ = cells.get("checkpoint"), cells.get("object")
        named: list[str | ScriptText] = []
        if point is not None:
            plain = point.content[:1] in "#0123456789"
            named = [f"{self.prose.say['checkpoint']} ", point] if plain else [point]
        if point is not None and object_ is not None:
            yield [*verb, *named, " (", object_, ")", *behind]
            yield [*verb, *named, ": ", object_, *behind]
            yield [*verb, f"{self.prose.say['of']} ", *named, " (", object_, ")", *behind]
        elif object_ is not None:
            yield [*verb, object_, *behind]
        else:
            yield [*verb, *named, *behind]

    def _behind(self, cells: dict[str, ScriptText]) -> Iterator[str | ScriptText]:
        """What a row says of its step: priority, whether it may be left out, speed."""
        if (cell := cells.get("priority")) is not None:
            worth = self._worth(cell)
            if worth != "1":
                yield from (f" {self.prose.say['priority']} ", _as(worth, cell) if worth else cell)
        if (cell := cells.get("optional")) is not None:
            said = cell.content.lower()
            if said in expand(self.prose.yes):
                yield from (" ", _as(self.prose.say["optional"], cell))
            elif said not in expand(self.prose.no):
                yield from (" ", cell)
        if (cell := cells.get("needed")) is not None:
            yield from self._unless_needed(cell)
        if (cell := cells.get("speed")) is not None:
            yield from (f" {self.prose.say['speed']} ", cell)
        if (cell := cells.get("remark")) is not None:
            yield from (" ", cell)
        if (cell := cells.get("condition")) is not None:
            if cell.content.lower() in expand(self.prose.no):
                self._note(cell)
            else:
                yield from (" ", cell)

    def _worth(self, cell: ScriptText) -> str:
        """The priority of a cell as the sentences count them, of which the greatest is the most
        important; nothing for what is no priority. Without a scale numbers are asked about."""
        if _NUMBER.fullmatch(cell.content) is None:
            return self.prose.rank(cell.content) or ""
        number = int(cell.content)
        if self.greatest_first is None and not self.asked:
            self.asked = True
            message = f"`{cell.content}` can count from the most important one, or from the "
            message += "least"
            hint = "write above the column `Priority (1 = highest)` or `Priority (1 = lowest)`, or "
            hint += "`high`, `medium` and `low` in it"
            self.diagnostics.error("ambiguous-priority", message, cell.span(), hint)
        return str(self.greatest + 1 - number if self.greatest_first is False else number)

    def _unless_needed(self, cell: ScriptText) -> Iterator[str | ScriptText]:
        """What a row says of its step under `Needed`, where `no` may mean two things."""
        said = cell.content.lower()
        if said in expand(self.prose.columns["optional"]):
            yield from (" ", _as(self.prose.say["optional"], cell))
        elif said in expand(self.prose.no) and said not in expand(self.prose.columns["needed"]):
            message = f"`{cell.content}` can mean that this is optional, or that it is excluded"
            hint = f"write `{self.prose.columns['optional'].split(' |')[0]}`, or remove the row"
            self.diagnostics.error("ambiguous-cell", message, cell.span(), hint)
        elif said not in expand(f"{self.prose.yes} | {self.prose.columns['needed']}"):
            yield from (" ", cell)


def _by_column(text: ScriptText, headings: list[_Heading], cut: str) -> dict[str, ScriptText]:
    """The cells of a row that say something, by what their columns hold."""
    found: dict[str, ScriptText] = {}
    for i, (at, cell) in enumerate(_cells(text, cut, len(headings))):
        under = [h for h in headings if h.start <= at + 1]
        heading = headings[min(i, len(headings) - 1)] if cut != "  " else (under or headings)[-1]
        if cell.content:
            before = found.get(heading.holds)
            found[heading.holds] = cell if before is None else _joined([before, " ", cell])
    return found


def _cells(
    text: ScriptText, cut: str, most: int = _MOST_COLUMNS + 1
) -> Iterator[tuple[int, ScriptText]]:
    """The cells of a line, with the column at which each begins. What signs of a sentence cut has
    at most so many cells, and what stands in quotation marks is one."""
    content = text.content
    start, end = 0, len(content)
    if cut == "|":
        start = content.find("|") + 1 if content.lstrip().startswith("|") else 0
        end = content.rfind("|") if content.rstrip().endswith("|") else end
    places = [found.span() for found in _PATTERNS[cut].finditer(content, start, end)]
    if cut in ";,":
        within = quotes(content)
        places = [(a, b) for a, b in places if not any(x < a < y for x, y in within)][: most - 1]
    at = start
    for stop, behind in [*places, (end, end)]:
        cell = text[at:stop]
        if cut != "  " or cell.content.strip():
            left = at + len(cell.content) - len(cell.content.lstrip())
            cell = cell.strip()
            whole = cut in ";," and quotes(cell.content) == [(0, len(cell.content))]
            yield left, cell[1:-1].strip() if whole else cell
        at = behind


def _as(said: str, cell: ScriptText) -> ScriptText:
    """Other words at the place of a cell."""
    return cell.replace(0, len(cell.content), said)


def _joined(parts: list[str | ScriptText], row: ScriptText | None = None) -> ScriptText:
    """The parts in one text; words that are added stand where the next cell does."""
    cells = [part for part in parts if isinstance(part, ScriptText)]
    content: list[str] = []
    offsets: list[int] = []
    near = (row or cells[0]).strip().offsets[0]
    for i, part in enumerate(parts):
        if isinstance(part, ScriptText):
            content.append(part.content)
            offsets += part.offsets
            continue
        ahead = next((p for p in parts[i:] if isinstance(p, ScriptText)), None)
        at = ahead.offsets[0] if ahead is not None else (offsets or [near])[-1]
        content.append(part)
        offsets += [at] * len(part)
    return ScriptText("".join(content), offsets, (row or cells[0]).source)
