"""Which known words a misspelt one may be meant to be."""

from collections.abc import Iterable
from functools import lru_cache

_ALIKE = 0.74
"""share of letters that must be in place: one error in four letters, two in eight"""

_LONGEST = 60
"""letters; no word of the language is anywhere near as long"""


def candidates(word: str, known: frozenset[str]) -> tuple[str, ...]:
    """The known words that `word` is most likely a misspelling of, none of them for short words and
    words with figures."""
    if not 4 <= len(word) <= _LONGEST or not word.replace("-", "").replace("'", "").isalpha():
        return ()
    return _closest(word.lower(), known)


@lru_cache(maxsize=4096)
def _closest(word: str, known: frozenset[str]) -> tuple[str, ...]:
    from rapidfuzz import process  # imported late: only misspelt words need it
    from rapidfuzz.distance import OSA

    similarity = OSA.normalized_similarity
    alike = process.extract(word, _long(known), scorer=similarity, score_cutoff=_ALIKE, limit=None)
    distances = {other: OSA.distance(word, other) for other, _, _ in alike}
    least = min(distances.values(), default=0)
    return tuple(sorted(other for other, distance in distances.items() if distance == least))


@lru_cache(maxsize=8)
def _long(known: frozenset[str]) -> list[str]:
    return [word for word in known if len(word) >= 3]


def nearest(text: str, known: Iterable[str], limit: int = 3) -> tuple[str, ...]:
    """Up to `limit` known texts, the most similar first; none that is not similar at all."""
    return _nearest(text, tuple(known), limit)


@lru_cache(maxsize=4096)
def _nearest(text: str, known: tuple[str, ...], limit: int) -> tuple[str, ...]:
    from rapidfuzz import fuzz, process

    found = process.extract(
        text, known, scorer=fuzz.ratio, processor=str.lower, limit=limit, score_cutoff=60
    )
    return tuple(choice for choice, _, _ in found)
