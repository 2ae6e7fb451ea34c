"""Spec of a run: all that the run depends on, as data, with its conditions."""

import math
from typing import Any

from pydantic import Field, ValidationError, field_validator

from argo_compiler.base.errors import Invalid
from argo_compiler.base.message import Message, as_message
from argo_compiler.base.model import Model, Pose
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.files.json_places import format_path
from argo_compiler.hfsm import Event
from argo_compiler.il import Mission
from argo_env.faults.kinds import AnyFault
from argo_env.files.checked_files import read_checked
from argo_env.files.yaml_messages import error_message
from argo_env.run.initial_state import InitialState
from argo_env.run.log import LoggedEvent, require_event_time, require_external
from argo_env.run.record import Reordering


class ValueStep(Model):
    """Sudden change of a value at one time."""

    at: float = Field(ge=0)
    """s"""
    change: float
    """in the checkpoint's unit"""


class ValueProfile(Model):
    """Profile of a value that a checkpoint shows during a run: drift, steps and noise.

    The value stays on the checkpoint's scale.
    """

    drift: float = 0.0
    """drift in the checkpoint's unit per hour"""
    steps: tuple[ValueStep, ...] = ()
    noise: float = Field(default=0.0, ge=0)
    """standard deviation of the noise, in the checkpoint's unit"""


class RunConditions(Model):
    """Conditions of a run: differences from the plan that the robot does not know.

    They are no faults. By default all is as planned.
    """

    ahead: float = Field(default=0.0, ge=-1, le=1)
    """m by which the robot stands ahead of the mission's start pose"""
    left: float = Field(default=0.0, ge=-1, le=1)
    """m by which the robot stands to the left of the mission's start pose"""
    turned: float = Field(default=0.0, ge=-180, le=180)
    """deg by which the robot is turned there, counter-clockwise"""
    speed: float = Field(default=1.0, gt=0, le=1)
    """share of the commanded speed that the drive reaches"""
    friction: float = Field(default=1.0, gt=0, le=1.3)
    """factor of the calibrated friction; only for the drive `tracked`, the only one that simulates
    forces; above the limit its belts are unstable"""
    charge: float | None = Field(default=None, gt=0, le=1)
    """charge of the battery at the start, 0 to 1; None: full, or that of the initial state"""
    capacity: float = Field(default=1.0, gt=0, le=1)
    """share of the battery's nominal capacity that remains"""
    sensor_noise: float = Field(default=0.0, ge=0, le=1)
    """standard deviation of readings, as a share of the scale"""
    values: dict[int, ValueProfile] = Field(default_factory=dict)
    """profiles of values, by number of the checkpoint"""

    def actual_start_pose(self, start: Pose) -> Pose:
        """Return the robot's actual start pose: the planned one, `start`, shifted and turned."""
        c, s = math.cos(start.yaw), math.sin(start.yaw)
        return start.model_copy(
            update={
                "x": start.x + c * self.ahead - s * self.left,
                "y": start.y + s * self.ahead + c * self.left,
                "yaw": start.yaw + math.radians(self.turned),
            }
        )


AS_PLANNED = RunConditions()
"""conditions of a run in which all is as planned"""

_SETTINGS = {"drive", "sensor", "seed", "values", "events", "faults", "conditions"}


class RunSpec(Model):
    """Spec of a run: all that it depends on.

    Equal specs give equal runs, on any computer and in any process.
    """

    mission: Mission
    site: str = "umad"
    """reference of the site: its name, the path of its file, or its parameters"""
    robot: str = "tracker"
    """name of the robot, with which the site is opened if it is not yet open"""
    drive: str = "kinematic"
    """name of the drive"""
    sensor: str = "ideal"
    """name of the sensor that reads checkpoints"""
    seed: int = Field(default=0, ge=0)
    """seed of all random values"""
    values: dict[int, float] = Field(default_factory=dict)
    """values that checkpoints show, by number; those of other checkpoints are drawn"""
    events: tuple[tuple[float, LoggedEvent], ...] = ()
    """events that occur during the run, with their times in s"""
    faults: tuple[AnyFault, ...] = ()
    """faults, which the robot can only find by sensing"""
    conditions: RunConditions = AS_PLANNED
    """differences from the plan that are no faults"""
    beginning: InitialState | None = None
    """state of an earlier run from which this one continues; None: the mission begins"""
    diagnostics: tuple[Diagnostic, ...] = ()
    """diagnostics of the mission's import, for the record"""
    reordering: Reordering | None = None
    """reordering of the mission's tasks, for the record; None: the written order"""
    source: str | None = None
    """absolute path of the mission's file, which must not change as long as the run may be resumed
    from a journal"""

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
        """Settings of the run as plain data: how it is carried out, without mission and site."""
        return self.model_dump(mode="json", include=_SETTINGS)


SPEC_REMEDY = Message(
    "restore it from a copy, or evaluate again, which writes it; if you have "
    "changed it yourself, remove its `checksum`"
)


def read_spec(content: str | bytes, name: str = Message("the run's spec")) -> RunSpec:
    """Return the spec in a JSON text.

    Raises Invalid, with the text's `name` and the place in it, if it is not a spec; Unavailable if
    it does not fit its checksum.
    """
    try:
        data = content.encode() if isinstance(content, str) else content
        return read_checked(RunSpec, data, name, SPEC_REMEDY)
    except ValidationError as error:
        raise _invalid(name, error) from None


def validate_spec(spec: RunSpec) -> RunSpec:
    """Return the spec after a check of its fields' types.

    Pydantic's `model_copy` and `model_construct` do not check them. Raises Invalid, with the name
    of the field, if the spec is invalid.
    """
    if not isinstance(spec, RunSpec):
        raise Invalid(Message("{spec} is not a spec of a run: make it a RunSpec", spec=repr(spec)))
    try:
        return RunSpec.model_validate(dict(spec))
    except ValidationError as error:
        raise _invalid("the run's spec", error) from None


def _invalid(name: str, error: ValidationError) -> Invalid:
    fault = error.errors(include_url=False)[0]
    place = format_path(fault["loc"])
    message = error_message(fault, fault["loc"])
    return Invalid(
        Message(
            "{name}: {place}{message}",
            name=name,
            place=f"{place}: " if place else "",
            message=as_message(message),
        )
    )


def logged_events(*events: tuple[float, Event]) -> tuple[tuple[float, LoggedEvent], ...]:
    """Return events with their times (s) in the form of a spec.

    Raises Invalid for an object that is no event.
    """
    return tuple((t, LoggedEvent.from_event(event)) for t, event in events)
