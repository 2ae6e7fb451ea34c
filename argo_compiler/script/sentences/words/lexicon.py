"""The words of a language: which phrase is which terminal of the grammar, and what it means."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import field
from functools import lru_cache
from itertools import product
from typing import Any

from argo_compiler.base.records import dataclass
from argo_compiler.script.sentences.words.without_effect import WITHOUT_EFFECT
from argo_compiler.script.sentences.words.word import VERBS

Entry = tuple[str, Any]
"""a terminal and its value"""
Phrases = Mapping[Entry, str]
"""by entry, its phrases, separated by bars; `check{s}` is `check` and `checks`, `[a/b] c` is `a c`
and `b c`"""


@dataclass(slots=True)
class PhraseStart:
    """The words with which phrases begin, and what may follow."""

    entry: Entry | None = None
    next: "dict[str, PhraseStart]" = field(default_factory=dict)
    parted: dict[tuple[str, ...], Entry] = field(default_factory=dict)
    """by what ends it behind other words: `kehre … zurück`"""

    def __reduce__(self) -> tuple[Any, ...]:  # half the time of what Python does by itself
        return PhraseStart, (self.entry, self.next, self.parted)


@dataclass(slots=True)
class FoundPhrase:
    """A phrase: its entry, how many pieces it takes at its place, and which others behind it."""

    entry: Entry
    length: int
    apart: range = range(0)


_BEHIND = frozenset(["JOINT", "IF", "UNLESS", "UNTIL", "ELSE", "IF_TIME", "IF_ONLY"])
_STOPS = frozenset(VERBS) - {"DOCK"} | {"IF", "UNLESS", "ELSE", "BACK"}
_FIGURE = re.compile(r"(?<!\w)[0-9]+(?:\.[0-9]+)?(?!\w)")


class Lexicon:
    """All phrases of a language, found by their first words, the longest first."""

    def __init__(
        self,
        name: str,
        articles: str,
        definite: str,
        passed_over: str,
        verbs_first: bool,
        plural_article: str,
        plural_ending: str,
        particles: str,
        times_ending: str,
    ) -> None:
        self.name = name
        self.articles = frozenset(articles.split())
        """what is passed over within a phrase wherever it stands"""
        self.definite = frozenset(definite.split())
        """articles, and words that have one in them, which say that it is one that is known"""
        self.passed_over = frozenset(passed_over.split()) | self.definite
        """words that may stand within a phrase"""
        self.plural_article = plural_article
        self.plural_ending = plural_ending
        self.particles = frozenset(particles.split())
        """what ends a parted verb only where its clause ends"""
        self.times_ending = times_ending
        self.verbs_first = verbs_first
        """whether a verb stands before all that it is said of, as the grammar has it"""
        self.other: Lexicon | None = None
        """of another language, in which a sentence may be as well"""
        self.root = PhraseStart()
        self.words: set[str] = set()
        self.figures: set[str] = set()
        """numbers in phrases, as in the name of a place"""
        self.numerals: dict[str, float] = {}
        self.phrases: dict[Entry, list[str]] = {}

    def add(self, entry: Entry, phrases: Iterable[str]) -> None:
        """Adds phrases, in lower case; one that is there already must not mean anything else,
        unless a place of the site has that name."""
        for phrase in phrases:
            said = folded(phrase)
            head, _, end = said.partition(" … ")
            node = self.root
            for k, piece in enumerate(head.split()):
                if k and piece in self.articles:
                    continue
                following = node.next.get(piece)
                if following is None:
                    following = node.next[piece] = PhraseStart()
                node = following
            last = tuple(end.split())
            there = node.parted.get(last) if end else node.entry
            named = entry[0] == "PLACE" and there is not None and there[0] != "PLACE"
            if there not in (None, entry) and not named:
                raise ValueError(f"{self.name}: `{phrase}` is {there} and {entry}")
            if end:
                node.parted[last] = entry
            else:
                node.entry = entry
            self.figures.update(_FIGURE.findall(said))
            self.words.update(_words(phrase), () if said is phrase else _words(said))
            self.phrases.setdefault(entry, []).append(phrase)
            if entry[0] == "NUMBER_WORD" and " " not in said:
                self.numerals[said] = entry[1]

    # ---- phrases in the pieces of a text

    def longest(self, said: Sequence[str], at: int) -> FoundPhrase | None:
        """The longest phrase from piece `at` on; of a parted one its end decides."""
        node = self.root.next.get(said[at])
        if node is None:
            return None
        entry, behind, parted = node.entry, at + 1, None
        if node.parted:
            parted = self._parted(said, at, at + 1, node)
        for k in range(at + 1, len(said)):
            step = node.next.get(said[k])
            if step is None:
                if said[k] not in self.passed_over:
                    break
                continue
            node = step
            if node.entry is not None:
                entry, behind, parted = node.entry, k + 1, None
            if node.parted:
                parted = self._parted(said, at, k + 1, node) or parted
        if parted is not None:
            return parted
        return None if entry is None else FoundPhrase(entry, behind - at)

    def _parted(
        self, said: Sequence[str], at: int, behind: int, node: PhraseStart
    ) -> FoundPhrase | None:
        """The parted phrase that is begun, if its end is found in the same clause."""
        for k in range(behind, len(said)):
            for last, entry in node.parted.items():
                end = k + len(last)
                if tuple(said[k:end]) == last and self._may_end(said, end, last):
                    return FoundPhrase(entry, behind - at, range(k, end))
            if said[k] in (";", ":") or self._type(said[k]) in _STOPS:
                return None
        return None

    def _may_end(self, said: Sequence[str], end: int, last: tuple[str, ...]) -> bool:
        """Return whether a clause may end before piece `end`; the word before may be another."""
        if end >= len(said) or last[-1] not in self.particles:
            return True
        after = said[end]
        if after in self.passed_over:
            return False
        type_ = self._type(after)
        return after in (",", ".", ";", ":", ")") or type_ in _BEHIND or type_ in WITHOUT_EFFECT

    def _type(self, piece: str) -> str | None:
        node = self.root.next.get(piece)
        return node.entry[0] if node is not None and node.entry is not None else None


def _words(phrase: str) -> list[str]:
    return [piece for piece in phrase.split() if piece[0].isalpha()]


_FOLDED = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ß": "ss"})


def folded(piece: str) -> str:
    """A word without umlauts, as it is often typed."""
    return piece if piece.isascii() else piece.translate(_FOLDED)


_GROUP = re.compile(r"\{(.*?)\}|\[(.*?)\]")


@lru_cache(maxsize=4096)
def expand(text: str) -> tuple[str, ...]:
    """The phrases that `text` lists: `check{s}` is two, `a|b` are two, `[a/b] c` are two."""
    found: list[str] = []
    for phrase in text.split("|"):
        if "[" not in phrase and "{" not in phrase:
            found.append(" ".join(phrase.split()))
            continue
        # Literal text, what may be there, and what is one of several, one after the other.
        parts = _GROUP.split(phrase)
        choices = [
            [part] if k % 3 == 0 else ["", *_optional(part)] if k % 3 == 1 else part.split("/")
            for k, part in enumerate(parts)
            if part is not None
        ]
        found += dict.fromkeys(" ".join("".join(form).split()) for form in product(*choices))
    return tuple(found)


def _optional(part: str) -> tuple[str, ...]:
    """Return the phrases of what may be there: one of several, or with one of several in it."""
    if "[" in part:
        return expand(part)
    return expand(f"[{part}]") if "/" in part else (part,)
