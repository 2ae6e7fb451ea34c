"""Part of a mission that a check is about."""

from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Diagnostic, Span, diagnostic_of


@dataclass(frozen=True, slots=True)
class CheckedItem:
    """Task, group or reaction that a check is about."""

    subject: str
    source: Span | None
    """where a script asked for it"""

    def diagnostic(self, code: str, message: str, hint: str, field: str = "") -> Diagnostic:
        """Return a diagnostic of the item, or of its field at a path such as `.name`."""
        return diagnostic_of(code, message, hint, self.subject + field, self.source)
