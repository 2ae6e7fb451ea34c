"""Kinds of trace entries, of outcomes of a mission, and of results of a measurement."""

from enum import StrEnum


class Cause(StrEnum):
    """Cause of an entry of the trace."""

    START = "start"
    RESTORE = "restored"
    CONDITION = "condition"
    REPEAT = "repeat"
    DEFAULT = "default"
    TIMEOUT = "time out"
    RETRY = "retry"
    """an action that failed is started again"""
    FAILURE = "failure"
    """an action failed for good, and the mission does not continue as after a success"""
    MISSED = "window missed"
    """a task's hard window is over, and its `missed` transition is taken"""
    ROUND = "round begins"
    """the awaited round of a group, which was not due before, begins"""
    READING = "reading given"
    """somebody other than the robot reported a value"""
    LATE = "late"
    """an action that was being cancelled succeeded when its task had already been left"""
    REPORT = "report"
    """an event has occurred"""
    REACTION = "reaction"
    """the reaction to an event begins"""
    HOLD = "hold"
    """a reaction holds: the robot stands still and waits"""
    LIMIT = "limit of the hold"
    """the limit of the hold is over"""
    MISSION = "mission goes on"
    PAUSE = "pause"
    RESUME = "resume"
    CANCEL = "cancel"
    END = "end"
    """a reaction, or the drive to the dock after a failure, ends the mission"""


class Outcome(StrEnum):
    """Outcome of a mission."""

    COMPLETED = "completed"
    """the mission came to its end, and no task that is not optional failed for good"""
    COMPLETED_WITH_FAILURES = "completed with failures"
    """the mission came to its end, but a task that is not optional failed for good"""
    RETURNED = "returned"
    """ended at the dock, after a failure or an event"""
    SHELTERED = "sheltered"
    """ended in a safe area, after an event"""
    FAILED = "failed"
    """the drive to the dock or to a safe area failed as well"""
    ABORTED = "aborted"
    """ended where the robot stood, after a failure or an event"""
    CANCELLED = "cancelled"
    """ended by a person"""


class ReadingKind(StrEnum):
    """Kind of the last measurement's result at a checkpoint (C3)."""

    VALUE = "value"
    UNREADABLE = "unreadable"
    UNREACHABLE = "unreachable"
    FAILED = "failed"
