"""Script text to syntax tree: tells the two kinds of script apart, heals the text and parses it."""

import re
from collections.abc import Collection
from typing import Literal

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.script.healing import heal
from argo_compiler.script.nodes import Script
from argo_compiler.script.protocol import parse_protocol, protocol_grammar
from argo_compiler.script.sheet import parse_sheet, sheet_grammar
from argo_compiler.script.source import Findings, Source
from argo_compiler.script.spelling import respell
from argo_compiler.script.vocabulary import SHEET_WORDS

MAX_LINES = 20_000
"""of a script; one with more is refused unread"""

_WORD = re.compile(r"[a-z][\w'-]*")
_UNRECOGNISED = (
    "a sheet begins like `Mission's designation: Mission #1` and `Main mode: Autonomous`; "
    "a protocol begins like `Mission Protocol #2` and `1. Set a starting point in starting area 1`"
)


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
    findings = Findings(source)
    if not source.text.strip("\ufeff \t\r\n"):
        findings.error("empty", "the script is empty", None, _UNRECOGNISED)
        raise DiagnosticError(source.name, findings.diagnostics)
    if len(source.lines) > MAX_LINES:
        message = f"the script has {len(source.lines)} lines; at most {MAX_LINES} are read"
        findings.error("too-long", message, None, "divide the mission")
        raise DiagnosticError(source.name, findings.diagnostics)

    sheet, protocol = _marks()
    openings = [_WORD.findall(line[:80].lower())[:2] for line in source.lines]
    for understand in (_as_spelled, respell):
        of_sheet = of_protocol = 0
        for words in openings:
            read = (understand(word, sheet | protocol) for word in words)
            mark = next((word for word in read if word), None)
            of_sheet += mark in sheet
            of_protocol += mark in protocol
        if of_sheet or of_protocol:
            return "sheet" if of_sheet >= of_protocol else "protocol"
    message = "this is neither a mission sheet nor a mission protocol"
    line = next(i for i, text in enumerate(source.lines, start=1) if text.strip("\ufeff \t"))
    findings.error(
        "unrecognised", message, source.line_text(line).strip().span(0, 1), _UNRECOGNISED
    )
    raise DiagnosticError(source.name, findings.diagnostics)


def _marks() -> tuple[frozenset[str], frozenset[str]]:
    """The words that mark a line's beginning as a sheet's, and as a protocol's."""
    sheet = sheet_grammar().openings("row")
    protocol = protocol_grammar().openings("line")
    return sheet - protocol, (protocol - sheet) | {"protocol"}


def _as_spelled(word: str, known: frozenset[str]) -> str | None:
    return word if word in known else None
