"""Export of missions as isar's definitions, if the robot's tasks have a fixed order."""

import json
from collections.abc import Iterator, Mapping
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from argo_compiler.base.model import Pose
from argo_compiler.base.quaternions import to_quaternion
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.export.exporter import Exporter, InspectionView, raise_refusals, refusal
from argo_compiler.hfsm import ActionSucceeded, Executor, Hfsm, StartAction
from argo_compiler.il import Action, Mission, Mode, OnFailure, Task
from argo_compiler.isar.definition import FRAME, IMAGE
from argo_compiler.isar.recognition import INSPECTION, RETURN_TO_HOME

MAX_TASKS = 10_000
"""Largest number of tasks in a definition, after the rounds of groups are unrolled."""


def to_isar(mission: Mission, hfsm: Hfsm, views: Mapping[str, InspectionView]) -> str:
    """Return isar's definition as JSON: inspections in the order in which the machine does them.

    `views` contains the site's checkpoints by their `object_id`. If a MEASURE has a pose, that pose
    replaces the pose of the view. Groups with a count are unrolled.

    Raises DiagnosticError with a diagnostic for each part that isar can't express.
    """
    raise_refusals(_feature_refusals(mission))
    tasks = _task_order(hfsm)
    raise_refusals(_task_refusals(mission, tasks, views))
    names: set[str] = set()
    definition: dict[str, Any] = {
        # Computed from the mission, so that equal missions give equal files.
        "id": str(uuid5(NAMESPACE_URL, f"argo:{mission.model_dump_json()}")),
        "name": mission.designation or "Argo",
        "tasks": [_task(task, _unique(task.name, names), views) for task in tasks],
    }
    start = next((t.pose for t in mission.tasks if t.action is Action.START and t.pose), None)
    if start:
        definition["start_pose"] = _pose(start)
    return json.dumps(definition, indent=2, ensure_ascii=False) + "\n"


EXPORTER = Exporter(
    "isar mission definition",
    (".json",),
    lambda given: to_isar(given.mission, given.machine, given.find_views()),
)


def _feature_refusals(mission: Mission) -> Iterator[Diagnostic]:
    """Yield a refusal for each feature that changes the robot's behaviour and that isar lacks."""
    if mission.mode is Mode.SUPERVISORY:
        yield refusal("isar-mode", "isar has no supervisory missions", "set its mode to autonomous")
    for task in mission.tasks:
        for feature, is_used in (
            ("conditions", any(transition.conditions for transition in task.transitions)),
            ("retries", task.retries > 0),
            ("a failure policy", task.on_failure is not OnFailure.CONTINUE),
            ("a velocity", task.velocity is not None),
            ("joint states", task.joint_states is not None),
            ("a time limit", task.time_limit is not None),
            ("a reading limit", task.reading_limit is not None),
            ("a time window", task.window is not None),
            ("a wait", task.wait is not None and task.wait.duration != 0),
        ):
            if is_used:
                yield refusal(
                    "isar-task",
                    f"task '{task.name}' has {feature}, which isar's tasks do not support",
                    "remove this, or export to a format that supports it",
                    task.source,
                )
    for group in mission.groups:
        limits = (
            ("for a duration", group.max_repeat_duration > 0),
            ("at fixed times", group.every > 0),
            ("until its conditions are satisfied", bool(group.until)),
        )
        for words in (words for words, is_used in limits if is_used):
            yield refusal(
                "isar-group",
                f"group '{group.name}' is repeated {words}; isar repeats nothing, and only a fixed "
                "number of rounds can be exported as separate tasks",
                "remove this, and limit the rounds by max_repeat_count",
                group.source,
            )
    for reaction in mission.reactions:
        yield refusal(
            "isar-reaction",
            f"the reaction to {reaction.event} can't be exported: isar has no reactions",
            "remove it; isar's own state machine reacts",
            reaction.source,
        )


def _task_order(hfsm: Hfsm) -> tuple[Task, ...]:
    """Return the tasks in the order in which the machine executes them if all actions succeed.

    The mission must have no conditions and times, so that the machine has no other order.
    """
    executor = Executor(hfsm)
    commands = executor.start(0.0)
    executed: list[Task] = []
    while commands:
        (command,) = commands
        assert isinstance(command, StartAction)
        executed.append(command.task)
        if len(executed) > MAX_TASKS:
            raise_refusals(
                [
                    refusal(
                        "isar-endless",
                        f"the mission has more than {MAX_TASKS} tasks when its rounds are unrolled",
                        "limit the rounds of its groups, and remove transitions that lead back",
                    )
                ]
            )
        commands = executor.handle(ActionSucceeded(command.task.name), 0.0)
    return tuple(executed)


def _task_refusals(
    mission: Mission, tasks: tuple[Task, ...], views: Mapping[str, InspectionView]
) -> Iterator[Diagnostic]:
    """Yield refusals for unknown checkpoints, and for WAYPOINTs other than a last one to the dock.

    A mission without tasks is refused, too.
    """
    if not tasks:
        yield refusal(
            "isar-empty",
            "isar has no missions without tasks",
            "add a task that measures a checkpoint",
        )
    seen: set[str] = set()
    for index, task in enumerate(tasks):
        if task.name in seen:
            continue
        seen.add(task.name)
        leads_to_dock = mission.end_area is not None or task.pose == mission.dock
        is_return = index == len(tasks) - 1 and leads_to_dock
        if task.action is Action.WAYPOINT and not is_return:
            yield refusal(
                "isar-waypoint",
                f"task '{task.name}' only drives to a pose; isar's tasks are inspections, and only "
                "the last task may be a drive to the dock",
                "remove the task, or measure a checkpoint there",
                task.source,
            )
        elif task.action is Action.MEASURE and task.object_id not in views:
            yield refusal(
                "isar-no-target",
                f"the position of checkpoint '{task.object_id}' of task '{task.name}' is not "
                "known, but isar needs a point to look at",
                "export with the site that has the checkpoint",
                task.source,
            )


def _task(task: Task, id: str, views: Mapping[str, InspectionView]) -> dict[str, Any]:
    if task.action is Action.WAYPOINT:
        assert task.pose is not None
        return {"id": id, "type": RETURN_TO_HOME, "pose": _pose(task.pose)}
    assert task.object_id is not None
    view = views[task.object_id]
    inspection = {"type": IMAGE, "inspection_target": _position(*view.target)}
    if view.name:
        inspection["inspection_description"] = view.name
    return {
        "id": id,
        "type": INSPECTION,
        "pose": _pose(task.pose or view.pose),
        "inspection": inspection,
        "tag": task.object_id,
    }


def _unique(name: str, names: set[str]) -> str:
    """Return a name that is not in `names`, with a number if needed, and add it to `names`.

    isar requires unique ids; the second round of a task `A` becomes `A (2)`.
    """
    unique, number = name, 1
    while unique in names:
        number += 1
        unique = f"{name} ({number})"
    names.add(unique)
    return unique


def _pose(pose: Pose) -> dict[str, Any]:
    z, w = to_quaternion(pose.yaw)
    return {
        "position": _position(pose.x, pose.y, pose.z),
        "orientation": {"x": 0.0, "y": 0.0, "z": z, "w": w, "frame_name": FRAME},
        "frame_name": FRAME,
    }


def _position(x: float, y: float, z: float) -> dict[str, Any]:
    return {"x": x, "y": y, "z": z, "frame_name": FRAME}
