"""The language of a script, with the names of its site."""

import re
from collections.abc import Container, Iterable
from functools import cached_property, lru_cache
from itertools import islice

from argo_compiler.base.records import dataclass
from argo_compiler.script.sentences.words import loading
from argo_compiler.script.sentences.words.lexicon import Lexicon, folded
from argo_compiler.script.sentences.words.prose import Prose

_WORD = re.compile(r"[^\W\d_]+")
_MOST = 4000
"""words from which the language is told"""


@dataclass(frozen=True)
class Language:
    """A lexicon, and all words that a text in it may have."""

    lexicon: Lexicon
    prose: Prose
    """what stands around its sentences"""

    @cached_property
    def words(self) -> frozenset[str]:
        return frozenset(self.lexicon.words)

    @classmethod
    def of(cls, text: str, places: Iterable[str]) -> "Language":
        """The language of which a text has more words that are none of the other's."""
        names = tuple(sorted(places))
        one, two = _lexicons(names)
        said = [folded(word.group().lower()) for word in islice(_WORD.finditer(text), _MOST)]
        score = sum([(word in two.words) - (word in one.words) for word in said])
        return _language(two, "german", "english") if score > 0 else _language(one, "english")

    @classmethod
    def all(cls, places: Iterable[str]) -> tuple["Language", "Language"]:
        """The languages, English first."""
        one, two = _lexicons(tuple(sorted(places)))
        return _language(one, "english"), _language(two, "german", "english")


@lru_cache(maxsize=16)
def _language(lexicon: Lexicon, name: str, besides: str | None = None) -> Language:
    return Language(lexicon, loading.prose(name, besides=besides))


def place_key(name: str, unsaid: Container[str]) -> str:
    """The words of a place's name that tell it from others: those are asked about that have the
    same ones."""
    return " ".join(word for word in folded(name.lower()).split() if word not in unsaid)


@lru_cache(maxsize=8)
def _lexicons(places: tuple[str, ...]) -> tuple[Lexicon, Lexicon]:
    one, two = loading.load_lexicons()
    named = {place_key(place, one.articles): place for place in reversed(places)}
    for key, place in named.items():
        for lexicon in (one, two):
            lexicon.add(("PLACE", place), [key])
    one.other, two.other = two, one
    return one, two
