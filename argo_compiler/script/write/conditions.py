"""Conditions, events and the reactions to them in the canonical script."""

from collections.abc import Sequence

from argo_compiler.il import (
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Reaction,
    Response,
    WaitRule,
)
from argo_compiler.il.exclusive_conditions import are_contradictory
from argo_compiler.script.write.text import Places, UnwritableError, duration, number, point, quote

_RELATIONS = {
    (ConditionType.LESS, False): "below",
    (ConditionType.LESS, True): "at most",
    (ConditionType.GREATER, False): "above",
    (ConditionType.GREATER, True): "at least",
}
_STATES = {
    ConditionType.UNREADABLE: "is unreadable",
    ConditionType.UNREACHABLE: "is unreachable",
    ConditionType.FAILED: "has failed",
    ConditionType.ABNORMAL: "is abnormal",
}
EVENTS = {
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
_RESPONSES = {
    Response.REPORT: "report it",
    Response.PAUSE: "pause",
    Response.ABORT: "abort the mission",
}
_ON_LIMIT = {
    Afterwards.RESUME: "resume",
    Afterwards.END: "end the mission",
    Afterwards.WAIT: "wait",
}
_AFTERWARDS = {
    Afterwards.RESUME: "and resume",
    Afterwards.WAIT: "and wait for the operator",
    Afterwards.END: "and end the mission",
}
_DRIVES = (Response.RETURN, Response.SAFE_AREA)


def conditions(held: Sequence[Condition]) -> str:
    """All of the conditions: `checkpoint #1 is above 2.5 and checkpoint #4 is abnormal`."""
    if are_contradictory(held):
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
        raise UnwritableError(f"a script names checkpoints by number; `{object_id}` is none")
    return object_id


# ---- reactions


def reaction_said(reaction: Reaction, places: Places) -> str:
    """`if a gas leak is detected, return to the docking station`"""
    _require_used(reaction)
    clauses = [f"if {_occurs(reaction)}", _response(reaction, places)]
    holding = _holding(reaction)
    if recharges_for_time(reaction.until, reaction):
        clauses.append(f"recharge {holding}")
    elif holding and reaction.until is not None and reaction.response in _DRIVES:
        clauses.append(f"wait {holding}")
    elif holding:
        clauses[-1] += f" {holding}"
    if reaction.priority is not None:
        clauses.append(f"with priority {reaction.priority}")
    resumes = reaction.on_limit is Afterwards.RESUME and reaction.response in _DRIVES
    if reaction.afterwards is not Afterwards.END or resumes:
        clauses.append(_AFTERWARDS[reaction.afterwards])
    return ",\n".join(clauses)


def _occurs(reaction: Reaction) -> str:
    level = reaction.battery_below
    if level is None:
        return EVENTS[reaction.event]
    if reaction.event is not EventKind.LOW_BATTERY:
        raise UnwritableError("only a low battery has a level: `battery_below`")
    return f"the battery drops below {percentage(level, 'battery_below')} %"


def awaited(event: EventKind, rule: Reaction | WaitRule, other: str = "") -> str:
    """Return the words for the end of a wait: `until the battery is charged to 80 %`.

    `other` are the words for a further end: ` or checkpoint #1 is above 3`. Raises UnwritableError.
    """
    charged = event is EventKind.BATTERY_CHARGED
    if (rule.charge_to, rule.charge_for) != (None, None) and not charged:
        raise UnwritableError("only a battery is charged: `charge_to`, `charge_for`")
    said = f"until {EVENTS[event]}"
    if rule.charge_to is not None:
        level = percentage(rule.charge_to, "charge_to")
        said = f"until the battery is at {level} %" if other else f"{said} to {level} %"
    elif rule.charge_for is not None and other:
        raise UnwritableError("a wait for a time of charging has no other end: `charge_for`")
    said += other
    return said if rule.charge_for is None else f"{said} for at least {duration(rule.charge_for)}"


def recharges_for_time(event: EventKind | None, rule: Reaction | WaitRule) -> bool:
    """Return True if the rule waits for a least time of charging, to no named charge."""
    charged = event is EventKind.BATTERY_CHARGED
    return charged and rule.charge_to is None and rule.charge_for is not None


def percentage(share: float, field: str) -> str:
    """Return a share of the charge (0 to 1) as a number of percent, such as `80`.

    Raises UnwritableError, which names `field`, if no number of percent is exactly this share.
    """
    percent = next((p for p in (share * 100, round(share * 100, 9)) if p / 100 == share), None)
    if percent is None:
        raise UnwritableError(f"this level of the battery is not a percentage: `{field}`")
    return number(percent)


def _holding(reaction: Reaction) -> str:
    """What it waits for, for how long, and what it does then."""
    said = []
    if reaction.until is not None:
        if recharges_for_time(reaction.until, reaction):
            assert reaction.charge_for is not None
            said.append(f"for at least {duration(reaction.charge_for)}")
        else:
            said.append(awaited(reaction.until, reaction))
    elif (reaction.charge_to, reaction.charge_for) != (None, None):
        raise UnwritableError("nothing is charged: `charge_to`, `charge_for`")
    if reaction.hold_limit is not None:
        said.append(f"for at most {duration(reaction.hold_limit)}")
    if reaction.hold_limit is not None or reaction.on_limit is not Afterwards.WAIT:
        said.append(f"or else {_ON_LIMIT[reaction.on_limit]}")
    return " ".join(said)


def _response(reaction: Reaction, places: Places) -> str:
    pose, area = reaction.pose, reaction.area
    if reaction.response is Response.SAFE_AREA:
        if pose is None:
            raise UnwritableError("it has no pose")
        return f"go to {places.location(pose)}"
    if reaction.response is not Response.RETURN:
        return _RESPONSES[reaction.response]
    said = "return to the docking station"
    dock = None
    if area is not None:
        dock = places.dock(area)
        if dock is None or pose is None:
            raise UnwritableError(f"there is no docking station for area {area}")
        said += f" in starting area {area}"
    return said if pose == dock else f"{said}, standing at {point(pose)}" if pose else said


def _require_used(reaction: Reaction) -> None:
    """That nothing is said that has no effect on the response. Raises UnwritableError."""
    unused = {
        "pose": reaction.pose is not None and reaction.response not in _DRIVES,
        "area": reaction.area is not None and reaction.response is not Response.RETURN,
        "hold_limit": reaction.hold_limit is not None
        and reaction.response in _DRIVES
        and reaction.until is None,
    }
    if reaction.response in (Response.REPORT, Response.ABORT):
        unused |= {
            "until": reaction.until is not None,
            "afterwards": reaction.afterwards is not Afterwards.END,
            "hold_limit": reaction.hold_limit is not None,
            "on_limit": reaction.on_limit is not Afterwards.WAIT,
        }
    names = [f"`{name}`" for name, given in unused.items() if given]
    if reaction.response is Response.PAUSE and reaction.afterwards is Afterwards.WAIT:
        names.append("`afterwards`")
    if names:
        raise UnwritableError(f"{', '.join(names)} has no effect on this action")
