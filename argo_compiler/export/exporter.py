"""What an exporter is, and how it refuses what its target can't say."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Mission

Exported = str | bytes | Mapping[str, bytes]
"""The text or the bytes of one file, or the files of a folder by their path in it."""


@dataclass(frozen=True, slots=True)
class Exporter:
    """A format that a machine can be written in."""

    description: str
    """a few words for people"""
    suffixes: tuple[str, ...]
    """what the file's name ends with, the usual one first; none where a folder is written"""
    export: Callable[[Mission, Hfsm], Exported]
    """raises DiagnosticError with a diagnostic for each thing that the format can't say"""


def refusal(
    code: str, message: str, hint: str | None = None, span: Span | None = None
) -> Diagnostic:
    """Says that the target can't say something of the mission; `code` without `export.`."""
    return Diagnostic(
        code=f"export.{code}", severity=Severity.ERROR, message=message, span=span, hint=hint
    )


def refuse(diagnostics: Iterable[Diagnostic]) -> None:
    """Raises DiagnosticError if there are diagnostics."""
    found = tuple(diagnostics)
    if found:
        raise DiagnosticError("mission", found)
