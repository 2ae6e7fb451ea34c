"""Worlds that vary: what is drawn anew for each seed, each from a stream of its own."""

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.faults.reading import FaultDistribution
from argo_env.run.run_setup import true_values
from argo_env.run.spec import RunConditions, RunSpec, ValueProfile, ValueStep
from argo_env.seeding import generator
from argo_env.site import Site


def _between(said: object) -> object:
    """A number is the range that has only it."""
    ends = (said, said) if _is_number(said) else said
    if not isinstance(ends, list | tuple) or len(ends) != 2 or not all(map(_is_number, ends)):
        raise ValueError("give a number, or the least and the most, as [0.8, 1.0]")
    return tuple(ends)


def _is_number(said: object) -> bool:
    return isinstance(said, int | float) and not isinstance(said, bool) and math.isfinite(said)


Range = Annotated[tuple[float, float], BeforeValidator(_between)]
"""the least and the most; each between them is equally probable"""


class _Ranges(Model):
    """Fields that are ranges."""

    @model_validator(mode="after")
    def _ordered(self) -> "_Ranges":
        for name, value in self:
            if isinstance(value, tuple) and len(value) == 2 and value[1] < value[0]:
                raise ValueError(f"{name}: {value[0]:g} to {value[1]:g}: the least comes first")
        return self


class StepRange(_Ranges):
    """A value that changes all at once, some time and by something."""

    at: Range
    """s"""
    change: Range
    """in the checkpoint's unit"""


class ValueRange(_Ranges):
    """What a checkpoint shows, and how that changes during a run."""

    start: Range | None = None
    """at the start, in the checkpoint's unit; None: somewhere in its nominal range"""
    drift: Range = (0.0, 0.0)
    """in the checkpoint's unit an hour"""
    noise: Range = (0.0, 0.0)
    """standard deviation of what flickers, in the checkpoint's unit"""
    steps: tuple[StepRange, ...] = ()


_CONDITIONS = ("ahead", "left", "turned", "speed", "friction", "charge", "capacity", "sensor_noise")


class Variation(_Ranges):
    """What differs from world to world beside what seeds draw anyway. Each is drawn from a stream
    of its own, so that one more changes nothing of the others."""

    ahead: Range | None = None
    """m that the robot stands ahead of where the mission starts, -1 to 1"""
    left: Range | None = None
    """m that it stands to the left of there, -1 to 1"""
    turned: Range | None = None
    """deg that it is turned there, counter-clockwise"""
    speed: Range | None = None
    """share of its speed that the drive makes, up to 1"""
    friction: Range | None = None
    """beside that of the calibration, up to 1.3; for the drive `tracked`"""
    charge: Range | None = None
    """of the battery at the start, up to 1"""
    capacity: Range | None = None
    """share of the battery's capacity that is left, up to 1"""
    sensor_noise: Range | None = None
    """standard deviation of readings, as a share of the scale; the robot notices more than 0.01"""
    values: dict[int, ValueRange] = Field(default_factory=dict)
    """what checkpoints show and how that changes, by number"""
    faults: FaultDistribution | None = None
    """what goes wrong in each, beside the faults that all runs of a case have"""

    @model_validator(mode="after")
    def _possible(self) -> "Variation":
        for name in _CONDITIONS:
            for end in getattr(self, name) or ():
                # Says by itself what a run can't have.
                RunConditions.model_validate({name: end})
        return self

    def check(self, site: Site) -> None:
        """Raises Invalid for values that no checkpoint of the site can show."""
        for id, one in self.values.items():
            try:
                for value in one.start or (site.checkpoint(id).nominal.low,):
                    true_values(site, 0, {id: value})
            except NotFound as error:
                raise Invalid(str(error)) from error

    def applied(self, spec: RunSpec, seed: int) -> RunSpec:
        """The spec of the run in the world of a seed."""
        update: dict[str, Any] = {"seed": seed}
        conditions = self._conditions(seed)
        if conditions:
            update["conditions"] = spec.conditions.model_copy(update=conditions)
        first = {
            id: _drawn(seed, one.start, "start", id)
            for id, one in self.values.items()
            if one.start is not None
        }
        if first:
            update["values"] = {**first, **spec.values}
        drawn = self.faults.drawn(seed) if self.faults is not None else None
        if drawn is not None:
            update["faults"] = (*spec.faults, *drawn.faults)
        return spec.model_copy(update=update)

    def drawn_faults(self, seed: int) -> str | None:
        """What the faults are called that are drawn for the world of a seed; None: none are."""
        drawn = self.faults.drawn(seed) if self.faults is not None else None
        return None if drawn is None else drawn.name

    def drawn(self, seed: int) -> dict[str, float]:
        """What is drawn for the world of a seed, by name."""
        found = {n: v for n, v in self._conditions(seed).items() if n != "values"}
        for id, one in self.values.items():
            if one.start is not None:
                found[f"start {id}"] = _drawn(seed, one.start, "start", id)
            found[f"drift {id}"] = _drawn(seed, one.drift, "drift", id)
        return found

    def _conditions(self, seed: int) -> dict[str, Any]:
        found: dict[str, Any] = {
            name: _drawn(seed, getattr(self, name), name)
            for name in _CONDITIONS
            if getattr(self, name) is not None
        }
        if self.values:
            found["values"] = {id: _profile(one, seed, id) for id, one in self.values.items()}
        return found


def _profile(one: ValueRange, seed: int, id: int) -> ValueProfile:
    return ValueProfile(
        drift=_drawn(seed, one.drift, "drift", id),
        noise=_drawn(seed, one.noise, "noise", id),
        steps=tuple(
            ValueStep(
                at=_drawn(seed, step.at, "step", id, k, "at"),
                change=_drawn(seed, step.change, "step", id, k, "change"),
            )
            for k, step in enumerate(one.steps)
        ),
    )


def _drawn(seed: int, between: Range, *purpose: str | int) -> float:
    low, high = between
    drawn = float(generator(seed, "world", *purpose).uniform(low, high))
    return min(max(round(drawn, 6), low), high)


NO_VARIATION = Variation()
"""Worlds differ by what seeds draw anyway: values, and what faults leave open."""
