"""Puts numbers together with what they count: lengths of time, speeds, quantities, limits.

`10 minutes` is a length of time, `0.3 m/s` a speed, `4.5 bar` a quantity, `at most three times` a
limit. Lengths of time are put together from their parts: `1 hour and 30 minutes`.
"""

import re
from dataclasses import dataclass

from argo_compiler.script.sentences.words.numbers import Figure
from argo_compiler.script.sentences.words.word import Word

_UNITS = ("UNIT_S", "A_UNIT")
_DAY_S = 86400.0
_BEFORE_MINUTE = (
    *("EARLIEST", "LATEST", "BETWEEN", "AND_", "JOINT", "BY", "AT", "FROM", "TO", "UNTIL", "UPTO"),
    *("AFTER", "BEFORE", "DASH", "WITHIN", "IN", "SINCE_START"),
)
"""how the types of words begin behind which `minute 10` is a time: `not before minute 10`"""
_LIMITS = {"TIMES": "MOST_TIMES", "DURATION": "MOST_TIME"}
_GLUED = re.compile(r"(?:([0-9]+)(?:h|std))?(?:([0-9]+)(?:min|m)?)?(?:([0-9]+)(?:sec|sek|s))?")
_NAMES = {3600.0: "h", 60.0: "min", 1.0: "s"}


@dataclass(frozen=True, slots=True)
class Length:
    """A length of time, and how else it may be read."""

    seconds: float
    unit: float = 1.0
    """s, of its last part: what is added to it has a smaller one"""
    other: float | None = None
    """s, the second reading: of `12:30`, and of `1.200 s`"""
    first: str = ""
    """how the first reading is written so that there is no doubt"""
    second: str = ""
    clock_parts: int = 0
    """number of its parts if it is written as a clock, else 0: `1:30` has 2, `1:30:00` has 3"""


def _told(number: float, unit: float) -> str:
    """A number of units as it is written without doubt."""
    return f"{number:g} {_NAMES[unit]}" if unit in _NAMES else f"{number * unit / 60:g} min"


def read_clock(said: str) -> Length | None:
    """`00:12:30`, or minutes and seconds if they can't be hours; None for sixty of them."""
    parts = [int(part) for part in said.split(":")]
    if any(part >= 60 for part in parts[1:]):
        return None
    if len(parts) == 3:
        return Length(parts[0] * 3600.0 + parts[1] * 60 + parts[2], clock_parts=3)
    minutes, rest = parts
    length = minutes * 60.0 + rest
    first, second = f"{minutes} min {rest} s", f"{minutes} h {rest} min"
    other = None if minutes >= 24 else length * 60
    return Length(length, other=other, first=first, second=second, clock_parts=2)


def read_glued(said: str) -> Length | None:
    """`1h30`, `1h30min` and `2min30s`; None for anything else, and for sixty minutes and more."""
    found = _GLUED.fullmatch(said)
    if found is None:
        return None
    hours, minutes, rest = (int(part or 0) for part in found.groups())
    if (found[1] and minutes >= 60) or (found[2] and rest >= 60):
        return None
    return Length(hours * 3600.0 + minutes * 60 + rest)


def counted(word: Word, after: Word, before: str = "") -> Word | None:
    """A number and what it counts, as one word. `before`: the type of the word before them."""
    if word.type == "HALF" and after.type in _UNITS:
        return Word("DURATION", Length(after.value / 2, after.value), word.start, after.end)
    if word.type == "DURATION" and after.type in _UNITS:
        clock = _of_clock(word.value, after.value)
        return None if clock is None else Word("DURATION", clock, word.start, after.end)
    if word.type == "UNIT_S" and after.type == "NUMBER":
        if word.value >= _DAY_S or not before.startswith(_BEFORE_MINUTE):
            return None  # `Day 1: #4`, `Minute 5: #4`
        return Word("DURATION", _length(after.value, word.value), word.start, after.end)
    if word.type != "NUMBER":
        return None
    figure: Figure = word.value
    match after.type:
        case "UNIT_S" | "A_UNIT":
            return Word("DURATION", _length(figure, after.value), word.start, after.end)
        case "TIME_WORD" | "X":
            return Word("TIMES", figure, word.start, after.end)
        case "RATE":
            return Word("SPEED", (figure, after.value), word.start, after.end)
        case "UNIT":
            return Word("QUANTITY", (figure, after.value), word.start, after.end)
        case "ORDINAL" if after.value == 2 and figure.value == 1:  # `one second`
            return Word("DURATION", Length(1.0), word.start, after.end)
        case _:
            return None


def _length(figure: Figure, unit: float) -> Length:
    if figure.other is None:
        return Length(figure.value * unit, unit)
    first, second = _told(figure.value, unit), _told(figure.other, unit)
    return Length(figure.value * unit, unit, figure.other * unit, first, second)


def _of_clock(length: Length, unit: float) -> Length | None:
    """`1:30 h` is hours and minutes, `1:30 min` minutes and seconds, `1:30:00 h` all three."""
    match length.clock_parts, unit:
        case (2, 60.0) | (3, 3600.0):
            return Length(length.seconds)
        case 2, 3600.0:
            return Length(length.seconds * 60 if length.other is None else length.other)
    return None


def total(first: Word, second: Word) -> Word | None:
    """Hours, then minutes, then seconds; None if they are no lengths of time in this order."""
    if first.type != "DURATION" or second.type != "DURATION":
        return None
    a, b = first.value, second.value
    if a.unit <= b.unit or a.other is not None or b.other is not None:
        return None
    return Word("DURATION", Length(a.seconds + b.seconds, b.unit), first.start, second.end)


def hours_and(hours: Word, minutes: Word, after: Word | None) -> Word | None:
    """`1 h 15`: the number behind the hours is the minutes, unless it begins something else."""
    if (hours.type, minutes.type) != ("DURATION", "NUMBER"):
        return None
    number = minutes.value.whole
    ends = after is None or after.type in ("JOINT", "SIGN", "RPAR")
    whole = hours.value.unit == 3600.0 and hours.value.other is None
    if not whole or not ends or number is None or number >= 60:
        return None
    return Word(
        "DURATION", Length(hours.value.seconds + number * 60, 60.0), hours.start, minutes.end
    )


def limited(words: list[Word]) -> list[Word]:
    """The words with limits in one: `at most 10 times`, `50 minutes at most`."""
    found: list[Word] = []
    for word in words:
        last = found[-1] if found else None
        # `Try again up to two more times` is as often as `up to twice`.
        tries = word.type == "MORE" and any(before.type == "RETRY" for before in found)
        if last is not None and last.type == "AT_MOST" and (word.type in _LIMITS or tries):
            type_ = _LIMITS.get(word.type, "MOST_TIMES")
            found[-1] = Word(type_, word.value, last.start, word.end)
        else:
            found.append(word)
    for i in range(len(found) - 1, 0, -1):
        last, word = found[i - 1 : i + 1]
        if word.type == "AT_MOST" and last.type in _LIMITS:
            found[i - 1 : i + 1] = [Word(_LIMITS[last.type], last.value, last.start, word.end)]
    return found
