"""Makes what is said of how, when and how often something is done."""

from collections.abc import Iterable
from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

from argo_compiler.il import Afterwards, EventKind, Order
from argo_compiler.script.syntax.building.figures import Signed, seconds, speed, whole
from argo_compiler.script.syntax.building.part import Make, RulePart
from argo_compiler.script.syntax.tree.conditions import Occurs, SaidCondition
from argo_compiler.script.syntax.tree.manner import Joints, Manner
from argo_compiler.script.syntax.tree.places import Coordinates
from argo_compiler.script.syntax.words.word import Word

_OF_JOINTS = {"AT": "positions", "VELOCITIES": "velocities", "EFFORTS": "efforts"}
_ON_LIMIT = {"GO_ON": Afterwards.RESUME, "END": Afterwards.END, "WAIT": Afterwards.WAIT}


def _seconds(part: RulePart) -> float:
    word = part.word("DURATION")
    assert word is not None
    return seconds(part, word)


def _times(part: RulePart) -> Manner:
    word = part.word("TIMES")
    assert word is not None
    return Manner(times=whole(part, word.value))


def _more(part: RulePart) -> Manner:
    return Manner(times=whole(part, part.children[0].value), more=True)


def _for(part: RulePart) -> Manner:
    if part.has("TIMES"):
        return _times(part)
    if event := part.word("EVENT"):
        return Manner(until=_until_event(part, event.value))
    if part.has("PERSON"):
        return Manner(person=True)
    return Manner(duration=_seconds(part))


def _until_event(part: RulePart, event: EventKind) -> SaidCondition:
    return SaidCondition(span=part.span, alternatives=((Occurs(span=part.span, event=event),),))


def _between_times(part: RulePart) -> Manner:
    first, last = (word for word in part.every(Word) if word.type in ("NUMBER", "DURATION"))
    latest = seconds(part, last)
    earliest = (
        seconds(part, first)
        if first.type == "DURATION"
        else whole(part, first.value) * last.value.unit
    )
    return Manner(earliest=earliest, latest=latest)


def _at_most(part: RulePart) -> Manner:
    if word := part.word("MOST_TIMES"):
        return Manner(at_most=whole(part, word.value))
    word = part.word("MOST_TIME", "DURATION")
    assert word is not None
    limit = seconds(part, word)
    return Manner(mission_time=limit) if part.has("TOTAL") else Manner(time_limit=limit)


def _priority(part: RulePart) -> Manner:
    word = part.word("NUMBER")
    assert word is not None
    sign = -1 if part.has("MINUS") else 1
    return Manner(priority=sign * whole(part, word.value))


def _ranked(part: RulePart) -> Manner:
    word = part.children[0]
    message = f"`{part.said}` is taken as priority {word.value}, of high 3, medium 2 and low 1"
    part.diagnostics.note("priority-taken", message, part.span)
    return Manner(rank=word.value)


def _flag(part: RulePart) -> Manner:
    match part.children[0].type:
        case "FINISHING":
            return Manner(finishing=True)
        case "STOPPING":
            return Manner(finishing=False)
        case "ENDLESS":
            return Manner(endless=True)
        case "IN_CIRCLES":
            return Manner(in_circles=True)
        case "ANY_ORDER":
            return Manner(order=Order.ANY)
        case "THIS_ORDER":
            return Manner(order=Order.PRECISE)
        case "PREFERABLY":
            return Manner(soft_window=True)
        case "ANY_TIME":
            return Manner(earliest=0.0)
        case "INCLUDED":
            return Manner(count_interruptions=True)
        case _:
            return Manner()


def _speed(part: RulePart) -> Manner:
    word = part.word("SPEED")
    assert word is not None
    value = speed(part, word)
    return Manner(leaving=value) if part.has("LEAVING") else Manner(speed=value)


def _string(part: RulePart) -> str:
    word = part.word("STRING")
    assert word is not None
    return str(word.value)


def _joints(part: RulePart) -> Manner:
    names = tuple(str(word.value) for word in part.every(Word) if word.type == "STRING")
    given: dict[str, tuple[float, ...]] = {}
    for word, values in pairwise(part.children):
        if isinstance(word, Word) and isinstance(values, tuple):
            given[_OF_JOINTS[word.type]] = values
    return Manner(joints=Joints(names=names, **given))


def _values(part: RulePart) -> tuple[float, ...]:
    return tuple(signed.value for signed in part.every(Signed))


def _on_limit(part: RulePart) -> Manner:
    return Manner(on_limit=next(_ON_LIMIT[w.type] for w in part.children if w.type in _ON_LIMIT))


def combined(part: RulePart, manners: Iterable[Manner]) -> Manner | None:
    """All of them in one; what is said twice is an error."""
    values: dict[str, Any] = {}
    for manner in manners:
        for field in fields(manner):
            value = getattr(manner, field.name)
            if value == field.default:
                continue
            if field.name in values:
                what = field.name.replace("_", " ")
                part.error("repeated-limit", f"the {what} is said twice", "leave one of them out")
            values[field.name] = value
    return Manner(**values) if values else None


RULES: dict[str, Make] = {
    "speed": _speed,
    "leaving": _speed,
    "times": _times,
    "more": _more,
    "every": lambda part: Manner(every=_seconds(part)),
    "for_": _for,
    "until": lambda part: Manner(until=part.the(SaidCondition)),
    "within": lambda part: Manner(latest=_seconds(part)),
    "between_times": _between_times,
    "latest": lambda part: Manner(latest=_seconds(part)),
    "earliest": lambda part: Manner(earliest=_seconds(part)),
    "delay": lambda part: Manner(delay=_seconds(part)),
    "at_most": _at_most,
    "if_time": lambda _: Manner(optional=True),
    "priority": _priority,
    "ranked": _ranked,
    "by_importance": lambda part: Manner(by_importance=True),  # noqa: ARG005
    "only_if": lambda part: Manner(condition=part.the(SaidCondition)),
    "unless": lambda part: Manner(condition=replace(part.the(SaidCondition), negated=True)),
    "flag": _flag,
    "floored": lambda part: Manner(floors=part.the(tuple)),
    "standing": lambda part: Manner(pose=part.the(Coordinates)),
    "shown": lambda part: Manner(shown_in=_string(part)),
    "about": lambda part: Manner(object_id=_string(part)),
    "joints": _joints,
    "values": _values,
    "reading": lambda part: Manner(reading_limit=_seconds(part)),
    "on_limit": _on_limit,
}
