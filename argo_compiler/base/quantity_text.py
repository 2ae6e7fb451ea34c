"""Texts for durations and energies."""


def duration_text(seconds: float) -> str:
    """Format a duration in s, such as `47.5 s`, `12 min 30 s` or `2 h 5 min`.

    Durations from one minute on are rounded to whole seconds.
    """
    if seconds < 60:
        return f"{seconds:.3g} s"
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    parts = (hours, "h"), (minutes, "min"), (rest, "s")
    return " ".join(f"{count} {unit}" for count, unit in parts if count)


def energy_text(energy_wh: float) -> str:
    """Format an energy in Wh, such as `120 Wh`."""
    return f"{energy_wh:.3g} Wh" if energy_wh < 1000 else f"{energy_wh:.0f} Wh"
