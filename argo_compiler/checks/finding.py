"""Findings about tasks and reactions."""

from argo_compiler.diagnostics import Diagnostic, Severity, Span
from argo_compiler.il import Reaction, Task


def task_finding(
    i: int,
    task: Task,
    code: str,
    message: str,
    hint: str,
    severity: Severity = Severity.ERROR,
    field: str = "",
) -> Diagnostic:
    """A finding about the mission's task `i`, or one of its fields."""
    return _finding(f"tasks[{i}]{field}", task.source, code, message, hint, severity)


def reaction_finding(
    i: int,
    reaction: Reaction,
    code: str,
    message: str,
    hint: str,
    severity: Severity = Severity.ERROR,
    field: str = "",
) -> Diagnostic:
    """A finding about the mission's reaction `i`, or one of its fields."""
    return _finding(f"reactions[{i}]{field}", reaction.source, code, message, hint, severity)


def _finding(
    subject: str, span: Span | None, code: str, message: str, hint: str, severity: Severity
) -> Diagnostic:
    return Diagnostic(
        code=code, severity=severity, message=message, span=span, hint=hint, subject=subject
    )
