"""Diagnostics as text for a terminal."""

import unicodedata
from collections.abc import Callable, Sequence

from argo_compiler.base.message import Message, identifier
from argo_compiler.base.wording import worded
from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.diagnostic import Diagnostic, has_errors, severity_counts_text

_INDENT = "    "


def to_text(
    diagnostics: Sequence[Diagnostic], source_name: str, say: Callable[[str], str] = str
) -> str:
    """Return all diagnostics as text with marked source lines, and their numbers by severity.

    If there are errors, a warning takes only one line, so that the errors are seen first. A note
    always takes one line. `say` puts a message into the language of the reader.
    """
    brief = has_errors(diagnostics)
    lines = []
    for diagnostic in diagnostics:
        lines.append(_headline(diagnostic, source_name, say))
        severity = diagnostic.severity
        if severity is Severity.ERROR or (severity is Severity.WARNING and not brief):
            lines += _details(diagnostic, say)
    if len(diagnostics) > 1:
        lines.append(f"{_printable(source_name)}: {say(severity_counts_text(diagnostics))}")
    return "\n".join(lines)


def _headline(diagnostic: Diagnostic, source_name: str, say: Callable[[str], str]) -> str:
    span = diagnostic.span
    location = f"{source_name}:{span.line}:{span.column}" if span else source_name
    if diagnostic.place:
        location = f"{source_name}: {diagnostic.place}"
    subject = (
        "" if span or diagnostic.place or not diagnostic.subject else f"{diagnostic.subject}: "
    )
    message = say(worded(diagnostic.message, diagnostic.message_wording))
    severity = say(identifier(diagnostic.severity))
    return _printable(f"{location}: {severity}: {subject}{message} [{diagnostic.code}]")


def _details(diagnostic: Diagnostic, say: Callable[[str], str]) -> list[str]:
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
        hint = say(worded(diagnostic.hint, diagnostic.hint_wording))
        lines.append(f"{_INDENT}{say(Message('hint'))}: {_printable(hint)}")
    return lines


def _printable(text: str) -> str:
    """Return the text with a replacement for each character that would control the terminal."""
    return "".join(
        c if c.isprintable() or _width(c) == 0 else "\N{REPLACEMENT CHARACTER}" for c in text
    )


def _width(text: str) -> int:
    """Return the terminal columns of a text: 2 for a wide character, 0 for a combining mark."""
    return sum(
        0
        if unicodedata.category(c) in {"Mn", "Me"}
        else 2
        if unicodedata.east_asian_width(c) in {"W", "F"}
        else 1
        for c in text
    )
