"""Missions become ROS messages; `from_message(to_message(m))` is `m`, unchanged."""

from typing import Any, NoReturn

from argo_compiler.base.model import Pose
from argo_compiler.base.quaternions import to_quaternion
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, Severity, Span
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import (
    Condition,
    EventKind,
    Group,
    JointState,
    Mission,
    Reaction,
    Task,
    TimeWindow,
    WaitRule,
)
from argo_compiler.il.velocities import of_ways_on, of_ways_there
from argo_compiler.ros.numbers import Numbers
from argo_compiler.ros.types import RosTypes

_MAX = {"int64": 2**63 - 1, "uint64": 2**64 - 1}


def to_message(mission: Mission, types: RosTypes) -> Any:
    """The mission as a MissionSpecification, whose velocities are those of the way on.

    Raises DiagnosticError for an integer beyond 64 bits, a text that can't be UTF-8, and velocities
    that depend on more than the task that the robot comes from.
    """
    return _Writer(types).mission(_with_velocities_on(mission))


def _with_velocities_on(mission: Mission) -> Mission:
    """The mission with the velocity of the way from each task, as the messages have it."""
    on, _ = of_ways_on(mission)
    back, differ = of_ways_there(on)
    for task, read in zip(mission.tasks, back.tasks, strict=True):
        if task.velocity != read.velocity or task.name in differ:
            given = "no velocity" if task.velocity is None else f"{task.velocity:g} m/s"
            _refuse(
                "velocity",
                f"{subject_of('tasks', task.name)}.velocity: a message has the velocity of the way "
                f"on from a task, whichever task follows: it can't say {given} on all ways to this "
                "task and another one on other ways from there",
                "give all tasks that may follow the same task one velocity",
            )
    return on


class _Writer:
    def __init__(self, types: RosTypes) -> None:
        self.types = types
        self.numbers = Numbers(types)

    def mission(self, mission: Mission) -> Any:
        dock = self._pose(mission.dock)
        return self.types.new(
            "MissionSpecification",
            version=mission.version,
            tasks=[self._task(task) for task in mission.tasks],
            groups=[self._group(group) for group in mission.groups],
            has_current=mission.current is not None,
            current=_text("current", mission.current or ""),
            reactions=[self._reaction(reaction) for reaction in mission.reactions],
            before=[
                self.types.new(
                    "MissionPrecedence",
                    first=_text("before", first),
                    second=_text("before", second),
                )
                for first, second in mission.before
            ],
            designation=_text("designation", mission.designation),
            site=_text("site", mission.site),
            mode=self.numbers.mode[mission.mode],
            order=self.numbers.order[mission.order],
            max_duration=mission.max_duration or 0.0,
            has_start_area=mission.start_area is not None,
            start_area=_integer("start_area", mission.start_area or 0, "int64"),
            has_end_area=mission.end_area is not None,
            end_area=_integer("end_area", mission.end_area or 0, "int64"),
            has_dock=dock["has_pose"],
            dock=dock["pose"],
            dock_yaw=dock["yaw"],
            anomaly_specification=_text("anomaly_specification", mission.anomaly_specification),
            real_time_reporting=_text("real_time_reporting", mission.real_time_reporting),
            after_mission_report=_text("after_mission_report", mission.after_mission_report),
        )

    def _task(self, task: Task) -> Any:
        place = subject_of("tasks", task.name)
        return self.types.new(
            "MissionTask",
            action=self.numbers.action[task.action],
            name=_text(f"{place}.name", task.name),
            group=_text(f"{place}.group", task.group),
            has_object_id=task.object_id is not None,
            object_id=_text(f"{place}.object_id", task.object_id or ""),
            velocity=task.velocity or 0.0,
            has_joint_states=task.joint_states is not None,
            joint_states=self._joints(place, task.joint_states),
            has_wait=task.wait is not None,
            wait=self._wait(place, task.wait or WaitRule()),
            has_window=task.window is not None,
            window=self._window(place, task.window or TimeWindow()),
            time_limit=task.time_limit or 0.0,
            reading_limit=task.reading_limit or 0.0,
            optional=task.optional,
            priority=task.priority,
            retries=_integer(f"{place}.retries", task.retries, "uint64"),
            on_failure=self.numbers.on_failure[task.on_failure],
            has_failure_target=task.failure_target is not None,
            failure_target=_text(f"{place}.failure_target", task.failure_target or ""),
            transitions=[
                self.types.new(
                    "MissionTransition",
                    target=_text(f"{place}.transitions", transition.target),
                    conditions=self._conditions(f"{place}.transitions", transition.conditions),
                )
                for transition in task.transitions
            ],
            **self._pose(task.pose),
            **_source(place, task.source),
        )

    def _joints(self, place: str, joints: JointState | None) -> Any:
        if joints is None:
            return self.types.joint_state()
        names = tuple(_text(f"{place}.joint_states", name) for name in joints.names)
        return self.types.joint_state(names, joints.positions, joints.velocities, joints.efforts)

    def _wait(self, place: str, wait: WaitRule) -> Any:
        return self.types.new(
            "MissionWait",
            has_duration=wait.duration is not None,
            duration=0.0 if wait.duration is None else wait.duration,
            event=self._event(wait.event),
            conditions=self._conditions(f"{place}.wait", wait.conditions),
            limit=wait.limit or 0.0,
        )

    def _window(self, place: str, window: TimeWindow) -> Any:
        missed = window.missed_target
        return self.types.new(
            "MissionWindow",
            earliest=window.earliest,
            latest=window.latest or 0.0,
            kind=self.numbers.hard[window.hard],
            has_missed_target=missed is not None,
            missed_target=_text(f"{place}.window", missed or ""),
        )

    def _event(self, event: EventKind | None) -> int:
        return 0 if event is None else self.numbers.event[event]

    def _conditions(self, place: str, conditions: tuple[Condition, ...]) -> list[Any]:
        return [self._condition(place, condition) for condition in conditions]

    def _condition(self, place: str, condition: Condition) -> Any:
        return self.types.new(
            "MissionCondition",
            type=self.numbers.condition[condition.type],
            id=_text(place, condition.id),
            object_id=_text(place, condition.object_id),
            has_param1=condition.param1 is not None,
            param1=0.0 if condition.param1 is None else condition.param1,
            has_param2=condition.param2 is not None,
            param2=0.0 if condition.param2 is None else condition.param2,
            inclusive=condition.inclusive,
            max_age=condition.max_age or 0.0,
        )

    def _group(self, group: Group) -> Any:
        place = subject_of("groups", group.name)
        return self.types.new(
            "MissionGroup",
            name=_text(f"{place}.name", group.name),
            start=_text(f"{place}.start", group.start),
            end=_text(f"{place}.end", group.end),
            max_repeat_count=_integer(
                f"{place}.max_repeat_count", group.max_repeat_count, "uint64"
            ),
            max_repeat_duration=group.max_repeat_duration,
            count_interruptions=group.count_interruptions,
            stop=self.numbers.stop[group.stop],
            every=group.every,
            until=self._conditions(f"{place}.until", group.until),
            **_source(place, group.source),
        )

    def _reaction(self, reaction: Reaction) -> Any:
        place = subject_of("reactions", reaction.event)
        return self.types.new(
            "MissionReaction",
            event=self.numbers.event[reaction.event],
            response=self.numbers.response[reaction.response],
            has_area=reaction.area is not None,
            area=_integer(f"{place}.area", reaction.area or 0, "int64"),
            until=self._event(reaction.until),
            afterwards=self.numbers.afterwards[reaction.afterwards],
            hold_limit=reaction.hold_limit or 0.0,
            on_limit=self.numbers.afterwards[reaction.on_limit],
            has_priority=reaction.priority is not None,
            priority=_integer(f"{place}.priority", reaction.priority or 0, "int64"),
            battery_below=reaction.battery_below or 0.0,
            **self._pose(reaction.pose),
            **_source(place, reaction.source),
        )

    def _pose(self, pose: Pose | None) -> dict[str, Any]:
        if pose is None:
            return {"has_pose": False, "pose": self.types.pose(0, 0, 0, 0, 1), "yaw": 0.0}
        message = self.types.pose(pose.x, pose.y, pose.z, *to_quaternion(pose.yaw))
        return {"has_pose": True, "pose": message, "yaw": pose.yaw}


def _source(place: str, span: Span | None) -> dict[str, Any]:
    if span is None:
        return {}
    return {"has_source": True} | {
        f"source_{name}": _integer(f"{place}.source.{name}", getattr(span, name), "int64")
        for name in ("line", "column", "length")
    }


def _text(place: str, text: str) -> str:
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        _refuse(
            "not-text", f"{place}: is no text that UTF-8 can hold", "remove what is no character"
        )
    return text


def _integer(place: str, value: int, kind: str) -> int:
    low = -_MAX[kind] - 1 if kind == "int64" else 0
    if not low <= value <= _MAX[kind]:
        _refuse(
            "number-too-large",
            f"{place}: {value} does not fit into the {kind} of the message",
            "use a smaller number",
        )
    return value


def _refuse(code: str, message: str, hint: str) -> NoReturn:
    diagnostic = Diagnostic(
        code=f"export.{code}", severity=Severity.ERROR, message=message, hint=hint
    )
    raise DiagnosticError("mission", [diagnostic]) from None
