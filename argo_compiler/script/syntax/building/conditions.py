"""Makes conditions."""

import re
from dataclasses import replace
from functools import cache

from argo_compiler.script.syntax.building.alternatives import alternatives, is_named
from argo_compiler.script.syntax.building.figures import Signed, duration
from argo_compiler.script.syntax.building.part import Make, RulePart
from argo_compiler.script.syntax.tree.conditions import (
    Amount,
    Asked,
    BatteryDrops,
    Between,
    Compared,
    InState,
    Occurs,
    Predicate,
    Relation,
    SaidCondition,
    TaskState,
    Test,
    TooLate,
)
from argo_compiler.script.syntax.tree.nouns import Nouns
from argo_compiler.script.syntax.words.loading import everywhere
from argo_compiler.script.syntax.words.word import Word


def require_moment(part: RulePart) -> None:
    """Asks about `whenever` and `as soon as` of values, which are looked at when that is said."""
    opening = part.word("IF", "IF_ONLY", "UNLESS")
    if opening is None or opening.value != "whenever":
        return
    condition = part.the(SaidCondition)
    tests = [test for tests in condition.alternatives for test in tests]
    if any(isinstance(test, Test) and not _is_failure(test) for test in tests):
        message = "a value is looked at where that is said, not at any time"
        hint = "write `if ...` behind each measurement that it is looked at after"
        part.diagnostics.error("ambiguous-case", message, condition.span, hint)


def _is_failure(test: Test) -> bool:
    return isinstance(test.predicate, InState) and test.predicate.is_failure


def _compared(part: RulePart) -> Compared:
    relation = Relation[part.children[0].type]
    return Compared(span=part.span, relation=relation, bound=part.the(Amount))


def _between(part: RulePart) -> Between:
    low, high = part.every(Amount)
    if not low.unit:
        low = replace(low, unit=high.unit)
    return Between(span=part.span, low=low, high=high, inclusive=part.has("FROM"))


def _exactly(part: RulePart) -> Between:
    amount = part.the(Amount)
    message = "a measured value is hardly ever exactly this one"
    hint = "write `between 4.9 and 5.1 bar`, `at least 5 bar` or `at most 5 bar`"
    part.error("condition", message, hint)
    return Between(span=part.span, low=amount, high=amount, inclusive=True)


def _beyond(part: RulePart) -> Compared:
    """`75 % or more`."""
    relation = Relation.AT_LEAST if part.has("OR_MORE") else Relation.AT_MOST
    return Compared(span=part.span, relation=relation, bound=part.the(Amount))


def _predicate(part: RulePart) -> tuple[Predicate, bool, str]:
    negated = part.has("NOT")
    state = part.word("STATE")
    stale = part.first(InState)
    if stale is not None:
        found: Predicate = stale
    elif state is not None or part.has("FAILS"):
        found = InState(span=part.span, state=TaskState(state.value) if state else TaskState.FAILED)
    else:
        plain = next((c for c in part.children if isinstance(c, Compared | Between)), None)
        found = plain or _exactly(part)
    verb = part.word("IS")
    return found, negated, str(verb.value) if verb is not None else ""


def _stale(part: RulePart) -> InState:
    return InState(span=part.span, state=TaskState.STALE, age=duration(part))


def _detail(part: RulePart) -> dict[str, object]:
    name = part.word("STRING")
    bound = part.first(Signed)
    return {"id": name.value if name else "", "second": bound.value if bound else None}


def _test(part: RulePart) -> Test:
    predicate, negated, how_many = next(c for c in part.children if isinstance(c, tuple))
    subject = part.first(Nouns)
    several = subject is not None and len(subject.nouns) > 1
    if subject is not None and several and how_many == ("both" if subject.either else "either"):
        message = "this can be meant of one of them, or of both"
        hint = "write `if either #1 or #5 is abnormal`, or `if both #1 and #5 are abnormal`"
        part.error("ambiguous-and-or", message, hint)
    age = part.first(float)
    detail = part.first(dict) or {"id": "", "second": None}
    return Test(
        span=part.span,
        subject=subject,
        predicate=predicate,
        negated=negated,
        max_age=predicate.age if isinstance(predicate, InState) and predicate.age else age,
        id=str(detail["id"]),
        second_bound=detail["second"],
    )


def _occurs(part: RulePart) -> Occurs:
    return Occurs(span=part.span, event=part.the_word("EVENT").value)


def _battery(part: RulePart) -> BatteryDrops:
    compared = part.the(Compared)
    return BatteryDrops(span=part.span, relation=compared.relation, level=compared.bound)


def _condition(part: RulePart) -> SaidCondition:
    """The alternatives; a test without a subject has that of the test before it."""
    tests: list[Asked] = []
    subject: Nouns | None = None
    said = [child for child in part.children if not isinstance(child, Word)]
    for test in said:
        if isinstance(test, Test):
            if test.subject is None and subject is not None:
                test = replace(test, subject=subject)
            subject = test.subject
        tests.append(test)
    _require_plain_negation(part)
    found = alternatives(part, tests, [is_named(test) for test in said])
    return SaidCondition(span=part.span, alternatives=found)


def _require_plain_negation(part: RulePart) -> None:
    """Asks about `not above 4 or below 2`: whether the second is to be so, or not."""
    content, start = part.text.content, part.start
    for test, joint in zip(part.children[::2], part.children[1::2], strict=False):
        plain = isinstance(test, Test) and not isinstance(test.predicate, Between)
        parted = joint.type == "OR_TEST" or (joint.type == "AND_TEST" and plain)
        said, behind = content[start : joint.start], content[joint.end :].lstrip()
        start = joint.end
        if parted and _negating().search(said) and _bounding().match(behind):
            message = "`not` can be said of the first of these only, or of both"
            hint = "write `is not ... and is not ...`, or `is not ... or is ...`"
            part.error("ambiguous-and-or", message, hint)
            return


@cache
def _negating() -> re.Pattern[str]:
    return re.compile(
        rf"\b(?:{everywhere('negating')})\b(?!.*\b(?:{everywhere('closing')})\W*$)", re.IGNORECASE
    )


@cache
def _bounding() -> re.Pattern[str]:
    """How a bound begins that has no verb of its own."""
    return re.compile(rf"(?:{everywhere('bounding')})(?!\w)", re.IGNORECASE)


RULES: dict[str, Make] = {
    "compared": _compared,
    "between": _between,
    "exactly": _exactly,
    "beyond": _beyond,
    "predicate": _predicate,
    "age": duration,
    "stale": _stale,
    "too_late": lambda part: TooLate(span=part.span),
    "detail": _detail,
    "test": _test,
    "occurs": _occurs,
    "battery": _battery,
    "condition": _condition,
}
