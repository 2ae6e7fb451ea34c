"""Older mission files: what each version of the format lacked, and what it meant otherwise."""

from collections.abc import Iterator
from typing import Any

from argo_compiler.base.listing import quoted
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.files.json_places import JsonPath
from argo_compiler.il import Action, EventKind, Mission, Mode, OnFailure, Response, Task
from argo_compiler.il.velocities import of_ways_there

VERSION = 3
"""of the mission format that is written"""

_NEW = {
    "tasks": (
        "wait",
        "failure_target",
        "time_limit",
        "reading_limit",
        "optional",
        "priority",
        "window",
    ),
    "groups": ("every", "until"),
    "reactions": ("hold_limit", "on_limit", "area", "battery_below"),
}
"""Fields that came with version 3, by list."""


def migrate(data: dict[str, Any]) -> tuple[dict[str, Any], int]:
    """The mission's data as ones of the present version, and which version they are of.

    All fields of older versions are fields of the present one; `fields_of_later` names those that
    they had not, and `updated` makes them mean what they meant. Data of unknown versions stay as
    they are.
    """
    version = data.get("version", VERSION)
    if isinstance(version, bool) or version not in range(1, VERSION):
        return data, VERSION
    return {**data, "version": VERSION}, int(version)


def fields_of_later(mission: Mission, version: int) -> Iterator[tuple[JsonPath, str]]:
    """What a mission that was read from data of an older version has and that version had not: the
    path of each field, and its name."""
    if version >= VERSION:
        return
    for name, new in _NEW.items():
        for i, part in enumerate(getattr(mission, name)):
            for field in new:
                if getattr(part, field) != type(part).model_fields[field].default:
                    yield (name, i, field), field
    if mission.before:
        yield ("before",), "before"
    for i, task in enumerate(mission.tasks):
        if task.action is Action.WAIT:
            yield ("tasks", i, "action"), "WAIT"


def updated(mission: Mission, version: int) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """A mission that was read from data of an older version, as it meant them, and what it can't
    say any more.

    Version 2 added reactions, failure policies, the dock and inclusive bounds; all may be left out,
    and then mean what version 1 meant.
    """
    return _to_3(mission) if version < VERSION else (mission, ())


def _to_3(mission: Mission) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """Version 3 has the velocity of the way to a task, not to the next one; uses the pose of a
    MEASURE and of a RETURN reaction; and ranks reactions by their event if no priority is given."""
    notes = tuple(_changes(mission))
    mission, differ = of_ways_there(mission)
    if differ:
        notes = (*notes, _velocities(differ))
    reactions = tuple(
        reaction.model_copy(
            update={
                "priority": reaction.priority or 0,
                "pose": None if reaction.response is Response.RETURN else reaction.pose,
            }
        )
        for reaction in mission.reactions
    )
    tasks = tuple(
        task.model_copy(update={"pose": None}) if _has_own_pose(task) else task
        for task in mission.tasks
    )
    return mission.model_copy(update={"tasks": tasks, "reactions": reactions}), notes


def _changes(mission: Mission) -> Iterator[Diagnostic]:
    """What does not mean what it meant."""
    looked_at = {c.object_id for task in mission.tasks for t in task.transitions
                 for c in t.conditions}  # fmt: skip
    failing = [
        task.name
        for task in mission.tasks
        if task.action is Action.MEASURE
        and task.object_id in looked_at
        and task.on_failure is OnFailure.CONTINUE
    ]
    if failing:
        yield diagnostic_of(
            "file.meaning-changed",
            f"where {quoted(failing)} fails, conditions do not see the value of an earlier "
            "measurement any more",
            "add a transition with a READING_FAILED condition, or a `failure_target`, for what is "
            "to follow then",
            "tasks",
        )
    interrupting = [r for r in mission.reactions if r.response is not Response.REPORT]
    for reaction in interrupting:
        safety = reaction.response is Response.ABORT or reaction.event is EventKind.EMERGENCY_STOP
        others = (r.priority or 0 for r in interrupting if r is not reaction)
        if safety and any(priority >= (reaction.priority or 0) for priority in others):
            yield diagnostic_of(
                "file.meaning-changed",
                f"the reaction to {reaction.event} comes before all others now, whatever their "
                "priorities",
                "nothing is to be done if that is what was meant",
                f"reactions['{reaction.event}']",
            )
    if mission.mode is Mode.SUPERVISORY:
        yield diagnostic_of(
            "file.meaning-changed",
            "a mission in supervisory mode begins paused now, until a person resumes it",
            "set `mode` to autonomous if it is to begin by itself",
            "mode",
        )
    if posed := [task.name for task in mission.tasks if _has_own_pose(task)]:
        yield diagnostic_of(
            "file.meaning-changed",
            f"the pose of {quoted(posed)} was never used, and is left out",
            "give it again if the robot is to measure from there",
            "tasks",
        )


def _has_own_pose(task: Task) -> bool:
    return task.action is Action.MEASURE and task.pose is not None


def _velocities(differ: tuple[str, ...]) -> Diagnostic:
    return diagnostic_of(
        "file.meaning-changed",
        f"{quoted(differ)} was driven to at different velocities, by where the robot came from; "
        "it is the slowest of them now",
        "a velocity belongs to the way to a task now, wherever the robot comes from: save the "
        f"mission as version {VERSION}, and set `velocity` there",
        "tasks",
    )
