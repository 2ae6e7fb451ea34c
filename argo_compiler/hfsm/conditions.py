"""Readings of checkpoints, the evaluation of conditions on them, and conditions as text."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from argo_compiler.base.message import Message
from argo_compiler.hfsm.kinds import ReadingKind
from argo_compiler.il import Condition, ConditionType, EventKind, Reaction, WaitRule
from argo_compiler.il.events import event_text


@dataclass(frozen=True, slots=True)
class Measured:
    """Value measured at a checkpoint, in the checkpoint's unit, and its time (s)."""

    value: float
    time: float


class CheckpointReading(NamedTuple):
    """Result of the last measurement at a checkpoint (C3), and its time (s)."""

    kind: ReadingKind
    time: float
    value: float | None = None
    """in the checkpoint's unit; only for the kind VALUE"""
    abnormal: bool = False


ReadingTest = Callable[[CheckpointReading, float], bool]
"""function that checks a reading of a condition's checkpoint at the present time (s)"""


def reading_test(condition: Condition) -> ReadingTest:
    """Return a function that checks whether a reading satisfies the condition.

    The function takes the reading and the present time (s). A checkpoint without a reading
    satisfies no condition; the caller checks that (C4, C7).
    """
    max_age = condition.max_age
    match condition.type:
        case ConditionType.UNREADABLE:
            return lambda reading, _: reading.kind is ReadingKind.UNREADABLE
        case ConditionType.UNREACHABLE:
            return lambda reading, _: reading.kind is ReadingKind.UNREACHABLE
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
    compare, limit = value_test(condition), condition.param1
    if max_age is None:
        # Most conditions are of these two forms: they get a predicate without a second call.
        if limit is not None and not condition.inclusive:
            if condition.type is ConditionType.LESS:
                return lambda reading, _: (value := reading.value) is not None and value < limit
            if condition.type is ConditionType.GREATER:
                return lambda reading, _: (value := reading.value) is not None and value > limit
        return lambda reading, _: (value := reading.value) is not None and compare(value)
    return lambda reading, now: (
        (value := reading.value) is not None and compare(value) and not now - reading.time > max_age
    )


def value_test(condition: Condition) -> Callable[[float], bool]:
    """Return a function that compares a value with the bounds of a LESS, GREATER or WITHIN.

    It does not check the age of the value (`max_age`).
    """
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


def is_satisfied(
    condition: Condition, readings: Mapping[str, CheckpointReading], now: float
) -> bool:
    """Return True if the readings (by object_id) satisfy the condition at time `now`.

    It is False if the checkpoint has no reading, or if the value is older than `max_age`. A value
    that is exactly `max_age` old still counts.
    """
    reading = readings.get(condition.object_id)
    return reading is not None and reading_test(condition)(reading, now)


def condition_text(condition: Condition) -> Message:
    """Return the condition as text, such as `2 < #4 < 5.5, at most 60 s old`."""
    name = f"#{condition.object_id}"
    equal = "=" if condition.inclusive else ""
    low, high = condition.param1, condition.param2
    if not condition.type.compares:
        return _state_text(condition, name)
    if condition.type is ConditionType.LESS:
        text = Message("{name} <{equal} {high:g}", name=name, equal=equal, high=low)
    elif condition.type is ConditionType.GREATER:
        text = Message("{name} >{equal} {low:g}", name=name, equal=equal, low=low)
    else:
        text = Message(
            "{low:g} <{equal} {name} <{equal} {high:g}", low=low, equal=equal, name=name, high=high
        )
    if condition.max_age is not None:
        text += Message(", at most {age:g} s old", age=condition.max_age)
    return text


def conjunction_text(conditions: Iterable[Condition]) -> Message:
    """Return conditions that must all be satisfied, at least one, as text."""
    first, *others = map(condition_text, conditions)
    text = first
    for other in others:
        text = Message("{first} and {second}", first=text, second=other)
    return text


def awaited_event_text(event: EventKind, rule: WaitRule | Reaction) -> str:
    """Return the event that ends a WAIT or a hold, such as `battery charged to 60 %`."""
    text = event_text(event)
    if rule.charge_to is not None:
        text += Message(" to {value:g} %", value=100 * rule.charge_to)
    if rule.charge_for is not None:
        text += Message(" for at least {charge_for:g} s", charge_for=rule.charge_for)
    return text


def wait_end_text(rule: WaitRule) -> str:
    """Return what ends a WAIT, such as `gas leak or #4 < 2`; empty if only its duration ends it."""
    ends = [] if rule.event is None else [awaited_event_text(rule.event, rule)]
    ends += [conjunction_text(rule.conditions)] if rule.conditions else []
    return " or ".join(ends)


def _state_text(condition: Condition, name: str) -> Message:
    match condition.type:
        case ConditionType.UNREADABLE:
            return Message("{name} unreadable", name=name)
        case ConditionType.UNREACHABLE:
            return Message("{name} unreachable", name=name)
        case ConditionType.FAILED:
            return Message("{name} failed", name=name)
        case ConditionType.STALE:
            return Message("{name} older than {age:g} s", name=name, age=condition.max_age or 0)
    text = Message("{name} abnormal", name=name)
    if condition.max_age is not None:
        text += Message(", at most {age:g} s old", age=condition.max_age)
    return text
