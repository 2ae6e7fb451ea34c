"""Texts that a script, or the next one, has again, if only with other figures: they are read once.

For a text whose figures are others the sentence is read once more with numbers that are not known.
Where that succeeds, nothing but the figures themselves can differ in what such texts say.
"""

import re
from bisect import bisect_left
from collections.abc import Callable, Mapping, Sequence
from dataclasses import field, fields
from functools import cache, lru_cache
from typing import Any

from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Span, span_at
from argo_compiler.script.documents.source import ScriptText, quotes
from argo_compiler.script.layout.lines import sentences
from argo_compiler.script.sentences.tree.manner import NOTHING_SAID, Manner
from argo_compiler.script.sentences.tree.node import Node
from argo_compiler.script.sentences.tree.script import Said
from argo_compiler.script.sentences.words.lexicon import Lexicon
from argo_compiler.script.sentences.words.unknown import (
    Unknown,
    UnknownName,
    UnknownValue,
    unknown_figure,
)

_MOST = 8192
"""texts that are kept, and shapes; then all are forgotten"""

ReadAgain = Callable[[ScriptText, Mapping[int, UnknownValue]], list[Said] | None]
"""reads a text, in which the figures at these places of the source are not known; None if what it
says hangs on them"""
_PLAIN = re.compile(
    r"(?<![\w.,'’:/½¼¾-])([2-9]|[1-9][0-9]{1,5}|[1-9][0-9]{0,4}\.[0-9]{1,2}"
    r"|0\.(?=[0-9]?[1-9])[0-9]{1,2})(?![\w½¼¾]|[.,'’:/-]\w)"
)
"""a number that can be read in one way only; 0 and 1 are often more than numbers"""
_HIDDEN = str.maketrans("0123456789", "\ue000" * 10)
_OTHERS = str.maketrans("0123456789", "4356789242")
"""by digit, another one, neither 0 nor 1"""
_Move = Callable[[int, int, Sequence[str]], Any]
"""the part so many lines and columns further on, with these figures for those that are unknown"""
_Fill = Callable[[object, object], None]


# ---- the shape of a text


def _shape(content: str) -> tuple[str, tuple[str, ...]]:
    """Return a text without its plain numbers, as all texts of its shape are, and the numbers."""
    parts = _PLAIN.split(content)
    figures = tuple(parts[1::2])
    # The first zero of `0.5` is part of the shape: such a number is less than one.
    parts[1::2] = [_changed(figure, _HIDDEN) for figure in figures]
    return "".join(parts), figures


def _changed(figure: str, digits: dict[int, str] | dict[int, int]) -> str:
    return f"0{figure[1:].translate(digits)}" if figure[0] == "0" else figure.translate(digits)


# ---- a node of a text that stands at another place, or says the same of other figures


def _mover(part: object) -> _Move | None:
    """What makes the same part for another place; None if it says nothing of its place, nor of
    a figure that is not known."""
    if type(part) is Unknown or type(part) is UnknownName:
        fill = part.fill
        return lambda _lines, _columns, figures: fill(figures)
    if part is NOTHING_SAID:
        return None
    match part:
        case Span(line=line, column=column, length=length):
            return lambda lines, columns, _: span_at(line + lines, column + columns, length)
        case tuple():
            moves = [_mover(one) for one in part]
            if not any(moves):
                return None
            pairs = list(zip(part, moves, strict=True))
            return lambda lines, columns, figures: tuple(
                [one if move is None else move(lines, columns, figures) for one, move in pairs]
            )
        case Node() | Manner():
            return _mover_of_node(part)
    return None


def _mover_of_node(part: Node | Manner) -> _Move:
    type_: Any = type(part)
    same: list[tuple[_Fill, object]] = []
    moving: list[tuple[_Fill, _Move]] = []
    for name, fill in _slots(type_):
        value = getattr(part, name)
        move = _mover(value)
        if move is None:
            same.append((fill, value))
        else:
            moving.append((fill, move))

    def moved(lines: int, columns: int, figures: Sequence[str]) -> object:
        new = object.__new__(type_)
        for fill, value in same:
            fill(new, value)
        for fill, move in moving:
            fill(new, move(lines, columns, figures))
        return new

    return moved


@cache
def _slots(type_: type[Any]) -> list[tuple[str, _Fill]]:
    """The fields of a node, and how each is filled: through its slot, which is several times as
    fast as making a node."""
    return [(field.name, getattr(type_, field.name).__set__) for field in fields(type_)]


# ---- what texts say


@dataclass(slots=True)
class _Text:
    """What a text says."""

    said: list[Said]
    text: ScriptText
    span: Span
    moves: list[_Move] = field(default_factory=list)
    """how it is said at another place; made when the text is met again, for most never are"""
    parts: list[slice] = field(default_factory=list)
    """where its sentences stand, likewise"""

    def at(self, here: Span, figures: tuple[str, ...]) -> list[Said]:
        """What it says at another place and with other figures."""
        if not self.moves:
            self.moves = [move for move in map(_mover, self.said) if move is not None]
            first = self.text.first
            found = sentences(self.text)
            self.parts = [slice(one.first - first, one.last + 1 - first) for one in found]
        lines, columns = here.line - self.span.line, here.column - self.span.column
        return [move(lines, columns, figures) for move in self.moves]


@dataclass
class Repeats:
    """What texts in a language, on a site with these names, say wherever they stand."""

    lexicon: Lexicon
    names: frozenset[str]
    _known: dict[str, _Text] = field(default_factory=dict)
    _shapes: dict[str, _Text | None] = field(default_factory=dict)
    """None: hangs on its figures"""
    _met: set[str] = field(default_factory=set)
    """shapes that were met once"""

    def keep(self, text: ScriptText, said: list[Said], read: ReadAgain) -> None:
        """Keeps what a text says. Only of one as it was written: in no other do the places of its
        parts follow from where it begins."""
        if not isinstance(text.offsets, range):
            return
        if len(self._known) >= _MOST:
            self._known.clear()
            self._shapes.clear()
            self._met.clear()
        self._known[text.content] = _Text(said, text, text.span())
        shape, figures = _shape(text.content)
        if not figures or shape in self._shapes or self._in_phrases(figures):
            return
        if shape in self._met:
            self._shapes[shape] = _of_shape(text, figures, said, read)
        self._met.add(shape)

    def said(self, text: ScriptText) -> tuple[list[Said], list[ScriptText]] | None:
        """Return the nodes of a text that was read before, and its sentences; None for another."""
        if not isinstance(text.offsets, range):
            return None
        known = self._known.get(text.content)
        if known is not None:
            return known.at(text.span(), ()), [text[part] for part in known.parts]
        shape, figures = _shape(text.content)
        known = self._shapes.get(shape)
        if known is None or self._in_phrases(figures):
            return None
        return known.at(text.span(), figures), [text[part] for part in known.parts]

    def _in_phrases(self, figures: tuple[str, ...]) -> bool:
        """Whether one of the figures is in a phrase of the language, such as a place's name."""
        return not self.lexicon.figures.isdisjoint(figures)


def _of_shape(
    text: ScriptText, figures: tuple[str, ...], said: list[Said], read: ReadAgain
) -> _Text | None:
    """What all texts of a shape say; None if that hangs on their figures, or on their digits."""
    places = [found.span() for found in _PLAIN.finditer(text.content)]
    unknown: dict[int, UnknownValue] = {
        text.offsets[start]: unknown_figure(text.content[start:end], place)
        for place, (start, end) in enumerate(places)
    }
    for start, end in quotes(text.content):  # `"WAYPOINT 8"` is a name
        inside = slice(bisect_left(places, (start,)), bisect_left(places, (end,)))
        if places[inside] and "\\" not in text.content[start:end]:
            parts = _PLAIN.split(text.content[start + 1 : end - 1])[::2]
            for place, _ in places[inside]:
                del unknown[text.offsets[place]]
            unknown[text.offsets[start]] = UnknownName(parts, inside)
    others = _PLAIN.sub(lambda found: _changed(found[0], _OTHERS), text.content)
    found = read(ScriptText(others, text.offsets, text.source), unknown)
    if found is None:
        return None
    kept = _Text(found, text, text.span())
    return kept if kept.at(text.span(), figures) == said else None


repeats = lru_cache(maxsize=8)(Repeats)
"""the same for all scripts in that language on that site"""
