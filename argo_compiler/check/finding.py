"""Findings about tasks."""

from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.il import Task


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
    return Diagnostic(
        code=code,
        severity=severity,
        message=message,
        span=task.source,
        hint=hint,
        subject=f"tasks[{i}]{field}",
    )
