"""The syntax of the mission sheet (thesis, figure 1.4): its rows, and the cells of free words.

A cell's label stands beside the middle of the cell, so that the first lines of the cell may come
before the label. A line without a label belongs to the label above it, unless it begins a sentence
that goes on beside the label below: it opens with a capital, the lines down to the label do not
end the sentence, and the text beside the label does not open one of its own.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from argo_compiler.diagnostics import Span
from argo_compiler.script.syntax.healing import Healed
from argo_compiler.script.syntax.nodes import (
    AreaField,
    ModeField,
    OrderField,
    Sheet,
    SheetStep,
    TextField,
)
from argo_compiler.script.syntax.sheet_rows import Cell, Label, RowBuilder
from argo_compiler.script.syntax.source import MAX_LINE, Diagnostics, ScriptText, Source, join
from argo_compiler.script.syntax.spelling import most_alike, respell
from argo_compiler.script.syntax.statements import Grammar, load_grammar, matches, parse_statement
from argo_compiler.script.syntax.terms import Duration, Node

FORMS = (
    "Mission's designation: Mission #1",
    "Main mode: Autonomous",
    "Maximum mission total duration: 20'",
    "Anomaly specification: anything outside the normal values",
    "Real-time reporting: as per the rules",
    "After-mission report: as per the rules",
    "Initial position: docked in starting area 1 or 2",
    "End of the mission: docked in starting area 1 or 2",
    "Inspect the checkpoints in this precise order:",
    "1. Checkpoint #4: read the position of valve R25",
    "1. Checkpoint #1: read the value on pressure gauge 1",
    "1. Checkpoint #2: read the level on liquid level gauge 1",
)
SHEET_STARTS = ("row", "order", "areas")
"""rules of the grammar to parse by"""


def sheet_grammar() -> Grammar:
    """The grammar of the sheet's rows."""
    return load_grammar("sheet", SHEET_STARTS, FORMS)


@dataclass
class _SheetParser:
    """Gathers the fields of a sheet from row to row."""

    diagnostics: Diagnostics
    fields: dict[str, Any] = field(default_factory=dict)
    cells: dict[Label, Cell] = field(default_factory=dict)
    steps: list[SheetStep] = field(default_factory=list)
    above: Cell | None = None
    """the cell that a line without a label may belong to"""
    waiting: list[ScriptText] = field(default_factory=list)
    """lines without a label whose cell is not known yet"""

    def line(self, text: ScriptText) -> None:
        words = text.strip()
        rule = _rule_of(text)
        if rule is None:
            self.waiting.append(words)
            return
        parsed = parse_statement(sheet_grammar(), rule, words, self.diagnostics)
        row = RowBuilder(parsed.text, self.diagnostics).statement(parsed.tree) if parsed else None
        cell = row if isinstance(row, Cell) else None
        self.place_waiting(cell)
        self.above = cell
        if isinstance(row, Cell):
            self.add_cell(row)
        elif isinstance(row, SheetStep):
            self.steps.append(row)
        elif isinstance(row, ModeField):
            self.add_field("mode", row)
        elif isinstance(row, Duration):
            self.add_field("max_duration", row)
        elif isinstance(row, OrderField):
            self.add_field("order", row)

    def place_waiting(self, below: Cell | None) -> None:
        """Gives the waiting lines to the cell above and the cell below."""
        lines, self.waiting = self.waiting, []
        split = _first_of_below(lines, below)
        if self.above:
            self.above.parts += lines[:split]
        elif lines[:split]:
            message = "this line belongs to no field of the sheet"
            hint = f"write a line such as: {most_alike(lines[0].content, FORMS)}"
            self.diagnostics.error("stray-text", message, lines[0].span(), hint)
        if below:
            below.parts[:0] = lines[split:]

    def add_cell(self, cell: Cell) -> None:
        known = self.cells.setdefault(cell.label, cell)
        if known is cell:
            return
        if cell.continues:
            known.parts += cell.parts
            self.above = known
        else:
            self.repeated(cell.label, cell.at.span())

    def add_field(self, name: str, node: Node) -> None:
        if name in self.fields:
            self.repeated(name, node.span)
        self.fields[name] = node

    def repeated(self, name: str, span: Span) -> None:
        message = f"a second {name.replace('_', ' ')}"
        self.diagnostics.error("repeated-field", message, span, "leave one of the two out")

    def close_cell(self, cell: Cell) -> None:
        text = join(cell.parts) if cell.parts else cell.at[:0]
        span = text.span() if text.content else cell.at.span()
        if len(text.content) > MAX_LINE:
            message = f"the field has {len(text.content)} characters; at most {MAX_LINE} are read"
            self.diagnostics.error("long-line", message, cell.at.span(), "shorten it")
        elif cell.label not in (Label.INITIAL, Label.END):
            content = " ".join(text.content.split())
            self.fields[cell.label] = TextField(span=span, text=content)
        elif parsed := parse_statement(sheet_grammar(), "areas", text, self.diagnostics):
            areas = RowBuilder(parsed.text, self.diagnostics).statement(parsed.tree)
            if areas is not None:
                content = " ".join(parsed.text.content.split())
                self.fields[cell.label] = AreaField(span=span, text=content, areas=areas)


_STEP = re.compile(r"\d+\s*[.)]|checkpoint\b", re.IGNORECASE)
_LABEL = re.compile(r"[\w#'-]+(?:\s+[\w#'-]+){0,6}\s*:")
_SENTENCE_ENDS = (".", "!", "?", ":")


def _rule_of(line: ScriptText) -> str | None:
    """The rule that the line's shape calls for; None for a line of free words."""
    content = line.content.strip()
    if _introduces_steps(content):
        return "order"
    if _STEP.match(content):
        return "row"
    # In the second column a colon may stand within a sentence.
    in_sentence = line.content[0].isspace() and content[0].islower()
    if _LABEL.match(content) and not in_sentence:
        return "row"
    return "row" if matches(sheet_grammar(), "row", line.strip()) else None


def _introduces_steps(content: str) -> bool:
    """Whether the words may be the sentence over the steps: `checkpoints ... order:`."""
    words = content.lower().rstrip(" .:").split()
    ends_in_order = words[-1:] == ["order"] or respell("".join(words[-1:]), ["order"])
    return bool(ends_in_order) and (
        content.endswith(":")
        or any(w.startswith("checkpoint") or respell(w, ["checkpoints"]) for w in words)
    )


def _first_of_below(lines: Sequence[ScriptText], below: Cell | None) -> int:
    """The index of the first of the `lines` that belongs to the cell below them."""
    if not lines or below is None or lines[-1].content.endswith(_SENTENCE_ENDS):
        return len(lines)
    if below.parts and below.parts[0].content[0].isupper():
        return len(lines)
    openings = [i for i, line in enumerate(lines) if line.content[0].isupper()]
    return openings[-1] if openings else len(lines)


def parse_sheet(healed: Healed, source: Source) -> Sheet:
    """The sheet in the healed lines; what can't be understood is in its diagnostics."""
    diagnostics = Diagnostics(source, list(healed.diagnostics))
    parser = _SheetParser(diagnostics)
    for line in healed.statements(diagnostics):
        parser.line(line)
    parser.place_waiting(None)
    for cell in parser.cells.values():
        parser.close_cell(cell)
    return Sheet(
        source_name=source.name,
        source_text=source.text,
        steps=tuple(parser.steps),
        diagnostics=diagnostics.by_place(),
        **parser.fields,
    )
