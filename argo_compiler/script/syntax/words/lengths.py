"""Lengths of time, put together from their parts: `1 hour and 30 minutes`, `an hour and a half`."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Length:
    """A length of time, and how else it may be read."""

    seconds: float
    unit: float = 1.0
    """s, of its last part: what is added to it has a smaller one"""
    other: float | None = None
    """s, the second reading: of `12:30`, and of `1.200 s`"""
    said: str = ""
    first: str = ""
    """how the first reading is written so that there is no doubt"""
    second: str = ""


def read_clock(said: str) -> Length | None:
    """`00:12:30`, or minutes and seconds if they can't be hours; None for sixty minutes and more."""
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
        said=said,
        first=f"{minutes} min {rest} s",
        second=f"{minutes} h {rest} min",
    )
