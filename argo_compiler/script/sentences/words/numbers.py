"""Numbers in figures and words: what `4,5`, `1.000,5`, `1.200` and `hundertfünf` stand for."""

import re
from collections.abc import Mapping, Sequence
from math import nan

from argo_compiler.base.records import dataclass

_GROUPED = re.compile(r"[1-9][0-9]{0,2}([.,'])[0-9]{3}(?:\1[0-9]{3})*")
_PLAIN = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?", re.IGNORECASE)
_DECIMALS = re.compile(
    r"(?:[0-9]+|[1-9][0-9]{0,2}(?:'[0-9]{3})+)[.,][0-9]+"
    r"|[1-9][0-9]{0,2}(?:(?:\.[0-9]{3})+,|(?:,[0-9]{3})+\.)[0-9]+"
)
_LISTED = re.compile(r"(?:0|[1-9][0-9]*)(?:,(?:0|[1-9][0-9]*))+")
_PARTS = {"½": 0.5, "¼": 0.25, "¾": 0.75}


@dataclass(frozen=True, slots=True)
class Figure:
    """A number, and how else it may be read."""

    value: float
    """not a number if it is a list of more than two, and nothing else"""
    other: float | None = None
    """the second reading: of `1.200`, 1200 beside 1.2"""
    listed: tuple[int, ...] = ()
    """`1,4`, which among checkpoints is a list of two"""

    @property
    def whole(self) -> int | None:
        """The whole number that it is; None if it has decimals or can be read in two ways."""
        if self.other is not None or self.listed or not self.value.is_integer():
            return None
        return int(self.value)


def read_figure(text: str) -> Figure | None:
    """The number in `text`, digits with points, commas or apostrophes between them; None if no
    one writes a number so."""
    if text.isdecimal():
        return Figure(float(text))
    if text[-1] in _PARTS:
        return Figure(float(text[:-1] or 0) + _PARTS[text[-1]])
    listed = tuple(map(int, text.split(","))) if _LISTED.fullmatch(text) else ()
    if grouped := _GROUPED.fullmatch(text):
        separator = grouped[1]
        whole = float(text.replace(separator, ""))
        if separator == "'" or text.count(separator) > 1:
            return Figure(whole, listed=listed)
        return Figure(float(text.replace(",", ".")), whole, listed)
    if _PLAIN.fullmatch(text):
        return Figure(float(text))
    if _DECIMALS.fullmatch(text):
        last = max(text.rfind("."), text.rfind(","))
        digits = re.sub(r"[.,']", "", text[:last])
        return Figure(float(f"{digits}.{text[last + 1 :]}"), listed=listed)
    return Figure(nan, listed=listed) if listed else None


def compose(values: Sequence[float | None]) -> tuple[float, int]:
    """The number that the first of the values stand for, and how many of them it takes.

    `[2, 1000, 300]` are two, thousand and three hundred. A value that is no number ends it, and so
    does one and a half.
    """
    total = part = n = 0
    last = 1000
    for value in values:
        if value is None or value != int(value):
            break
        number = int(value)
        if number == 1000 and (part > 0 or n == 0):
            total, part, last = total + max(part, 1) * 1000, 0, 1000
        elif number == 100 and 0 < part < 100:
            part, last = part * 100, 100
        elif number < last or n == 0:
            # After twenty comes at most nine, after a hundred at most ninety-nine.
            part += number
            last = number if number >= 100 else 10 if number >= 20 and number % 10 == 0 else 1
        else:
            break
        n += 1
    if n == 0 and values and values[0] is not None:
        return values[0], 1
    return total + part, n


def split_number(word: str, numerals: Mapping[str, float]) -> list[float] | None:
    """The numbers that a word is put together from, as `zweihundertfünf` is; None if it is not."""
    if not word:
        return []
    for end in range(len(word), 0, -1):
        value = numerals.get(word[:end])
        if value is None:
            continue
        rest = split_number(word[end:].removeprefix("und"), numerals)
        if rest is not None:
            return [value, *rest]
    return None
