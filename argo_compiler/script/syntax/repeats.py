"""Texts that a script, or the next one, has again: they are read once."""

from dataclasses import dataclass, field
from functools import lru_cache

from argo_compiler.diagnostics import Span
from argo_compiler.script.syntax.sentence_reading import Said
from argo_compiler.script.syntax.text.source import ScriptText
from argo_compiler.script.syntax.tree.moving import Move, mover
from argo_compiler.script.syntax.words.lexicon import Lexicon

_MOST = 8192
"""texts that are kept; then all are forgotten"""


@dataclass(slots=True)
class _Text:
    """What a text says."""

    said: list[Said]
    span: Span
    moves: list[Move] = field(default_factory=list)
    """how it is said at another place; made when the text is met again, for most never are"""


@dataclass
class Repeats:
    """What texts in a language, on a site with these names, say wherever they stand."""

    lexicon: Lexicon
    names: frozenset[str]
    _known: dict[str, _Text] = field(default_factory=dict)

    def keep(self, text: ScriptText, said: list[Said]) -> None:
        """Keeps what a text says. Only of one as it was written: in no other do the places of its
        parts follow from where it begins."""
        if isinstance(text.offsets, range):
            if len(self._known) >= _MOST:
                self._known.clear()
            self._known[text.content] = _Text(said, text.span())

    def said(self, text: ScriptText) -> list[Said] | None:
        """What a text says; None if it is not known."""
        known = self._known.get(text.content)
        if known is None or not isinstance(text.offsets, range):
            return None
        known.moves = known.moves or [move for move in map(mover, known.said) if move is not None]
        here = text.span()
        lines, columns = here.line - known.span.line, here.column - known.span.column
        return [move(lines, columns) for move in known.moves]


repeats = lru_cache(maxsize=8)(Repeats)
"""the same for all scripts in that language on that site"""
