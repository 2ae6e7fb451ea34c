"""Makes facts: what is said of the mission as a whole."""

from argo_compiler.script.syntax.building.figures import seconds, whole
from argo_compiler.script.syntax.building.part import Make, RulePart, T
from argo_compiler.script.syntax.tree import facts
from argo_compiler.script.syntax.tree.nouns import Nouns
from argo_compiler.script.syntax.tree.orders import Side
from argo_compiler.script.syntax.tree.places import Steps
from argo_compiler.script.syntax.words.word import Word


def _duration(part: RulePart) -> float:
    return seconds(part, part.the_word("DURATION", "MOST_TIME"))


def _back_within(part: RulePart) -> facts.Fact:
    where = next(c for c in part.children if not isinstance(c, Word))
    return facts.BackWithin(span=part.span, where=where, seconds=_duration(part))


def _in_order(part: RulePart, type_: type[T]) -> dict[str, T]:
    """What comes first, and what second."""
    first, second = part.every(type_)
    if part.the(Side) is Side.AFTER:
        first, second = second, first
    return {"first": first, "second": second}


def _rounds_driven(part: RulePart) -> facts.Fact:
    count = whole(part, part.the_word("TIMES").value)
    return facts.RoundsDriven(span=part.span, steps=part.the(Steps), count=count)


RULES: dict[str, Make] = {
    "max_duration": lambda part: facts.MaxDuration(span=part.span, seconds=_duration(part)),
    "back_within": _back_within,
    "precedence": lambda part: facts.ReadBefore(span=part.span, **_in_order(part, Nouns)),
    "steps_ordered": lambda part: facts.StepsOrdered(span=part.span, **_in_order(part, Steps)),
    "rounds_driven": _rounds_driven,
    "order_free": lambda part: facts.OrderFree(span=part.span),
    "leave_out": lambda part: facts.LeaveOut(span=part.span),
}
