"""Texts for durations and energies."""


def time_words(seconds: float) -> str:
    """Format a duration in s, such as `47 s`, `12 min 30 s` or `2 h 5 min`."""
    if seconds < 60:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 60:
        return f"{minutes} min {rest} s" if rest else f"{minutes} min"
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if minutes else f"{hours} h"


def energy_words(energy_wh: float) -> str:
    """Format an energy in Wh, such as `120 Wh`."""
    return f"{energy_wh:.3g} Wh" if energy_wh < 1000 else f"{energy_wh:.0f} Wh"
