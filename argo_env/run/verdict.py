"""Verdict of a run as data: parts with codes, and their English texts.

`result.py` decides which parts a verdict has. The planner page makes its own texts, in English and
German, from the same data (`argo_planner/page/src/texts/verdict.ts`).
"""

from collections.abc import Callable, Iterable, Mapping
from enum import StrEnum

from argo_compiler.base.model import Model
from argo_compiler.il import EventKind
from argo_env.formatting import distinct_time_texts, min_sec_text, rounded_time_text


class VerdictCode(StrEnum):
    """Code of a part of a verdict; with each, the fields of the part that it needs."""

    AS_PLANNED = "as_planned"
    """a success without anything to add"""
    COMPLETED = "completed"
    """a success; the other parts say what is to add"""
    NOTHING_GIVEN_UP = "nothing_given_up"
    """a success, although the mission was ended before its end: all that it requires was done"""

    RETURNED = "returned"
    """ended at the dock; `event`: by the reaction to it, else after a failure"""
    SHELTERED = "sheltered"
    """ended in a safe area by the reaction to `event`"""
    NOT_REACHED = "not_reached"
    """ended, as the robot did not reach its dock or the safe area; `event` as for RETURNED"""
    ABORTED = "aborted"
    """ended where the robot was; `event` as for RETURNED"""
    CANCELLED = "cancelled"
    """ended by a person"""
    NOT_ENDED = "not_ended"
    """the mission still goes on; `times`: s since its start"""

    RUN_TOO_LONG = "run_too_long"
    """the run was stopped; `times`: s, Argo's limit for a run"""
    BATTERY_EMPTY = "battery_empty"
    """the run was stopped; `times`: s, when the battery was empty"""
    WAITS_IN_VAIN = "waits_in_vain"
    """the run was stopped; `times`: s since when the robot waits for an event"""
    STAYS_PAUSED = "stays_paused"
    """the run was stopped; `times`: s since when the mission is paused"""
    NEVER_BEGUN = "never_begun"
    """the run was stopped; `times`: s since when a supervisory mission waits for a person"""
    HELD_BY_STOP = "held_by_stop"
    """the run was stopped; `times`: s since when the emergency stop holds the robot"""
    STOPPED_BY_PERSON = "stopped_by_person"
    """a person stopped the run"""
    STOPPED = "stopped"
    """the run was stopped; `times`: s, when"""
    OTHER = "other"
    """`text` in English, such as the reason that a program gave for stopping the run"""

    FAILED = "failed"
    """`names`: tasks"""
    WINDOW_MISSED = "window_missed"
    """`names`: tasks"""
    NOT_DONE = "not_done"
    """`names`: tasks that were still to come and were never done"""
    NOT_DONE_AGAIN = "not_done_again"
    """`names`: tasks that were done, and might have been repeated"""
    READ = "read"
    """`numbers`: of checkpoints that were read, and of all; `names`: object_ids of the others"""
    TOO_LATE = "too_late"
    """`times`: s that the mission took and might have taken"""
    DOCKED = "docked"
    """`numbers`: the starting area where the robot ended, as the mission asks"""
    NOT_DOCKED = "not_docked"
    """`numbers`: the starting area where the robot should have ended"""
    DOCKED_ELSEWHERE = "docked_elsewhere"
    """`numbers`: the starting area where the robot ended, and that where it should have"""

    DONE_BEFORE = "done_before"
    """`names`: tasks done before this run"""
    BY_HAND_BEFORE = "by_hand_before"
    """`names`: tasks done by hand or skipped before this run"""
    PASSED_OVER = "passed_over"
    """`names`: tasks that a condition passed over"""
    REACHED_ALL_THE_SAME = "reached_all_the_same"
    """`names`: tasks whose drive was interrupted, at whose pose the robot ended all the same"""
    BY_HAND = "by_hand"
    """`names`: tasks that a person did"""
    SKIPPED = "skipped"
    """`names`: tasks that a person skipped"""
    OPTIONAL_FAILED = "optional_failed"
    """`names`: optional tasks that failed"""
    OPTIONAL_NOT_DONE = "optional_not_done"
    """`names`: optional tasks that were still to come"""


class VerdictPart(Model):
    """Part of a verdict: a code, and the fields that the code needs."""

    code: VerdictCode
    names: tuple[str, ...] = ()
    """names of tasks, or object_ids of checkpoints"""
    times: tuple[float, ...] = ()
    """s"""
    numbers: tuple[int, ...] = ()
    """numbers of starting areas, or of checkpoints"""
    event: EventKind | None = None
    text: str = ""

    def __str__(self) -> str:
        return _TEXTS[self.code](self)


def verdict_text(parts: Iterable[VerdictPart]) -> str:
    """Return a verdict as text, without a full stop."""
    return "; ".join(map(str, parts))


def _reaction(part: VerdictPart) -> str | None:
    return part.event and f"the reaction to {part.event.replace('_', ' ')} ended the mission"


def _names(text: str) -> Callable[[VerdictPart], str]:
    return lambda part: f"{text}: {', '.join(part.names)}"


def _fixed(text: str) -> Callable[[VerdictPart], str]:
    return lambda _: text


def _after(text: str) -> Callable[[VerdictPart], str]:
    return lambda part: text.format(rounded_time_text(part.times[0]))


def _standing(why: str) -> Callable[[VerdictPart], str]:
    return lambda part: (
        f"the robot has stood still since {min_sec_text(part.times[0])}, {why}, and nothing more "
        "occurs"
    )


def _read(part: VerdictPart) -> str:
    read, total = part.numbers
    if read == total:
        return "the checkpoint was read" if total == 1 else f"all {total} checkpoints were read"
    missing = ", ".join(f"#{name}" for name in part.names)
    return f"{read} of {total} checkpoint{'s' if total > 1 else ''} read, not {missing}"


def _too_late(part: VerdictPart) -> str:
    took, most = distinct_time_texts(*part.times)
    return f"it took {took} of at most {most}"


_C = VerdictCode
_ABORTED = "the mission was aborted"
_TEXTS: Mapping[VerdictCode, Callable[[VerdictPart], str]] = {
    _C.AS_PLANNED: _fixed("everything was done as planned"),
    _C.COMPLETED: _fixed("the mission was completed"),
    _C.NOTHING_GIVEN_UP: _fixed("all that the mission requires was done"),
    _C.RETURNED: lambda part: f"{_reaction(part) or _ABORTED}, and the robot returned to its dock",
    _C.SHELTERED: lambda part: f"{_reaction(part) or _ABORTED}, and the robot went to a safe area",
    _C.NOT_REACHED: lambda part: (
        f"{_reaction(part) or _ABORTED}, and the robot did not reach the place where it should wait"
    ),
    _C.ABORTED: lambda part: _reaction(part) or _ABORTED,
    _C.CANCELLED: _fixed("the mission was cancelled by a person"),
    _C.NOT_ENDED: _after("the mission has not ended after {}"),
    _C.RUN_TOO_LONG: _after("it was stopped after {}, Argo's limit for a run"),
    _C.BATTERY_EMPTY: _after("the battery was empty after {}"),
    _C.WAITS_IN_VAIN: _standing("waiting for an event"),
    _C.STAYS_PAUSED: _standing("paused"),
    _C.NEVER_BEGUN: lambda part: (
        f"{_standing('paused')(part)}: a supervisory mission begins when a person resumes it (the "
        "event `resume`)"
    ),
    _C.HELD_BY_STOP: _standing("held by its emergency stop"),
    _C.STOPPED_BY_PERSON: _fixed("it was stopped by a person"),
    _C.STOPPED: _after("it was stopped after {}"),
    _C.OTHER: lambda part: part.text,
    _C.FAILED: _names("failed"),
    _C.WINDOW_MISSED: _names("missed the time window"),
    _C.NOT_DONE: _names("not done"),
    _C.NOT_DONE_AGAIN: _names("not done again"),
    _C.READ: _read,
    _C.TOO_LATE: _too_late,
    _C.DOCKED: lambda part: f"the robot is docked in starting area {part.numbers[0]}",
    _C.NOT_DOCKED: lambda part: f"the robot is not docked in starting area {part.numbers[0]}",
    _C.DOCKED_ELSEWHERE: lambda part: "the robot is docked in starting area {}, not in {}".format(
        *part.numbers
    ),
    _C.DONE_BEFORE: _names("done before this run"),
    _C.BY_HAND_BEFORE: _names("done by hand or skipped before this run"),
    _C.PASSED_OVER: _names("passed over"),
    _C.REACHED_ALL_THE_SAME: _names("reached all the same"),
    _C.BY_HAND: _names("done by hand"),
    _C.SKIPPED: _names("skipped by a person"),
    _C.OPTIONAL_FAILED: _names("optional tasks that failed"),
    _C.OPTIONAL_NOT_DONE: _names("optional tasks not done"),
}
