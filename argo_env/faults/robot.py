"""Faults of the robot and its network: battery, connection, emergency stop, sensor and drive."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np
from pydantic import Field

from argo_compiler.base.message import Message
from argo_compiler.il import EventKind
from argo_env.faults.fault import Fault, Sign, TimedFault, in_unit
from argo_env.seeding import draw
from argo_env.site import Site
from argo_env.site.spec import Rect
from argo_env.surroundings.surroundings import RadioShadow

if TYPE_CHECKING:
    from argo_env.faults.targets import FaultTargets


class LowBattery(Fault):
    """The robot starts with a low charge."""

    sign: ClassVar[Sign] = Sign(EventKind.LOW_BATTERY, "battery")
    kind: Literal["low_battery"] = "low_battery"
    charge: float | None = Field(default=None, gt=0, le=1, json_schema_extra=in_unit("1"))
    """share of the capacity at the start, unless the charge is lower anyway"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:  # noqa: ARG002
        return self.fill_unset(charge=draw(rng, 0.1, 0.25, 3))

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.charge is not None
        targets.battery.charge = min(targets.battery.charge, self.charge)


class WornBattery(Fault):
    """The battery has a lower capacity than a new one."""

    sign: ClassVar[Sign] = Sign(EventKind.LOW_BATTERY, "battery")
    kind: Literal["worn_battery"] = "worn_battery"
    capacity: float | None = Field(default=None, gt=0, le=1, json_schema_extra=in_unit("1"))
    """share of the capacity that remains"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:  # noqa: ARG002
        return self.fill_unset(capacity=draw(rng, 0.2, 0.6, 3))

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.capacity is not None
        targets.battery.scale_capacity_and_energy(self.capacity)


class ConnectionLoss(TimedFault):
    """A part of the site has no radio signal; without `rect` and `floor`, the whole site."""

    sign: ClassVar[Sign] = Sign(EventKind.CONNECTION_LOST, "connection")
    adds_up: ClassVar[bool] = True
    kind: Literal["connection_loss"] = "connection_loss"
    rect: Rect | None = Field(default=None, json_schema_extra=in_unit("m"))
    """m, [x0, y0, x1, y1]; None: the whole floor"""
    floor: int | None = Field(default=None, ge=1)
    """number of the floor; None: every floor"""

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:
        return {"floor": [floor.number for floor in site.spec.floors]}

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        if self.floor is not None:
            site.floor(self.floor)
        return super().resolve_for(site, rng)

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        targets.network.shadows.append(RadioShadow(self.rect, self.floor))

    def revert(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        targets.network.shadows.remove(RadioShadow(self.rect, self.floor))


class EmergencyStop(TimedFault):
    """Someone presses the emergency stop, and releases it at the fault's end."""

    sign: ClassVar[Sign] = Sign(EventKind.EMERGENCY_STOP, Message("emergency stop"))
    kind: Literal["emergency_stop"] = "emergency_stop"

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        targets.drive.stop_pressed = True

    def revert(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        targets.drive.stop_pressed = False


class SensorDysfunction(TimedFault):
    """The camera that reads checkpoints fails, or its pictures are noisy."""

    sign: ClassVar[Sign] = Sign(EventKind.DYSFUNCTION, "camera")
    kind: Literal["sensor_dysfunction"] = "sensor_dysfunction"
    effect: Literal["fails", "noise"] | None = None
    """`fails`: no readings; `noise`: readings with noise"""
    noise: float = Field(default=0.1, gt=0, le=1, json_schema_extra=in_unit("1"))
    """standard deviation of the noise, as a share of the scale"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        drawn = "fails" if rng.uniform() < 0.5 else "noise"
        return super().resolve_for(site, rng).fill_unset(effect=drawn)

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        if self.effect == "fails":
            targets.sensor.failed = True
        else:
            targets.sensor.noise = self.noise

    def revert(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        targets.sensor.failed, targets.sensor.noise = False, targets.sensor.usual_noise


class DriveDysfunction(TimedFault):
    """The drive has only a part of its speed, or none. With several faults, the slowest counts."""

    # The watch compares the distance driven with the planned one over 10 s.
    sign: ClassVar[Sign] = Sign(EventKind.DYSFUNCTION, "drive", outlasts=11.0)
    kind: Literal["drive_dysfunction"] = "drive_dysfunction"
    speed: float | None = Field(default=None, ge=0, lt=1, json_schema_extra=in_unit("1"))
    """share of the speed that remains; 0: the robot stops"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        drawn = draw(rng, 0.0, 0.5, 2)
        return super().resolve_for(site, rng).fill_unset(speed=drawn)

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.speed is not None
        targets.drive.speed_share = min(targets.drive.speed_share, self.speed)

    def revert(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        targets.drive.speed_share = targets.drive.usual_speed_share
