"""Makes what is said of how, when and how often something is done."""

from collections.abc import Iterable
from dataclasses import fields, replace
from itertools import pairwise
from typing import Any

from argo_compiler.il import Afterwards, JointState, Order
from argo_compiler.script.sentences.building.conditions import require_moment
from argo_compiler.script.sentences.building.part import (
    Make,
    RulePart,
    Signed,
    amount,
    duration,
    seconds,
    speed,
    whole,
)
from argo_compiler.script.sentences.tree.conditions import Occurs, SaidCondition
from argo_compiler.script.sentences.tree.manner import NOTHING_SAID, Manner
from argo_compiler.script.sentences.tree.places import Coordinates
from argo_compiler.script.sentences.words.word import Word

_OF_JOINTS = {"AT": "positions", "VELOCITIES": "velocities", "EFFORTS": "efforts"}
_FLAGS: dict[str, dict[str, Any]] = {
    "FINISHING": {"finishing": True},
    "STOPPING": {"finishing": False},
    "ENDLESS": {"endless": True},
    "IN_CIRCLES": {"in_circles": True},
    "ANY_ORDER": {"order": Order.ANY},
    "THIS_ORDER": {"order": Order.PRECISE},
    "REVERSED": {"backwards": True},
    "PREFERABLY": {"soft_window": True},
    "ANY_TIME": {"earliest": 0.0},
    "INCLUDED": {"count_interruptions": True},
    "EXCLUDED": {},
}
_ON_LIMIT = {"GO_ON": Afterwards.RESUME, "END": Afterwards.END, "WAIT": Afterwards.WAIT}


def _times(part: RulePart) -> Manner:
    return Manner(times=whole(part, part.the_word("TIMES").value), more=_in_all(part))


def _in_all(part: RulePart) -> bool | None:
    return False if part.has("TOTAL") else None


def _more(part: RulePart) -> Manner:
    word = part.children[0]
    if "and" in word.before:
        message = "this can mean once more right after it, or at another time"
        hint = "write `check it twice`, or the tasks in between: `..., then check it again`"
        part.error("ambiguous-manner", message, hint)
    return Manner(times=whole(part, word.value), more=True)


def _for(part: RulePart) -> Manner:
    if part.has("TIMES"):
        return _times(part)
    if event := part.word("EVENT"):
        occurs = Occurs(span=part.span, event=event.value)
        return Manner(until=SaidCondition(span=part.span, alternatives=((occurs,),)))
    if part.has("PERSON"):
        return Manner(person=True)
    return Manner(duration=duration(part))


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
        return Manner(at_most=whole(part, word.value), more=_in_all(part))
    word = part.the_word("MOST_TIME", "DURATION")
    limit = seconds(part, word)
    return Manner(mission_time=limit) if part.has("TOTAL") else Manner(time_limit=limit)


def _priority(part: RulePart) -> Manner:
    word = part.the_word("NUMBER")
    sign = -1 if part.has("MINUS") else 1
    return Manner(priority=sign * whole(part, word.value))


def _ranked(part: RulePart) -> Manner:
    word = part.children[0]
    message = f"`{part.said}` is taken as priority {word.value} (high is 3, medium 2, low 1)"
    part.diagnostics.note("priority-taken", message, part.span)
    return Manner(rank=word.value)


def _speed(part: RulePart) -> Manner:
    word = part.the_word("SPEED")
    value = speed(part, word)
    return Manner(leaving=value) if part.has("LEAVING") else Manner(speed=value)


def _joints(part: RulePart) -> Manner:
    names = tuple(str(word.value) for word in part.every(Word) if word.type == "STRING")
    given: dict[str, tuple[float, ...]] = {}
    for word, values in pairwise(part.children):
        if isinstance(word, Word) and isinstance(values, tuple):
            given[_OF_JOINTS[word.type]] = values
    return Manner(joints=JointState(names=names, **given))


def combined(part: RulePart, manners: Iterable[Manner]) -> Manner:
    """All of them in one; what is said twice is an error."""
    values: dict[str, Any] = {}
    for manner in manners:
        asked = "condition" in values or "until" in values
        if asked and (manner.times is not None or manner.duration is not None):
            message = "this can apply to the condition, or to the command"
            hint = "write it before the condition: `check #4 twice if it is above 5`"
            part.error("ambiguous-manner", message, hint)
        for field in fields(manner):
            value = getattr(manner, field.name)
            if value == field.default:
                continue
            same = field.name == "order" and value == values.get(field.name)
            if field.name in values and not same:
                what = field.name.replace("_", " ")
                part.error("repeated-limit", f"the {what} is given twice", "remove one of them")
            values[field.name] = value
    return Manner(**values) if values else NOTHING_SAID


def _only_if(part: RulePart) -> Manner:
    require_moment(part)
    return Manner(condition=part.the(SaidCondition))


RULES: dict[str, Make] = {
    "speed": _speed,
    "leaving": _speed,
    "times": _times,
    "more": _more,
    "every": lambda part: Manner(every=duration(part)),
    "pause": lambda part: Manner(pause=duration(part)),
    "within": lambda part: Manner(latest=duration(part)),
    "latest": lambda part: Manner(latest=duration(part)),
    "earliest": lambda part: Manner(earliest=duration(part)),
    "delay": lambda part: Manner(delay=duration(part)),
    "reading": lambda part: Manner(reading_limit=duration(part)),
    "charge_time": lambda part: Manner(charge_time=duration(part)),
    "for_": _for,
    "until": lambda part: Manner(until=part.the(SaidCondition)),
    "between_times": _between_times,
    "between_tasks": lambda part: Manner(task_pair=part.children[-1]),
    "at_most": _at_most,
    "if_time": lambda _: Manner(optional=True),
    "priority": _priority,
    "ranked": _ranked,
    "by_importance": lambda part: Manner(by_importance=True),  # noqa: ARG005
    "only_if": _only_if,
    "unless": lambda part: Manner(condition=replace(part.the(SaidCondition), negated=True)),
    "flag": lambda part: Manner(**_FLAGS[part.children[0].type]),
    "floored": lambda part: Manner(floors=part.the(tuple)),
    "standing": lambda part: Manner(pose=part.the(Coordinates)),
    "shown": lambda part: Manner(shown_in=part.the_word("STRING").value),
    "about": lambda part: Manner(object_id=part.the_word("STRING").value),
    "joints": _joints,
    "values": lambda part: tuple(float(signed.value) for signed in part.every(Signed)),
    "charge": lambda part: Manner(charge=amount(part)),
    "on_limit": lambda part: Manner(on_limit=_ON_LIMIT[part.the_word(*_ON_LIMIT).type]),
}
