"""The ids and the data of an SCXML document."""

from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Hfsm
from argo_compiler.il import Action, Task
from argo_compiler.model import Pose

ARGO = "urn:argo:mission"
"""The namespace of attributes that say what a state is, for people and for drivers."""

_COUNTERS = (
    "now",  # s since the mission's start, of the last event
    "clock",  # the same without interruptions
    "lost",  # s of interruptions, those that are over
    "mode",  # 0 the mission goes on, 1 a reaction drives, 2 all stands still, 3 it ends
    "outcome",  # 0 none yet, else a number of `OUTCOMES`
    "count",  # visits of states with actions so far
    "visit",  # the number of the mission's visit that wants its action, or 0
    "visits",  # of the mission's tasks so far
    "drive",  # the number of the reaction's visit that wants its drive, or 0
    "paused",  # 1 while a person's resume is waited for
    "done",  # 1 when the mission's last task has ended
    "fails",  # failures of this visit's action
    "completed",  # the group whose round has ended and that has not decided yet, or 0
    "object",  # the object that the mission's task measures, or 0
    "running",  # the visit that the running action serves, or 0
    "running_object",
    "starts",  # actions started so far
    "events",  # events with a reaction so far
)


class ActionIds:
    """Short ids by position, as names may hold anything."""

    def __init__(self, hfsm: Hfsm) -> None:
        self.leaves = {leaf.id: f"t{i}" for i, leaf in enumerate(hfsm.leaves, 1)}
        self.groups = {group.id: i for i, group in enumerate(hfsm.composites[1:], 1)}
        self.objects: dict[str, int] = {}
        for leaf in hfsm.leaves:
            if leaf.task.object_id is not None:
                self._number(leaf.task.object_id)
        for transition in hfsm.transitions():
            for condition in transition.conditions:
                self._number(condition.object_id)

    def _number(self, object_id: str) -> None:
        self.objects.setdefault(object_id, len(self.objects) + 1)

    def object_of(self, task: Task) -> int:
        if task.action is not Action.MEASURE or task.object_id is None:
            return 0
        return self.objects[task.object_id]


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
        for object_id, k in ids.objects.items():
            xml.add("data", {"id": f"known_{k}", "expr": "0", "argo:object_id": object_id})
            xml.add("data", {"id": f"value_{k}", "expr": "0"})
            xml.add("data", {"id": f"time_{k}", "expr": "0"})
        for state in hfsm.reactions:
            xml.add("data", {"id": f"since_{state.reaction.event}", "expr": "0"})
            xml.add("data", {"id": f"over_{state.reaction.event}", "expr": "0"})


def task_attributes(task: Task) -> Attributes:
    """What a driver has to know of a task, in Argo's namespace."""
    joints = task.joint_states
    return {
        "argo:name": task.name,
        "argo:action": str(task.action),
        "argo:object_id": task.object_id,
        "argo:velocity": task.velocity,
        **_pose_attributes(task.pose),
        "argo:joint_names": None if joints is None else repr(list(joints.names)),
        "argo:joint_positions": None if joints is None else repr(list(joints.positions)),
    }


def _pose_attributes(pose: Pose | None) -> Attributes:
    if pose is None:
        return {}
    return {f"argo:{axis}": value for axis, value in pose.model_dump().items()}


def send_time_out(xml: XmlWriter, n: int, counts_interruptions: bool) -> None:
    """The engine's own timer for a group that is active while the mission goes on."""
    up = f"until_{n}" if counts_interruptions else f"until_{n} + lost"
    left = f"Math.max(0, {up} - now) + 's'"
    with xml.element("send", {"event": f"timeout.g{n}", "id": f"timer_{n}", "delayexpr": left}):
        xml.add("param", {"name": "time", "expr": f"Math.max(now, {up})"})
