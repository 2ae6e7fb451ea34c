"""Texts that a script, or the next one, has again, if only with other figures: they are read once.

For a text whose figures are others the sentence is read once more with numbers that are not known.
Where that succeeds, nothing but the figures themselves can differ in what such texts say.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache

from argo_compiler.diagnostics import Span
from argo_compiler.script.syntax.moving import Move, mover
from argo_compiler.script.syntax.sentence_reading import Said
from argo_compiler.script.syntax.shapes import Shape, figure_places, with_other_figures
from argo_compiler.script.syntax.text.source import ScriptText
from argo_compiler.script.syntax.words.lexicon import Lexicon
from argo_compiler.script.syntax.words.unknown import UnknownFigure, unknown_figure

_MOST = 8192
"""texts that are kept, and shapes; then all are forgotten"""

ReadAgain = Callable[[ScriptText, Mapping[int, UnknownFigure]], list[Said] | None]
"""reads a text, in which the figures at these places of the source are not known; None if what it
says hangs on them"""


@dataclass(slots=True)
class _Text:
    """What a text says."""

    said: list[Said]
    span: Span
    moves: list[Move] = field(default_factory=list)
    """how it is said at another place; made when the text is met again, for most never are"""

    def at(self, here: Span, figures: tuple[str, ...]) -> list[Said]:
        """What it says at another place and with other figures."""
        self.moves = self.moves or [move for move in map(mover, self.said) if move is not None]
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
        self._known[text.content] = _Text(said, text.span())
        shape = Shape.of(text.content)
        if not shape.figures or shape.key in self._shapes or self._in_phrases(shape.figures):
            return
        if shape.key in self._met:
            self._shapes[shape.key] = _of_shape(text, shape, said, read)
        self._met.add(shape.key)

    def said(self, text: ScriptText) -> list[Said] | None:
        """What a text says; None if it is not known."""
        if not isinstance(text.offsets, range):
            return None
        known = self._known.get(text.content)
        if known is not None:
            return known.at(text.span(), ())
        shape = Shape.of(text.content)
        known = self._shapes.get(shape.key)
        if known is None or self._in_phrases(shape.figures):
            return None
        return known.at(text.span(), shape.figures)

    def _in_phrases(self, figures: tuple[str, ...]) -> bool:
        """Whether one of the figures is in a phrase of the language, such as a place's name."""
        said = self.lexicon.figures
        return bool(said) and not said.isdisjoint(figures)


def _of_shape(text: ScriptText, shape: Shape, said: list[Said], read: ReadAgain) -> _Text | None:
    """What all texts of a shape say; None if that hangs on their figures, or on their digits."""
    unknown = {
        text.offsets[start]: unknown_figure(figure, place)
        for place, (start, figure) in enumerate(
            zip(figure_places(text.content), shape.figures, strict=True)
        )
    }
    other = ScriptText(with_other_figures(text.content), text.offsets, text.source)
    found = read(other, unknown)
    if found is None:
        return None
    kept = _Text(found, text.span())
    return kept if kept.at(text.span(), shape.figures) == said else None


repeats = lru_cache(maxsize=8)(Repeats)
"""the same for all scripts in that language on that site"""
