"""Missions as ROS messages and back; `from_message(to_message(m))` is `m`, unchanged.

A field of a message has the name that the field of the mission has. One that may be None is told by
a `has_...` beside it, or else is 0 then. Enumerations are constants, the flag of a window is its
`kind`, and poses have their heading beside them, as a quaternion does not keep its last digit.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any, NoReturn, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from argo_compiler.base.model import Model, Pose
from argo_compiler.base.quaternions import to_quaternion, to_yaw
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Span, diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.files.json_places import format_path
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Order,
    Reaction,
    Response,
    Stop,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)
from argo_compiler.il.velocities import of_ways_on, of_ways_there
from argo_compiler.ros.types import RosTypes

_MESSAGES: dict[type[Model], str] = {
    Mission: "MissionSpecification",
    Task: "MissionTask",
    Transition: "MissionTransition",
    Condition: "MissionCondition",
    WaitRule: "MissionWait",
    TimeWindow: "MissionWindow",
    Group: "MissionGroup",
    Reaction: "MissionReaction",
}
_MODELS = {message: model for model, message in _MESSAGES.items()}
_CONSTANTS: dict[type[Enum], tuple[str, str]] = {
    Mode: ("MissionSpecification", "MODE_"),
    Order: ("MissionSpecification", "ORDER_"),
    Action: ("MissionTask", ""),
    OnFailure: ("MissionTask", "ON_FAILURE_"),
    Stop: ("MissionGroup", ""),
    EventKind: ("MissionReaction", ""),
    Response: ("MissionReaction", "RESPONSE_"),
    Afterwards: ("MissionReaction", "AFTERWARDS_"),
}
"""The message that has the constants for an enumeration, and how their names begin."""
_RANGES = {"int64": range(-(2**63), 2**63), "uint64": range(2**64)}
_HEADINGS = {"pose": "yaw", "dock": "dock_yaw"}
"""the field with the heading of a pose"""
_SPAN = tuple(Span.model_fields)
_FLAT = {
    **{heading: (pose, "yaw") for pose, heading in _HEADINGS.items()},
    **{f"source_{name}": ("source", name) for name in _SPAN},
}
"""the fields of a message that are those of a field of the mission"""


@dataclass(frozen=True)
class Received:
    """The mission of a message, and warnings about what it could not take over."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...] = ()


def refuse(source_name: str, code: str, message: str, hint: str) -> NoReturn:
    """Raise a DiagnosticError for one reason."""
    raise DiagnosticError(source_name, [diagnostic_of(code, message, hint)]) from None


def _numbers(types: RosTypes) -> dict[type[Enum], dict[Any, int]]:
    """Return the constants for each enumeration, read from the definitions themselves."""
    found: dict[type[Enum], dict[Any, int]] = {
        enumeration: types.numbers(message, enumeration, prefix)
        for enumeration, (message, prefix) in _CONSTANTS.items()
    }
    # Some compare a value, others look at the reading: the constants have two prefixes.
    conditions = {type: types.constant("MissionCondition", type.value) for type in ConditionType}
    return found | {ConditionType: conditions}


# ---- missions become messages


def to_message(mission: Mission, types: RosTypes) -> Any:
    """The mission as a MissionSpecification, whose velocities are those of the way on.

    Raises DiagnosticError for an integer beyond 64 bits, a text that can't be UTF-8, and velocities
    that depend on more than the task that the robot comes from.
    """
    return _Writer(types).message(_with_velocities_on(mission), "")


def _with_velocities_on(mission: Mission) -> Mission:
    """The mission with the velocity of the way from each task, as the messages have it."""
    on, _ = of_ways_on(mission)
    back, differ = of_ways_there(on)
    for task, read in zip(mission.tasks, back.tasks, strict=True):
        if task.velocity != read.velocity or task.name in differ:
            given = "no velocity" if task.velocity is None else f"{task.velocity:g} m/s"
            refuse(
                "mission",
                "export.velocity",
                f"{subject_of('tasks', task.name)}.velocity: a message has the velocity of the way "
                f"on from a task, whichever task follows: it can't say {given} on all ways to this "
                "task and another one on other ways from there",
                "give all tasks that may follow the same task one velocity",
            )
    return on


class _Writer:
    def __init__(self, types: RosTypes) -> None:
        self.types = types
        self.numbers = _numbers(types)

    def message(self, part: Model, place: str, named: bool = True) -> Any:
        """Return the message of a part of the mission.

        What can't be said is at the field behind `place`, or at `place` itself where fields are not
        `named`, as deeper in a task, group or reaction.
        """
        fields: dict[str, Any] = {}
        for name, kind in self.types.fields(_MESSAGES[type(part)]):
            at = f"{place}{'.'.join(_FLAT.get(name, (name,)))}" if named else place
            if name.startswith("has_"):
                fields[name] = getattr(part, name.removeprefix("has_")) is not None
            elif (value := _given(part, name)) is not None:
                fields[name] = self._value(value, kind, at)
            elif name in _HEADINGS:
                fields[name] = self.types.pose(0, 0, 0, *to_quaternion(0.0))
        return self.types.new(_MESSAGES[type(part)], **fields)

    def _value(self, value: Any, kind: str, at: str) -> Any:
        match value:
            case Enum():
                return self.numbers[type(value)][value]
            case str():
                return _text(at, value)
            case int() if kind in _RANGES:
                return _integer(at, value, kind)
            case Pose():
                return self.types.pose(value.x, value.y, value.z, *to_quaternion(value.yaw))
            case JointState():
                names = tuple(_text(at, name) for name in value.names)
                moved = (value.positions, value.velocities, value.efforts)
                return self.types.joint_state(names, *moved)
            case (str(first), str(second)):
                pair = {"first": _text(at, first), "second": _text(at, second)}
                return self.types.new("MissionPrecedence", **pair)
            case tuple():
                return [self._value(item, kind, at) for item in value]
            case Task() | Group():
                field = "tasks" if isinstance(value, Task) else "groups"
                return self.message(value, f"{subject_of(field, value.name)}.")
            case Reaction():
                return self.message(value, f"{subject_of('reactions', value.event)}.")
            case Model():
                return self.message(value, at, named=False)
        return value


def _given(part: Model, name: str) -> Any:
    """Return what a field of a message says of a part of the mission; None: nothing."""
    if isinstance(part, TimeWindow) and name == "kind":
        return Stop.HARD if part.hard else Stop.SOFT
    for step in _FLAT.get(name, (name,)):
        part = part and getattr(part, step)
    return part


def _text(place: str, text: str) -> str:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        message = f"{place}: is no text that UTF-8 can hold"
        refuse("mission", "export.not-text", message, "remove what is no character")
    return text


def _integer(place: str, value: int, kind: str) -> int:
    if value not in _RANGES[kind]:
        message = f"{place}: {value} does not fit into the {kind} of the message"
        refuse("mission", "export.number-too-large", message, "use a smaller number")
    return value


# ---- messages become missions


def from_message(message: Any, types: RosTypes, source_name: str) -> Received:
    """The mission of a MissionSpecification, with the velocities of the way to each task; whether
    it makes sense is for `check`.

    Raises DiagnosticError for what a mission can't hold, by the path of the field.
    """
    version = Mission.model_fields["version"].default
    if message.version != version:
        refuse(
            source_name,
            "ros.unsupported-version",
            f"has version {message.version} of the messages",
            f"this Argo reads version {version}: set the field, or use the Argo it is from",
        )
    data = _Reader(types, source_name).part(message, "")
    try:
        mission, differ = of_ways_there(Mission.model_validate(data))
    except ValidationError as error:
        diagnostics = [
            diagnostic_of(
                "ros.wrong-field", f"{format_path(e['loc'])}: {e['msg']}", "publish a sound value"
            )
            for e in error.errors(include_url=False)
        ]
        raise DiagnosticError(source_name, diagnostics) from None
    return Received(mission, tuple(_slowest(task) for task in differ))


def _slowest(task: str) -> Diagnostic:
    return diagnostic_of(
        "ros.velocity",
        f"'{task}' is driven to at different velocities, by where the robot comes from: it "
        "has the slowest of them",
        "a velocity belongs to the way to a task: set it there",
        subject_of("tasks", task),
    )


class _Reader:
    def __init__(self, types: RosTypes, source_name: str) -> None:
        self.types = types
        self.source_name = source_name
        self.numbers = _numbers(types)

    def part(self, message: Any, place: str) -> dict[str, Any]:
        """Return the data of a part of the mission, whose fields stand behind `place`."""
        kind = message.__msgtype__.rpartition("/")[2]
        known = _MODELS[kind].model_fields
        data: dict[str, Any] = {}
        for name, _ in self.types.fields(kind):
            if name in known and getattr(message, f"has_{name}", True):
                value, field = getattr(message, name), known[name]
                told = hasattr(message, f"has_{name}") or field.is_required()
                if value or told or field.default == 0 or isinstance(field.default, Enum):
                    data[name] = self._value(message, name, value, field, place + name)
        if getattr(message, "has_source", False):
            data["source"] = {name: getattr(message, f"source_{name}") for name in _SPAN}
        if kind == _MESSAGES[TimeWindow]:
            data["hard"] = self._member(f"{place}kind", Stop, message.kind) is Stop.HARD
        return data

    def _value(self, message: Any, name: str, value: Any, field: FieldInfo, place: str) -> Any:
        for kind in (field.annotation, *get_args(field.annotation)):
            if isinstance(kind, type) and issubclass(kind, Enum):
                return self._member(place, kind, value)
        if name in _HEADINGS:
            return self._pose(place, value, getattr(message, _HEADINGS[name]))
        if name == "before":
            return tuple((pair.first, pair.second) for pair in value)
        if name == "joint_states":
            return _joints(value)
        if isinstance(value, list):
            return tuple(self.part(item, f"{place}[{i}].") for i, item in enumerate(value))
        return self.part(value, f"{place}.") if hasattr(value, "__msgtype__") else value

    def _pose(self, place: str, m: Any, planned: float) -> dict[str, float]:
        q = m.orientation
        try:
            yaw = to_yaw(q.x, q.y, q.z, q.w, planned)
        except ValueError as error:
            message = f"{place}: the orientation {error}"
            refuse(self.source_name, "ros.orientation", message, "set a turn about z")
        return {"x": m.position.x, "y": m.position.y, "z": m.position.z, "yaw": yaw}

    def _member(self, place: str, enumeration: type[Enum], number: int) -> Any:
        numbers = self.numbers[enumeration]
        for member, value in numbers.items():
            if value == number:
                return member
        known = ", ".join(f"{value} {member.name}" for member, value in numbers.items())
        refuse(self.source_name, "ros.wrong-field", f"{place}: is {number}", f"known are {known}")


def _joints(m: Any) -> dict[str, Any]:
    return {
        "names": tuple(m.name),
        "positions": tuple(m.position.tolist()),
        "velocities": tuple(m.velocity.tolist()),
        "efforts": tuple(m.effort.tolist()),
    }
