"""Charge of the battery for which a mission waits (R12)."""

from typing import NamedTuple

LOW, FULL = 0.2, 0.99
"""charge, 0 to 1, below which a robot calls its battery low, and from which on it calls it charged,
if the mission names no other"""


class AwaitedCharge(NamedTuple):
    """Charge for which a hold or a WAIT waits: with it, the robot raises BATTERY_CHARGED."""

    level: float | None
    """least charge, 0 to 1; None: the robot's own level of a charged battery"""
    not_before: float
    """time (s) before which the robot does not raise the event"""
    while_charging: bool = False
    """whether the robot raises the event only if the battery charges then, or is full"""


def awaited_charge(
    charge_to: float | None, charge_for: float | None, since: float
) -> AwaitedCharge:
    """Return the charge for which a hold or a WAIT that began at the time `since` (s) waits.

    `charge_to` (0 to 1) and `charge_for` (s) are those of the reaction or the WAIT.
    """
    if charge_for is None:
        return AwaitedCharge(charge_to, since)
    return AwaitedCharge(0.0 if charge_to is None else charge_to, since + charge_for, True)
