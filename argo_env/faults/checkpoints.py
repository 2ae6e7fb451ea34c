"""Faults at checkpoints: values outside of their nominal range, and displaced checkpoints."""

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.message import Message
from argo_compiler.il import EventKind
from argo_env.faults.fault import Sign, TimedFault, in_unit
from argo_env.seeding import draw
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import Vector
from argo_env.world.placement import AS_PLANNED, Placement, draw_checkpoint_placement

if TYPE_CHECKING:
    from argo_env.faults.targets import FaultTargets

MAX_OFFSET = 0.1  # m (thesis 1.2)
MAX_TURN = 90.0  # deg (thesis 1.2)
_CLEARLY = 0.1  # of the scale: drawn values are this far outside the nominal range, if possible


class CheckpointFault(TimedFault):
    """A fault at one checkpoint."""

    checkpoint: int | None = Field(default=None, ge=1)
    """number of the checkpoint"""

    @classmethod
    def choices_on(cls, site: Site) -> Mapping[str, Sequence[str | int]]:
        return {"checkpoint": [checkpoint.id for checkpoint in site.checkpoints]}

    def _at_checkpoint(self, site: Site, rng: np.random.Generator) -> SiteCheckpoint:
        known = [c.id for c in site.checkpoints]
        if not known:
            raise NotFound(Message("site {site} has no checkpoint", site=site.name))
        drawn = known[int(rng.integers(len(known)))]
        return site.checkpoint(self.checkpoint or drawn)


class AbnormalValue(CheckpointFault):
    """A checkpoint shows a value outside its nominal range."""

    sign: ClassVar[Sign] = Sign(EventKind.ABNORMAL_READING, "reading")
    kind: Literal["abnormal_value"] = "abnormal_value"
    value: float | None = None
    """in the checkpoint's unit"""

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        checkpoint = self._at_checkpoint(site, rng)
        drawn = _abnormal(checkpoint, rng)
        value = drawn if self.value is None else self.value
        shown, nominal = checkpoint.range, checkpoint.nominal
        if not shown.contains(value):
            raise Invalid(
                Message(
                    "checkpoint {id} ({checkpoint}) shows {low:g} to {high:g} {unit}, not "
                    "{value:g}",
                    id=checkpoint.id,
                    checkpoint=checkpoint.name,
                    low=shown.low,
                    high=shown.high,
                    unit=checkpoint.unit,
                    value=value,
                )
            )
        if nominal.contains(value):
            raise Invalid(
                Message(
                    "{value:g} {unit} is not abnormal at checkpoint {id} ({checkpoint}): its "
                    "nominal range is {low:g} to {high:g}",
                    value=value,
                    unit=checkpoint.unit,
                    id=checkpoint.id,
                    checkpoint=checkpoint.name,
                    low=nominal.low,
                    high=nominal.high,
                )
            )
        return super().resolve_for(site, rng)._copy_with(checkpoint=checkpoint.id, value=value)

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.checkpoint is not None
        assert self.value is not None
        targets.show_value(self.checkpoint, self.value)

    def revert(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.checkpoint is not None
        targets.show_value(self.checkpoint, targets.fault_free_values[self.checkpoint])


class DisplacedCheckpoint(CheckpointFault):
    """A checkpoint is not at its planned pose."""

    sign: ClassVar[None] = None  # nothing reports it: the checkpoint can still be read
    kind: Literal["displaced_checkpoint"] = "displaced_checkpoint"
    at: float | None = Field(default=0.0, ge=0, json_schema_extra=in_unit("s"))
    """s, when it is moved; usually before the run"""
    offset: Vector | None = Field(default=None, json_schema_extra=in_unit("m"))
    """m along the site's axes, with a length of 0.1 at most"""
    turn: float | None = Field(
        default=None, ge=-MAX_TURN, le=MAX_TURN, json_schema_extra=in_unit("deg")
    )
    """deg about the vertical, counter-clockwise seen from above"""
    roll: float | None = Field(
        default=None, ge=-MAX_TURN, le=MAX_TURN, json_schema_extra=in_unit("deg")
    )
    """deg about the normal of its face, clockwise; a level gauge has no roll"""

    @classmethod
    def limits_on(cls, site: Site) -> Mapping[str, tuple[Vector, Vector]]:  # noqa: ARG003
        return {"offset": ((-MAX_OFFSET,) * 3, (MAX_OFFSET,) * 3)}

    @model_validator(mode="after")
    def _near(self) -> Self:
        if self.offset is not None and math.hypot(*self.offset) > MAX_OFFSET + 1e-9:
            away = math.hypot(*self.offset)
            raise ValueError(f"the offset is {away:.3f} m, and may be at most {MAX_OFFSET:g} m")
        return self

    def resolve_for(self, site: Site, rng: np.random.Generator) -> Self:
        checkpoint = self._at_checkpoint(site, rng)
        upright = checkpoint.kind is CheckpointKind.LIQUID_LEVEL_GAUGE
        if upright and self.roll:
            raise Invalid(
                Message(
                    "checkpoint {id} is a level gauge, which can't have a `roll`", id=checkpoint.id
                )
            )
        drawn = draw_checkpoint_placement(rng, upright)
        # Round towards zero, since an offset that is rounded up might exceed the limit.
        x, y, z = (math.trunc(v * 1e4) / 1e4 for v in drawn.offset)
        turn, roll = (round(math.degrees(angle), 1) for angle in (drawn.turn, drawn.roll))
        resolved = super().resolve_for(site, rng)._copy_with(checkpoint=checkpoint.id)
        return resolved.fill_unset(offset=(x, y, z), turn=turn, roll=roll)

    def apply(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.checkpoint is not None
        assert self.offset is not None
        assert self.turn is not None
        assert self.roll is not None
        placement = Placement(self.offset, math.radians(self.turn), math.radians(self.roll))
        targets.world.set_displacement(self.checkpoint, placement)

    def revert(self, targets: "FaultTargets", now: float) -> None:  # noqa: ARG002
        assert self.checkpoint is not None
        targets.world.set_displacement(self.checkpoint, AS_PLANNED)


def _abnormal(checkpoint: SiteCheckpoint, rng: np.random.Generator) -> float:
    """Return a random value on the scale, outside the nominal range, and clearly so if possible."""
    scale, nominal = checkpoint.range, checkpoint.nominal
    below, above = math.nextafter(nominal.low, -math.inf), math.nextafter(nominal.high, math.inf)

    def beyond(gap: float) -> list[tuple[float, float]]:
        parts = (
            (scale.low, min(below - gap, scale.high)),
            (max(above + gap, scale.low), scale.high),
        )
        return [(low, high) for low, high in parts if low <= high]

    free = beyond(_CLEARLY * (scale.high - scale.low)) or beyond(0.0)
    if not free:
        raise Invalid(
            Message(
                "checkpoint {id} ({checkpoint}) can't show an abnormal value: its whole "
                "scale is nominal",
                id=checkpoint.id,
                checkpoint=checkpoint.name,
            )
        )
    lengths = np.array([high - low for low, high in free]) + 1e-9
    low, high = free[int(rng.choice(len(free), p=lengths / lengths.sum()))]
    return draw(rng, low, high, 2)
