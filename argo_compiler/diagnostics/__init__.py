"""Diagnostics: messages of the compiler about its input, with positions in the source.

`to_text`, `to_json` and `to_sarif` write diagnostics for people, programs and code hosts. `CODES`
explains all codes.
"""

from argo_compiler.diagnostics.codes import CODES
from argo_compiler.diagnostics.codes.code import Severity
from argo_compiler.diagnostics.diagnostic import (
    MAX_EXCERPT,
    Diagnostic,
    Span,
    by_position,
    count,
    diagnostic_of,
    has_errors,
    severity_counts_text,
    span_at,
    with_excerpts,
)
from argo_compiler.diagnostics.error import DiagnosticError
from argo_compiler.diagnostics.json_format import to_json
from argo_compiler.diagnostics.sarif import to_sarif
from argo_compiler.diagnostics.text import to_text

__all__ = [
    "CODES",
    "MAX_EXCERPT",
    "Diagnostic",
    "DiagnosticError",
    "Severity",
    "Span",
    "by_position",
    "count",
    "diagnostic_of",
    "has_errors",
    "severity_counts_text",
    "span_at",
    "to_json",
    "to_sarif",
    "to_text",
    "with_excerpts",
]
