"""Variation of worlds: values that are drawn for each seed, each from its own random stream."""

import math
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, model_validator

from argo_compiler.base.errors import Invalid, NotFound
from argo_compiler.base.model import Model
from argo_env.faults.loading import FaultDistribution
from argo_env.run.run_setup import true_values
from argo_env.run.spec import RunConditions, RunSpec, ValueProfile, ValueStep
from argo_env.seeding import generator
from argo_env.site import Site


def _parse_range(value: object) -> object:
    """Return a range as its two ends; a single number becomes both ends."""
    ends = (value, value) if _is_number(value) else value
    if not isinstance(ends, list | tuple) or len(ends) != 2 or not all(map(_is_number, ends)):
        raise ValueError("give a number, or the smallest and the largest, as [0.8, 1.0]")
    return tuple(ends)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


Range = Annotated[tuple[float, float], BeforeValidator(_parse_range)]
"""smallest and largest value of a uniform distribution"""


class _Ranges(Model):
    """Base of models with fields that are ranges."""

    @model_validator(mode="after")
    def _check_ends(self) -> "_Ranges":
        for name, value in self:
            if isinstance(value, tuple) and len(value) == 2 and value[1] < value[0]:
                raise ValueError(
                    f"{name}: {value[0]:g} to {value[1]:g}: give the smaller value first"
                )
        return self


class StepRange(_Ranges):
    """Ranges of the time and the size of a sudden change of a checkpoint's value."""

    at: Range
    """time of the change in s"""
    change: Range
    """size of the change in the checkpoint's unit"""


class ValueRange(_Ranges):
    """Ranges of a checkpoint's value at the start and of its changes during a run."""

    start: Range | None = None
    """value at the start, in the checkpoint's unit; None: drawn from the nominal range"""
    drift: Range = (0.0, 0.0)
    """change in the checkpoint's unit per hour"""
    noise: Range = (0.0, 0.0)
    """standard deviation of the value's noise, in the checkpoint's unit"""
    steps: tuple[StepRange, ...] = ()
    """sudden changes of the value"""


_CONDITIONS = ("ahead", "left", "turned", "speed", "friction", "charge", "capacity", "sensor_noise")


class Variation(_Ranges):
    """Ranges of values that vary from world to world, in addition to what every run draws anyway.

    Each value is drawn from its own random stream, so that a further one does not change the
    others. None: the value does not vary.
    """

    ahead: Range | None = None
    """offset of the robot's start pose in m, ahead of the mission's start, -1 to 1"""
    left: Range | None = None
    """offset of the robot's start pose in m, to the left of the mission's start, -1 to 1"""
    turned: Range | None = None
    """rotation of the robot's start pose in deg, counter-clockwise"""
    speed: Range | None = None
    """speed of the drive relative to its usual speed, up to 1"""
    friction: Range | None = None
    """friction relative to the calibration, up to 1.3; for the drive `tracked`"""
    charge: Range | None = None
    """charge of the battery at the start, up to 1"""
    capacity: Range | None = None
    """remaining capacity of the battery as a share of its nominal one, up to 1"""
    sensor_noise: Range | None = None
    """standard deviation of readings, as a share of the scale; the robot notices more than 0.01"""
    values: dict[int, ValueRange] = Field(default_factory=dict)
    """values of checkpoints and their changes, by number"""
    faults: FaultDistribution | None = None
    """distribution of the faults in each world, in addition to the faults of a case"""

    @model_validator(mode="after")
    def _check_conditions(self) -> "Variation":
        for name in _CONDITIONS:
            for end in getattr(self, name) or ():
                # This raises an error for a value that a run can't have.
                RunConditions.model_validate({name: end})
        return self

    def check(self, site: Site) -> None:
        """Raise Invalid for a checkpoint that the site lacks, or a value that it can't show."""
        for id, ranges in self.values.items():
            try:
                for value in ranges.start or (site.checkpoint(id).nominal.low,):
                    true_values(site, 0, {id: value})
            except NotFound as error:
                raise Invalid(str(error)) from error

    def apply(self, spec: RunSpec, seed: int) -> RunSpec:
        """Return the spec of the run in the world of a seed, with all values drawn for it.

        Checkpoint values that the given spec has already are kept.
        """
        update: dict[str, Any] = {"seed": seed}
        conditions = self._conditions(seed)
        if conditions:
            update["conditions"] = spec.conditions.model_copy(update=conditions)
        start_values = {
            id: _sample(seed, ranges.start, "start", id)
            for id, ranges in self.values.items()
            if ranges.start is not None
        }
        if start_values:
            update["values"] = {**start_values, **spec.values}
        drawn = self.faults.draw(seed) if self.faults is not None else None
        if drawn is not None:
            update["faults"] = (*spec.faults, *drawn.faults)
        return spec.model_copy(update=update)

    def faults_name_if_drawn(self, seed: int) -> str | None:
        """Return the name of the faults drawn for the world of a seed; None if it has none."""
        drawn = self.faults.draw(seed) if self.faults is not None else None
        return None if drawn is None else drawn.name

    def values_for(self, seed: int) -> dict[str, float]:
        """Return the values drawn for the world of a seed, by name, for the row of a run.

        Noise and sudden changes of checkpoints' values are left out.
        """
        values = {n: v for n, v in self._conditions(seed).items() if n != "values"}
        for id, ranges in self.values.items():
            if ranges.start is not None:
                values[f"start {id}"] = _sample(seed, ranges.start, "start", id)
            values[f"drift {id}"] = _sample(seed, ranges.drift, "drift", id)
        return values

    def _conditions(self, seed: int) -> dict[str, Any]:
        conditions: dict[str, Any] = {
            name: _sample(seed, getattr(self, name), name)
            for name in _CONDITIONS
            if getattr(self, name) is not None
        }
        if self.values:
            conditions["values"] = {
                id: _profile(ranges, seed, id) for id, ranges in self.values.items()
            }
        return conditions


def _profile(ranges: ValueRange, seed: int, id: int) -> ValueProfile:
    return ValueProfile(
        drift=_sample(seed, ranges.drift, "drift", id),
        noise=_sample(seed, ranges.noise, "noise", id),
        steps=tuple(
            ValueStep(
                at=_sample(seed, step.at, "step", id, k, "at"),
                change=_sample(seed, step.change, "step", id, k, "change"),
            )
            for k, step in enumerate(ranges.steps)
        ),
    )


def _sample(seed: int, ends: Range, *purpose: str | int) -> float:
    low, high = ends
    value = float(generator(seed, "world", *purpose).uniform(low, high))
    return min(max(round(value, 6), low), high)


NO_VARIATION = Variation()
"""variation without ranges; worlds still differ in what every run draws by its seed: values of
checkpoints, and what the faults leave open"""
