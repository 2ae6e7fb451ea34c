"""The language of a script, with the names of its site."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from argo_compiler.script.syntax.words import english
from argo_compiler.script.syntax.words.english_prose import PROSE
from argo_compiler.script.syntax.words.lexicon import Lexicon
from argo_compiler.script.syntax.words.prose import Prose


@dataclass(frozen=True)
class Language:
    """A lexicon, and all words that a text in it may have."""

    lexicon: Lexicon

    @property
    def words(self) -> set[str]:
        return self.lexicon.words

    @property
    def prose(self) -> Prose:
        """What stands around its sentences."""
        return PROSE

    @classmethod
    def of(cls, text: str, places: Iterable[str]) -> "Language":
        """The language that a text is written in."""
        return cls(_english(tuple(sorted(places))))


@lru_cache(maxsize=8)
def _english(places: tuple[str, ...]) -> Lexicon:
    lexicon = Lexicon("English", *english.PARTS)
    for place in places:
        words = [word for word in place.lower().split() if word not in ("the", "a", "an")]
        lexicon.add(("PLACE", place), [" ".join(words)])
    return lexicon
