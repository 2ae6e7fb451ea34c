"""Script text to syntax tree: tells the two kinds of script apart, heals the text and parses it."""

import re
from collections.abc import Collection
from typing import Literal

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.garbage_collector import collector_held
from argo_compiler.script.syntax.healing import heal
from argo_compiler.script.syntax.nodes import Script
from argo_compiler.script.syntax.protocol import parse_protocol, protocol_grammar
from argo_compiler.script.syntax.sheet import parse_sheet, sheet_grammar
from argo_compiler.script.syntax.source import Diagnostics, Source
from argo_compiler.script.syntax.spelling import respell
from argo_compiler.script.syntax.vocabulary import PROTOCOL_MARKS, SHEET_MARKS, SHEET_WORDS

MAX_LINES = 120_000
"""of a script; one with more is refused unread"""

_NUMBERED = re.compile(r"\s*(?:step\s+)?[0-9]+\s*[.):]", re.IGNORECASE)
_MARKS = SHEET_MARKS | PROTOCOL_MARKS | {"mission", "protocol"}
_WORD = re.compile(r"[a-z][\w'-]*")
_UNRECOGNISED = (
    "a sheet begins like `Mission's designation: Mission #1` and `Main mode: Autonomous`; "
    "a protocol begins like `Mission Protocol #2` and `1. Set a starting point in starting area 1`"
)


@collector_held()
def parse(text: str, vocabulary: Collection[str] = (), source_name: str = "script") -> Script:
    """The syntax tree of the script, with all that was found on the way in its `diagnostics`.

    `vocabulary` are the site's words (`catalog_words`), by which cut names are healed. Lines that
    can't be understood are errors among the diagnostics, and the rest of the tree stands without
    them. Raises DiagnosticError if it is no script at all.
    """
    source = Source(text, source_name)
    kind = _kind_of(source)
    words = {*vocabulary, *_keywords(kind)}
    if kind == "sheet":
        return parse_sheet(heal(source, words | SHEET_WORDS), source)
    return parse_protocol(heal(source, words), source)


def _keywords(kind: Literal["sheet", "protocol"]) -> Collection[str]:
    grammar = sheet_grammar() if kind == "sheet" else protocol_grammar()
    return grammar.keywords.values()


def _kind_of(source: Source) -> Literal["sheet", "protocol"]:
    """Which kind of script it is, by the words that only lines of one kind open with."""
    diagnostics = Diagnostics(source)
    if not source.text.strip("\ufeff \t\r\n"):
        diagnostics.error("empty", "the script is empty", None, _UNRECOGNISED)
        raise DiagnosticError(source.name, diagnostics.entries)
    lines = max(source.text.count("\n"), source.text.count("\r")) + 1
    if lines > MAX_LINES:
        message = f"the script has {lines} lines; at most {MAX_LINES} are read"
        diagnostics.error("too-long", message, None, "divide the mission")
        raise DiagnosticError(source.name, diagnostics.entries)

    for understand in (_as_spelled, respell):
        votes = {"sheet": 0, "protocol": 0, "steps": 0}
        for line in source.lines:
            words = _WORD.findall(line[:80].lower())[:2]
            is_step = _NUMBERED.match(line[:80]) is not None
            read = [word for w in words if (word := understand(w, _MARKS))]
            if read == ["mission", "protocol"]:
                return "protocol"
            mark = next((word for word in read if word != "mission"), None)
            votes["sheet"] += mark in SHEET_MARKS
            votes["protocol"] += mark in PROTOCOL_MARKS
            # A protocol may have the fields of a sheet; its steps tell them apart.
            first = understand(words[0], _MARKS) if words else None
            votes["steps"] += is_step * ((first in PROTOCOL_MARKS) - (first in SHEET_MARKS))
        if votes["steps"] > 0:
            return "protocol"
        if votes["sheet"] or votes["protocol"]:
            return "sheet" if votes["sheet"] >= votes["protocol"] else "protocol"
    message = "this is neither a mission sheet nor a mission protocol"
    opening = next(i for i, line in enumerate(source.lines, start=1) if line.strip("\ufeff \t"))
    diagnostics.error(
        "unrecognised", message, source.line_text(opening).strip().span(0, 1), _UNRECOGNISED
    )
    raise DiagnosticError(source.name, diagnostics.entries)


def _as_spelled(word: str, known: frozenset[str]) -> str | None:
    return word if word in known else None
