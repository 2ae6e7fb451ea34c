"""Lengths of time, put together from their parts: `1 hour and 30 minutes`, `an hour and a half`."""

import re
from dataclasses import dataclass

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


def told(number: float, unit: float) -> str:
    """A number of units as it is written without doubt."""
    return f"{number:g} {_NAMES[unit]}" if unit in _NAMES else f"{number * unit / 60:g} min"


def read_clock(said: str) -> Length | None:
    """`00:12:30`, or minutes and seconds if they can't be hours; None for sixty of them."""
    parts = [int(part) for part in said.split(":")]
    if any(part >= 60 for part in parts[1:]):
        return None
    if len(parts) == 3:
        return Length(parts[0] * 3600.0 + parts[1] * 60 + parts[2])
    minutes, rest = parts
    length = minutes * 60.0 + rest
    if minutes >= 24:
        return Length(length)
    return Length(
        length,
        other=length * 60,
        first=f"{minutes} min {rest} s",
        second=f"{minutes} h {rest} min",
    )


def read_glued(said: str) -> Length | None:
    """`1h30`, `1h30min` and `2min30s`; None for anything else, and for sixty minutes and more."""
    found = _GLUED.fullmatch(said)
    if found is None:
        return None
    hours, minutes, rest = (int(part or 0) for part in found.groups())
    if (found[1] and minutes >= 60) or (found[2] and rest >= 60):
        return None
    return Length(hours * 3600.0 + minutes * 60 + rest)
