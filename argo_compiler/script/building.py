"""Turns the parser's trees into nodes: what the sheet and the protocol share."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar, TypeVar

from lark import Token, Tree

from argo_compiler.catalog import CheckpointKind
from argo_compiler.diagnostics import Span
from argo_compiler.script.nodes import Duration, Name, Number, Quantity, Reference
from argo_compiler.script.source import Findings, Text

# The words of `number_word` and `ordinal_word` in common.lark, in order.
_CARDINALS = """
    one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen
    seventeen eighteen nineteen twenty
"""
_ORDINALS = "first second third fourth fifth sixth seventh eighth ninth tenth eleventh twelfth"
_VALUES = {word: i for words in (_CARDINALS, _ORDINALS) for i, word in enumerate(words.split(), 1)}
_LARGEST = 1_000_000

T = TypeVar("T")


@dataclass(frozen=True)
class Phrase:
    """A rule's part of a statement: what its own parts were built to, and its text."""

    children: tuple[Any, ...]
    text: Text
    end: int
    """the index in the statement after its last character"""

    @property
    def span(self) -> Span:
        return self.text.span()

    def first(self, type_: type[T]) -> T | None:
        """The first child of the type, if there is one."""
        return next((child for child in self.children if isinstance(child, type_)), None)

    def the(self, type_: type[T]) -> T:
        """The first child of the type, which the grammar asks for."""
        child = self.first(type_)
        assert child is not None, f"the grammar lets {type_.__name__} be left out"
        return child

    def every(self, type_: type[T]) -> tuple[T, ...]:
        """All children of the type."""
        return tuple(child for child in self.children if isinstance(child, type_))


class Time(Duration):
    """A part of a duration, in one unit."""

    unit: float
    """s"""


class Builder:
    """Builds the nodes of one statement. A method is named after the rule that it builds."""

    constants: ClassVar[dict[str, Any]] = {
        "hours": 3600.0,
        "minutes": 60.0,
        "seconds": 1.0,
        "pressure_gauge": CheckpointKind.PRESSURE_GAUGE,
        "liquid_level_gauge": CheckpointKind.LIQUID_LEVEL_GAUGE,
        "valve": CheckpointKind.VALVE,
        "value": Quantity.VALUE,
        "position": Quantity.POSITION,
        "level": Quantity.LEVEL,
        "prose": None,
    }
    """what the rules stand for that always mean the same"""

    def __init__(self, text: Text, findings: Findings) -> None:
        self.text = text
        self.findings = findings

    def statement(self, tree: Tree[Token]) -> Any:
        """The node of a statement's tree; None if it makes no sense, with an error that says so."""
        errors = self.findings.errors
        node = self._build(tree)
        return node if self.findings.errors == errors else None

    def _build(self, tree: Tree[Token]) -> Any:
        # No rule of the grammars contains itself, so the trees are shallow.
        if tree.data in self.constants:
            return self.constants[tree.data]
        children = tuple(self._build(c) if isinstance(c, Tree) else c for c in tree.children)
        start, end = (0, 0) if tree.meta.empty else (tree.meta.start_pos, tree.meta.end_pos)
        return getattr(self, tree.data)(Phrase(children, self.text[start:end], end))

    def number(self, phrase: Phrase) -> Number:
        word = phrase.text.content.lower()
        figures = word.rstrip("stndrh")
        value = int(figures) if figures.isdecimal() else _VALUES[word]
        if value > _LARGEST:
            hint = f"numbers go up to {_LARGEST}"
            self.findings.error("number", f"{word} is too large a number", phrase.span, hint)
        return Number(span=phrase.span, value=min(value, _LARGEST))

    ordinal = number

    def number_word(self, phrase: Phrase) -> str:
        return phrase.text.content

    ordinal_word = number_word

    def step_number(self, phrase: Phrase) -> int:
        return min(int(phrase.the(Token)), _LARGEST)

    def time(self, phrase: Phrase) -> Time:
        number, unit = phrase.children
        return Time(span=phrase.span, seconds=number.value * unit, unit=unit)

    def duration(self, times: tuple[Time, ...]) -> Duration:
        """The sum of the times, which must go from hours down to seconds and be more than none."""
        start, end = times[0].span, times[-1].span
        span = start.model_copy(update={"length": end.column + end.length - start.column})
        seconds = sum(time.seconds for time in times)
        if seconds == 0:
            self.findings.error("duration", "a duration of zero", span, "write, say, `10 minutes`")
        elif any(a.unit <= b.unit for a, b in pairwise(times)):
            hint = "write hours before minutes before seconds, each once: `1 h 30 min`"
            self.findings.error("duration", "the units of this duration are mixed up", span, hint)
        return Duration(span=span, seconds=seconds)

    def identifier(self, phrase: Phrase) -> str:
        return phrase.text.content

    def name(self, phrase: Phrase) -> Name:
        kind, identifier = phrase.children
        return Name(span=phrase.span, kind=kind, identifier=identifier)

    def checkpoint_number(self, phrase: Phrase) -> Reference:
        return Reference(span=phrase.span, number=phrase.the(Number).value)

    def label_end(self, phrase: Phrase) -> int:
        """Where a field's label ends; its text is taken from there."""
        return phrase.end

    def field_text(self, phrase: Phrase) -> Text:
        """The text of a field, as it stands after the label."""
        return self.text[phrase.the(int) :].strip()
