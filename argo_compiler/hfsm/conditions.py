"""Conditions: when they hold, and how people read them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from argo_compiler.il import Condition, ConditionType


@dataclass(frozen=True, slots=True)
class Measured:
    """A value measured at a checkpoint, in the checkpoint's unit, and when (s)."""

    value: float
    time: float


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


def holds(condition: Condition, values: Mapping[str, Measured], now: float) -> bool:
    """Whether a condition holds for the values last measured (by object_id) at time `now`.

    A value that was never measured, or is older than `max_age`, makes it false. One that is exactly
    `max_age` old still counts.
    """
    measured = values.get(condition.object_id)
    if measured is None:
        return False
    if condition.max_age is not None and now - measured.time > condition.max_age:
        return False
    return comparison(condition)(measured.value)


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
