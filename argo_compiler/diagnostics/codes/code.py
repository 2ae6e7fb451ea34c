"""Severity and explanation of a diagnostic code."""

from enum import StrEnum

from argo_compiler.base.records import dataclass


class Severity(StrEnum):
    """Severity of a diagnostic.

    An error stops the compiler. A warning is shown, and the compiler continues. A note only reports
    something without effect; it needs no action.
    """

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Code:
    """Severity and explanation of a code. Both texts are whole sentences."""

    severity: Severity
    meaning: str
    remedy: str
    """how to resolve it"""


def error(meaning: str, remedy: str) -> Code:
    """Return a new entry for the registry of codes, with the severity of an error."""
    return Code(Severity.ERROR, meaning, remedy)


def warning(meaning: str, remedy: str) -> Code:
    """Return a new entry for the registry of codes, with the severity of a warning."""
    return Code(Severity.WARNING, meaning, remedy)


def note(meaning: str, remedy: str) -> Code:
    """Return a new entry for the registry of codes, with the severity of a note."""
    return Code(Severity.NOTE, meaning, remedy)
