"""Makes sentences and facts, and runs through a sentence's tree to make all of its parts."""

from dataclasses import replace
from typing import Any

from argo_compiler.script.documents.source import Diagnostics, ScriptText
from argo_compiler.script.sentences.building import (
    conditions,
    manners,
    nouns,
    orders,
    part,
    places,
)
from argo_compiler.script.sentences.building.part import Make, RulePart, seconds, whole
from argo_compiler.script.sentences.grammar.parser import Branch
from argo_compiler.script.sentences.tree.conditions import SaidCondition
from argo_compiler.script.sentences.tree.manner import Manner
from argo_compiler.script.sentences.tree.nouns import Labelled, Nouns, Pronoun
from argo_compiler.script.sentences.tree.orders import (
    Amend,
    Case,
    DoneBefore,
    Fact,
    Follow,
    LeaveOut,
    MaxDuration,
    Measure,
    OrderFree,
    Repeat,
    Rest,
    RoundsDriven,
    ScriptOrder,
    Sentence,
    Side,
)
from argo_compiler.script.sentences.tree.places import Steps
from argo_compiler.script.sentences.words.word import Word

_RESTS = {"IN_ALL_OTHERS": Rest.ALL_OTHERS, "LAST_ROUND": Rest.LAST_ROUND}


def _case(part: RulePart) -> Case:
    """`If ..., A and B`; what comes behind a semicolon may be meant for this case, or for any."""
    orders = _joined(part)
    word = part.word(*_RESTS)
    condition = part.first(SaidCondition)
    if condition is not None and orders and orders[0].manner.delay is not None:
        behind = part.children[part.children.index(condition) + 1]
        if not isinstance(behind, Word):
            message = "this time can belong to the condition, or be a wait before the command"
            hint = "write `wait 5 minutes` as a sentence before the `if` for the first, "
            hint += "`if ..., wait 5 minutes and check ...` for the second"
            part.diagnostics.error("ambiguous-case", message, orders[0].span, hint)
    conditions.require_moment(part)
    if condition is not None and orders and isinstance(orders[0], Amend):
        _require_joint(part, condition, orders[0])
    if condition is not None and part.the(Word).value == "unless":
        condition = replace(condition, negated=True)
    for order in orders[1:]:
        if ";" in order.joint:
            message = "this can apply in this case only, or in any case"
            hint = "write `, then ...` for the first, and a separate sentence for the second"
            part.diagnostics.error("ambiguous-case", message, order.span, hint)
    rest = Rest.OTHERWISE if word is None else _RESTS[word.type]
    chained = part.has("ELSE")
    return Case(span=part.span, condition=condition, orders=orders, rest=rest, chained=chained)


def _require_joint(part: RulePart, condition: SaidCondition, manner: Amend) -> None:
    """`If it is above 4 for 2 minutes, ...`: nothing says what the time is said of."""
    before = part.children.index(condition) + 1
    if part.children[before] is not manner:
        return
    message = "this can apply to the condition, or to the command"
    hint = "remove it, or write it after the command: `if it is above 5, check #4 twice`"
    part.diagnostics.error("ambiguous-manner", message, manner.span, hint)


def _sentence(part: RulePart) -> Sentence | Fact:
    said = part.every(Fact)
    orders = _joined(part)
    if said and not orders:
        return said[0]
    return Sentence(span=part.span, orders=orders, cases=part.every(Case), facts=said)


def _joined(part: RulePart) -> tuple[ScriptOrder, ...]:
    """The orders with what stood between them. A checkpoint that is only named, and what is to be
    read there, are one: `Checkpoint #8: read the value on pressure gauge 5`."""
    found: list[ScriptOrder] = []
    joint = ""
    for child in part.children:
        if isinstance(child, ScriptOrder):
            last = found[-1] if found else None
            if (
                isinstance(last, Measure)
                and isinstance(child, Measure)
                and _same(last, child, joint)
            ):
                found[-1] = _both(last, child)
            elif isinstance(last, Follow | Repeat) and isinstance(child, Amend) and _pauses(child):
                # `Do the following twice, and wait 1 minute in between:`
                found[-1] = replace(last, manner=replace(last.manner, pause=child.manner.pause))
            else:
                if last is not None and _may_be_step(part, last, joint):
                    message = "this number can be that of a checkpoint or of a step"
                    hint = "write `check checkpoint 4` for the first, `4. ...` for the second"
                    part.diagnostics.error("ambiguous-number", message, last.span, hint)
                if isinstance(last, Measure) and _is_same_reading(child):
                    message = "this can be the last measurement, or another one"
                    hint = "remove it for the first, write `check it again` for the second"
                    part.diagnostics.error("ambiguous-measure", message, child.span, hint)
                found.append(child.joined(joint) if joint else child)
        joint = str(child.value) if isinstance(child, Word) and child.type == "NEXT" else ""
    return tuple(found)


def _pauses(order: Amend) -> bool:
    """Whether an order says nothing but how long to wait between rounds."""
    return order.manner == Manner(pause=order.manner.pause)


def _is_same_reading(order: ScriptOrder) -> bool:
    """Whether an order measures what another one has just measured: `and note the value`."""
    return (
        isinstance(order, Measure)
        and not order.manner
        and all(isinstance(noun, Pronoun) for noun in order.what.nouns)
    )


def _may_be_step(part: RulePart, order: ScriptOrder, joint: str) -> bool:
    """Whether an order is a bare number that stands as a step's does: `2; ...`, `No. 2: ...`."""
    if not isinstance(order, Measure) or not order.bare or joint not in (";", ":"):
        return False
    noun = order.what.nouns[0]
    numbered = isinstance(noun, Labelled) and noun.kind is None and isinstance(noun.label, int)
    return numbered and len(order.what.nouns) == 1 and part.said[0] != "#"


def _same(first: Measure, second: Measure, joint: str) -> bool:
    one = len(first.what.nouns) == len(second.what.nouns) == 1
    return one and not second.bare and (joint == ":" or (first.bare and joint == ","))


def _both(first: Measure, second: Measure) -> Measure:
    (noun,), (also,) = first.what.nouns, second.what.nouns
    if not isinstance(noun, Labelled) or not isinstance(also, Labelled):
        return first
    nouns = replace(first.what, nouns=(replace(noun, also=also),))
    return replace(first, what=nouns, manner=second.manner or first.manner)


# ---- facts: what is said of the mission as a whole


def _max_duration(part: RulePart) -> Fact:
    time = seconds(part, part.the_word("DURATION", "MOST_TIME"))
    where = next((c for c in part.children if not isinstance(c, Word)), None)
    return MaxDuration(span=part.span, seconds=time, where=where)


def _precedence(part: RulePart) -> Fact:
    first, second = (c for c in part.children if isinstance(c, Nouns | Steps))
    if part.the(Side) is Side.AFTER:
        first, second = second, first
    return DoneBefore(span=part.span, first=first, second=second)


_RULES: dict[str, Make] = {
    **part.RULES,
    **nouns.RULES,
    **places.RULES,
    **conditions.RULES,
    **manners.RULES,
    **orders.RULES,
    "case": _case,
    "otherwise": _case,
    "sentence": _sentence,
    "max_duration": _max_duration,
    "back_within": _max_duration,
    "precedence": _precedence,
    "steps_ordered": _precedence,
    "rounds_driven": lambda part: RoundsDriven(
        span=part.span, steps=part.the(Steps), count=whole(part, part.the_word("TIMES").value)
    ),
    "order_free": lambda part: OrderFree(span=part.span),
    "leave_out": lambda part: LeaveOut(span=part.span),
}


def build(branch: Branch, words: list[Word], text: ScriptText, diagnostics: Diagnostics) -> Any:
    """The node of a branch of a sentence's tree."""
    rule, parts, first, behind = branch
    children = [
        words[part] if isinstance(part, int) else build(part, words, text, diagnostics)
        for part in parts
    ]
    start = words[first].start if first < len(words) else len(text.content)
    end = words[behind - 1].end if behind > first else start
    return _RULES[rule](RulePart(tuple(children), text, start, end, diagnostics))
