"""What a code stands for."""

from dataclasses import dataclass
from enum import StrEnum


class Severity(StrEnum):
    """How bad it is: an error stops the compiler, a warning is shown and the work goes on, and so
    is a note, which says what has no effect and need not be looked after."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


@dataclass(frozen=True, slots=True)
class Code:
    """What a code stands for. Both texts are whole sentences."""

    severity: Severity
    meaning: str
    remedy: str
    """the way out"""


def error(meaning: str, remedy: str) -> Code:
    """What an error's code stands for."""
    return Code(Severity.ERROR, meaning, remedy)


def warning(meaning: str, remedy: str) -> Code:
    """What a warning's code stands for."""
    return Code(Severity.WARNING, meaning, remedy)


def note(meaning: str, remedy: str) -> Code:
    """What a note's code stands for."""
    return Code(Severity.NOTE, meaning, remedy)
