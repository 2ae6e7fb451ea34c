"""What the compiler has to say about its input: diagnostics with a place in the source.

`Diagnostic` is one of them; `to_text`, `to_json` and `to_sarif` show them to people, programs and
code hosts. `CODES` explains every code there is.
"""

from argo_compiler.diagnostics.as_json import to_json
from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.diagnostic import (
    MAX_EXCERPT,
    Diagnostic,
    Span,
    by_place,
    count,
    diagnostic_of,
    has_errors,
    span_at,
    summary,
    with_excerpts,
)
from argo_compiler.diagnostics.error import DiagnosticError
from argo_compiler.diagnostics.sarif import to_sarif
from argo_compiler.diagnostics.text import to_text

__all__ = [
    "CODES",
    "MAX_EXCERPT",
    "Diagnostic",
    "DiagnosticError",
    "Severity",
    "Span",
    "by_place",
    "count",
    "diagnostic_of",
    "has_errors",
    "span_at",
    "summary",
    "to_json",
    "to_sarif",
    "to_text",
    "with_excerpts",
]
