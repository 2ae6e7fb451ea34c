"""ROS messages become missions, with the velocities of the way to each task."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, NoReturn, TypeVar

from pydantic import ValidationError

from argo_compiler.base.quaternions import to_yaw
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import EventKind, Mission
from argo_compiler.il.velocities import of_ways_there
from argo_compiler.ros.numbers import Numbers
from argo_compiler.ros.types import RosTypes

E = TypeVar("E")


@dataclass(frozen=True)
class Received:
    """The mission of a message, and warnings about what it could not take over."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...] = ()


def from_message(message: Any, types: RosTypes, source_name: str) -> Received:
    """The mission of a MissionSpecification; whether it makes sense is for `check`.

    Raises DiagnosticError for what a mission can't hold, by the path of the field.
    """
    reader = _Reader(types, source_name)
    data = reader.mission(message)
    try:
        mission, differ = of_ways_there(Mission.model_validate(data))
    except ValidationError as error:
        diagnostics = [
            _diagnostic(
                "ros.wrong-field", f"{_path(e['loc'])}: {e['msg']}", "publish a sound value"
            )
            for e in error.errors(include_url=False)
        ]
        raise DiagnosticError(source_name, diagnostics) from None
    return Received(mission, tuple(_slowest(task) for task in differ))


def _slowest(task: str) -> Diagnostic:
    return Diagnostic(
        code="ros.velocity",
        severity=Severity.WARNING,
        message=f"'{task}' is driven to at different velocities, by where the robot comes from: it "
        "has the slowest of them",
        hint="a velocity belongs to the way to a task: set it there",
        subject=subject_of("tasks", task),
    )


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
            "before": tuple((p.first, p.second) for p in m.before),
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
            "joint_states": _joints(m.joint_states) if m.has_joint_states else None,
            "wait": self._wait(place, m.wait) if m.has_wait else None,
            "window": self._window(place, m.window) if m.has_window else None,
            "time_limit": m.time_limit or None,
            "reading_limit": m.reading_limit or None,
            "optional": m.optional,
            "priority": m.priority or 1,
            "retries": m.retries,
            "on_failure": self._member(
                f"{place}.on_failure", self.numbers.on_failure, m.on_failure
            ),
            "failure_target": m.failure_target if m.has_failure_target else None,
            "transitions": tuple(
                {
                    "target": transition.target,
                    "conditions": self._conditions(
                        f"{place}.transitions[{i}].conditions", transition.conditions
                    ),
                }
                for i, transition in enumerate(m.transitions)
            ),
            "source": _span(m),
        }

    def _wait(self, place: str, m: Any) -> dict[str, Any]:
        return {
            "duration": m.duration if m.has_duration else None,
            "event": self._event(f"{place}.wait.event", m.event),
            "conditions": self._conditions(f"{place}.wait.conditions", m.conditions),
            "limit": m.limit or None,
        }

    def _window(self, place: str, m: Any) -> dict[str, Any]:
        return {
            "earliest": m.earliest,
            "latest": m.latest or None,
            "hard": self._member(f"{place}.window.kind", self.numbers.hard, m.kind),
            "missed_target": m.missed_target if m.has_missed_target else None,
        }

    def _event(self, place: str, number: int) -> EventKind | None:
        return self._member(place, self.numbers.event, number) if number else None

    def _conditions(self, place: str, messages: Iterable[Any]) -> tuple[dict[str, Any], ...]:
        return tuple(self._condition(f"{place}[{i}]", m) for i, m in enumerate(messages))

    def _condition(self, place: str, m: Any) -> dict[str, Any]:
        return {
            "type": self._member(f"{place}.type", self.numbers.condition, m.type),
            "id": m.id,
            "object_id": m.object_id,
            "param1": m.param1 if m.has_param1 else None,
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
            "every": m.every,
            "until": self._conditions(f"{place}.until", m.until),
            "source": _span(m),
        }

    def _reaction(self, place: str, m: Any) -> dict[str, Any]:
        events = self.numbers.event
        return {
            "event": self._member(f"{place}.event", events, m.event),
            "response": self._member(f"{place}.response", self.numbers.response, m.response),
            "pose": self._pose(f"{place}.pose", m.pose, m.yaw) if m.has_pose else None,
            "area": m.area if m.has_area else None,
            "until": self._event(f"{place}.until", m.until),
            "afterwards": self._member(
                f"{place}.afterwards", self.numbers.afterwards, m.afterwards
            ),
            "hold_limit": m.hold_limit or None,
            "on_limit": self._member(f"{place}.on_limit", self.numbers.afterwards, m.on_limit),
            "priority": m.priority if m.has_priority else None,
            "battery_below": m.battery_below or None,
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

    def _member(self, place: str, numbers: Mapping[E, int], number: int) -> E:
        for member, value in numbers.items():
            if value == number:
                return member
        known = ", ".join(f"{value} {_name(member)}" for member, value in numbers.items())
        _refuse(self.source_name, "ros.wrong-field", f"{place}: is {number}", f"known are {known}")


def _joints(m: Any) -> dict[str, Any]:
    return {
        "names": tuple(m.name),
        "positions": tuple(m.position.tolist()),
        "velocities": tuple(m.velocity.tolist()),
        "efforts": tuple(m.effort.tolist()),
    }


def _name(member: object) -> str:
    if isinstance(member, bool):
        return "HARD" if member else "SOFT"
    return getattr(member, "name", str(member))


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
