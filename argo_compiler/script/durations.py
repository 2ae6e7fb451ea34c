"""Durations outside scripts, in fields of forms: read with the words and signs of scripts."""

from argo_compiler.base.model import Model
from argo_compiler.il import MAX_TIME_S
from argo_compiler.script.documents.healing import plain_signs
from argo_compiler.script.sentences.words.amounts import Length
from argo_compiler.script.sentences.words.language import Language
from argo_compiler.script.sentences.words.lexer import words_of
from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.word import Word

LONGEST_TEXT = 100
"""characters of a duration's text"""
_UNITS_S = (1.0, 60.0, 3600.0)
"""s of the units that a bare number may count"""


class DurationReading(Model):
    """Meaning of a text as a duration: one, several to choose from, or none."""

    seconds: float | None
    """s, if the text has exactly one meaning"""
    possible: tuple[float, ...]
    """s; all that the text can mean, if it has several meanings"""


def read_duration(text: str) -> DurationReading:
    """Return what a text says as a duration, as scripts would, in English and in German.

    `1:30 h`, `1h30`, `half an hour` and `1 Stunde 30` have one meaning. `1:30` and `10` can be read
    in two and three ways; a text that is no duration, such as `1:90`, in none. Texts that are
    longer than `LONGEST_TEXT` are none. What a text can mean is at most `MAX_TIME_S`.
    """
    found: set[float] = set()
    if len(text) <= LONGEST_TEXT:
        for language in Language.all(()):
            found.update(_possible(words_of(plain_signs(text).strip(" ."), language.lexicon)))
    possible = sorted(seconds for seconds in found if seconds <= MAX_TIME_S)
    if len(possible) == 1:
        return DurationReading(seconds=possible[0], possible=())
    return DurationReading(seconds=None, possible=tuple(possible))


def _possible(words: list[Word]) -> list[float]:
    """Return the seconds of each thing that the words can mean."""
    match [(word.type, word.value) for word in words]:
        case [("DURATION", Length(seconds=seconds, other=other))]:
            return [seconds] if other is None else [seconds, other]
        case [("NUMBER", Figure(value=value, other=other))]:
            numbers = [value] if other is None else [value, other]
            return [number * unit for number in numbers for unit in _UNITS_S]
        case [("QUANTITY", (Figure(value=value, other=None), "m"))]:  # minutes, and not metres
            return [value * 60.0]
        case [("DURATION", Length(seconds=seconds, unit=60.0, other=None)), ("NUMBER", number)]:
            return [seconds + number.value] if number.whole in range(60) else []  # `12 min 30`
    return []
