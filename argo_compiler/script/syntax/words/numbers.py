"""Numbers in figures: what `4,5`, `1.000,5` and `1.200` stand for."""

import re
from dataclasses import dataclass

_GROUPED = re.compile(r"[1-9][0-9]{0,2}([.,'])[0-9]{3}(?:\1[0-9]{3})*")
_PLAIN = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Figure:
    """A number, and how else it may be read."""

    value: float
    other: float | None = None
    """the second reading: of `1.200`, 1200 beside 1.2"""
    listed: tuple[int, ...] = ()
    """`1,4`, which among checkpoints is a list of two"""

    @property
    def whole(self) -> int | None:
        """The whole number that it is; None if it has decimals or can be read in two ways."""
        if self.other is not None or self.listed or self.value != int(self.value):
            return None
        return int(self.value)


def read_figure(text: str) -> Figure:
    """The number in `text`: digits, with points, commas or apostrophes between them."""
    if text.isdecimal():
        return Figure(float(text))
    listed = tuple(int(part) for part in text.split(",") if part.isdecimal())
    if "," not in text or listed == () or "." in text or len(listed) != text.count(",") + 1:
        listed = ()
    if _GROUPED.fullmatch(text):
        separator = next(c for c in text if not c.isdecimal())
        whole = float(text.replace(separator, ""))
        if separator == "'" or text.count(separator) > 1:
            return Figure(whole, listed=listed)
        return Figure(float(text.replace(",", ".")), whole, listed)
    if _PLAIN.fullmatch(text):
        return Figure(float(text))
    last = max(text.rfind("."), text.rfind(","))
    digits = re.sub(r"[.,']", "", text[:last])
    return Figure(float(f"{digits}.{text[last + 1 :]}"), listed=listed)


def compose(values: list[int | None]) -> tuple[int, int]:
    """The number that the first of the values stand for, and how many of them it takes.

    `[2, 1000, 300]` are two, thousand and three hundred. A value that is no number ends it.
    """
    total = part = n = 0
    last = 1000
    for value in values:
        if value is None:
            break
        if value == 1000 and 0 < part:
            total, part, last = total + part * 1000, 0, 1000
        elif value == 100 and 0 < part < 100:
            part, last = part * 100, 100
        elif value < last:
            # After twenty comes at most nine, after a hundred at most ninety-nine.
            part += value
            last = 10 if value >= 20 and value % 10 == 0 else 1
        else:
            break
        n += 1
    return total + part, n
