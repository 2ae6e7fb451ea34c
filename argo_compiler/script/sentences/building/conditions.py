"""Makes conditions, and tells what `and` and `or` join in them.

Where both are said it is a comma that tells what belongs together: `A and B, or C`. Without one it
is asked about, with both readings.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, product

from argo_compiler.il import EventKind
from argo_compiler.script.sentences.building.part import Make, RulePart, Signed, amount, duration
from argo_compiler.script.sentences.tree.conditions import (
    Amount,
    Asked,
    BatteryLevel,
    Bounded,
    InState,
    Occurs,
    Predicate,
    SaidCondition,
    TaskState,
    Test,
    TooLate,
    ValvePosition,
)
from argo_compiler.script.sentences.tree.nouns import Labelled, Nouns
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.word import Word

_Alternatives = tuple[tuple[Asked, ...], ...]
_STATES = {str(state): state for state in (*TaskState, *ValvePosition)}
_MOST = 64
"""alternatives of one condition"""
_NEGATING = r"\b<negating>\b(?!.*\b<closing>\W*$)"
_INDEFINITE = r"\b<indefinite>\s+$"
_BOUNDING = r"<bounding>(?!\w)"
"""how a bound begins that has no verb of its own"""


def require_moment(part: RulePart) -> None:
    """Asks about `whenever` and `as soon as` of values, which are looked at when that is said."""
    opening = part.word("IF", "IF_ONLY", "UNLESS")
    if opening is None or opening.value != "whenever":
        return
    condition = part.the(SaidCondition)
    if any(isinstance(test, Test) and not test.is_of_failure for test in condition.tests):
        message = "a condition on a value is evaluated after a task, not at any time"
        hint = "write `if ...` after each measurement"
        part.diagnostics.error("ambiguous-case", message, condition.span, hint)


def _compared(part: RulePart) -> Bounded:
    """`above 75 %`, `75 % or more`"""
    inclusive = not part.has("GREATER", "LESS")
    if part.has("GREATER", "AT_LEAST", "OR_MORE"):
        return Bounded(span=part.span, low=part.the(Amount), inclusive=inclusive)
    return Bounded(span=part.span, high=part.the(Amount), inclusive=inclusive)


def _between(part: RulePart) -> Bounded:
    low, high = part.every(Amount)
    if not low.unit:
        low = replace(low, unit=high.unit)
    return Bounded(span=part.span, low=low, high=high, inclusive=part.has("FROM"))


def _exactly(part: RulePart) -> Bounded:
    amount = part.the(Amount)
    hint = "write `between 4.9 and 5.1 bar`, `at least 5 bar` or `at most 5 bar`"
    part.error("condition", "a measured value is hardly ever exactly equal to this", hint)
    return Bounded(span=part.span, low=amount, high=amount, inclusive=True)


def _predicate(part: RulePart) -> tuple[Predicate, bool, str]:
    negated = part.has("NOT")
    found: Predicate | None = part.first(InState) or part.first(Bounded)
    if state := part.word("STATE"):
        found = InState(span=part.span, state=_STATES[state.value])
    elif part.has("FAILS"):
        found = InState(span=part.span, state=TaskState.FAILED)
    elif found is None:
        found = _exactly(part)
    verb = part.word("IS")
    return found, negated, str(verb.value) if verb is not None else ""


def _detail(part: RulePart) -> dict[str, object]:
    name = part.word("STRING")
    bound = part.first(Signed)
    return {"id": name.value if name else "", "second": bound.value if bound else None}


def _test(part: RulePart) -> Test:
    predicate, negated, how_many = next(c for c in part.children if isinstance(c, tuple))
    subject = part.first(Nouns)
    several = subject is not None and len(subject.nouns) > 1
    if subject is not None and several and how_many == ("both" if subject.either else "either"):
        hint = "write `if either #1 or #5 is abnormal`, or `if both #1 and #5 are abnormal`"
        part.error("ambiguous-and-or", "this can apply to one of them, or to both", hint)
    plain = subject is not None and not any(isinstance(n, Labelled) for n in subject.nouns)
    age = part.first(float)
    detail = part.first(dict) or {"id": "", "second": None}
    return Test(
        span=part.span,
        subject=subject,
        predicate=predicate,
        negated=negated,
        general=plain and pattern(_INDEFINITE).search(part.text.content[: part.start]) is not None,
        max_age=predicate.age if isinstance(predicate, InState) and predicate.age else age,
        id=str(detail["id"]),
        second_bound=detail["second"],
    )


def _occurs(part: RulePart) -> Occurs | BatteryLevel:
    event = part.the_word("EVENT").value
    if not part.has("QUANTITY"):
        return Occurs(span=part.span, event=event)
    if event is not EventKind.BATTERY_CHARGED:
        message = "only a battery is charged to a level"
        part.error("battery", message, "write, for example, `the battery is charged to 80 %`")
    return _battery(part)


def _battery(part: RulePart) -> BatteryLevel:
    level = part.first(Bounded)
    if level is None:  # `the battery is at 60 %`
        level = Bounded(span=part.span, low=amount(part), inclusive=True)
    return BatteryLevel(span=part.span, level=level)


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
    found = _alternatives(part, tests, [_is_named(test) for test in said])
    return SaidCondition(span=part.span, alternatives=found)


def _require_plain_negation(part: RulePart) -> None:
    """Asks about `not above 4 or below 2`: whether the second is to be so, or not."""
    content, start = part.text.content, part.start
    for test, joint in zip(part.children[::2], part.children[1::2], strict=False):
        plain = isinstance(test, Test) and not (
            isinstance(test.predicate, Bounded) and len(test.predicate.bounds) == 2
        )
        parted = joint.type == "OR_TEST" or (joint.type == "AND_TEST" and plain)
        said, behind = content[start : joint.start], content[joint.end :].lstrip()
        start = joint.end
        if parted and pattern(_NEGATING).search(said) and pattern(_BOUNDING).match(behind):
            message = "`not` can apply to the first of these only, or to both"
            hint = "write `is not ... and is not ...`, or `is not ... or is ...`"
            part.error("ambiguous-and-or", message, hint)
            return


# ---- what is joined


@dataclass(frozen=True)
class _Joint:
    """What stands between two tests."""

    said: str
    """`and` or `or`"""
    parts: bool
    """whether a comma parts the two sides"""
    start: int
    """where it stands in the text"""


def _alternatives(part: RulePart, tests: Sequence[Asked], named: Sequence[bool]) -> _Alternatives:
    """The alternatives, of each of which all tests must hold; `named` tells which tests say what
    they ask of. Those that do not belong to the one before: `above 5 and below 7`."""
    joints = tuple(_joints(part.every(Word)))
    found = _joined(tests, joints, named)
    if found is None:
        _ask(part, joints, "put a comma between the two parts, or write a sentence for each")
        return (tuple(tests),)
    if len(found) > _MOST:
        message = f"this condition has more than {_MOST} alternatives"
        part.error("condition", message, "divide it into several sentences")
    return found


def _joints(words: Sequence[Word]) -> Iterable[_Joint]:
    """The joints; a comma alone is as the joint behind it, which then ends a list: `A, B, or C`."""
    found: list[_Joint] = []
    for i in range(len(words) - 1, -1, -1):
        word = words[i]
        said = "or" if word.type.startswith("OR_") else "and"
        if found and word.value == ",":
            said = found[-1].said
        listed = word.value == "," or (i > 0 and words[i - 1].value == ",")
        found.append(_Joint(said, word.value[:1] in ",;" and not listed, word.start))
    return reversed(found)


def _joined(
    tests: Sequence[Asked], joints: Sequence[_Joint], named: Sequence[bool]
) -> _Alternatives | None:
    """None: it can be read in two ways."""
    said = {joint.said for joint in joints}
    if len(said) < 2:
        return tuple((test,) for test in tests) if said == {"or"} else (tuple(tests),)
    at = [i for i, joint in enumerate(joints) if joint.parts]
    if not at:
        at = [i for i, joint in enumerate(joints) if joint.said == "or" and named[i + 1]]
        others = [joint.said for i, joint in enumerate(joints) if i not in at]
        inner = [named[i + 1] for i in range(len(joints)) if i not in at]
        if not at or "or" in others or any(inner):
            return None
    outer = {joints[i].said for i in at}
    bounds = [-1, *at, len(joints)]
    parts = [
        _joined(tests[a + 1 : b + 1], joints[a + 1 : b], named[a + 1 : b + 1])
        for a, b in pairwise(bounds)
    ]
    known = [part for part in parts if part is not None]
    if len(outer) > 1 or len(known) < len(parts):
        return None
    if outer == {"or"}:
        return sum(known, ())
    found: _Alternatives = ((),)
    for part in known:
        found = tuple(one + other for one, other in product(found, part))
        if len(found) > _MOST:
            break
    return found


def require_one_joint(part: RulePart) -> None:
    """Asks about a list of checkpoints that has both."""
    words = [word for word in part.every(Word) if word.type != "EXCEPT"]
    joints = tuple(_joints(words))
    if len({joint.said for joint in joints}) > 1:
        _ask(part, joints, "write a sentence or a comparison for each")


def _ask(part: RulePart, joints: Sequence[_Joint], hint: str) -> None:
    """Names both readings, of the first two joints that differ."""
    content = part.text.content
    second = next(i for i in range(1, len(joints)) if joints[i].said != joints[i - 1].said)
    readings = []
    for joint in (joints[second], joints[second - 1]):
        before, behind = content[part.start : joint.start], content[joint.start : part.end]
        readings.append(f"`{before.rstrip(' ,;')}, {behind.lstrip(' ,;')}`")
    part.error("ambiguous-and-or", f"this can be read as {readings[0]} or as {readings[1]}", hint)


def _is_named(test: Asked) -> bool:
    """Whether a test says what it asks of."""
    return not isinstance(test, Test) or test.subject is not None


RULES: dict[str, Make] = {
    "compared": _compared,
    "between": _between,
    "spread": lambda part: replace(_between(part), inclusive=True),
    "exactly": _exactly,
    "beyond": _compared,
    "predicate": _predicate,
    "age": duration,
    "stale": lambda part: InState(span=part.span, state=TaskState.STALE, age=duration(part)),
    "too_late": lambda part: TooLate(span=part.span),
    "detail": _detail,
    "test": _test,
    "occurs": _occurs,
    "battery": _battery,
    "condition": _condition,
}
