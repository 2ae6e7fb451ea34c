"""Conversion of missions to ROS messages and back; `from_message(to_message(m))` equals `m`.

A message's field has the same name as the mission's field. If that may be None, the message has a
flag `has_...` for it, or 0 stands for None. Enumerations are constants, and the flag `hard` of a
window is its `kind`. Poses have their heading in a separate field, as a quaternion does not
preserve its last digit.
"""

from dataclasses import dataclass
from enum import Enum
from typing import Any, NoReturn, get_args

from pydantic import ValidationError
from pydantic.fields import FieldInfo

from argo_compiler.base.message import Message
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
from argo_compiler.il.velocities import (
    approach_to_departure_velocities,
    departure_to_approach_velocities,
)
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
"""Message with the constants for an enumeration, and the prefix of their names."""
_RANGES = {"int64": range(-(2**63), 2**63), "uint64": range(2**64)}
_HEADINGS = {"pose": "yaw", "dock": "dock_yaw"}
"""Field with the heading of a pose."""
_SPAN = tuple(Span.model_fields)
_FLATTENED = {
    **{heading: (pose, "yaw") for pose, heading in _HEADINGS.items()},
    **{f"source_{name}": ("source", name) for name in _SPAN},
}
"""Fields of a message that are fields of a nested part of the mission, with their paths."""


@dataclass(frozen=True)
class Received:
    """Received mission, and warnings about values that the conversion changed."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...] = ()


def raise_error(source_name: str, code: str, message: str, hint: str) -> NoReturn:
    """Raise a DiagnosticError with one diagnostic."""
    raise DiagnosticError(source_name, [diagnostic_of(code, message, hint)]) from None


def _constants(types: RosTypes) -> dict[type[Enum], dict[Any, int]]:
    """Return, by enumeration, the numbers that stand for its members in messages."""
    constants: dict[type[Enum], dict[Any, int]] = {
        enumeration: types.enum_constants(message, enumeration, prefix)
        for enumeration, (message, prefix) in _CONSTANTS.items()
    }
    # Constants of conditions have two prefixes: for comparisons, and for the kind of a reading.
    conditions = {type: types.constant("MissionCondition", type.value) for type in ConditionType}
    return constants | {ConditionType: conditions}


# ---- from missions to messages


def to_message(mission: Mission, types: RosTypes) -> Any:
    """Return the mission as a ROS message, a MissionSpecification.

    In the message, a task's velocity applies to the path to the next task. Raises DiagnosticError
    for an integer beyond 64 bits, a text that UTF-8 can't represent, and velocities that depend on
    more than the task from which the robot comes.
    """
    return _MessageWriter(types).message(_with_onward_velocities(mission), "")


def _with_onward_velocities(mission: Mission) -> Mission:
    """Return the mission with each task's velocity on the path from it instead of to it.

    Raises DiagnosticError if that is impossible without loss.
    """
    onward, _ = approach_to_departure_velocities(mission)
    back, differ = departure_to_approach_velocities(onward)
    for task, returned in zip(mission.tasks, back.tasks, strict=True):
        if task.velocity != returned.velocity or task.name in differ:
            velocity = "no velocity" if task.velocity is None else f"{task.velocity:g} m/s"
            raise_error(
                "mission",
                "export.velocity",
                Message(
                    "{subject_of}.velocity: a message has one velocity for all paths that "
                    "start at a task: it can't have {velocity} on all paths to this task and "
                    "another velocity on other paths from the same tasks",
                    subject_of=subject_of("tasks", task.name),
                    velocity=velocity,
                ),
                "set the same velocity for all tasks that may follow the same task",
            )
    return onward


class _MessageWriter:
    """Writer of messages for one version of ROS."""

    def __init__(self, types: RosTypes) -> None:
        self.types = types
        self.constants = _constants(types)

    def message(self, part: Model, path: str, named: bool = True) -> Any:
        """Return the ROS message for the mission or a part of it, such as a task.

        Errors name the faulty field by `path` and its name, or by `path` alone if `named` is False,
        as for the windows and other parts of a task, group or reaction.
        """
        fields: dict[str, Any] = {}
        for name, kind in self.types.fields(_MESSAGES[type(part)]):
            field_path = f"{path}{'.'.join(_FLATTENED.get(name, (name,)))}" if named else path
            if name.startswith("has_"):
                fields[name] = getattr(part, name.removeprefix("has_")) is not None
            elif (value := _field_value(part, name)) is not None:
                fields[name] = self._value(value, kind, field_path)
            elif name in _HEADINGS:
                fields[name] = self.types.pose(0, 0, 0, *to_quaternion(0.0))
        return self.types.new(_MESSAGES[type(part)], **fields)

    def _value(self, value: Any, kind: str, path: str) -> Any:
        match value:
            case Enum():
                return self.constants[type(value)][value]
            case str():
                return _text(path, value)
            case int() if kind in _RANGES:
                return _integer(path, value, kind)
            case Pose():
                return self.types.pose(value.x, value.y, value.z, *to_quaternion(value.yaw))
            case JointState():
                names = tuple(_text(path, name) for name in value.names)
                targets = (value.positions, value.velocities, value.efforts)
                return self.types.joint_state(names, *targets)
            case (str(first), str(second)):
                pair = {"first": _text(path, first), "second": _text(path, second)}
                return self.types.new("MissionPrecedence", **pair)
            case tuple():
                return [self._value(item, kind, path) for item in value]
            case Task() | Group():
                field = "tasks" if isinstance(value, Task) else "groups"
                return self.message(value, f"{subject_of(field, value.name)}.")
            case Reaction():
                return self.message(value, f"{subject_of('reactions', value.event)}.")
            case Model():
                return self.message(value, path, named=False)
        return value


def _field_value(part: Model, name: str) -> Any:
    """Return the part's value for the message field `name`, or None if it is not set."""
    if isinstance(part, TimeWindow) and name == "kind":
        return Stop.HARD if part.hard else Stop.SOFT
    for step in _FLATTENED.get(name, (name,)):
        part = part and getattr(part, step)
    return part


def _text(path: str, text: str) -> str:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        message = Message("{path} is not text that UTF-8 can represent", path=path)
        raise_error("mission", "export.not-text", message, "remove the invalid characters")
    return text


def _integer(path: str, value: int, kind: str) -> int:
    if value not in _RANGES[kind]:
        message = Message(
            "{path}: {value} does not fit into the {kind} of the message",
            path=path,
            value=value,
            kind=kind,
        )
        raise_error("mission", "export.number-too-large", message, "use a smaller number")
    return value


# ---- from messages to missions


def from_message(message: Any, types: RosTypes, source_name: str) -> Received:
    """Return the mission of a MissionSpecification; its velocities become those on paths to tasks.

    This does not check the meaning of the mission, as `check` does. Raises DiagnosticError for
    values that a mission can't have, with the path of the field.
    """
    version = Mission.model_fields["version"].default
    if message.version != version:
        raise_error(
            source_name,
            "ros.unsupported-version",
            Message("the message has version {version} of the messages", version=message.version),
            Message(
                "this Argo reads version {version}: set the field, or use the Argo that wrote it",
                version=version,
            ),
        )
    data = _MessageReader(types, source_name).part(message, "")
    try:
        mission, differ = departure_to_approach_velocities(Mission.model_validate(data))
    except ValidationError as error:
        diagnostics = [
            diagnostic_of(
                "ros.wrong-field",
                Message("{place}: {message}", place=format_path(e["loc"]), message=e["msg"]),
                "publish a valid value",
            )
            for e in error.errors(include_url=False)
        ]
        raise DiagnosticError(source_name, diagnostics) from None
    return Received(mission, tuple(_velocity_warning(task) for task in differ))


def _velocity_warning(task: str) -> Diagnostic:
    return diagnostic_of(
        "ros.velocity",
        Message(
            "the velocity of the path to '{task}' depends on the previous task: the "
            "lowest of these velocities is used",
            task=task,
        ),
        "a velocity applies to the path to its task: set it there",
        subject_of("tasks", task),
    )


class _MessageReader:
    """Reader of messages of one version of ROS; errors call the message's source by its name."""

    def __init__(self, types: RosTypes, source_name: str) -> None:
        self.types = types
        self.source_name = source_name
        self.constants = _constants(types)

    def part(self, message: Any, path: str) -> dict[str, Any]:
        """Return the data of the mission or a part of it; errors name its fields after `path`."""
        kind = message.__msgtype__.rpartition("/")[2]
        model_fields = _MODELS[kind].model_fields
        data: dict[str, Any] = {}
        for name, _ in self.types.fields(kind):
            if name in model_fields and getattr(message, f"has_{name}", True):
                value, field = getattr(message, name), model_fields[name]
                is_set = hasattr(message, f"has_{name}") or field.is_required()
                if value or is_set or field.default == 0 or isinstance(field.default, Enum):
                    data[name] = self._value(message, name, value, field, path + name)
        if getattr(message, "has_source", False):
            data["source"] = {name: getattr(message, f"source_{name}") for name in _SPAN}
        if kind == _MESSAGES[TimeWindow]:
            data["hard"] = self._member(f"{path}kind", Stop, message.kind) is Stop.HARD
        return data

    def _value(self, message: Any, name: str, value: Any, field: FieldInfo, path: str) -> Any:
        for kind in (field.annotation, *get_args(field.annotation)):
            if isinstance(kind, type) and issubclass(kind, Enum):
                return self._member(path, kind, value)
        if name in _HEADINGS:
            return self._pose(path, value, getattr(message, _HEADINGS[name]))
        if name == "before":
            return tuple((pair.first, pair.second) for pair in value)
        if name == "joint_states":
            return _joints(value)
        if isinstance(value, list):
            return tuple(self.part(item, f"{path}[{i}].") for i, item in enumerate(value))
        return self.part(value, f"{path}.") if hasattr(value, "__msgtype__") else value

    def _pose(self, path: str, pose: Any, heading: float) -> dict[str, float]:
        q = pose.orientation
        try:
            yaw = to_yaw(q.x, q.y, q.z, q.w, heading)
        except ValueError as error:
            message = Message("{path}: the orientation {error}", path=path, error=error)
            raise_error(self.source_name, "ros.orientation", message, "set a rotation about z only")
        return {"x": pose.position.x, "y": pose.position.y, "z": pose.position.z, "yaw": yaw}

    def _member(self, path: str, enumeration: type[Enum], number: int) -> Any:
        constants = self.constants[enumeration]
        for member, value in constants.items():
            if value == number:
                return member
        valid = ", ".join(f"{value} {member.name}" for member, value in constants.items())
        raise_error(
            self.source_name,
            "ros.wrong-field",
            Message("{path} is {number}", path=path, number=number),
            Message("valid values: {valid}", valid=valid),
        )


def _joints(state: Any) -> dict[str, Any]:
    return {
        "names": tuple(state.name),
        "positions": tuple(state.position.tolist()),
        "velocities": tuple(state.velocity.tolist()),
        "efforts": tuple(state.effort.tolist()),
    }
