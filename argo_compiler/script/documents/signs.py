"""Signs of forms and plans: blanks to fill in, boxes, rules, times of day, dates."""

import re

BLANK = re.compile(r"_{2,}|\.{4,}|…{2,}")
"""to be filled in by a person"""
_BOX = re.compile(r"[□☐]")
RULE = re.compile(r"[\s|:=+-]*-[\s|:=+-]*")
"""a line between rows"""
CLOCK = re.compile(
    r"(?<![\d.:])(?P<hour>[0-9]{1,2})[:.](?P<minute>[0-9]{2})(?!\d|:\d|\.\d)(?:\s?(?:h|Uhr)\b)?"
)
"""a time of day"""
DATE = re.compile(
    r"\b(?:[0-9]{1,2}\.\s?(?:[0-9]{1,2}\.|[A-Z][a-zä]+)(?:\s?[0-9]{2,4})?|[0-9]{4}-[0-9]{2}-[0-9]{2}"
    r"|[0-9]{1,2}/[0-9]{1,2}(?:/[0-9]{2,4})?"
    r"|(?:[0-9]{1,2}(?:st|nd|rd|th)?\s+(?:of\s+)?(?:Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)[a-z]*"
    r"|(?:Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)[a-z]*\s+[0-9]{1,2})\b)"
)

_PLACE_IN_ORDER = re.compile(r"#?\s*(\d{1,6})(?:st|nd|rd|th|[.):])?", re.IGNORECASE)
_LETTER_IN_ORDER = re.compile(r"([A-Za-z])[.):]?")


def is_to_fill(content: str) -> bool:
    """Return True if a text has a blank or a box for a person to fill in."""
    return BLANK.search(content) is not None or _BOX.search(content) is not None


def place_in_order(content: str) -> int | None:
    """Return the place in an order that a cell has, from its number or letter; None if it has
    none."""
    number, letter = _PLACE_IN_ORDER.fullmatch(content), _LETTER_IN_ORDER.fullmatch(content)
    if letter is not None:
        return ord(letter[1].lower()) - ord("a") + 1
    return int(number[1]) if number is not None else None
