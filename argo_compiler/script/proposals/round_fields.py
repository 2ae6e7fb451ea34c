"""Fields of sheets about rounds: how many there are, and how far apart they begin.

What a field says is told by its label: `Number of rounds | 4`, `New round every | 30 min`. The
number is proposed together with the time, whichever stands first.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from argo_compiler.script.documents.source import join
from argo_compiler.script.layout.forms import FormRow
from argo_compiler.script.parsing.script import Piece
from argo_compiler.script.proposals.composing import Proposal
from argo_compiler.script.proposals.frames import Sentences, length_words
from argo_compiler.script.proposals.mentions import Mentions, mentions_in
from argo_compiler.script.sentences.understanding import Understanding
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.prose import phrase_pattern

_ITEM = re.compile(r"(?:[A-Z]?\d{1,2}(?:\.\d)?[.)]?\s+)?")
"""the number of an item before its label: `A3`"""
_PART = "a part of what the number of rounds says"
_CUT = re.compile(r"\s*(?:[:|]|\.{3,}|…+)\s*")
_TIMES = ("every", "pause")
_OF_VALUES = ("NUMBER", "TIMES", "EVERY", "DURATION", "TIME_WORD")


@dataclass(frozen=True)
class _RoundField:
    """Field of a sheet that gives the number of rounds, their interval or their pause."""

    at: int
    """the offset at which its piece begins"""
    kind: str
    """`count`, `every` or `pause`"""
    count: int | None = None
    length: str | None = None
    """in words of the mission language"""
    is_clear: bool = False
    """whether all of its value is used"""


def propose_rounds(
    pieces: Iterable[Piece], rows: Mapping[int, FormRow], understanding: Understanding
) -> dict[int, Proposal]:
    """Return what is proposed for the fields of a script about rounds, by the offset at which their
    pieces begin; one that has no place in that is open."""
    read = (_field(piece, rows.get(piece.text.first), understanding) for piece in pieces)
    fields = [field for field in read if field is not None]
    counts = [field for field in fields if field.count is not None]
    times = [field for field in fields if field.length is not None]
    clear = all(field.is_clear for field in fields) and len(counts) == 1 and len(times) <= 1
    if not clear:
        return {field.at: Proposal(choices=_ways(field, times[:1])) for field in fields}
    choices = _ways(counts[0], times)
    found = {field.at: Proposal(aside=_PART) for field in times}
    return {**found, counts[0].at: Proposal(choices[0], choices=choices)}


def _ways(field: _RoundField, times: Sequence[_RoundField]) -> tuple[Sentences, ...]:
    """Return what a number of rounds may mean, the likeliest first."""
    if field.count is None:
        return ((),)
    plain = f"Repeat everything {field.count} times"
    ways = [plain]
    for time in times:
        paused = f"{plain}, with a wait of {time.length} in between"
        spaced = f"Repeat everything every {time.length}, {field.count} times"
        ways = [paused, spaced, plain] if time.kind == "pause" else [spaced, paused, plain]
    return (*((f"{way}.",) for way in ways), ())


def _field(piece: Piece, row: FormRow | None, understanding: Understanding) -> _RoundField | None:
    """Return what a piece says of the rounds, if its label is one of rounds."""
    text = piece.text
    if row is not None and (row.doubt or row.box is not None or row.is_heading):
        return None
    cells = [cell.text for cell in row.cells] if row is not None else []
    if len(cells) > 1:
        label, value = cells[0], join(cells[1:], " ")
    else:
        text = text if row is None else row.place
        cut = _CUT.search(text.content)
        at, behind = cut.span() if cut is not None else (len(text.content),) * 2
        label, value = text[:at], text[behind:]
    form = understanding.language.prose.form
    bare = _ITEM.sub("", label.content, count=1).strip(" .:")
    kinds = [kind for kind in ("count", *_TIMES) if _is_label(bare, form[f"rounds_{kind}"])]
    if not kinds or not value.content:
        return None
    found = mentions_in(value, understanding)
    lengths = [length_words(mention.value) for mention in found.of("DURATION")]
    count, length = _count(found), lengths[0] if len(lengths) == 1 else None
    kind = "every" if found.has("EVERY") else kinds[0]
    clear = found.only(*_OF_VALUES) and not found.unknown
    clear &= len(lengths) <= 1
    clear &= (length is not None) if kind in _TIMES else (count is not None and length is None)
    return _RoundField(piece.text.first, kind, count, length, clear)


def _is_label(content: str, phrases: str) -> bool:
    return phrase_pattern(phrases).fullmatch(content) is not None


def _count(found: Mentions) -> int | None:
    """Return the number of a value, if it has one that can be a number of rounds."""
    figures = [m.value for m in found.of("NUMBER", "TIMES")]
    if len(figures) != 1 or not isinstance(figures[0], Figure):
        return None
    whole = figures[0].whole
    return whole if whole is not None and whole > 1 else None
