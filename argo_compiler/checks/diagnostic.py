"""Diagnostics about tasks and reactions."""

from argo_compiler.diagnostics import Diagnostic, Severity, Span
from argo_compiler.il import Reaction, Task


def task_diagnostic(
    at: str,
    task: Task,
    code: str,
    message: str,
    hint: str,
    severity: Severity = Severity.ERROR,
    field: str = "",
) -> Diagnostic:
    """A diagnostic about the task whose subject is `at`, or one of its fields."""
    return _diagnostic(at + field, task.source, code, message, hint, severity)


def reaction_diagnostic(
    at: str,
    reaction: Reaction,
    code: str,
    message: str,
    hint: str,
    severity: Severity = Severity.ERROR,
    field: str = "",
) -> Diagnostic:
    """A diagnostic about the reaction whose subject is `at`, or one of its fields."""
    return _diagnostic(at + field, reaction.source, code, message, hint, severity)


def _diagnostic(
    subject: str, span: Span | None, code: str, message: str, hint: str, severity: Severity
) -> Diagnostic:
    return Diagnostic(
        code=code, severity=severity, message=message, span=span, hint=hint, subject=subject
    )
