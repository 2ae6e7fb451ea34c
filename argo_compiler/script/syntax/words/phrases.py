"""Finds the phrases of a lexicon in the pieces of a text."""

from collections.abc import Sequence
from dataclasses import dataclass

from argo_compiler.script.syntax.words.joints import VERBS
from argo_compiler.script.syntax.words.lexicon import Entry, Lexicon, PhraseStart

_BEHIND = frozenset(["JOINT", "FILLER", "IF", "UNLESS", "UNTIL", "ELSE", "IF_TIME", "IF_ONLY"])
_STOPS = frozenset(VERBS) - {"DOCK"} | {"IF", "UNLESS", "ELSE", "BACK"}


@dataclass(slots=True)
class Found:
    """A phrase: its entry, how many pieces it takes at its place, and which others behind it."""

    entry: Entry
    length: int
    apart: range = range(0)


def longest(said: Sequence[str], at: int, lexicon: Lexicon) -> Found | None:
    """The longest phrase from piece `at` on; of a parted one its end decides."""
    node = lexicon.root.next.get(said[at])
    if node is None:
        return None
    entry, behind, parted = node.entry, at + 1, None
    if node.parted:
        parted = _parted(said, at, at + 1, node, lexicon)
    for k in range(at + 1, len(said)):
        step = node.next.get(said[k])
        if step is None:
            if said[k] not in lexicon.passed_over:
                break
            continue
        node = step
        if node.entry is not None:
            entry, behind, parted = node.entry, k + 1, None
        if node.parted:
            parted = _parted(said, at, k + 1, node, lexicon) or parted
    if parted is not None:
        return parted
    return None if entry is None else Found(entry, behind - at)


def _parted(
    said: Sequence[str], at: int, behind: int, node: PhraseStart, lexicon: Lexicon
) -> Found | None:
    """The parted phrase that is begun, if its end is found in the same clause."""
    for k in range(behind, len(said)):
        for last, entry in node.parted.items():
            end = k + len(last)
            if tuple(said[k:end]) == last and _may_end(said, end, last, lexicon):
                return Found(entry, behind - at, range(k, end))
        if said[k] in (";", ":") or _type(said[k], lexicon) in _STOPS:
            return None
    return None


def _may_end(said: Sequence[str], end: int, last: tuple[str, ...], lexicon: Lexicon) -> bool:
    """Whether a clause may end before piece `end`, if the word before it could mean otherwise."""
    if end >= len(said) or last[-1] not in lexicon.particles:
        return True
    after = said[end]
    if after in lexicon.passed_over:
        return False
    return after in (",", ".", ";", ":", ")") or _type(after, lexicon) in _BEHIND


def _type(piece: str, lexicon: Lexicon) -> str | None:
    node = lexicon.root.next.get(piece)
    return node.entry[0] if node is not None and node.entry is not None else None
