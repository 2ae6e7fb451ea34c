"""ROS messages become missions."""

from collections.abc import Iterable, Mapping
from enum import Enum
from typing import Any, NoReturn, TypeVar

from pydantic import ValidationError

from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.il import Mission
from argo_compiler.quaternions import to_yaw
from argo_compiler.ros.numbers import Numbers
from argo_compiler.ros.types import RosTypes

E = TypeVar("E", bound=Enum)


def from_message(message: Any, types: RosTypes, source_name: str) -> Mission:
    """The mission of a MissionSpecification; whether it makes sense is for `check`.

    Raises DiagnosticError for what a mission can't hold, by the path of the field.
    """
    reader = _Reader(types, source_name)
    data = reader.mission(message)
    try:
        return Mission.model_validate(data)
    except ValidationError as error:
        diagnostics = [
            _diagnostic(
                "ros.wrong-field", f"{_path(e['loc'])}: {e['msg']}", "publish a sound value"
            )
            for e in error.errors(include_url=False)
        ]
        raise DiagnosticError(source_name, diagnostics) from None


class _Reader:
    def __init__(self, types: RosTypes, source_name: str) -> None:
        self.source_name = source_name
        self.numbers = Numbers(types)

    def mission(self, m: Any) -> dict[str, Any]:
        version = Mission.model_fields["version"].default
        if m.version != version:
            _refuse(
                self.source_name,
                "ros.unsupported-version",
                f"has version {m.version} of the messages",
                f"this Argo reads version {version}: set the field, or use the Argo it is from",
            )
        return {
            "tasks": tuple(self._task(f"tasks[{i}]", t) for i, t in enumerate(m.tasks)),
            "groups": tuple(self._group(f"groups[{i}]", g) for i, g in enumerate(m.groups)),
            "current": m.current if m.has_current else None,
            "reactions": tuple(
                self._reaction(f"reactions[{i}]", r) for i, r in enumerate(m.reactions)
            ),
            "designation": m.designation,
            "site": m.site,
            "mode": self._member("mode", self.numbers.mode, m.mode),
            "order": self._member("order", self.numbers.order, m.order),
            "max_duration": m.max_duration or None,
            "start_area": m.start_area if m.has_start_area else None,
            "end_area": m.end_area if m.has_end_area else None,
            "dock": self._pose("dock", m.dock, m.dock_yaw) if m.has_dock else None,
            "anomaly_specification": m.anomaly_specification,
            "real_time_reporting": m.real_time_reporting,
            "after_mission_report": m.after_mission_report,
        }

    def _task(self, place: str, m: Any) -> dict[str, Any]:
        return {
            "action": self._member(f"{place}.action", self.numbers.action, m.action),
            "name": m.name,
            "group": m.group,
            "object_id": m.object_id if m.has_object_id else None,
            "velocity": m.velocity or None,
            "pose": self._pose(f"{place}.pose", m.pose, m.yaw) if m.has_pose else None,
            "joint_states": self._joints(place, m.joint_states) if m.has_joint_states else None,
            "retries": m.retries,
            "on_failure": self._member(
                f"{place}.on_failure", self.numbers.on_failure, m.on_failure
            ),
            "transitions": tuple(
                {
                    "target": transition.target,
                    "conditions": tuple(
                        self._condition(f"{place}.transitions[{i}].conditions[{j}]", condition)
                        for j, condition in enumerate(transition.conditions)
                    ),
                }
                for i, transition in enumerate(m.transitions)
            ),
            "source": _span(m),
        }

    def _condition(self, place: str, m: Any) -> dict[str, Any]:
        return {
            "type": self._member(f"{place}.type", self.numbers.condition, m.type),
            "id": m.id,
            "object_id": m.object_id,
            "param1": m.param1,
            "param2": m.param2 if m.has_param2 else None,
            "inclusive": m.inclusive,
            "max_age": m.max_age or None,
        }

    def _group(self, place: str, m: Any) -> dict[str, Any]:
        return {
            "name": m.name,
            "start": m.start,
            "end": m.end,
            "max_repeat_count": m.max_repeat_count,
            "max_repeat_duration": m.max_repeat_duration,
            "count_interruptions": m.count_interruptions,
            "stop": self._member(f"{place}.stop", self.numbers.stop, m.stop),
            "source": _span(m),
        }

    def _reaction(self, place: str, m: Any) -> dict[str, Any]:
        events = self.numbers.event
        return {
            "event": self._member(f"{place}.event", events, m.event),
            "response": self._member(f"{place}.response", self.numbers.response, m.response),
            "pose": self._pose(f"{place}.pose", m.pose, m.yaw) if m.has_pose else None,
            "until": self._member(f"{place}.until", events, m.until) if m.until else None,
            "afterwards": self._member(
                f"{place}.afterwards", self.numbers.afterwards, m.afterwards
            ),
            "priority": m.priority,
            "source": _span(m),
        }

    def _pose(self, place: str, m: Any, planned: float) -> dict[str, float]:
        q = m.orientation
        try:
            yaw = to_yaw(q.x, q.y, q.z, q.w, planned)
        except ValueError as error:
            _refuse(
                self.source_name,
                "ros.orientation",
                f"{place}: the orientation {error}",
                "set a turn about z",
            )
        return {"x": m.position.x, "y": m.position.y, "z": m.position.z, "yaw": yaw}

    def _joints(self, place: str, m: Any) -> dict[str, Any]:
        if len(m.velocity) or len(m.effort):
            _refuse(
                self.source_name,
                "ros.joint-states",
                f"{place}.joint_states: has velocities or efforts, which a mission does not hold",
                "leave them empty",
            )
        return {"names": tuple(m.name), "positions": tuple(m.position.tolist())}

    def _member(self, place: str, numbers: Mapping[E, int], number: int) -> E:
        for member, value in numbers.items():
            if value == number:
                return member
        known = ", ".join(f"{value} {member.name}" for member, value in numbers.items())
        _refuse(self.source_name, "ros.wrong-field", f"{place}: is {number}", f"known are {known}")


def _span(m: Any) -> dict[str, int] | None:
    if not m.has_source:
        return None
    return {"line": m.source_line, "column": m.source_column, "length": m.source_length}


def _path(location: Iterable[int | str]) -> str:
    steps = (f"[{step}]" if isinstance(step, int) else f".{step}" for step in location)
    return "".join(steps).removeprefix(".")


def _diagnostic(code: str, message: str, hint: str) -> Diagnostic:
    return Diagnostic(code=code, severity=Severity.ERROR, message=message, hint=hint)


def _refuse(source_name: str, code: str, message: str, hint: str) -> NoReturn:
    raise DiagnosticError(source_name, [_diagnostic(code, message, hint)])
