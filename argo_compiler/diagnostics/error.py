"""The exception that carries diagnostics."""

from collections.abc import Iterable

from argo_compiler.base.errors import Invalid
from argo_compiler.diagnostics.diagnostic import Diagnostic, by_place
from argo_compiler.diagnostics.text import to_text


class DiagnosticError(Invalid):
    """The input can't be used; `diagnostics` says why, errors and warnings alike, by place."""

    def __init__(self, source_name: str, diagnostics: Iterable[Diagnostic]) -> None:
        self.source_name = source_name
        self.diagnostics = by_place(diagnostics)
        super().__init__(to_text(self.diagnostics, source_name))

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.source_name, self.diagnostics), vars(self)
