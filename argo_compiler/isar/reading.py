"""isar's definitions become missions."""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from pydantic import ValidationError

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.base.quaternions import to_yaw
from argo_compiler.diagnostics import Diagnostic, DiagnosticError, diagnostic_of, has_errors
from argo_compiler.files.json_places import format_path
from argo_compiler.il import Action, Mission, Task, Transition
from argo_compiler.isar.definition import (
    FRAME,
    IMAGE,
    MissionDefinition,
    Part,
    RobotPose,
    TaskDefinition,
)
from argo_compiler.isar.recognition import RETURN_TO_HOME, WRAPPED, find_definition

_START = "START"


@dataclass(frozen=True)
class Imported:
    """A mission, and warnings about what it could not take over."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...]


def read_isar(content: bytes, source_name: str, catalog: Catalog | None = None) -> Imported | None:
    """The mission of a file with an isar definition; None if it is no such file.

    Raises DiagnosticError as `from_isar` does.
    """
    data = find_definition(content)
    return None if data is None else from_isar(data, source_name, catalog)


def from_isar(data: Any, source_name: str, catalog: Catalog | None = None) -> Imported:
    """The mission of a definition: a MEASURE for each image, in order, by the tag of the equipment.

    A tag is a checkpoint's number, or its name where a catalogue is given. The robot's pose is
    kept, though Argo chooses its own; the target is the site's.

    Raises DiagnosticError for what Argo can't do, with a diagnostic for each.
    """
    definition = data.get(WRAPPED, data) if isinstance(data, dict) else data
    try:
        read = MissionDefinition.model_validate(definition)
    except ValidationError as error:
        diagnostics = [
            diagnostic_of(
                "isar.wrong-field",
                f"{format_path(e['loc']) or 'the mission'}: {e['msg']}",
                "correct the isar mission",
            )
            for e in error.errors(include_url=False)[:100]
        ]
        raise DiagnosticError(source_name, diagnostics) from None
    return _Reader(source_name, catalog).mission(read)


@dataclass
class _Reader:
    """Reads one definition; collects diagnostics on the way."""

    source_name: str
    catalog: Catalog | None
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def mission(self, read: MissionDefinition) -> Imported:
        names = (
            {} if self.catalog is None else {c.name: str(c.id) for c in self.catalog.checkpoints}
        )
        self._warn_of_extras("", read)
        tasks: list[Task] = []
        dock: Pose | None = None
        if read.start_pose:
            pose = self._pose("start_pose", read.start_pose)
            tasks.append(Task(name=_START, action=Action.START, pose=pose))
        used = {task.id for task in read.tasks if task.id} | {_START}
        for index, task in enumerate(read.tasks):
            place = f"tasks[{index}]"
            self._warn_of_extras(place, task)
            name = task.id or _fresh(f"task {index + 1}", used)
            pose = self._pose(f"{place}.pose", task.pose)
            if task.type == RETURN_TO_HOME:
                dock = pose
                self._require(place, pose is not None, "home", "says not where home is in the site")
                tasks.append(Task(name=name, action=Action.WAYPOINT, pose=pose))
            else:
                self._check_inspection(place, task)
                object_id = names.get(task.tag or "", task.tag)
                tasks.append(Task(name=name, action=Action.MEASURE, object_id=object_id, pose=pose))
        if has_errors(self.diagnostics):
            raise DiagnosticError(self.source_name, self.diagnostics)
        linked = [
            task.model_copy(update={"transitions": (Transition(target=following.name),)})
            for task, following in pairwise(tasks)
        ]
        mission = Mission(designation=read.name or "", tasks=(*linked, *tasks[-1:]), dock=dock)
        return Imported(mission, tuple(self.diagnostics))

    def _check_inspection(self, place: str, task: TaskDefinition) -> None:
        inspection = task.inspection
        self._require(place, inspection is not None, "inspection", "has no inspection")
        self._require(
            place, bool(task.tag), "tag", "has no tag: which checkpoint it inspects is not said"
        )
        if task.zoom is not None:
            self._warn(f"{place}.zoom", "is not taken over: Argo does not zoom")
        if inspection:
            self._warn_of_extras(f"{place}.inspection", inspection)
            self._require(
                place,
                inspection.type == IMAGE,
                "inspection-type",
                f"is an inspection of type {inspection.type}; Argo reads checkpoints, in images",
            )

    def _pose(self, place: str, pose: RobotPose) -> Pose | None:
        """The pose in the site's frame, if it is one."""
        frames = {pose.frame_name, pose.position.frame_name, pose.orientation.frame_name}
        if frames != {FRAME}:
            other = ", ".join(sorted(frames - {FRAME}))
            self._warn(place, f"is not taken over: it is in the frame {other}, not in {FRAME}")
            return None
        q, p = pose.orientation, pose.position
        try:
            return Pose(x=p.x, y=p.y, z=p.z, yaw=to_yaw(q.x, q.y, q.z, q.w))
        except ValueError as error:
            self._warn(place, f"is not taken over: the orientation {error}")
            return None

    def _require(self, place: str, given: bool, code: str, message: str) -> None:
        if not given:
            hint = "remove the task, or complete it"
            self.diagnostics.append(diagnostic_of(f"isar.{code}", f"{place}: {message}", hint))

    def _warn_of_extras(self, place: str, part: Part) -> None:
        for name, value in (part.model_extra or {}).items():
            if value is not None:
                self._warn(f"{place}.{name}".removeprefix("."), "is not taken over")

    def _warn(self, place: str, message: str) -> None:
        self.diagnostics.append(diagnostic_of("isar.dropped", f"{place}: {message}"))


def _fresh(name: str, used: set[str]) -> str:
    while name in used:
        name += "'"
    used.add(name)
    return name
