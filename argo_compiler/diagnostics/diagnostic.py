"""Diagnostics about an input: code, severity, message and position."""

from collections.abc import Iterable, Sequence

from pydantic import BaseModel, Field
from pydantic.json_schema import SkipJsonSchema

from argo_compiler.base.errors import Remedy, RemedyChoice
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Worded, Wording, wording_field
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.codes.code import Severity

MAX_EXCERPT = 200
"""largest length of a source line that is shown with a diagnostic, in characters"""


class Span(Model):
    """Range in one source line. Lines and columns count from 1, in characters."""

    line: int
    column: int
    length: int = 1


_GIVEN = Span(line=1, column=1, length=1).__pydantic_fields_set__
_set_values, _set_given, _set_extra, _set_private = (
    BaseModel.__dict__[name].__set__
    for name in (
        *("__dict__", "__pydantic_fields_set__", "__pydantic_extra__", "__pydantic_private__"),
    )
)


def span_at(line: int, column: int, length: int) -> Span:
    """Return a span at a line and column, both from 1, without checking the numbers.

    This is much faster, as a script has very many spans.
    """
    new = object.__new__(Span)
    _set_values(new, {"line": line, "column": column, "length": length})
    _set_given(new, _GIVEN)
    _set_extra(new, None)
    _set_private(new, None)
    return new


class Diagnostic(Worded):
    """Diagnostic of a mission or script. `docs/diagnostics.md` explains the stable codes."""

    code: str
    severity: Severity
    message: Text
    message_wording: Wording | None = wording_field("message")
    span: Span | None = None
    place: str | None = None
    """place in a document, such as `Round!B7` or `page 2, row 3`; the span is then one in the text
    that was read from the document"""
    excerpt: str | None = None
    """source line that contains the span"""
    hint: Text | None = None
    """how to resolve the problem"""
    hint_wording: Wording | None = wording_field("hint")
    subject: str | None = None
    """part of the mission concerned, as a path by names, such as
    `tasks['MEASURE 4'].transitions[0]`; see `argo_compiler.diagnostics.subject`"""
    remedies: tuple[Remedy, ...] = Field(default=(), exclude=True)
    """machine-readable remedies, for front ends that name their own options"""
    choice: SkipJsonSchema[RemedyChoice | None] = Field(default=None, exclude=True)
    """the values that the hint offers for a remedy, if any"""


def diagnostic_of(
    code: str,
    message: str,
    hint: str | None = None,
    subject: str | None = None,
    span: Span | None = None,
    severity: Severity | None = None,
    choice: RemedyChoice | None = None,
) -> Diagnostic:
    """Return a diagnostic; without `severity` it has the severity of its code in `CODES`.

    Without `hint` it has none.
    """
    return Diagnostic(
        code=code,
        severity=severity or CODES[code].severity,
        message=message,
        hint=hint,
        subject=subject,
        span=span,
        remedies=() if choice is None else (choice.remedy,),
        choice=choice,
    )


def has_errors(diagnostics: Iterable[Diagnostic]) -> bool:
    """Return True if at least one diagnostic is an error."""
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)


def by_position(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """Return the diagnostics sorted by source position, then severity (errors first) and code.

    Diagnostics without a span come last, in their given order.
    """
    return tuple(sorted(diagnostics, key=_sort_key))


_RANKS = tuple(Severity)


def _sort_key(diagnostic: Diagnostic) -> tuple[bool, int, int, int, str]:
    span = diagnostic.span
    if span is None:
        return (True, 0, 0, 0, "")
    rank = _RANKS.index(diagnostic.severity)
    return (False, span.line, span.column, rank, diagnostic.code)


def with_excerpts(
    diagnostics: Iterable[Diagnostic], lines: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """Return the diagnostics with the source lines of their spans as excerpts.

    `lines` are all lines of the source. A line longer than MAX_EXCERPT gives no excerpt.
    """

    def with_excerpt(diagnostic: Diagnostic) -> Diagnostic:
        span = diagnostic.span
        if span is None or span.line > len(lines):
            return diagnostic
        line = lines[span.line - 1]
        excerpt = line if len(line) <= MAX_EXCERPT else None
        return diagnostic.model_copy(update={"excerpt": excerpt})

    return tuple(with_excerpt(diagnostic) for diagnostic in diagnostics)


def count(diagnostics: Iterable[Diagnostic], severity: Severity) -> int:
    """Return the number of diagnostics of a severity."""
    return sum(diagnostic.severity is severity for diagnostic in diagnostics)


def severity_counts_text(diagnostics: Iterable[Diagnostic]) -> Message:
    """Return the numbers of diagnostics by severity as text, such as `2 errors, 5 warnings`.

    Severities without diagnostics are left out; without any, the text is `no findings`.
    """
    diagnostics = tuple(diagnostics)
    errors, warnings, notes = (count(diagnostics, severity) for severity in Severity)
    parts = [
        *([Message("1 error")] if errors == 1 else []),
        *([Message("{errors} errors", errors=errors)] if errors > 1 else []),
        *([Message("1 warning")] if warnings == 1 else []),
        *([Message("{warnings} warnings", warnings=warnings)] if warnings > 1 else []),
        *([Message("1 note")] if notes == 1 else []),
        *([Message("{notes} notes", notes=notes)] if notes > 1 else []),
    ]
    return Message("{parts}", parts=parts) if parts else Message("no findings")
