"""The ids and the data of an SCXML document."""

from collections.abc import Iterable

from argo_compiler.base.model import Pose
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Action, Condition, Task

ARGO = "urn:argo:mission"
"""The namespace of attributes that say what a state is, for people and for drivers."""

DUES = ("wait", "window", "action", "limit", "hold", "round")
"""What may be due beside groups and the mission: `timeout.wait` at `due_wait`, and so on."""

NEVER = "1000000000000000"
"""s; when the time of a group is up that lies in a round which has not begun"""

_COUNTERS = (
    "now",  # s since the mission's start, of the last event
    "clock",  # the same without interruptions
    "lost",  # s of interruptions, those that are over
    "mode",  # 0 the mission goes on, 1 a reaction drives, 2 all stands still, 3 it ends
    "outcome",  # 0 none yet, else a number of `OUTCOMES`
    "ends",  # 0, else the outcome that the plan has come to
    "failures",  # tasks that are not optional and failed for good
    "count",  # actions wanted so far
    "visit",  # the number of the action that the mission wants, or 0
    "first",  # that of the first one in this visit
    "drive",  # that of the active reaction's drive
    "paused",  # 1 while a person's resume is waited for
    "fails",  # failures of this visit's action
    "completed",  # the group whose round has ended and that has not decided yet, or 0
    "awaits",  # the group whose next round is not due yet, or 0
    "occurred",  # 1 when the event that this visit waits for has occurred
    "look",  # 1 when the conditions that this visit waits for have to be looked at
    "object",  # the object that the mission's task measures, or 0
    "limit",  # s that the action of the mission's task may take, or 0
    "earliest",  # s since the mission's start when it may begin at its place
    "running",  # the number of the running action, or 0
    "running_object",
    "starts",  # actions started so far
    "events",  # events with a reaction so far
    *(f"due_{due}" for due in DUES),  # s since the mission's start, or 0
)


class ActionIds:
    """Short ids by position, as names may hold anything."""

    def __init__(self, hfsm: Hfsm) -> None:
        self.leaves = {leaf.id: f"t{i}" for i, leaf in enumerate(hfsm.leaves, 1)}
        self.groups = {group.id: i for i, group in enumerate(hfsm.composites[1:], 1)}
        self.dues = _dues(hfsm)
        """those of `DUES` that the mission's tasks may have"""
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

    def object_of(self, task: Task) -> int:
        if task.action is not Action.MEASURE or task.object_id is None:
            return 0
        return self.objects[task.object_id]


def _dues(hfsm: Hfsm) -> tuple[str, ...]:
    tasks = [leaf.task for leaf in hfsm.leaves]
    waits = [task.wait for task in tasks if task.wait is not None]
    windows = [task.window for task in tasks if task.window is not None]
    repeats = [group.repeat for group in hfsm.composites if group.repeat is not None]
    found = {
        "wait": bool(waits),
        "window": any(window.hard and window.latest is not None for window in windows),
        "action": any(task.time_limit is not None for task in tasks),
        "limit": any(wait.limit is not None for wait in waits),
        "round": any(repeat.every for repeat in repeats),
    }
    return tuple(due for due in DUES if found.get(due))


def assign(xml: XmlWriter, location: str, expr: str) -> None:
    """Writes an assignment to the data."""
    xml.add("assign", {"location": location, "expr": expr})


def data_model(xml: XmlWriter, hfsm: Hfsm, ids: ActionIds) -> None:
    """Writes the data with what it holds at the beginning."""
    with xml.element("datamodel"):
        for name in _COUNTERS:
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
                },
            )
            xml.add("data", {"id": f"over_{state.reaction.event}", "expr": "0"})


def task_attributes(task: Task) -> Attributes:
    """What a driver has to know of a task, in Argo's namespace."""
    joints, window = task.joint_states, task.window
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
    }


def _pose_attributes(pose: Pose | None) -> Attributes:
    if pose is None:
        return {}
    return {f"argo:{axis}": value for axis, value in pose.model_dump().items()}


def send_time_out(xml: XmlWriter, n: int, counts_interruptions: bool) -> None:
    """The engine's own timer for a group that is active while the mission goes on."""
    up = f"until_{n}" if counts_interruptions else f"until_{n} + lost"
    _send(xml, f"timeout.g{n}", f"timer_{n}", up)


def send_due(xml: XmlWriter, due: str) -> None:
    """The engine's own timer for one of `DUES`, if it is due at all."""
    with xml.element("if", {"cond": f"due_{due} != 0"}):
        _send(xml, f"timeout.{due}", f"timer_{due}", f"due_{due}")


def cancel_due(xml: XmlWriter, due: str) -> None:
    """Stops that timer."""
    xml.add("cancel", {"sendid": f"timer_{due}"})


def _send(xml: XmlWriter, event: str, id: str, up: str) -> None:
    left = f"Math.max(0, {up} - now) + 's'"
    with xml.element("send", {"event": event, "id": id, "delayexpr": left}):
        xml.add("param", {"name": "time", "expr": f"Math.max(now, {up})"})
