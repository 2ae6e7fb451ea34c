"""Sources of gas, heat and sound that are out of the ordinary. What they send out is in the
modules beside this one; how the robot senses it, in `argo_env.sensing.signals`."""

from dataclasses import dataclass
from enum import StrEnum

from argo_env.site.shapes import Vector


class PumpFault(StrEnum):
    """What can be wrong with a running pump."""

    BEARING = "bearing"
    """a spall in the outer race: a burst of ringing each time that a ball rolls over it"""
    CAVITATION = "cavitation"
    """bubbles that collapse in the impeller: loud broadband noise"""


@dataclass(frozen=True)
class GasLeak:
    """Natural gas that escapes at `place` (m) with `rate` (kg/s), and hisses."""

    place: Vector
    rate: float = 0.02


@dataclass(frozen=True)
class HotSpot:
    """A glowing ball about `place` (m) of `radius` (m) and `temperature` (°C), half sunk into what
    it lies on."""

    place: Vector
    radius: float = 0.15
    temperature: float = 90.0


@dataclass(frozen=True)
class PumpSound:
    """The pump of the site with the name `pump` runs with a fault. All other pumps run well."""

    pump: str
    fault: PumpFault = PumpFault.BEARING


@dataclass(frozen=True)
class Alarm:
    """The general platform alarm sounds, from loudspeakers all over the site, with `level` (dB)."""

    level: float = 85.0


Source = GasLeak | HotSpot | PumpSound | Alarm
