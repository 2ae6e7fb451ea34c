"""What faults act on: the parts of a run that can go wrong."""

from dataclasses import dataclass, field

from argo_env.drives.battery import Battery
from argo_env.drives.powertrain import Powertrain
from argo_env.sensing.onboard import OnboardSensor
from argo_env.surroundings import Surroundings
from argo_env.surroundings.surroundings import RadioNetwork
from argo_env.world.without_physics import AnyWorld


@dataclass(frozen=True)
class FaultTargets:
    """The parts of one run. They change as faults begin and end; the set of them does not."""

    world: AnyWorld
    truth: dict[int, float]
    """what each checkpoint shows, in its unit"""
    surroundings: Surroundings
    drive: Powertrain
    sensor: OnboardSensor
    battery: Battery
    network: RadioNetwork
    usual: dict[int, float] = field(init=False)
    """what each checkpoint shows without a fault"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "usual", dict(self.truth))

    def show(self, checkpoint: int, value: float) -> None:
        """From now on the checkpoint shows that value, in its unit."""
        self.truth[checkpoint] = value
        self.world.show_value(checkpoint, value)
