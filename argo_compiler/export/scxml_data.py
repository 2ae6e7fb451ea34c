"""Ids and data model of an SCXML document."""

from collections.abc import Iterable

from argo_compiler.base.model import Pose
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Action, Condition, Task

ARGO = "urn:argo:mission"
"""Namespace of the attributes that describe a state to people and to drivers of the chart."""

DEADLINES = ("wait", "window", "action", "limit", "hold", "round")
"""Kinds of deadlines other than those of groups and the mission.

Event `timeout.wait` is due at the time in `due_wait`, and so on.
"""

NEVER = "1000000000000000"
"""deadline in s of a group inside a round that has not started: later than any real time"""

_NUMBERS = (
    "now",  # time of the last event, in s since the mission's start
    "clock",  # the same without the time of interruptions
    "lost",  # s spent in interruptions that have ended
    "mode",  # 0 the mission runs, 1 a reaction drives, 2 no action is wanted, 3 the mission ends
    "outcome",  # 0 none yet, else the position in `OUTCOMES` from 1
    "ends",  # 0 while tasks remain, else the outcome to which the tasks have led
    "failures",  # tasks that are not optional and have failed with all retries
    "count",  # actions requested so far
    "visit",  # number of the action that the mission requests, or 0
    "first",  # number of the first action of this visit
    "drive",  # number of the active reaction's drive
    "paused",  # 1 while the mission waits for a person to resume it
    "fails",  # failures of this visit's action
    "completed",  # group whose round has ended, until its next transition; or 0
    "awaits",  # group whose next round is not due yet, or 0
    "occurred",  # 1 if the event that this visit waits for has occurred
    "look",  # 1 if the conditions that this visit waits for have to be evaluated
    "object",  # number of the object that the mission's task measures, or 0
    "limit",  # time limit in s of the mission's task, or 0
    "earliest",  # earliest start at the task's pose, in s since the mission's start
    "running",  # number of the running action, or 0
    "running_object",  # number of the object that it measures, or 0
    "starts",  # actions started so far
    "events",  # events with a reaction so far
    *(f"due_{due}" for due in DEADLINES),  # s since the mission's start, or 0
)


class ChartIds:
    """Short ids of tasks, groups and objects by position, as names may contain any characters."""

    def __init__(self, hfsm: Hfsm) -> None:
        self.leaves = {leaf.id: f"t{i}" for i, leaf in enumerate(hfsm.leaves, 1)}
        self.groups = {group.id: i for i, group in enumerate(hfsm.composites[1:], 1)}
        self.deadlines = _deadlines(hfsm)
        """kinds of `DEADLINES` that the mission's tasks and groups can have"""
        self.objects: dict[str, int] = {}
        for leaf in hfsm.leaves:
            if leaf.task.object_id is not None:
                self._number(leaf.task.object_id)
            if leaf.task.wait is not None:
                self._number_all(leaf.task.wait.conditions)
        for composite in hfsm.composites[1:]:
            if composite.repeat is not None:
                self._number_all(composite.repeat.until)
        for transition in hfsm.transitions():
            self._number_all(transition.conditions)

    def _number_all(self, conditions: Iterable[Condition]) -> None:
        for condition in conditions:
            self._number(condition.object_id)

    def _number(self, object_id: str) -> None:
        self.objects.setdefault(object_id, len(self.objects) + 1)

    def measured_object_number_or_0(self, task: Task) -> int:
        """Return the chart's number of the task's checkpoint, or 0 if it measures none."""
        if task.action is not Action.MEASURE or task.object_id is None:
            return 0
        return self.objects[task.object_id]


def _deadlines(hfsm: Hfsm) -> tuple[str, ...]:
    tasks = [leaf.task for leaf in hfsm.leaves]
    waits = [task.wait for task in tasks if task.wait is not None]
    windows = [task.window for task in tasks if task.window is not None]
    repeats = [group.repeat for group in hfsm.composites if group.repeat is not None]
    is_possible = {
        "wait": bool(waits),
        "window": any(window.hard and window.latest is not None for window in windows),
        "action": any(task.time_limit is not None for task in tasks),
        "limit": any(wait.limit is not None for wait in waits),
        "round": any(repeat.every for repeat in repeats),
    }
    return tuple(kind for kind in DEADLINES if is_possible.get(kind))


def assign(xml: XmlWriter, location: str, expr: str) -> None:
    """Write an assignment to a variable of the data model."""
    xml.add("assign", {"location": location, "expr": expr})


def write_data_model(xml: XmlWriter, hfsm: Hfsm, ids: ChartIds) -> None:
    """Write the variables of the chart with their initial values."""
    with xml.nest_in("datamodel"):
        for name in _NUMBERS:
            xml.add("data", {"id": name, "expr": "0"})
        for name in ("place", "drive_place", "running_place"):
            xml.add("data", {"id": name, "expr": "''"})
        for group in hfsm.composites[1:]:
            n = ids.groups[group.id]
            xml.add("data", {"id": f"round_{n}", "expr": "0"})
            if group.repeat and group.repeat.duration:
                xml.add("data", {"id": f"until_{n}", "expr": "0"})
            if group.repeat and group.repeat.every:
                xml.add("data", {"id": f"entered_{n}", "expr": "0"})
        for object_id, k in ids.objects.items():
            xml.add("data", {"id": f"known_{k}", "expr": "0", "argo:object_id": object_id})
            for name in ("value", "time", "abnormal"):
                xml.add("data", {"id": f"{name}_{k}", "expr": "0"})
        for state in hfsm.reactions:
            xml.add(
                "data",
                {
                    "id": f"since_{state.reaction.event}",
                    "expr": "0",
                    "argo:battery_below": state.reaction.battery_below,
                    "argo:charge_to": state.reaction.charge_to,
                    "argo:charge_for": state.reaction.charge_for,
                },
            )
            xml.add("data", {"id": f"over_{state.reaction.event}", "expr": "0"})


def task_attributes(task: Task) -> Attributes:
    """Return the attributes of a task's state for the program that drives the chart.

    They are in Argo's namespace, such as `argo:action`.
    """
    joints, window, wait = task.joint_states, task.window, task.wait
    joint_states: Attributes = {}
    if joints is not None:
        joint_states = {
            "argo:joint_names": repr(list(joints.names)),
            "argo:joint_positions": repr(list(joints.positions)),
            "argo:joint_velocities": repr(list(joints.velocities)),
            "argo:joint_efforts": repr(list(joints.efforts)),
        }
    return {
        "argo:name": task.name,
        "argo:action": str(task.action),
        "argo:object_id": task.object_id,
        "argo:velocity": task.velocity,
        **_pose_attributes(task.pose),
        **joint_states,
        "argo:reading_limit": task.reading_limit,
        "argo:optional": 1 if task.optional else None,
        "argo:priority": task.priority if task.priority != 1 else None,
        "argo:earliest": None if window is None else window.earliest or None,
        "argo:latest": None if window is None else window.latest,
        "argo:charge_to": None if wait is None else wait.charge_to,
        "argo:charge_for": None if wait is None else wait.charge_for,
    }


def _pose_attributes(pose: Pose | None) -> Attributes:
    if pose is None:
        return {}
    return {f"argo:{axis}": value for axis, value in pose.model_dump().items()}


def write_group_timer_start(xml: XmlWriter, n: int, counts_interruptions: bool) -> None:
    """Write the start of the engine's own timer for the time-out of group `n`.

    The caller writes starts and cancellations at such places of the chart that the timer runs while
    the group is active and the mission is not interrupted. Unless `counts_interruptions`, a start
    adds the time that interruptions took until then to the time-out.
    """
    deadline = f"until_{n}" if counts_interruptions else f"until_{n} + lost"
    _send(xml, f"timeout.g{n}", f"timer_{n}", deadline)


def write_timer_start(xml: XmlWriter, deadline_name: str) -> None:
    """Write the start of the engine's own timer for a deadline of `DEADLINES`.

    The engine starts the timer only if the deadline is set at that time of the run.
    """
    with xml.nest_in("if", {"cond": f"due_{deadline_name} != 0"}):
        _send(xml, f"timeout.{deadline_name}", f"timer_{deadline_name}", f"due_{deadline_name}")


def write_timer_cancel(xml: XmlWriter, deadline: str) -> None:
    """Write the cancellation of the timer that `write_timer_start` starts."""
    xml.add("cancel", {"sendid": f"timer_{deadline}"})


def _send(xml: XmlWriter, event: str, id: str, deadline: str) -> None:
    remaining = f"Math.max(0, {deadline} - now) + 's'"
    with xml.nest_in("send", {"event": event, "id": id, "delayexpr": remaining}):
        xml.add("param", {"name": "time", "expr": f"Math.max(now, {deadline})"})
