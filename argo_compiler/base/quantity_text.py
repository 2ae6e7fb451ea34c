"""Texts for durations, energies and numbers of things.

Bounds are rounded such that they remain bounds: a lower one down, an upper one up.
"""

import math
from collections.abc import Callable

from argo_compiler.base.message import Message

_NOISE = 1e-9  # relative error of sums of floating-point numbers, which is not rounded up or down


def rounded_down(value: float) -> int:
    """Round a lower bound to a whole number."""
    return math.floor(value + _NOISE * max(1.0, abs(value)))


def rounded_up(value: float) -> int:
    """Round an upper bound to a whole number."""
    return math.ceil(value - _NOISE * max(1.0, abs(value)))


def duration_text(seconds: float, to_whole: Callable[[float], int] = round) -> Message:
    """Format a duration in s, such as `47.5 s`, `12 min 30 s` or `2 h 5 min`.

    `to_whole` rounds durations from one minute on to whole seconds, and shorter ones to three
    digits.
    """
    if (short := _three_digits(seconds, to_whole)) < 60:
        return Message("{seconds:.3g} s", seconds=short)
    minutes, rest = divmod(to_whole(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    parts = (
        (hours, Message("{hours} h", hours=hours)),
        (minutes, Message("{minutes} min", minutes=minutes)),
        (rest, Message("{seconds} s", seconds=rest)),
    )
    return Message("{parts: }", parts=tuple(text for count, text in parts if count))


def least_duration_text(seconds: float) -> Message:
    """Format a lower bound of a duration in s."""
    return duration_text(seconds, rounded_down)


def most_duration_text(seconds: float) -> Message:
    """Format an upper bound of a duration in s."""
    return duration_text(seconds, rounded_up)


def limit_text(seconds: float) -> Message:
    """Format a limit in s that somebody has set: all of it, such as `2 min` or `90.4 s`."""
    whole = float(seconds).is_integer()
    return duration_text(seconds) if whole else Message("{seconds:.10g} s", seconds=seconds)


def exceeding_duration_text(least: float, limit: float) -> Message:
    """Format a lower bound in s that exceeds a limit (s), with the digits that show it."""
    if (_three_digits(least, rounded_down) if least < 60 else rounded_down(least)) > limit:
        return least_duration_text(least)
    for digits in range(1, 6):
        shown = rounded_down(least * 10**digits) / 10**digits
        if shown > limit:
            return Message("{seconds:g} s", seconds=shown)
    return Message("{seconds:.10g} s", seconds=least)


def energy_text(energy_wh: float, to_whole: Callable[[float], int] = round) -> Message:
    """Format an energy in Wh, such as `120 Wh`; `to_whole` rounds it, to three digits or more."""
    if (short := _three_digits(energy_wh, to_whole)) < 1000:
        return Message("{energy:.3g} Wh", energy=short)
    return Message("{energy} Wh", energy=to_whole(energy_wh))


def least_energy_text(energy_wh: float) -> Message:
    """Format a lower bound of an energy in Wh."""
    return energy_text(energy_wh, rounded_down)


def most_energy_text(energy_wh: float) -> Message:
    """Format an upper bound of an energy in Wh."""
    return energy_text(energy_wh, rounded_up)


def counted_text(count: int, noun: str) -> str:
    """Format a number of things, such as `1 run` and `2 runs`."""
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


def with_article(noun: str) -> str:
    """Return a noun with its indefinite article, such as `a script` and `an evaluation`."""
    return f"{'an' if noun[:1].lower() in 'aeiou' else 'a'} {noun}"


def _three_digits(value: float, to_whole: Callable[[float], int]) -> float:
    """Round a number below 1,000 to three digits."""
    if value == 0 or abs(value) >= 1000:
        return value
    digits = min(15, 2 - math.floor(math.log10(abs(value))))
    scale = 10.0**digits
    return to_whole(value * scale) / scale
