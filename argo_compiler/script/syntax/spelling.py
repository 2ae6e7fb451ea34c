"""Which known word a misspelt one was meant to be."""

from collections.abc import Iterable, Sequence
from functools import lru_cache

from rapidfuzz import fuzz, process
from rapidfuzz.distance import OSA, JaroWinkler

_ALIKE = 0.74
"""share of letters that must be in place: one error in four letters, two in eight"""

_LONGEST = 60
"""letters; no word of the language is anywhere near as long"""


def respell(word: str, known: Iterable[str]) -> str | None:
    """The one known word that `word` is a misspelling of; None if there is none, or more than one.

    A singular and its plural are one. Short words and words with figures are never respelled: too
    much of them would be a guess.
    """
    if not 4 <= len(word) <= _LONGEST or not word.replace("-", "").replace("'", "").isalpha():
        return None
    return _respell(word, known if isinstance(known, frozenset) else frozenset(known))


@lru_cache(maxsize=4096)
def _respell(word: str, known: frozenset[str]) -> str | None:
    alike = process.extract(
        word,
        [other for other in known if len(other) >= 3],
        scorer=OSA.normalized_similarity,
        score_cutoff=_ALIKE,
        limit=None,
    )
    distances = {other: OSA.distance(word, other) for other, _, _ in alike}
    closest = [w for w, distance in distances.items() if distance == min(distances.values())]
    if len({w.removesuffix("s") for w in closest}) != 1:
        return None
    return max(closest, key=len)


def nearest(text: str, known: Iterable[str], limit: int = 3) -> tuple[str, ...]:
    """Up to `limit` known texts, the most similar first; none that is not similar at all."""
    found = process.extract(
        text, list(known), scorer=fuzz.ratio, processor=str.lower, limit=limit, score_cutoff=60
    )
    return tuple(choice for choice, _, _ in found)


def most_alike(text: str, forms: Sequence[str]) -> str:
    """The one of the `forms` that `text` resembles most, its beginning above all."""
    key = text.lstrip("0123456789.) ").lower()
    return max(forms, key=lambda form: JaroWinkler.similarity(key, form.lower()))
