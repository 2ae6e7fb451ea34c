"""A word of a script, as the grammar sees it."""

from dataclasses import dataclass
from typing import Any


@dataclass(slots=True)
class Word:
    """A word, a phrase, a number or a sign, with its kind and what it means. Not frozen, for there
    are very many, and they are made faster so; nothing changes one."""

    type: str
    """the terminal of the grammar"""
    value: Any
    """what the lexicon or the figures say that it is"""
    start: int
    end: int
    """indices in the text, of the first character and behind the last"""
    before: str = ""
    """the joining signs and words that stood before it: `, and`"""
