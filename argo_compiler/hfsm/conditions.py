"""Readings and conditions: when conditions hold, and how people read them."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from argo_compiler.hfsm.kinds import ReadingKind
from argo_compiler.il import Condition, ConditionType, WaitRule


@dataclass(frozen=True, slots=True)
class Measured:
    """A value measured at a checkpoint, in the checkpoint's unit, and when (s)."""

    value: float
    time: float


class CheckpointReading(NamedTuple):
    """What came of the last measurement at a checkpoint (C3), and when (s)."""

    kind: ReadingKind
    time: float
    value: float | None = None
    """of the kind VALUE, in the checkpoint's unit"""
    abnormal: bool = False


Test = Callable[[CheckpointReading, float], bool]
"""Whether a condition holds for the reading of its checkpoint at a time (s)."""


def reading_test(condition: Condition) -> Test:
    """The test that a condition makes of a reading; without a reading it does not hold (C4, C7)."""
    max_age = condition.max_age
    match condition.type:
        case ConditionType.UNREADABLE:
            return lambda reading, _: reading.kind is ReadingKind.UNREADABLE
        case ConditionType.FAILED:
            return lambda reading, _: reading.kind is not ReadingKind.VALUE
        case ConditionType.STALE:
            return lambda reading, now: (
                max_age is not None and reading.value is not None and now - reading.time > max_age
            )
        case ConditionType.ABNORMAL:
            return lambda reading, now: (
                reading.abnormal and (max_age is None or not now - reading.time > max_age)
            )
    compare, limit = comparison(condition), condition.param1
    if max_age is None:
        # What most conditions are has no second call.
        if limit is not None and not condition.inclusive:
            if condition.type is ConditionType.LESS:
                return lambda reading, _: (value := reading.value) is not None and value < limit
            if condition.type is ConditionType.GREATER:
                return lambda reading, _: (value := reading.value) is not None and value > limit
        return lambda reading, _: (value := reading.value) is not None and compare(value)
    return lambda reading, now: (
        (value := reading.value) is not None and compare(value) and not now - reading.time > max_age
    )


def comparison(condition: Condition) -> Callable[[float], bool]:
    """The test that a LESS, GREATER or WITHIN makes of a value, its age apart."""
    low, high = condition.param1, condition.param2
    if low is None:
        return lambda _: False
    if condition.type is ConditionType.LESS:
        return (lambda value: value <= low) if condition.inclusive else (lambda value: value < low)
    if condition.type is ConditionType.GREATER:
        return (lambda value: value >= low) if condition.inclusive else (lambda value: value > low)
    if high is None:
        return lambda _: False
    if condition.inclusive:
        return lambda value: low <= value <= high
    return lambda value: low < value < high


def holds(condition: Condition, readings: Mapping[str, CheckpointReading], now: float) -> bool:
    """Whether a condition holds for the readings (by object_id) at time `now`.

    A checkpoint that has none makes it false, and a value that is older than `max_age` does. One
    that is exactly `max_age` old still counts.
    """
    reading = readings.get(condition.object_id)
    return reading is not None and reading_test(condition)(reading, now)


def words(condition: Condition) -> str:
    """The condition as text, such as `2 < #4 < 5.5, at most 60 s old`."""
    name = f"#{condition.object_id}"
    equal = "=" if condition.inclusive else ""
    if not condition.type.compares:
        return _words_of_state(condition, name)
    if condition.type is ConditionType.LESS:
        text = f"{name} <{equal} {condition.param1:g}"
    elif condition.type is ConditionType.GREATER:
        text = f"{name} >{equal} {condition.param1:g}"
    else:
        text = f"{condition.param1:g} <{equal} {name} <{equal} {condition.param2:g}"
    if condition.max_age is not None:
        text += f", at most {condition.max_age:g} s old"
    return text


def all_words(conditions: Iterable[Condition]) -> str:
    """Conditions that are to hold together, as text."""
    return " and ".join(map(words, conditions))


def awaited(rule: WaitRule) -> str:
    """What ends a WAIT, such as `gas leak or #4 < 2`; empty where only its time does."""
    ends = [] if rule.event is None else [rule.event.replace("_", " ")]
    ends += [all_words(rule.conditions)] if rule.conditions else []
    return " or ".join(ends)


def _words_of_state(condition: Condition, name: str) -> str:
    match condition.type:
        case ConditionType.UNREADABLE:
            return f"{name} unreadable"
        case ConditionType.FAILED:
            return f"{name} failed"
        case ConditionType.STALE:
            return f"{name} older than {condition.max_age or 0:g} s"
    age = "" if condition.max_age is None else f", at most {condition.max_age:g} s old"
    return f"{name} abnormal{age}"
