"""Findings as text for a terminal."""

import unicodedata
from collections.abc import Sequence

from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.finding import Diagnostic, has_errors, summary

_INDENT = "    "


def to_text(findings: Sequence[Diagnostic], source_name: str) -> str:
    """All findings, the source line with a mark below each, and how many there are.

    Beside errors a warning takes one line only: what stops the work should be seen first.
    """
    brief = has_errors(findings)
    lines = []
    for finding in findings:
        lines.append(_headline(finding, source_name))
        if not (brief and finding.severity is Severity.WARNING):
            lines += _details(finding)
    if len(findings) > 1:
        lines.append(f"{_printable(source_name)}: {summary(findings)}")
    return "\n".join(lines)


def _headline(finding: Diagnostic, source_name: str) -> str:
    span = finding.span
    place = f"{source_name}:{span.line}:{span.column}" if span else source_name
    subject = "" if span or not finding.subject else f"{finding.subject}: "
    return _printable(f"{place}: {finding.severity}: {subject}{finding.message} [{finding.code}]")


def _details(finding: Diagnostic) -> list[str]:
    lines = []
    if finding.span and finding.excerpt:
        excerpt = _printable(finding.excerpt.replace("\t", " "))
        lines.append(_INDENT + excerpt)
        start = finding.span.column - 1
        # A shortened source line may end before the mark.
        if start <= len(excerpt):
            marked = excerpt[start : start + finding.span.length]
            caret = "^" * max(1, _width(marked))
            lines.append(_INDENT + " " * _width(excerpt[:start]) + caret)
    if finding.hint:
        lines.append(f"{_INDENT}hint: {_printable(finding.hint)}")
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
