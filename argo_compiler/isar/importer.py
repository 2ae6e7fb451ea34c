"""Import of isar's definitions as missions."""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

from pydantic import ValidationError

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.message import Listing, Message
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
from argo_compiler.isar.recognition import RETURN_TO_HOME, WRAPPED, find_isar_data

_START = "START"


@dataclass(frozen=True)
class Imported:
    """Imported mission, and warnings about parts of the definition that were ignored."""

    mission: Mission
    diagnostics: tuple[Diagnostic, ...]


def read_isar(content: bytes, source_name: str, catalog: Catalog | None = None) -> Imported | None:
    """Return the mission of a file with an isar definition, or None if the file has none.

    Raises DiagnosticError as `from_isar` does.
    """
    data = find_isar_data(content)
    return None if data is None else from_isar(data, source_name, catalog)


def from_isar(data: Any, source_name: str, catalog: Catalog | None = None) -> Imported:
    """Return the mission of an isar definition: a MEASURE for each image, in the same order.

    Inspections of other types are errors. The tag of the equipment names the checkpoint: it is the
    checkpoint's number; if a catalogue is given, it may also be the checkpoint's name. The robot's
    pose is imported, and the robot measures from it; the target point is not imported, as the site
    has it.

    Raises DiagnosticError with a diagnostic for each part that Argo can't execute.
    """
    definition = data.get(WRAPPED, data) if isinstance(data, dict) else data
    try:
        validated = MissionDefinition.model_validate(definition)
    except ValidationError as error:
        diagnostics = [
            diagnostic_of(
                "isar.wrong-field",
                Message(
                    "{place}: {message}",
                    place=format_path(e["loc"]) or Message("the mission"),
                    message=e["msg"],
                ),
                "correct the isar mission",
            )
            for e in error.errors(include_url=False)[:100]
        ]
        raise DiagnosticError(source_name, diagnostics) from None
    return _Importer(source_name, catalog).mission(validated)


@dataclass
class _Importer:
    """Importer of one definition; collects diagnostics."""

    source_name: str
    catalog: Catalog | None
    diagnostics: list[Diagnostic] = field(default_factory=list)

    def mission(self, definition: MissionDefinition) -> Imported:
        names = (
            {} if self.catalog is None else {c.name: str(c.id) for c in self.catalog.checkpoints}
        )
        self._warn_of_extras("", definition)
        tasks: list[Task] = []
        dock: Pose | None = None
        if definition.start_pose:
            pose = self._pose("start_pose", definition.start_pose)
            tasks.append(Task(name=_START, action=Action.START, pose=pose))
        used = {task.id for task in definition.tasks if task.id} | {_START}
        for index, task in enumerate(definition.tasks):
            path = f"tasks[{index}]"
            self._warn_of_extras(path, task)
            name = task.id or _unused(Message("task {index}", index=index + 1), used)
            pose = self._pose(f"{path}.pose", task.pose)
            if task.type == RETURN_TO_HOME:
                dock = pose
                self._require(
                    path,
                    pose is not None,
                    "home",
                    Message("has no usable pose of the home in the site's frame"),
                )
                tasks.append(Task(name=name, action=Action.WAYPOINT, pose=pose))
            else:
                self._check_inspection(path, task)
                object_id = names.get(task.tag or "", task.tag)
                tasks.append(Task(name=name, action=Action.MEASURE, object_id=object_id, pose=pose))
        if has_errors(self.diagnostics):
            raise DiagnosticError(self.source_name, self.diagnostics)
        linked = [
            task.model_copy(update={"transitions": (Transition(target=following.name),)})
            for task, following in pairwise(tasks)
        ]
        mission = Mission(
            designation=definition.name or "", tasks=(*linked, *tasks[-1:]), dock=dock
        )
        return Imported(mission, tuple(self.diagnostics))

    def _check_inspection(self, path: str, task: TaskDefinition) -> None:
        inspection = task.inspection
        self._require(path, inspection is not None, "inspection", Message("has no inspection"))
        self._require(
            path,
            bool(task.tag),
            "tag",
            Message("has no tag, which names the checkpoint to inspect"),
        )
        if task.zoom is not None:
            self._warn(f"{path}.zoom", Message("is ignored: Argo does not zoom"))
        if inspection:
            self._warn_of_extras(f"{path}.inspection", inspection)
            self._require(
                path,
                inspection.type == IMAGE,
                "inspection-type",
                Message(
                    "is an inspection of type {type}; Argo only reads images", type=inspection.type
                ),
            )

    def _pose(self, path: str, pose: RobotPose) -> Pose | None:
        """Return the robot's pose of the definition's part at `path`, which is for messages.

        If the pose is in another frame than the site's, or its orientation is invalid, add a
        warning and return None.
        """
        frames = {pose.frame_name, pose.position.frame_name, pose.orientation.frame_name}
        if frames != {FRAME}:
            other = Listing(sorted(frames - {FRAME}))
            self._warn(
                path,
                Message(
                    "is ignored: it is in the frame {other}, not in {frame}",
                    other=other,
                    frame=FRAME,
                ),
            )
            return None
        q, p = pose.orientation, pose.position
        try:
            return Pose(x=p.x, y=p.y, z=p.z, yaw=to_yaw(q.x, q.y, q.z, q.w))
        except ValueError as error:
            self._warn(path, Message("is ignored: the orientation {error}", error=error))
            return None

    def _require(self, path: str, is_given: bool, code: str, message: str) -> None:
        if not is_given:
            hint = Message("remove the task, or complete it")
            self.diagnostics.append(
                diagnostic_of(
                    f"isar.{code}", Message("{path} {message}", path=path, message=message), hint
                )
            )

    def _warn_of_extras(self, path: str, part: Part) -> None:
        for name, value in (part.model_extra or {}).items():
            if value is not None:
                self._warn(f"{path}.{name}".removeprefix("."), Message("is ignored"))

    def _warn(self, path: str, message: str) -> None:
        self.diagnostics.append(
            diagnostic_of("isar.dropped", Message("{path} {message}", path=path, message=message))
        )


def _unused(name: str, used: set[str]) -> str:
    while name in used:
        name += "'"
    used.add(name)
    return name
