"""The kinds of result of a measurement."""

from enum import StrEnum


class ReadingKind(StrEnum):
    """What came of the last measurement at a checkpoint (C3)."""

    VALUE = "value"
    UNREADABLE = "unreadable"
    FAILED = "failed"
