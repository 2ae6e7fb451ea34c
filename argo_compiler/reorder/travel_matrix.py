"""Travel times and energies of a mission on a site, the input of its route problem."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Conflict, Invalid
from argo_compiler.base.message import Message
from argo_compiler.il import Action, Mission

_ROUNDING = 1e-6  # of a unit, left by sums of floats


@dataclass(frozen=True, eq=False)
class TravelMatrix:
    """Times and energies between the n tasks of a mission and c chargers.

    A row is the robot's origin: row i after task i, row n the mission's start, rows from n + 1 the
    chargers. A column is its destination, with the action there: column j task j, columns from n
    the chargers. The speed of a drive is that of the task at its destination.

    The entries of a WAIT are ignored: it takes place where the robot is.
    """

    tasks: tuple[str, ...]
    """names of all tasks but START, in the mission's order"""
    time: NDArray[np.float64]
    """units, shape (n + 1 + c, n + c); inf if there is no path"""
    energy: NDArray[np.float64]
    """Wh, of the same shape"""
    work: NDArray[np.float64]
    """units of `time` that the action itself takes, without the drive; shape (n + c,)"""
    chargers: tuple[str, ...] = ()
    """names of the chargers"""
    battery: float | None = None
    """Wh that may be used on one charge; None if unknown"""
    charging: float = 0.0
    """charging power in W"""
    unit: float = 0.1
    """length of a unit of time in s"""

    def __post_init__(self) -> None:
        """Check the shapes and the battery. Raises ArgoError."""
        columns = len(self.tasks) + len(self.chargers)
        shape = (columns + 1, columns)
        if self.time.shape != shape or self.energy.shape != shape or len(self.work) != columns:
            raise Invalid(
                Message(
                    "times, energies and work of {columns} destinations must be {shape}",
                    columns=columns,
                    shape=str(shape),
                )
            )
        if self.chargers and (self.battery is None or self.charging <= 0.0):
            raise Invalid("with chargers, the battery and the charging power must be given")

    def charging_time_units(self, watt_hours: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the times, in units of time, that it takes to charge energies in Wh."""
        return watt_hours * 3600.0 / (self.charging * self.unit)

    def units_rounded_up(self, seconds: float) -> int:
        """Return a time in s as whole units of time, rounded up."""
        return int(np.ceil(seconds / self.unit - _ROUNDING))

    def units_rounded_down(self, seconds: float) -> int:
        """Return a time in s as whole units of time, rounded down."""
        return int(np.floor(seconds / self.unit + _ROUNDING))


def require_matrix_for(matrix: TravelMatrix, mission: Mission) -> None:
    """Raise ArgoError if the matrix belongs to another mission."""
    names = tuple(task.name for task in mission.tasks if task.action is not Action.START)
    if names != matrix.tasks:
        raise Conflict("these travel times belong to a mission with other tasks")
