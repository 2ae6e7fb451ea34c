"""The outcomes of a mission."""

from enum import StrEnum


class Outcome(StrEnum):
    """How a mission has ended."""

    COMPLETED = "completed"
    """all was done that the plan asked for"""
    COMPLETED_WITH_FAILURES = "completed with failures"
    """the plan came to its end, and a task that is not optional had failed for good"""
    RETURNED = "returned"
    """at the dock, after a failure or an event"""
    SHELTERED = "sheltered"
    """in a safe area, after an event"""
    FAILED = "failed"
    """the way to the dock or to a safe area failed as well"""
    ABORTED = "aborted"
    """where the robot stood, after a failure or an event"""
    CANCELLED = "cancelled"
    """by a person"""
