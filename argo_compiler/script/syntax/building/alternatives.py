"""What `and` and `or` join in a condition. Where both are said it is a comma that tells what
belongs together: `A and B, or C`. Without one it is asked about, with both readings."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise, product

from argo_compiler.script.syntax.building.part import RulePart
from argo_compiler.script.syntax.tree.conditions import Asked, Test
from argo_compiler.script.syntax.words.word import Word

Alternatives = tuple[tuple[Asked, ...], ...]
_MOST = 64
"""alternatives of one condition"""


@dataclass(frozen=True)
class _Joint:
    """What stands between two tests."""

    said: str
    """`and` or `or`"""
    parts: bool
    """whether a comma parts the two sides"""
    start: int
    """where it stands in the text"""


def alternatives(part: RulePart, tests: Sequence[Asked], named: Sequence[bool]) -> Alternatives:
    """The alternatives, of each of which all tests must hold; `named` tells which tests say what
    they ask of. Those that do not belong to the one before: `above 5 and below 7`."""
    joints = tuple(_joints(part.every(Word)))
    found = _joined(tests, joints, named)
    if found is None:
        _ask(part, joints, "put a comma where the two sides part, or write a sentence for each")
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
) -> Alternatives | None:
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
    found: Alternatives = ((),)
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
        _ask(part, joints, "write a sentence, or what is asked of them, for each")


def _ask(part: RulePart, joints: Sequence[_Joint], hint: str) -> None:
    """Names both readings, of the first two joints that differ."""
    content = part.text.content
    second = next(i for i in range(1, len(joints)) if joints[i].said != joints[i - 1].said)
    readings = []
    for joint in (joints[second], joints[second - 1]):
        before, behind = content[part.start : joint.start], content[joint.start : part.end]
        readings.append(f"`{before.rstrip(' ,;')}, {behind.lstrip(' ,;')}`")
    message = f"this can be read as {readings[0]} or as {readings[1]}"
    part.error("ambiguous-and-or", message, hint)


def is_named(test: Asked) -> bool:
    """Whether a test says what it asks of."""
    return not isinstance(test, Test) or test.subject is not None
