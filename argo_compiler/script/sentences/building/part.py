"""A rule's part of a sentence while its node is made, and the numbers, amounts and lengths of time
in it: what can be read in two ways is asked about."""

from collections.abc import Callable, Iterable
from math import inf, isinf, isnan
from typing import Any, TypeVar

from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Span
from argo_compiler.il import MAX_TIME_S
from argo_compiler.script.documents.source import Diagnostics, ScriptText
from argo_compiler.script.sentences.tree.conditions import Amount
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.word import Word

T = TypeVar("T")
_LARGEST = 1_000_000_000


@dataclass(slots=True)
class RulePart:
    """What the parts of a rule were made to, and where the rule's words stand. Not frozen, for
    there are very many, and they are made faster so; nothing changes one."""

    children: tuple[Any, ...]
    """nodes, and the words that the grammar has by themselves"""
    text: ScriptText
    start: int
    end: int
    """indices in the text, of the first character and behind the last"""
    diagnostics: Diagnostics

    @property
    def span(self) -> Span:
        return self.text.span(self.start, self.end)

    @property
    def said(self) -> str:
        return self.text.content[self.start : self.end]

    def word(self, *types: str) -> Word | None:
        """The first word of one of the types."""
        for child in self.children:
            if type(child) is Word and child.type in types:
                return child
        return None

    def the_word(self, *types: str) -> Word:
        """The word of one of the types, which the grammar asks for."""
        found = self.word(*types)
        assert found is not None, f"the grammar lets {types} be left out"
        return found

    def has(self, *types: str) -> bool:
        return self.word(*types) is not None

    def every(self, type_: type[T]) -> tuple[T, ...]:
        return tuple([child for child in self.children if isinstance(child, type_)])

    def joined(self, type_: type[Iterable[Any]]) -> tuple[Any, ...]:
        """What is in the children of a type, which have several things each."""
        return tuple([one for child in self.every(type_) for one in child])

    def first(self, type_: type[T]) -> T | None:
        for child in self.children:
            if isinstance(child, type_):
                return child
        return None

    def the(self, type_: type[T]) -> T:
        """The one child of the type, which the grammar asks for."""
        found = self.first(type_)
        assert found is not None, f"the grammar lets {type_.__name__} be left out"
        return found

    def error(self, code: str, message: str, hint: str) -> None:
        self.diagnostics.error(code, message, self.span, hint)


Make = Callable[[RulePart], Any]
"""makes the node of a rule"""


# ---- figures


@dataclass(frozen=True, slots=True)
class Signed:
    """A number in coordinates and the like, where the point is the decimal sign."""

    value: float
    listed: tuple[int, ...] = ()


def whole(part: RulePart, figure: Figure, most: int = _LARGEST) -> int:
    """The whole number that a figure is; anything else is an error, and 0."""
    value = figure.whole
    if value is None:
        _complain_of_whole(part, figure)
        return 0
    if value > most:
        part.error("number", f"{value} is too large a number", f"numbers go up to {most} here")
        return 0
    return value


def _complain_of_whole(part: RulePart, figure: Figure) -> None:
    if figure.other is not None:
        message = f"this number can be read as {figure.value:g} or as {figure.other:g}"
        part.error("ambiguous-number", message, f"write `{figure.other:g}` for the second")
    elif isnan(figure.value):
        part.error("number", "these are several numbers, not one", "write one number")
    else:
        part.error("number", f"{figure.value:g} is not a whole number", "write a whole number")


def decimal(part: RulePart, figure: Figure, unit: str = "") -> float:
    """The number that a figure is; one that can be read in two ways is an error."""
    if figure.other is None and -inf < figure.value < inf:
        return figure.value
    behind = f" {unit}" if unit else ""
    if figure.other is not None:
        first, second = f"{figure.value:g}{behind}", f"{figure.other:g}{behind}"
        hint = f"write `{figure.value:g}0{behind}` for the first, `{second}` for the second"
        part.error("ambiguous-number", f"`{part.said}` can be read as {first} or as {second}", hint)
    elif isnan(figure.value):
        part.error("number", f"`{part.said}` is several numbers, not one", "write one number")
        return 0.0
    elif isinf(figure.value):
        part.error("number", f"{part.said} is too large a number", "write a smaller number")
        return 0.0
    return figure.value


def seconds(part: RulePart, word: Word) -> float:
    """The seconds of a length of time that is more than none."""
    length: Length = word.value
    if length.other is None and 0 < length.seconds <= MAX_TIME_S:
        return length.seconds
    if isnan(length.seconds):
        part.error("number", f"`{part.said}` has several numbers, not one", "write one number")
        return 1.0
    if length.other is not None:
        said = part.text.content[word.start : word.end]
        message = f"`{said}` can be read as {length.first} or as {length.second}"
        part.error("ambiguous-duration", message, f"write `{length.first}` or `{length.second}`")
    elif length.seconds <= 0:
        part.error("duration", "a duration must be more than zero", "for example, `10 minutes`")
        return 1.0
    elif length.seconds > MAX_TIME_S:
        message = f"a duration of {length.seconds:g} s is too long"
        part.error("duration", message, f"at most {MAX_TIME_S:g} s are counted")
        return MAX_TIME_S
    return length.seconds


def duration(part: RulePart) -> float:
    """The seconds of the one duration in a rule."""
    return seconds(part, part.the_word("DURATION"))


def speed(part: RulePart, word: Word) -> float:
    """m/s"""
    figure, factor = word.value
    value = decimal(part, figure, "m/s" if factor == 1 else "")
    if value <= 0:
        part.error("speed", "a speed must be more than zero", "for example, `at 0.3 m/s`")
        return 1.0
    return value if factor == 1 else float(f"{value * factor:.12g}")


def single(part: RulePart) -> float:
    """The one number that is asked for in coordinates and the like."""
    value = part.the(Signed).value
    if not -inf < value < inf:
        part.error("number", f"`{part.said}` has several numbers, not one", "write one number")
        return 0.0
    return value


def _signed(part: RulePart) -> Signed:
    word = part.the_word("NUMBER")
    sign = -1 if part.has("MINUS") else 1
    if word.value.value == inf:
        part.error("number", f"{part.said} is too large a number", "write a smaller number")
        return Signed(0.0)
    return Signed(sign * word.value.value, word.value.listed)


def amount(part: RulePart) -> Amount:
    """Return the one amount in a rule, with its unit if it has one."""
    sign = -1 if part.has("MINUS") else 1
    if word := part.word("QUANTITY"):
        figure, unit = word.value
        return Amount(span=part.span, value=sign * decimal(part, figure, unit), unit=unit)
    word = part.the_word("NUMBER")
    return Amount(span=part.span, value=sign * decimal(part, word.value))


RULES: dict[str, Make] = {"signed": _signed, "amount": amount}
