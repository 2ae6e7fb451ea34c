"""Numbers, durations and quoted texts: what their words and figures amount to."""

import json
import re

_UNITS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine"]
_TEENS = [
    "ten",
    "eleven",
    "twelve",
    "thirteen",
    "fourteen",
    "fifteen",
    "sixteen",
    "seventeen",
    "eighteen",
    "nineteen",
]
_TENS = ["twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety"]
ORDINALS = (
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
    "ninth",
    "tenth",
    "eleventh",
    "twelfth",
)
_SMALL = {
    "a": 1,
    "an": 1,
    **{word: value for value, word in enumerate(_UNITS + _TEENS, start=1)},
    **{word: value for value, word in zip(range(20, 100, 10), _TENS, strict=True)},
    **{word: value for value, word in enumerate(ORDINALS, start=1)},
}

_PIECE = re.compile(r"\"(?:[^\"\\]|\\.)*\"", re.DOTALL)
_SECONDS = {"hour": 3600.0, "minute": 60.0, "second": 1.0}


def number(text: str) -> float | int | None:
    """The number that figures or words stand for; None if the words make no number."""
    text = text.lower()
    if text[:1].isdecimal():
        return int(text) if text.isdecimal() else float(text)
    total = part = 0
    scale = 10_000
    last = 1000
    for word in text.replace("-", " ").split():
        if word == "and":
            continue
        if word == "thousand":
            if part == 0 or scale <= 1000:
                return None
            total += part * 1000
            part, scale, last = 0, 1000, 1000
        elif word == "hundred":
            if not 0 < part < 100:
                return None
            part *= 100
            last = 100
        else:
            value = _SMALL.get(word)
            # After twenty comes at most nine, after a hundred at most ninety-nine.
            if value is None or value >= last:
                return None
            part += value
            last = 10 if value >= 20 and value % 10 == 0 else 1
    return total + part


def parse_clock(text: str) -> float | None:
    """Seconds of `00:12:30`; None for two parts, which could be minutes or hours first, and for
    sixty and more minutes or seconds."""
    parts = [int(part) for part in text.split(":")]
    if len(parts) != 3 or max(parts[1:]) >= 60:
        return None
    return float(parts[0] * 3600 + parts[1] * 60 + parts[2])


def phrase(text: str) -> float | None:
    """Seconds of `half an hour`, `an hour and a half`, `two and a half hours` and the like."""
    words = text.lower().split()
    unit = next((s for name, s in _SECONDS.items() for w in words if w.startswith(name)), None)
    if unit is None:
        return None
    if words[0] == "half":
        return unit / 2
    if "quarter" in words:
        return unit / 4
    if "quarters" in words:
        return unit * 3 / 4
    count = number(words[0])
    return None if count is None else (count + 0.5 * ("half" in words)) * unit


def quoted(text: str) -> str | None:
    """The text that quoted pieces, one after the other, stand for; None if one is no JSON."""
    try:
        whole = "".join(str(json.loads(piece)) for piece in _PIECE.findall(text))
        whole.encode()
    except ValueError:
        return None
    return whole


def is_quoted(text: str) -> bool:
    """Whether the text is quoted pieces and nothing else."""
    return bool(text) and not _PIECE.sub("", text).strip()
