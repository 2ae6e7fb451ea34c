"""Values in other units than a checkpoint's own."""

import re
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pint import UnitRegistry

_UNIT = re.compile(r"[^\W\d_]+|[°%]|°[CF]|[^\W\d_]+/[^\W\d_]+")
"""how units are written in a catalogue; anything else is a name of its own, and not converted"""
ABSOLUTE = " absolute"
"""how the name of a unit of absolute pressure ends; gauges show what exceeds that of the air"""
_ANGLES = frozenset(["deg", "rad", "°", "degree", "degrees", "radian"])


def converted(value: float, unit: str, wanted: str) -> float | None:
    """The value in the wanted unit; None if it can't be told in that one."""
    if unit == wanted:
        return value
    if unit.endswith(ABSOLUTE):
        return None
    # To Pint an angle is a number as a share is; 30 % of a valve are no 17 degrees.
    if (unit in _ANGLES) != (wanted in _ANGLES) or not _UNIT.fullmatch(wanted):
        return None
    # It takes longer to load than most scripts to import, and few of them need it.
    import pint

    try:
        found = _registry().Quantity(value, unit).to(wanted).magnitude
    except pint.errors.PintError:
        return None
    # What comes of factors such as 1e5 / 1e6 is meant to have no more digits than it was given.
    return float(f"{found:.12g}")


@cache
def _registry() -> "UnitRegistry[float]":
    import pint

    return pint.UnitRegistry()
