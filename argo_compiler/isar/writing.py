"""Missions become isar's definitions, where what the robot does can be said as a fixed order."""

import json
from collections.abc import Iterator, Mapping
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from argo_compiler.base.model import Model, Pose
from argo_compiler.base.quaternions import to_quaternion
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.export.exporter import raise_refusals, refusal
from argo_compiler.hfsm import ActionSucceeded, Executor, Hfsm, StartAction
from argo_compiler.il import Action, Mission, Mode, OnFailure, Task
from argo_compiler.isar.definition import FRAME, IMAGE
from argo_compiler.isar.recognition import INSPECTION, RETURN_TO_HOME

MAX_TASKS = 10_000
"""of the definition, rounds unrolled"""


class InspectionView(Model):
    """How a checkpoint is inspected: from where, which point, and its name for people."""

    pose: Pose
    target: tuple[float, float, float]
    """m, in the site's frame"""
    name: str = ""


def to_isar(mission: Mission, hfsm: Hfsm, views: Mapping[str, InspectionView]) -> str:
    """The definition as JSON: the inspections in the order in which the machine does them.

    `views` holds the site's checkpoints by their `object_id`; a MEASURE with a pose is inspected
    from there. Groups with a count are unrolled.

    Raises DiagnosticError with a diagnostic for all that isar can't say.
    """
    raise_refusals(_unsaid(mission))
    tasks = _in_order(hfsm)
    raise_refusals(_unplaced(mission, tasks, views))
    names: set[str] = set()
    definition: dict[str, Any] = {
        # Made from the mission, so that equal missions are equal files.
        "id": str(uuid5(NAMESPACE_URL, f"argo:{mission.model_dump_json()}")),
        "name": mission.designation or "Argo",
        "tasks": [_task(task, _unique(task.name, names), views) for task in tasks],
    }
    start = next((t.pose for t in mission.tasks if t.action is Action.START and t.pose), None)
    if start:
        definition["start_pose"] = _pose(start)
    return json.dumps(definition, indent=2, ensure_ascii=False) + "\n"


def _unsaid(mission: Mission) -> Iterator[Diagnostic]:
    """All that changes what the robot does and has no place in a definition."""
    if mission.mode is Mode.SUPERVISORY:
        yield refusal("isar-mode", "isar has no supervisory missions", "plan it as autonomous")
    for task in mission.tasks:
        for field, given in (
            ("conditions", any(transition.conditions for transition in task.transitions)),
            ("retries", task.retries > 0),
            ("a failure policy", task.on_failure is not OnFailure.CONTINUE),
            ("a velocity", task.velocity is not None),
            ("joint states", task.joint_states is not None),
            ("a limit of time", task.time_limit is not None),
            ("a limit for its reading", task.reading_limit is not None),
            ("a window", task.window is not None),
            ("a wait", task.wait is not None and task.wait.duration != 0),
        ):
            if given:
                yield refusal(
                    "isar-task",
                    f"task '{task.name}' has {field}, which isar's tasks have not",
                    "remove it, or export to a format that has it",
                    task.source,
                )
    for group in mission.groups:
        how = (
            ("for a time", group.max_repeat_duration > 0),
            ("at set times", group.every > 0),
            ("until its conditions hold", bool(group.until)),
        )
        for words in (words for words, given in how if given):
            yield refusal(
                "isar-group",
                f"group '{group.name}' is repeated {words}; isar repeats nothing, and only a "
                "number of rounds can be written out",
                "leave that out, and limit it by max_repeat_count",
                group.source,
            )
    for reaction in mission.reactions:
        yield refusal(
            "isar-reaction",
            f"the reaction to {reaction.event} has no place in isar's missions",
            "remove it; isar's own state machine reacts",
            reaction.source,
        )


def _in_order(hfsm: Hfsm) -> tuple[Task, ...]:
    """What the machine does if every action succeeds, as it does without conditions and times."""
    executor = Executor(hfsm)
    commands = executor.start(0.0)
    done: list[Task] = []
    while commands:
        (command,) = commands
        assert isinstance(command, StartAction)
        done.append(command.task)
        if len(done) > MAX_TASKS:
            raise_refusals(
                [
                    refusal(
                        "isar-endless",
                        f"the mission has more than {MAX_TASKS} tasks, rounds written out",
                        "limit its groups, or lead no transition back",
                    )
                ]
            )
        commands = executor.handle(ActionSucceeded(command.task.name), 0.0)
    return tuple(done)


def _unplaced(
    mission: Mission, tasks: tuple[Task, ...], views: Mapping[str, InspectionView]
) -> Iterator[Diagnostic]:
    if not tasks:
        yield refusal("isar-empty", "isar has no missions without tasks", "measure something")
    seen: set[str] = set()
    for index, task in enumerate(tasks):
        if task.name in seen:
            continue
        seen.add(task.name)
        docks = mission.end_area is not None or task.pose == mission.dock
        home = index == len(tasks) - 1 and docks
        if task.action is Action.WAYPOINT and not home:
            yield refusal(
                "isar-waypoint",
                f"task '{task.name}' only drives; isar's tasks are inspections, and as the last "
                "one the way to the dock",
                "remove it, or measure a checkpoint there",
                task.source,
            )
        elif task.action is Action.MEASURE and task.object_id not in views:
            yield refusal(
                "isar-no-target",
                f"where checkpoint '{task.object_id}' of task '{task.name}' is, is not known, "
                "and isar needs a point to look at",
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
    """The name, with the number of its round where it has been used; isar's ids are unique."""
    unique, round = name, 1
    while unique in names:
        round += 1
        unique = f"{name} ({round})"
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
