"""Kinds of trace entries, of ends of a mission, and of results of a measurement."""

from enum import StrEnum


class Cause(StrEnum):
    """Why there is an entry in the trace."""

    START = "start"
    RESTORE = "restored"
    CONDITION = "condition"
    REPEAT = "repeat"
    DEFAULT = "default"
    TIMEOUT = "time out"
    RETRY = "retry"
    """an action that failed is started anew"""
    FAILURE = "failure"
    """an action failed for good, and it does not go on as after another end"""
    MISSED = "window missed"
    """a task's hard window is over, and what follows then"""
    ROUND = "round begins"
    """a round that was not due before"""
    READING = "reading given"
    """somebody else told a value"""
    LATE = "late"
    """an action that was being cancelled succeeded after all, when its task had been left"""
    REPORT = "report"
    """an event has occurred"""
    REACTION = "reaction"
    """the reaction to an event begins"""
    HOLD = "hold"
    """a reaction stands still and waits"""
    LIMIT = "limit of the hold"
    """it stands still no longer"""
    MISSION = "mission goes on"
    PAUSE = "pause"
    RESUME = "resume"
    CANCEL = "cancel"
    END = "end"
    """a reaction ends the mission"""


class Outcome(StrEnum):
    """End of a mission."""

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


class ReadingKind(StrEnum):
    """Result of the last measurement at a checkpoint (C3)."""

    VALUE = "value"
    UNREADABLE = "unreadable"
    FAILED = "failed"
