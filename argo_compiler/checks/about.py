"""Diagnostics about tasks, groups and reactions."""

from dataclasses import dataclass

from argo_compiler.diagnostics import Diagnostic, Span, diagnostic_of


@dataclass(frozen=True, slots=True)
class About:
    """A task, group or reaction that is looked at."""

    subject: str
    source: Span | None
    """where a script asked for it"""

    def diagnostic(self, code: str, message: str, hint: str, field: str = "") -> Diagnostic:
        """Return what is wrong with it, or with one of its fields."""
        return diagnostic_of(code, message, hint, self.subject + field, self.source)
