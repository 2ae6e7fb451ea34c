"""What the compiler has to say about its input: diagnostics with a place in the source."""

from collections.abc import Iterable
from enum import StrEnum

from argo_compiler.errors import ArgoError
from argo_compiler.model import Model


class Severity(StrEnum):
    """How bad it is: an error stops the compiler, a warning is shown and the work goes on."""

    ERROR = "error"
    WARNING = "warning"


class Span(Model):
    """A stretch of one source line. Lines and columns count from 1, in characters."""

    line: int
    column: int
    length: int = 1


class Diagnostic(Model):
    """One finding. `code` is stable, `excerpt` is the source line, `hint` the way out."""

    code: str
    severity: Severity
    message: str
    span: Span | None = None
    excerpt: str | None = None
    hint: str | None = None

    def render(self, source_name: str) -> str:
        """The finding as text: place, severity, message, source line with a caret, hint."""
        place = f"{source_name}:{self.span.line}:{self.span.column}" if self.span else source_name
        lines = [f"{place}: {self.severity}: {self.message} [{self.code}]"]
        if self.span and self.excerpt is not None:
            # Tabs would move the caret away from what it points at.
            lines.append("    " + self.excerpt.replace("\t", " "))
            lines.append("    " + " " * (self.span.column - 1) + "^" * max(1, self.span.length))
        if self.hint:
            lines.append(f"    hint: {self.hint}")
        return "\n".join(lines)


class DiagnosticError(ArgoError):
    """The input can't be used; `diagnostics` says why, errors and warnings alike."""

    def __init__(self, source_name: str, diagnostics: Iterable[Diagnostic]) -> None:
        self.source_name = source_name
        self.diagnostics = tuple(diagnostics)
        super().__init__("\n".join(d.render(source_name) for d in self.diagnostics))
