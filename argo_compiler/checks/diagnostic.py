"""Diagnostics about tasks, groups and reactions."""

from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.il import Group, Reaction, Task


def diagnostic_about(
    at: str,
    part: Task | Group | Reaction,
    code: str,
    message: str,
    hint: str,
    severity: Severity = Severity.ERROR,
    field: str = "",
) -> Diagnostic:
    """What is wrong with the part whose subject is `at`, or with one of its fields."""
    return Diagnostic(
        code=code,
        severity=severity,
        message=message,
        span=part.source,
        hint=hint,
        subject=at + field,
    )
