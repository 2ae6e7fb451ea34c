"""The syntax of the mission protocol (thesis, figure 5.1): header lines, then commands."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

from argo_compiler.script.syntax.clauses import HeaderClause, LineBuilder, Statement
from argo_compiler.script.syntax.healing import MOST_ERRORS, Healed
from argo_compiler.script.syntax.labels import PROTOCOL_LABELS, name_unknown_label
from argo_compiler.script.syntax.nodes import AreaField, Hint, Protocol, ProtocolStep
from argo_compiler.script.syntax.sentences import SentenceBuilder
from argo_compiler.script.syntax.sheet import sheet_grammar
from argo_compiler.script.syntax.sheet_rows import RowBuilder
from argo_compiler.script.syntax.source import Diagnostics, ScriptText, Source, join
from argo_compiler.script.syntax.statements import Grammar, load_grammar, parse_statement
from argo_compiler.script.syntax.terms import Node

FORMS = (
    "Mission Protocol #2",
    "Set a starting point in starting area 1",
    "Set a starting point in front of the site",
    "Patrol the first floor in circles for 10 minutes",
    "Patrol floor 2 three times",
    "Check the checkpoint #14",
    "Check checkpoints #1, #4 and #8",
    "Read the position of valve R25",
    "Add checkpoint #2 after checkpoint #14",
    "Delete the measuring of checkpoint #2",
    "Move checkpoint #4 before checkpoint #1",
    "Replace checkpoint #1 by checkpoint #2",
    "Go to the front of the site",
    "Go to (12.5, 3, 2.5) heading 90 degrees",
    "Return to the docking station",
    "Repeat steps 2 to 4 three times",
    "If the value of checkpoint #1 is greater than 5, skip to step 5",
    "If a gas leak is detected, return to the docking station",
    "When the battery is low, go to the docking station, recharge and resume",
    "Hint: what the planner should know",
    "Done!",
)
PROTOCOL_STARTS = ("line",)
"""rules of the grammar to parse by"""
MAX_STATEMENT = 50_000
"""characters in a statement of several lines"""

_NUMBERED = re.compile(r"(?:step\s+)?[0-9]+\s*(?:[.)](?![0-9])|:(?![0-9]))", re.IGNORECASE)
_LABELLED = re.compile(r"[^\W\d_][\w'-]*(?:\s+[\w'-]+){0,5}\s*:")
_PROSE = re.compile(
    r"(?:hints?|notes?|remark|[\w' -]*(?:specification|report|reporting|designation|"
    r"initial position|end of (?:the )?mission))\s*:",
    re.IGNORECASE,
)
_LAST_WORD = re.compile(
    r"(?:[,:(\[-]|\b(?:and|or|then|the|a|an|of|on|to|at|in|is|if|when|than|by|with|for|"
    r"from|between|before|after|until|within|last|otherwise|least|most))$",
    re.IGNORECASE,
)


_BATCH = 64
"""statements that go through each pass together: code that stays in the processor's caches is
faster by a fifth"""
_TAIL = 12
"""characters in which the last word of a line that is not finished can be told"""


def protocol_grammar() -> Grammar:
    """The grammar of the protocol's lines."""
    return load_grammar("protocol", PROTOCOL_STARTS, FORMS)


def _statements(lines: Iterable[ScriptText]) -> Iterator[ScriptText]:
    """The statements; the lines of one that goes on are joined."""
    openers = protocol_grammar().openings("line")
    gathered: list[ScriptText] = []
    indent = 0
    prose = unfinished = False
    for line in lines:
        text = line.strip()
        content = text.content
        depth = len(line.content) - len(line.content.lstrip())
        if (
            gathered
            and not _NUMBERED.match(content)
            and (_goes_on(content, openers, prose) if depth > indent else unfinished)
            and not _LABELLED.match(content)
        ):
            gathered.append(text)
        else:
            if gathered:
                yield join(gathered) if len(gathered) > 1 else gathered[0]
            gathered, indent = [text], depth
            prose = ":" in content and _PROSE.match(content) is not None
        unfinished = (
            content[-1] not in ".!;)"
            and not prose
            and _LAST_WORD.search(content[-_TAIL:]) is not None
        )
    if gathered:
        yield join(gathered) if len(gathered) > 1 else gathered[0]


def _goes_on(content: str, openers: frozenset[str], prose: bool) -> bool:
    """Whether a line that is indented further goes on with the statement above."""
    if prose or not content[0].isupper():
        return True
    match = re.match(r"[\w'-]+", content)
    return match is None or match.group().lower() not in openers


@dataclass
class _Parts:
    """What the lines of a protocol come to."""

    fields: dict[str, Any] = field(default_factory=dict)
    steps: list[ProtocolStep] = field(default_factory=list)
    hints: list[Hint] = field(default_factory=list)


def parse_protocol(healed: Healed, source: Source) -> Protocol:
    """The protocol in the healed lines; what can't be understood is in its diagnostics."""
    for batch in (_BATCH, 1):
        diagnostics = Diagnostics(source, list(healed.diagnostics))
        errors = diagnostics.errors
        parts = _Parts()
        statements = _statements(healed.statements(diagnostics))
        while texts := list(islice(statements, batch)):
            if diagnostics.errors > (errors if batch > 1 else MOST_ERRORS + 1):
                break
            _read(texts, parts, diagnostics)
        # Which error is the last one to be reported can be told one by one only.
        if diagnostics.errors == errors:
            break
    return Protocol(
        source_name=source.name,
        source_text=source.text,
        steps=tuple(parts.steps),
        hints=tuple(parts.hints),
        diagnostics=diagnostics.by_place(),
        **parts.fields,
    )


def _read(texts: Sequence[ScriptText], parts: _Parts, diagnostics: Diagnostics) -> None:
    """Adds what the statements come to."""
    grammar = protocol_grammar()
    statements = []
    for text in texts:
        if len(text.content) > MAX_STATEMENT:
            message = f"the statement has {len(text.content)} characters"
            hint = f"at most {MAX_STATEMENT} are read; break it into statements"
            diagnostics.error("long-line", message, text.span(0, 1), hint)
            continue
        parsed = parse_statement(grammar, "line", text, diagnostics)
        if parsed is None:
            name_unknown_label(text, PROTOCOL_LABELS, diagnostics)
        else:
            statements.append(parsed)
    nodes = [LineBuilder(parsed.text, diagnostics).statement(parsed.tree) for parsed in statements]
    for parsed, node in zip(statements, nodes, strict=True):
        if isinstance(node, Hint):
            parts.hints.append(node)
        elif isinstance(node, Statement):
            commands = SentenceBuilder(parsed.text, diagnostics).commands(node.clauses)
            span = commands[0].span if commands else parsed.text.span()
            parts.steps.append(ProtocolStep(span=span, number=node.number, commands=commands))
        elif isinstance(node, HeaderClause):
            _add_field(node, parts.fields, diagnostics)


def _add_field(header: HeaderClause, fields: dict[str, Node], diagnostics: Diagnostics) -> None:
    node = header.node
    if isinstance(node, ScriptText):
        node = _areas(node, diagnostics)
        if node is None:
            return
    if header.field in fields:
        message = f"a second {header.field.replace('_', ' ')}"
        diagnostics.error("repeated-field", message, node.span, "leave one of the two out")
    fields[header.field] = node


def _areas(text: ScriptText, diagnostics: Diagnostics) -> AreaField | None:
    """The starting areas that a cell of free words names."""
    span = text.span()
    parsed = parse_statement(sheet_grammar(), "areas", text, diagnostics)
    areas = RowBuilder(parsed.text, diagnostics).statement(parsed.tree) if parsed else None
    if parsed is None or areas is None:
        return None
    return AreaField(span=span, text=" ".join(parsed.text.content.split()), areas=areas)
