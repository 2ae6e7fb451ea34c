"""The language of a script, with the names of its site."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import islice

from argo_compiler.script.syntax.words import english, english_prose, german, german_prose
from argo_compiler.script.syntax.words.lexicon import Lexicon, folded
from argo_compiler.script.syntax.words.prose import Prose

_WORD = re.compile(r"[^\W\d_]+")
_MOST = 4000
"""words from which the language is told"""


@dataclass(frozen=True)
class Language:
    """A lexicon, and all words that a text in it may have."""

    lexicon: Lexicon
    prose: Prose
    """what stands around its sentences"""

    @property
    def words(self) -> set[str]:
        return self.lexicon.words

    @classmethod
    def of(cls, text: str, places: Iterable[str]) -> "Language":
        """The language of which a text has more words that are none of the other's."""
        names = tuple(sorted(places))
        one, two = _lexicons(names)
        said = [folded(word.group().lower()) for word in islice(_WORD.finditer(text), _MOST)]
        score = sum((word in two.words) - (word in one.words) for word in said)
        return cls(two, german_prose.PROSE) if score > 0 else cls(one, english_prose.PROSE)


@lru_cache(maxsize=8)
def _lexicons(places: tuple[str, ...]) -> tuple[Lexicon, Lexicon]:
    one = Lexicon("English", english.PARTS, "the", "a an straight directly then please also")
    two = Lexicon(
        "German",
        (*german.PARTS, german.OWN),
        "der die das den dem des am im zum zur beim vom ins",
        "ein eine einen einem einer eines bitte dann direkt gleich auch the",
        verbs_first=False,
        plural_article="die",
        plural_ending="n",
    )
    for place in places:
        pieces = [word for word in place.lower().split() if word not in ("the", "a", "an")]
        for lexicon in (one, two):
            lexicon.add(("PLACE", place), [" ".join(pieces)])
    one.other, two.other = two, one
    return one, two
