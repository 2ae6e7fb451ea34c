"""Faults of the process: gas leaks, hot spots, pumps with a defect, and the platform alarm."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, field_validator

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Listing, Message
from argo_compiler.il import EventKind
from argo_env.faults.fault import Sign, TimedFault, in_unit
from argo_env.seeding import draw
from argo_env.site import Site
from argo_env.site.shapes import Vector
from argo_env.surroundings import Alarm, GasLeak, HotSpot, PumpFault, PumpSound
from argo_env.surroundings.surroundings import Source

if TYPE_CHECKING:
    from argo_env.faults.targets import FaultTargets

_BESIDE, _ABOVE, _BELOW = 5.0, 10.0, 1.0
"""m beside the ground, above the highest floor and below the ground, within which a leak or a hot
spot may lie"""
_GAS_REACH = 25.0  # m from a leak within which its gas or its hiss may be noticed
_SPOT_ERROR = 2.5  # m, error of a hot spot's detected position at most
_BEHIND = 0.2  # m behind the face of a checkpoint, in the pipe or vessel that carries it


class ProcessFault(TimedFault):
    """A fault that adds a source of gas, heat or sound to the surroundings."""

    needs_world: ClassVar[bool] = True
    adds_up: ClassVar[bool] = True

    def source(self) -> Source:
        """Return the source that the fault adds."""
        raise NotImplementedError

    def apply(self, targets: "FaultTargets", now: float) -> None:
        targets.surroundings.add(self.source(), now)

    def revert(self, targets: "FaultTargets", now: float) -> None:
        targets.surroundings.remove(self.source(), now)


class PlacedFault(ProcessFault):
    """A fault of the process at a place."""

    place: Vector | None = Field(default=None, json_schema_extra=in_unit("m"))
    """m; drawn: at a pipe or vessel that carries a checkpoint"""

    @classmethod
    def limits_on(cls, site: Site) -> Mapping[str, tuple[Vector, Vector]]:
        return {"place": _place_limits(site)}


class GasLeakFault(PlacedFault):
    """Natural gas escapes and hisses."""

    sign: ClassVar[Sign] = Sign(EventKind.GAS_LEAK, "gas", outlasts=120.0)  # gas has to disperse
    kind: Literal["gas_leak"] = "gas_leak"
    rate: float | None = Field(default=None, gt=0, le=1.0, json_schema_extra=in_unit("kg/s"))
    """kg/s"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        _check_place(site, self.place)
        place, rate = _near_equipment(site, rng, 0.0), draw(rng, 0.01, 0.04, 4)
        return super().resolve_for(site, rng).fill_unset(place=place, rate=rate)

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        return _is_within(_GAS_REACH, self.place, noticed_from)

    def source(self) -> Source:
        assert self.place is not None
        assert self.rate is not None
        return GasLeak(self.place, self.rate)


class HotSpotFault(PlacedFault):
    """A part of the equipment is too hot."""

    sign: ClassVar[Sign] = Sign(EventKind.HOT_SPOT, "heat")
    kind: Literal["hot_spot"] = "hot_spot"
    temperature: float | None = Field(default=None, ge=40, le=800, json_schema_extra=in_unit("°C"))
    """°C"""
    radius: float = Field(default=0.15, gt=0, le=1.0, json_schema_extra=in_unit("m"))
    """m"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        _check_place(site, self.place)
        place = _near_equipment(site, rng, 0.3)
        temperature = draw(rng, 80.0, 150.0, 1)
        return super().resolve_for(site, rng).fill_unset(place=place, temperature=temperature)

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        return _is_within(_SPOT_ERROR, self.place, place)

    def source(self) -> Source:
        assert self.place is not None
        assert self.temperature is not None
        return HotSpot(self.place, self.radius, self.temperature)


class AbnormalPump(ProcessFault):
    """A running pump sounds abnormal."""

    sign: ClassVar[Sign] = Sign(EventKind.ABNORMAL_SOUND, "pumps")
    kind: Literal["abnormal_pump"] = "abnormal_pump"
    pump: str | None = None
    """name of the pump"""
    defect: PumpFault | None = None
    """defect that it sounds like"""

    @field_validator("defect", mode="before")
    @classmethod
    def _from_text(cls, value: Any) -> Any:
        return PumpFault(value) if value in [*PumpFault] else value

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:
        return {"pump": _pump_names(site)}

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        known = _pump_names(site)
        if not known:
            raise NotFound(Message("site {site} has no pump", site=site.name))
        pump, defect = known[int(rng.integers(len(known)))], list(PumpFault)[int(rng.integers(2))]
        if self.pump is not None and self.pump not in known:
            raise NotFound(
                Message(
                    "site {site} has no pump `{pump}`; there are: {known}",
                    site=site.name,
                    pump=self.pump,
                    known=Listing(known),
                )
            )
        return super().resolve_for(site, rng).fill_unset(pump=pump, defect=defect)

    def can_explain(self, place: Vector | None, noticed_from: Vector | None, site: Site) -> bool:  # noqa: ARG002
        # The watch reports the position of the pump that it hears.
        from argo_env.sensing.signals.microphone import pump_positions  # loads all watches

        if place is None:
            return False
        positions = pump_positions(site)
        return min(positions, key=lambda name: math.dist(positions[name], place)) == self.pump

    def source(self) -> Source:
        assert self.pump is not None
        assert self.defect is not None
        return PumpSound(self.pump, self.defect)


class PlatformAlarm(ProcessFault):
    """The general platform alarm (GPA) sounds."""

    sign: ClassVar[Sign] = Sign(EventKind.PLATFORM_ALARM, "alarm")
    kind: Literal["platform_alarm"] = "platform_alarm"
    level: float = Field(default=85.0, ge=40, le=120, json_schema_extra=in_unit("dB"))
    """dB"""

    def source(self) -> Source:
        return Alarm(self.level)


def _is_within(reach: float, place: Vector | None, other: Vector | None) -> bool:
    return place is not None and other is not None and math.dist(place, other) <= reach


def _pump_names(site: Site) -> list[str]:
    return [pump.name for floor in site.spec.floors for pump in floor.pumps]


def _place_limits(site: Site) -> tuple[Vector, Vector]:
    """Return the lowest and highest coordinates (m) of a leak or hot spot on the site."""
    x0, y0, x1, y1 = site.spec.ground
    top, bottom = max(f.z for f in site.spec.floors), site.spec.ground_z
    return (
        (x0 - _BESIDE, y0 - _BESIDE, bottom - _BELOW),
        (x1 + _BESIDE, y1 + _BESIDE, top + _ABOVE),
    )


def _check_place(site: Site, place: Vector | None) -> None:
    if place is None:
        return
    x, y, z = place
    low, high = _place_limits(site)
    if not all(a <= v <= b for a, v, b in zip(low, place, high, strict=True)):
        raise Invalid(
            Message(
                "there is no equipment at ({x:g}, {y:g}, {z:g}): a place on site {site} "
                "lies between ({low:g}, {low_2:g}, {low_3:g}) and ({high:g}, {high_2:g}, "
                "{high_3:g})",
                x=x,
                y=y,
                z=z,
                site=site.name,
                low=low[0],
                low_2=low[1],
                low_3=low[2],
                high=high[0],
                high_2=high[1],
                high_3=high[2],
            )
        )


def _near_equipment(site: Site, rng: np.random.Generator, up: float) -> Vector:
    """Return a random position on the equipment behind a checkpoint, `up` m above the latter."""
    if not site.checkpoints:
        raise NotFound(Message("site {site} has no checkpoint: give the `place`", site=site.name))
    checkpoint = site.checkpoints[int(rng.integers(len(site.checkpoints)))]
    x, y, z = checkpoint.position
    return (
        round(x - _BEHIND * float(np.cos(checkpoint.yaw)), 3),
        round(y - _BEHIND * float(np.sin(checkpoint.yaw)), 3),
        round(z + up, 3),
    )
