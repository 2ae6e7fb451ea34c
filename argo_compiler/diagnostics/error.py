"""Exception that carries diagnostics."""

from collections.abc import Iterable

from argo_compiler.base.errors import Invalid
from argo_compiler.diagnostics.diagnostic import Diagnostic, by_position
from argo_compiler.diagnostics.text import to_text


class DiagnosticError(Invalid):
    """Raised when an input can't be used; `diagnostics` has all errors and warnings by position."""

    def __init__(self, source_name: str, diagnostics: Iterable[Diagnostic]) -> None:
        self.source_name = source_name
        self.diagnostics = by_position(diagnostics)
        super().__init__(to_text(self.diagnostics, source_name))

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.source_name, self.diagnostics), vars(self)
