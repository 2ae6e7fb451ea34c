"""Makes noun phrases."""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from argo_compiler.script.sentences.building.conditions import require_one_joint
from argo_compiler.script.sentences.building.part import Make, RulePart, whole
from argo_compiler.script.sentences.tree.nouns import (
    AllOf,
    Kind,
    Labelled,
    Noun,
    Nouns,
    Pronoun,
    Quantity,
    TheOne,
)
from argo_compiler.script.sentences.words.loading import pattern
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.word import Word

_WHERE = r"\b<where>\s+$"
"""before a floor: that something is done there, `check on floor 2`"""


class Label(NamedTuple):
    """A number or an identifier, and the numbers that it may be a list of."""

    first: int | str
    listed: tuple[int, ...] = ()


def _label(part: RulePart) -> Label:
    (word,) = part.children
    if word.type != "NUMBER":
        return Label(word.value)
    figure: Figure = word.value
    if figure.listed:
        return Label(figure.listed[0], figure.listed)
    return Label(whole(part, figure))


def _kind(word: Word | None) -> tuple[Kind | None, bool]:
    if word is None:
        return None, False
    kind, plural = word.value[:2]
    return kind, plural


def named(part: RulePart) -> list[Noun]:
    """The checkpoint; several where a number is a list without blanks: `1,4`."""
    kind, plural = _kind(part.word("KIND"))
    (label, listed), *upto = part.every(Label)
    return [
        Labelled(
            span=part.span,
            label=one,
            kind=kind,
            plural=plural,
            hash=part.has("HASH"),
            last=upto[0].first if upto else None,
            floors=next((t for t in part.every(tuple) if not isinstance(t, Label)), ()),
        )
        for one in listed or (label,)
    ]


def _of(part: RulePart) -> list[Noun]:
    word, nouns = part.children
    quantity = Quantity(word.value)
    return [
        replace(noun, quantity=quantity) if isinstance(noun, Labelled) else noun
        for noun in (nouns if isinstance(nouns, list) else [nouns])
    ]


def _aka(part: RulePart) -> list[Noun]:
    (first, *_), (second, *_) = part.every(list)
    return [replace(first, also=second, span=part.span)]


def _all(part: RulePart) -> AllOf:
    kind, _ = _kind(part.word("KIND"))
    number = part.word("NUMBER")
    count = 2 if part.has("BOTH") else whole(part, number.value) if number else None
    return AllOf(
        span=part.span,
        kind=kind or Kind.CHECKPOINT,
        floors=part.joined(tuple),
        count=count,
        whole=part.has("EVERYTHING"),
    )


def _the_one(part: RulePart) -> TheOne:
    kind, plural = _kind(part.word("KIND"))
    return TheOne(
        span=part.span, kind=kind or Kind.CHECKPOINT, floors=part.joined(tuple), plural=plural
    )


def _pronoun(part: RulePart) -> Pronoun:
    them = part.word("THEM", "BOTH")
    number = part.word("NUMBER")
    shown = part.word("VALUE")
    return Pronoun(
        span=part.span,
        every=them is not None,
        either=them is not None and them.value == "either",
        or_one=them is not None and them.value == "or one",
        count=whole(part, number.value) if number else None,
        kind=_kind(part.word("KIND"))[0],
        quantity=None if shown is None else Quantity(shown.value),
    )


def _is_of_last(child: object, nouns: list[Noun], joint: str) -> bool:
    """Whether a noun is what the checkpoint before it shows: `checkpoint 2, level`."""
    shown = isinstance(child, Pronoun) and child.quantity is not None and joint == ","
    last = nouns[-1] if nouns else None
    return shown and isinstance(last, Labelled) and last.quantity is None


def _on_common_floors(part: RulePart, nouns: Sequence[Noun]) -> list[Noun]:
    """Return the nouns, those of a floor with the floor: `the valves and gauges on floor 3`."""
    found: list[Noun] = []
    for noun in reversed(nouns):
        after = found[-1] if found else None
        if isinstance(noun, AllOf | TheOne) and isinstance(after, AllOf | TheOne):
            if noun.floors and not after.floors:
                message = "this can be on the same floor as what is before it, or on all floors"
                hint = "write the floor behind each, or `on all floors`"
                part.diagnostics.error("ambiguous-floor", message, after.span, hint)
            elif after.floors and not noun.floors:
                if isinstance(after, AllOf) or (isinstance(noun, TheOne) and not noun.plural):
                    message = "this floor can be that of all of them, or of the last one only"
                    hint = "write the floor behind each, or two sentences"
                    part.diagnostics.error("ambiguous-floor", message, after.span, hint)
                noun = replace(noun, floors=after.floors)
        found.append(noun)
    return found[::-1]


def _ask_of_excepted_floors(part: RulePart, excepted: Sequence[Noun]) -> None:
    """Ask about `everything except the valves on floor 2 and floor 3`."""
    for noun in excepted:
        if isinstance(noun, AllOf | TheOne) and len(noun.floors) > 1:
            message = "the last floor can be that of the exception, or a further exception"
            hint = "write the exceptions in a sentence of their own: `do not check ...`"
            part.diagnostics.error("ambiguous-exception", message, noun.span, hint)


def _nouns(part: RulePart) -> Nouns:
    require_one_joint(part)
    nouns: list[Noun] = []
    but: list[Noun] = []
    either = excluded = False
    joint = ""
    for child in part.children:
        if _is_of_last(child, nouns, joint):
            nouns[-1] = replace(nouns[-1], quantity=child.quantity)
            continue
        joint = ""
        if isinstance(child, Word):
            joint = str(child.value).strip()
            excluded = excluded or child.type == "EXCEPT"
            either = either or child.type.startswith("OR_")
        else:
            either = either or (isinstance(child, Pronoun) and child.either)
            (but if excluded else nouns).extend(child if isinstance(child, list) else [child])
    words = part.every(Word)
    parted = len(nouns) == 2 and len(words) == 1 and str(words[0].value).strip() != ","
    parted = parted and str(words[0].value).startswith(",")
    all_ = tuple(_on_common_floors(part, nouns))
    _ask_of_excepted_floors(part, but)
    return Nouns(span=part.span, nouns=all_, but=tuple(but), either=either, parted=parted)


def _whole_floors(part: RulePart) -> Nouns:
    """`inspect floor 2`, `check floors 2 and 3 except valve R12`"""
    floors, *exceptions = part.children
    if pattern(_WHERE).search(part.text.content[: part.start]):
        message = "it is not said what is read there"
        part.error("ambiguous-floor", message, "write `check everything on floor 2`")
    whole = AllOf(span=part.span, kind=Kind.CHECKPOINT, floors=floors, whole=True)
    return _nouns(replace(part, children=(whole, *exceptions)))


RULES: dict[str, Make] = {
    # `except valve R40`, behind how the others are measured
    "but": lambda part: Nouns(span=part.span, nouns=(), but=part.joined(list)),
    "label": _label,
    "identifier": _label,
    "upto": lambda part: part.the(Label),
    "named": named,
    "marked": named,
    "of": _of,
    "aka": _aka,
    "all": _all,
    "the_one": _the_one,
    "pronoun": _pronoun,
    "the_same": _pronoun,
    "nouns": _nouns,
    "whole_floors": _whole_floors,
    "ends": _nouns,
}
