"""Values in other units than a checkpoint's own."""

from functools import cache
from typing import Any

_SAME = {"degree": "deg", "degrees": "deg", "°": "deg", "percent": "%", "bars": "bar"}


def converted(value: float, unit: str, wanted: str) -> float | None:
    """The value in the wanted unit; None if it can't be told in that one."""
    unit, wanted = _plain(unit), _plain(wanted)
    if unit == wanted:
        return value
    registry = _registry()
    try:
        found = registry.Quantity(value, unit).to(wanted).magnitude
    except Exception:  # noqa: BLE001
        return None
    # What comes of factors such as 1e5 / 1e6 is meant to have no more digits than it was given.
    return float(f"{found:.12g}")


def _plain(unit: str) -> str:
    return _SAME.get(unit.lower(), unit)


@cache
def _registry() -> Any:
    import pint

    return pint.UnitRegistry()
