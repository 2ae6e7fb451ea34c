"""Spec of a run: all that it depends on, as data; and its conditions, which are as planned unless
something else is said."""

import math
from typing import Any

from pydantic import Field, ValidationError, field_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Model, Pose
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.files.json_places import format_path
from argo_compiler.hfsm import Event
from argo_compiler.il import Mission
from argo_env.faults.kinds import AnyFault
from argo_env.files.yaml_messages import message_of
from argo_env.run.initial_state import InitialState
from argo_env.run.log import LoggedEvent, require_event_time, require_external
from argo_env.run.record import Reordering


class ValueStep(Model):
    """A value that changes all at once."""

    at: float = Field(ge=0)
    """s"""
    change: float
    """in the checkpoint's unit"""


class ValueProfile(Model):
    """How the value that a checkpoint shows changes during a run. It stays on the scale."""

    drift: float = 0.0
    """in the checkpoint's unit an hour"""
    steps: tuple[ValueStep, ...] = ()
    noise: float = Field(default=0.0, ge=0)
    """standard deviation of what flickers, in the checkpoint's unit"""


class RunConditions(Model):
    """What the robot does not know, and no fault is: how its world differs from the plan's."""

    ahead: float = Field(default=0.0, ge=-1, le=1)
    """m that the robot stands ahead of where the mission starts"""
    left: float = Field(default=0.0, ge=-1, le=1)
    """m that it stands to the left of there"""
    turned: float = Field(default=0.0, ge=-180, le=180)
    """deg that it is turned there, counter-clockwise"""
    speed: float = Field(default=1.0, gt=0, le=1)
    """share of its speed that the drive makes"""
    friction: float = Field(default=1.0, gt=0, le=1.3)
    """beside that of the calibration; for the drive `tracked`, as no other knows forces, and up to
    where its belts are stable"""
    charge: float | None = Field(default=None, gt=0, le=1)
    """of the battery at the start; None: full, or as the run goes on from"""
    capacity: float = Field(default=1.0, gt=0, le=1)
    """share of the battery's capacity that is left"""
    sensor_noise: float = Field(default=0.0, ge=0, le=1)
    """standard deviation of readings, as a share of the scale"""
    values: dict[int, ValueProfile] = Field(default_factory=dict)
    """how values change, by number of the checkpoint"""

    def actual_start_pose(self, start: Pose) -> Pose:
        """Where the robot really stands when it is to stand there."""
        c, s = math.cos(start.yaw), math.sin(start.yaw)
        return start.model_copy(
            update={
                "x": start.x + c * self.ahead - s * self.left,
                "y": start.y + s * self.ahead + c * self.left,
                "yaw": start.yaw + math.radians(self.turned),
            }
        )


AS_PLANNED = RunConditions()
"""all is as planned"""

_SETTINGS = {"drive", "sensor", "seed", "values", "events", "faults", "conditions"}


class RunSpec(Model):
    """All that a run depends on. Equal specs give equal runs, on any machine and in any process."""

    mission: Mission
    site: str = "umad"
    """what opens the site: its name, the path of its file, or its parameters"""
    robot: str = "tracker"
    """name of the robot that opens the site, where that is not open already"""
    drive: str = "kinematic"
    """name of the drive"""
    sensor: str = "ideal"
    """name of the sensor that reads checkpoints"""
    seed: int = Field(default=0, ge=0)
    """of all that is drawn"""
    values: dict[int, float] = Field(default_factory=dict)
    """what checkpoints show, by number, where it is not drawn"""
    events: tuple[tuple[float, LoggedEvent], ...] = ()
    """what the run is told, and when (s)"""
    faults: tuple[AnyFault, ...] = ()
    """what goes wrong; the robot finds out by sensing"""
    conditions: RunConditions = AS_PLANNED
    """what is not as planned, and no fault"""
    beginning: InitialState | None = None
    """where another run stood, from which this one goes on; None: the mission begins"""
    diagnostics: tuple[Diagnostic, ...] = ()
    """what the mission's import had to say, for the record"""
    reordering: Reordering | None = None
    """for the record, where the mission is in another order than it was written"""
    source: str | None = None
    """the whole path of the file that the mission was read from, which must not change while the
    run is to go on from a journal"""

    @field_validator("events")
    @classmethod
    def _from_outside(
        cls, events: tuple[tuple[float, LoggedEvent], ...]
    ) -> tuple[tuple[float, LoggedEvent], ...]:
        for t, event in events:
            try:
                require_event_time(t)
                require_external(event)
            except Invalid as error:
                raise ValueError(str(error)) from None
        return events

    @property
    def settings(self) -> dict[str, Any]:
        """How the run is carried out, without what and where, as plain data."""
        return self.model_dump(mode="json", include=_SETTINGS)


def read_spec(content: str | bytes, name: str = "the run's spec") -> RunSpec:
    """The spec in a JSON text; Invalid, with its `name` and the place in it, if it is none."""
    try:
        return RunSpec.model_validate_json(content)
    except ValidationError as error:
        raise _invalid(name, error) from None


def validate_spec(spec: RunSpec) -> RunSpec:
    """The spec with the types that its fields have: pydantic's `model_copy` and `model_construct`
    check nothing. Raises Invalid, with the field, for what is none."""
    if not isinstance(spec, RunSpec):
        raise Invalid(f"{spec!r} is no spec of a run: make it a RunSpec")
    try:
        return RunSpec.model_validate(dict(spec))
    except ValidationError as error:
        raise _invalid("the run's spec", error) from None


def _invalid(name: str, error: ValidationError) -> Invalid:
    fault = error.errors(include_url=False)[0]
    place = format_path(fault["loc"])
    said = message_of(fault, fault["loc"])
    return Invalid(f"{name}: {place + ': ' if place else ''}{said}")


def logged_events(*events: tuple[float, Event]) -> tuple[tuple[float, LoggedEvent], ...]:
    """Events and their times (s) as specs hold them; Invalid for what is no event."""
    return tuple((t, LoggedEvent.from_event(event)) for t, event in events)
