"""How long the ways of a mission take on a site: what a route problem is made from."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.il import Action, Mission

_ROUNDING = 1e-6  # of a unit, left by sums of floats


@dataclass(frozen=True, eq=False)
class TravelMatrix:
    """Times and energies between the n tasks of a mission and c places where the robot can charge.

    A row is where the robot stands: after task i, row n where the mission starts, and from n + 1 at
    the chargers. A column is where it goes, the action there included: to task j, and from n to the
    chargers. The speed on a way is that of the task that it leads to.

    What is said of a WAIT counts for nothing: it takes its time where the robot stands.
    """

    tasks: tuple[str, ...]
    """the names of all tasks but START, in the mission's order"""
    time: NDArray[np.float64]
    """units, shape (n + 1 + c, n + c); inf: there is no way"""
    energy: NDArray[np.float64]
    """Wh, likewise"""
    work: NDArray[np.float64]
    """units of `time` that the action takes even if the robot is there already, shape (n + c,)"""
    chargers: tuple[str, ...] = ()
    """names"""
    battery: float | None = None
    """Wh that may be used on one charge; None: not known"""
    charging: float = 0.0
    """W"""
    unit: float = 0.1
    """s"""

    def __post_init__(self) -> None:
        """Raises ArgoError if the shapes don't fit."""
        columns = len(self.tasks) + len(self.chargers)
        shape = (columns + 1, columns)
        if self.time.shape != shape or self.energy.shape != shape or len(self.work) != columns:
            raise Invalid(f"times, energies and work of {columns} places must be {shape}")
        if self.chargers and (self.battery is None or self.charging <= 0.0):
            raise Invalid("with chargers it must be known what battery they charge, and how fast")

    def units_of_energy(self, watt_hours: NDArray[np.float64]) -> NDArray[np.float64]:
        """Energy (Wh) as the time that it takes to charge it, in units."""
        return watt_hours * 3600.0 / (self.charging * self.unit)

    def up(self, seconds: float) -> int:
        """Whole units that a time takes, the last one begun counted."""
        return int(np.ceil(seconds / self.unit - _ROUNDING))

    def down(self, seconds: float) -> int:
        """Whole units that fit into a time."""
        return int(np.floor(seconds / self.unit + _ROUNDING))


def require_matrix_of(ways: TravelMatrix, mission: Mission) -> None:
    """Raises ArgoError if the ways are those of another mission."""
    names = tuple(task.name for task in mission.tasks if task.action is not Action.START)
    if names != ways.tasks:
        raise Conflict("these are the ways of another mission: its tasks are others")
