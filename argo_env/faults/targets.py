"""Targets of faults: the parts of a run that faults act on."""

from dataclasses import dataclass, field

from argo_env.drives.battery import Battery
from argo_env.drives.powertrain import Powertrain
from argo_env.sensing.onboard import SensorWithFaults
from argo_env.surroundings import Surroundings
from argo_env.surroundings.surroundings import RadioNetwork
from argo_env.world.without_physics import AnyWorld


@dataclass(frozen=True)
class FaultTargets:
    """Parts of one run that faults change. The parts themselves are never replaced."""

    world: AnyWorld
    truth: dict[int, float]
    """value that each checkpoint shows, in its unit, by the checkpoint's number"""
    surroundings: Surroundings
    drive: Powertrain
    sensor: SensorWithFaults
    battery: Battery
    network: RadioNetwork
    fault_free_values: dict[int, float] = field(init=False)
    """value that each checkpoint shows without a fault"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "fault_free_values", dict(self.truth))

    def show_value(self, checkpoint: int, value: float) -> None:
        """Make a checkpoint show a value in its unit from now on."""
        self.truth[checkpoint] = value
        self.world.show_value(checkpoint, value)
