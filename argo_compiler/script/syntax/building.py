"""Turns the parser's trees into nodes: what the sheet and the protocol share."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter
from typing import Any, ClassVar, NamedTuple, TypeVar

from argo_compiler.catalog import CheckpointKind
from argo_compiler.diagnostics import Span
from argo_compiler.il import MAX_TIME_S, Mode, Order
from argo_compiler.script.syntax import quantities
from argo_compiler.script.syntax.shapes import Syntax, SyntaxNode
from argo_compiler.script.syntax.source import Diagnostics, ScriptText
from argo_compiler.script.syntax.terms import Duration, Name, Number, Quantity

_LARGEST = 1_000_000

T = TypeVar("T")


class Phrase(NamedTuple):
    """A rule's part of a statement: what its own parts were built to, and where it stands."""

    children: tuple[Any, ...]
    statement: ScriptText
    start: int
    end: int
    """the index in the statement after its last character"""

    @property
    def content(self) -> str:
        return self.statement.content[self.start : self.end]

    @property
    def span(self) -> Span:
        return self.statement.span(self.start, self.end)

    def first(self, type_: type[T]) -> T | None:
        """The first child of the type, if there is one."""
        for child in self.children:
            if isinstance(child, type_):
                return child
        return None

    def the(self, type_: type[T]) -> T:
        """The first child of the type, which the grammar asks for."""
        child = self.first(type_)
        assert child is not None, f"the grammar lets {type_.__name__} be left out"
        return child

    def every(self, type_: type[T]) -> tuple[T, ...]:
        """All children of the type."""
        return tuple(child for child in self.children if isinstance(child, type_))


@dataclass(frozen=True, slots=True, kw_only=True)
class Time(Duration):
    """A part of a duration, in one unit."""

    unit: float
    """s"""


@dataclass(frozen=True, slots=True)
class Quoted:
    """A quoted text, as it is meant."""

    text: str


class Figure(NamedTuple):
    """A whole number; its node is made only where its place is of use, for places cost time."""

    value: int
    phrase: Phrase

    @property
    def node(self) -> Number:
        return Number(span=self.phrase.span, value=self.value)


class Numbered(NamedTuple):
    """A checkpoint's number, and the words in which it stands."""

    number: int
    phrase: Phrase


_Build = Callable[["Builder", Phrase], Any]
_Pick = Callable[[list[Any]], tuple[Any, ...]]


def _pick(children: list[int]) -> tuple[int, _Pick]:
    if len(children) == 1:
        return children[0], tuple
    return -1, itemgetter(*children) if children else lambda _: ()


@dataclass(frozen=True, slots=True)
class _Plan:
    """How all trees of one shape are built: what is always the same, then step by step the rest."""

    values: list[Any]
    steps: list[tuple[_Build, int, _Pick, int, int]]
    """the method; which of the values so far is its only child, or else how its children are
    picked from them; the positions"""

    @classmethod
    def of(cls, root: SyntaxNode, builder: type["Builder"]) -> "_Plan":
        """The plan for trees such as this one."""
        values: list[Any] = []
        branches: list[tuple[SyntaxNode, list[SyntaxNode | int]]] = []

        def gather(branch: SyntaxNode) -> SyntaxNode | int:
            if branch.rule in builder.passed and len(branch.children) == 1:
                (only,) = branch.children
                assert isinstance(only, SyntaxNode)
                return gather(only)
            # No rule of the grammars contains itself, so the trees are shallow.
            if branch.rule in builder.constants:
                values.append(builder.constants[branch.rule])
                return len(values) - 1
            children: list[SyntaxNode | int] = []
            for child in branch.children:
                if isinstance(child, SyntaxNode):
                    children.append(gather(child))
                else:
                    values.append(child)
                    children.append(len(values) - 1)
            branches.append((branch, children))
            return branch

        gather(root)
        index = {id(branch): i for i, (branch, _) in enumerate(branches, start=len(values))}
        steps = [
            (
                getattr(builder, branch.rule),
                *_pick([c if isinstance(c, int) else index[id(c)] for c in children]),
                branch.start,
                branch.end,
            )
            for branch, children in branches
        ]
        return cls(values, steps)


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
        "autonomous": Mode.AUTONOMOUS,
        "supervisory": Mode.SUPERVISORY,
        "precise": Order.PRECISE,
        "any_order": Order.ANY,
        "prose": None,
        "ordinal_word": None,
    }
    """what the rules stand for that always mean the same"""
    passed: ClassVar[frozenset[str]] = frozenset()
    """rules that mean what their one part does, if they have only one"""

    def __init__(self, text: ScriptText, diagnostics: Diagnostics) -> None:
        self.text = text
        self.diagnostics = diagnostics

    def statement(self, tree: Syntax) -> Any:
        """The node of a statement's tree; None if it makes no sense, with an error that says so."""
        errors = self.diagnostics.errors
        plan = tree.made.get(type(self))
        if plan is None:
            plan = tree.made[type(self)] = _Plan.of(tree.root, type(self))
        values = plan.values.copy()
        new = tuple.__new__  # as Phrase(...) does it, but for the checks: this is the inner loop
        text, positions = self.text, tree.positions
        for build, only, parts_of, start, end in plan.steps:
            parts = (values[only],) if only >= 0 else parts_of(values)
            phrase = new(Phrase, (parts, text, positions[start], positions[end]))
            values.append(build(self, phrase))
        return values[-1] if self.diagnostics.errors == errors else None

    def number(self, phrase: Phrase) -> Figure:
        said = phrase.content
        if len(said) < 7 and said.isdecimal():
            return Figure(int(said), phrase)
        value = quantities.number(phrase.content.rstrip("stndrhSTNDRH"))
        if value is None:
            value = quantities.number(phrase.content)
        if value is None:
            hint = "write it in figures"
            message = f"`{phrase.content}` is no number"
            self.diagnostics.error("number", message, phrase.span, hint)
        elif value > _LARGEST:
            hint = f"numbers go up to {_LARGEST}"
            message = f"{phrase.content} is too large a number"
            self.diagnostics.error("number", message, phrase.span, hint)
        elif value != int(value):
            message = f"`{phrase.content}` is not a whole number"
            self.diagnostics.error("number", message, phrase.span, "write a whole number")
        return Figure(int(min(value or 0, _LARGEST)), phrase)

    ordinal = number

    def step_number(self, phrase: Phrase) -> int:
        said = phrase.content
        if said[:-1].isdecimal() and len(said) < 7:
            return int(said[:-1])
        digits = "".join(c for c in said if c.isdecimal() or c == ".").rstrip(".")
        return int(min(float(digits), _LARGEST))

    def time(self, phrase: Phrase) -> Time:
        value, unit = phrase.children
        return Time(span=phrase.span, seconds=value * unit, unit=unit)

    def amount(self, phrase: Phrase) -> float:
        """A number that need not be whole."""
        value = quantities.number(phrase.content)
        if value is None:
            message = f"`{phrase.content}` is no number"
            self.diagnostics.error("number", message, phrase.span, "write it in figures")
        elif value >= 1e308:
            message = f"{phrase.content} is too large a number"
            self.diagnostics.error("number", message, phrase.span, "write a smaller one")
            return 0.0
        return value or 0

    def phrase_time(self, phrase: Phrase) -> Time:
        seconds = quantities.phrase(phrase.content)
        if seconds is None:
            message = f"`{phrase.content}` is no duration"
            self.diagnostics.error("duration", message, phrase.span, "write, say, `90 minutes`")
        return Time(span=phrase.span, seconds=seconds or 1.0, unit=1.0)

    def clock(self, phrase: Phrase) -> Time:
        said = phrase.content
        seconds = quantities.parse_clock(said)
        if seconds is None and said.count(":") == 1:
            a, b = said.split(":")
            message = f"`{said}` can be read as {a} min {b} s or as {a} h {b} min"
            hint = f"write `{a} min {b} s` or `{a} h {b} min`"
            self.diagnostics.error("ambiguous-duration", message, phrase.span, hint)
        elif seconds is None:
            message = f"`{said}` has sixty or more minutes or seconds"
            self.diagnostics.error("duration", message, phrase.span, "write, say, `00:12:30`")
        # Nothing may follow that is larger or the same.
        return Time(span=phrase.span, seconds=1.0 if seconds is None else seconds, unit=1.0)

    def duration(self, times: tuple[Time, ...]) -> Duration:
        """The sum of the times, which must go from hours down to seconds and be more than none."""
        start, end = times[0].span, times[-1].span
        length = max(1, end.column + end.length - start.column)
        span = Span(line=start.line, column=start.column, length=length)
        seconds = sum(time.seconds for time in times)
        if seconds == 0:
            self.diagnostics.error(
                "duration", "a duration of zero", span, "write, say, `10 minutes`"
            )
        elif seconds > MAX_TIME_S:
            message = (
                f"a duration of {seconds:g} s is too long: at most {MAX_TIME_S:g} s are counted"
            )
            self.diagnostics.error("duration", message, span, "write a shorter one")
            seconds = MAX_TIME_S
        elif any(a.unit <= b.unit for a, b in pairwise(times)):
            hint = "write hours before minutes before seconds, each once: `1 h 30 min`"
            self.diagnostics.error(
                "duration", "the units of this duration are mixed up", span, hint
            )
        return Duration(span=span, seconds=float(seconds))

    def identifier(self, phrase: Phrase) -> str:
        if phrase.content.startswith('"'):
            return self.unquote(phrase)
        return phrase.content

    def unquote(self, phrase: Phrase) -> str:
        text = quantities.quoted(phrase.content)
        if text is None:
            message = "this quoted text has an escape that is none"
            hint = r"write a backslash as \\, a quotation mark as \" and any sign as, say, \u002a"
            self.diagnostics.error("quoted-text", message, phrase.span, hint)
        return text or ""

    def name(self, phrase: Phrase) -> Name:
        kind, identifier = phrase.children
        return Name(span=phrase.span, kind=kind, identifier=identifier)

    def checkpoint_number(self, phrase: Phrase) -> Numbered:
        return Numbered(phrase.the(Figure).value, phrase)

    def reading(self, phrase: Phrase) -> Quantity:
        return phrase.the(Quantity)

    def label_end(self, phrase: Phrase) -> int:
        """Where a field's label ends; its text is taken from there."""
        return phrase.end

    def field_text(self, phrase: Phrase) -> ScriptText:
        """The text of a field, as it stands after the label."""
        return self.text[phrase.the(int) :].strip()

    def free_text(self, text: ScriptText) -> str:
        """A field's text: as it is meant where it is quoted as a whole, else in single blanks."""
        if quantities.is_quoted(text.content):
            return self.unquote(Phrase((), text, 0, len(text.content)))
        return " ".join(text.content.split())
