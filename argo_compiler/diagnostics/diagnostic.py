"""One diagnostic about some input: what is wrong, how bad it is, and where."""

from collections.abc import Iterable, Sequence

from pydantic import Field
from pydantic.json_schema import SkipJsonSchema

from argo_compiler.base.errors import Remedy, RemedyChoice
from argo_compiler.base.model import Model
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.codes.code import Severity

MAX_EXCERPT = 200
"""characters of the longest source line that is shown with a diagnostic"""


class Span(Model):
    """A stretch of one source line. Lines and columns count from 1, in characters."""

    line: int
    column: int
    length: int = 1


_CHECKED = Span(line=1, column=1, length=1)
_fill = object.__setattr__


def span_at(line: int, column: int, length: int) -> Span:
    """A span of numbers that need no check: a script has very many, and this is far faster."""
    new = object.__new__(Span)
    _fill(new, "__dict__", {"line": line, "column": column, "length": length})
    _fill(new, "__pydantic_fields_set__", _CHECKED.__pydantic_fields_set__)
    _fill(new, "__pydantic_extra__", None)
    _fill(new, "__pydantic_private__", None)
    return new


class Diagnostic(Model):
    """One diagnostic. `code` is stable and explained in `docs/diagnostics.md`."""

    code: str
    severity: Severity
    message: str
    span: Span | None = None
    excerpt: str | None = None
    """the source line that the span lies in"""
    hint: str | None = None
    """the way out"""
    subject: str | None = None
    """what it is about, as a path into the mission that goes by names, such as
    `tasks['MEASURE 4'].transitions[0]`; see `argo_compiler.diagnostics.subject`"""
    remedies: tuple[Remedy, ...] = Field(default=(), exclude=True)
    """how to take the way out, for front ends that add their own words"""
    choice: SkipJsonSchema[RemedyChoice | None] = Field(default=None, exclude=True)
    """what the hint lets one choose by the remedy, where it says that"""


def diagnostic_of(
    code: str,
    message: str,
    hint: str | None = None,
    subject: str | None = None,
    span: Span | None = None,
    severity: Severity | None = None,
    choice: RemedyChoice | None = None,
) -> Diagnostic:
    """Return a diagnostic; without a severity it is as bad as its code is."""
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
    """Whether there is an error among them."""
    return any(diagnostic.severity is Severity.ERROR for diagnostic in diagnostics)


def by_place(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """All in the source's order, at one place errors before warnings and notes, then by code. Those
    without a place come last, in the order in which they are given."""
    return tuple(sorted(diagnostics, key=_place))


_RANKS = tuple(Severity)


def _place(diagnostic: Diagnostic) -> tuple[bool, int, int, int, str]:
    span = diagnostic.span
    if span is None:
        return (True, 0, 0, 0, "")
    rank = _RANKS.index(diagnostic.severity)
    return (False, span.line, span.column, rank, diagnostic.code)


def with_excerpts(
    diagnostics: Iterable[Diagnostic], lines: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """The diagnostics with the source's lines that they point at."""

    def shown(diagnostic: Diagnostic) -> Diagnostic:
        span = diagnostic.span
        if span is None or span.line > len(lines):
            return diagnostic
        line = lines[span.line - 1]
        excerpt = line if len(line) <= MAX_EXCERPT else None
        return diagnostic.model_copy(update={"excerpt": excerpt})

    return tuple(shown(diagnostic) for diagnostic in diagnostics)


def count(diagnostics: Iterable[Diagnostic], severity: Severity) -> int:
    """How many of them are of that severity."""
    return sum(diagnostic.severity is severity for diagnostic in diagnostics)


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """How many there are, such as `2 errors, 5 warnings`."""
    diagnostics = tuple(diagnostics)
    counts = ((count(diagnostics, severity), severity) for severity in Severity)
    parts = (f"{number} {severity}{'' if number == 1 else 's'}" for number, severity in counts)
    return ", ".join(part for part in parts if not part.startswith("0 ")) or "no findings"
