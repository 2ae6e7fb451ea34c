"""One finding about some input: what is wrong, how bad it is, and where."""

from collections.abc import Iterable, Sequence

from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.model import Model

MAX_EXCERPT = 200
"""characters of the longest source line that is shown with a finding"""


class Span(Model):
    """A stretch of one source line. Lines and columns count from 1, in characters."""

    line: int
    column: int
    length: int = 1


class Diagnostic(Model):
    """One finding. `code` is stable and explained in `docs/diagnostics.md`."""

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


def has_errors(findings: Iterable[Diagnostic]) -> bool:
    """Whether there is an error among them."""
    return any(finding.severity is Severity.ERROR for finding in findings)


def by_place(findings: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
    """The findings in the source's order, at one place errors before warnings, then by code. Those
    without a place come last, in the order in which they are given."""
    return tuple(sorted(findings, key=_place))


def _place(finding: Diagnostic) -> tuple[bool, int, int, bool, str]:
    span = finding.span
    if span is None:
        return (True, 0, 0, False, "")
    warning = finding.severity is Severity.WARNING
    return (False, span.line, span.column, warning, finding.code)


def with_excerpts(findings: Iterable[Diagnostic], lines: Sequence[str]) -> tuple[Diagnostic, ...]:
    """The findings with the source's lines that they point at."""

    def shown(finding: Diagnostic) -> Diagnostic:
        span = finding.span
        if span is None or span.line > len(lines):
            return finding
        line = lines[span.line - 1]
        excerpt = line if len(line) <= MAX_EXCERPT else None
        return finding.model_copy(update={"excerpt": excerpt})

    return tuple(shown(finding) for finding in findings)


def count(findings: Iterable[Diagnostic], severity: Severity) -> int:
    """How many of them are of that severity."""
    return sum(finding.severity is severity for finding in findings)


def summary(findings: Iterable[Diagnostic]) -> str:
    """How many there are, such as `2 errors, 5 warnings`."""
    findings = tuple(findings)
    counts = ((count(findings, severity), severity) for severity in Severity)
    parts = (f"{number} {severity}{'' if number == 1 else 's'}" for number, severity in counts)
    return ", ".join(part for part in parts if not part.startswith("0 ")) or "no findings"
