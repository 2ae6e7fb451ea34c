"""How the canonical script says conditions and events."""

from collections.abc import Sequence

from argo_compiler.il import Condition, ConditionType, EventKind
from argo_compiler.il.bounds import contradict
from argo_compiler.script.write.text import UnwritableError, duration, number, quote

_RELATIONS = {
    (ConditionType.LESS, False): "below",
    (ConditionType.LESS, True): "at most",
    (ConditionType.GREATER, False): "above",
    (ConditionType.GREATER, True): "at least",
}
_STATES = {
    ConditionType.UNREADABLE: "is unreadable",
    ConditionType.FAILED: "has failed",
    ConditionType.ABNORMAL: "is abnormal",
}
_EVENTS = {
    EventKind.GAS_LEAK: "a gas leak is detected",
    EventKind.HOT_SPOT: "a hot spot is detected",
    EventKind.ABNORMAL_SOUND: "an abnormal sound is heard",
    EventKind.PLATFORM_ALARM: "the platform alarm sounds",
    EventKind.POSITIVE_OBSTACLE: "a positive obstacle is detected",
    EventKind.NEGATIVE_OBSTACLE: "a negative obstacle is detected",
    EventKind.LOW_BATTERY: "the battery is low",
    EventKind.CONNECTION_LOST: "the connection is lost",
    EventKind.EMERGENCY_STOP: "an emergency stop occurs",
    EventKind.DYSFUNCTION: "a dysfunction occurs",
    EventKind.ABNORMAL_READING: "a reading is abnormal",
    EventKind.TIME_UP: "the time is up",
    EventKind.ALL_CLEAR: "all clear is given",
    EventKind.BATTERY_CHARGED: "the battery is charged",
    EventKind.CONNECTION_RESTORED: "the connection is restored",
}


def event(kind: EventKind) -> str:
    """`a gas leak is detected`"""
    return _EVENTS[kind]


def conditions(held: Sequence[Condition]) -> str:
    """All of the conditions: `checkpoint #1 is above 2.5 and checkpoint #4 is abnormal`."""
    if contradict(held):
        raise UnwritableError("no value satisfies all of its conditions at once")
    return " and\n".join(condition(c) for c in held)


def condition(c: Condition) -> str:
    """`checkpoint #1 is above 2.5`"""
    details = []
    if c.id:
        details.append(f"called {quote(c.id)}")
    test = _comparison(c) if c.type.compares else _state(c)
    if c.type in (ConditionType.LESS, ConditionType.GREATER) and c.param2 is not None:
        details.append(f"with second bound {number(c.param2)}")
    said = f"checkpoint #{checkpoint(c.object_id)}"
    if details:
        said += f" ({' '.join(details)})"
    if c.max_age is not None and c.type is not ConditionType.STALE:
        said += f" measured within the last {duration(c.max_age)}"
    return f"{said} {test}"


def _comparison(c: Condition) -> str:
    if c.param1 is None:
        raise UnwritableError(f"a condition of type {c.type} has no bound: `param1`")
    low = number(c.param1)
    if c.type is not ConditionType.WITHIN:
        return f"is {_RELATIONS[c.type, c.inclusive]} {low}"
    if c.param2 is None:
        raise UnwritableError("a WITHIN condition has no second bound: `param2`")
    high = number(c.param2)
    return f"is from {low} to {high}" if c.inclusive else f"is between {low} and {high}"


def _state(c: Condition) -> str:
    unused = {"param1": c.param1 is not None, "param2": c.param2 is not None}
    for name, given in {**unused, "inclusive": c.inclusive}.items():
        if given:
            raise UnwritableError(f"a condition of type {c.type} has no use for `{name}`")
    if c.type is not ConditionType.STALE:
        return _STATES[c.type]
    if c.max_age is None:
        raise UnwritableError("a condition of type READING_STALE has no age: `max_age`")
    return f"is older than {duration(c.max_age)}"


def checkpoint(object_id: str) -> str:
    """A checkpoint's number."""
    if not (object_id.isascii() and object_id.isdecimal()) or object_id != str(int(object_id)):
        raise UnwritableError(f"a script names checkpoints by number, and `{object_id}` is none")
    return object_id
