"""Diagnostics as text for a terminal."""

import unicodedata
from collections.abc import Sequence

from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.diagnostic import Diagnostic, has_errors, summary

_INDENT = "    "


def to_text(diagnostics: Sequence[Diagnostic], source_name: str) -> str:
    """All diagnostics, the source line with a mark below each, and how many there are.

    Beside errors a warning takes one line only: what stops the work should be seen first. A note
    always does.
    """
    brief = has_errors(diagnostics)
    lines = []
    for diagnostic in diagnostics:
        lines.append(_headline(diagnostic, source_name))
        severity = diagnostic.severity
        if severity is Severity.ERROR or (severity is Severity.WARNING and not brief):
            lines += _details(diagnostic)
    if len(diagnostics) > 1:
        lines.append(f"{_printable(source_name)}: {summary(diagnostics)}")
    return "\n".join(lines)


def _headline(diagnostic: Diagnostic, source_name: str) -> str:
    span = diagnostic.span
    place = f"{source_name}:{span.line}:{span.column}" if span else source_name
    subject = "" if span or not diagnostic.subject else f"{diagnostic.subject}: "
    return _printable(
        f"{place}: {diagnostic.severity}: {subject}{diagnostic.message} [{diagnostic.code}]"
    )


def _details(diagnostic: Diagnostic) -> list[str]:
    lines = []
    if diagnostic.span and diagnostic.excerpt:
        excerpt = _printable(diagnostic.excerpt.replace("\t", " "))
        lines.append(_INDENT + excerpt)
        start = diagnostic.span.column - 1
        # A shortened source line may end before the mark.
        if start <= len(excerpt):
            marked = excerpt[start : start + diagnostic.span.length]
            caret = "^" * max(1, _width(marked))
            lines.append(_INDENT + " " * _width(excerpt[:start]) + caret)
    if diagnostic.hint:
        lines.append(f"{_INDENT}hint: {_printable(diagnostic.hint)}")
    return lines


def _printable(text: str) -> str:
    """The text without characters that would steer the terminal; each stands for one."""
    return "".join(
        c if c.isprintable() or _width(c) == 0 else "\N{REPLACEMENT CHARACTER}" for c in text
    )


def _width(text: str) -> int:
    """Columns that the text takes on a terminal: two for wide characters, none for marks."""
    return sum(
        0
        if unicodedata.category(c) in {"Mn", "Me"}
        else 2
        if unicodedata.east_asian_width(c) in {"W", "F"}
        else 1
        for c in text
    )
