"""Migration of mission files of older versions: fields they lacked, and meanings that changed."""

from collections.abc import Iterator
from typing import Any

from argo_compiler.base.listing import brief_quoted_list
from argo_compiler.base.message import Message
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.files.json_places import JsonPath
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    EventKind,
    Mission,
    Mode,
    OnFailure,
    Response,
    Task,
)
from argo_compiler.il.velocities import departure_to_approach_velocities

VERSION = 4
"""Version of the mission format that Argo writes."""

_FIELDS_OF_3 = {
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
"""Fields that were added in version 3, by list of the mission."""
_CHARGING_FIELDS = ("charge_to", "charge_for")
"""Fields of reactions and waits that were added in version 4."""


def copy_with_current_version(data: dict[str, Any]) -> tuple[dict[str, Any], int]:
    """Return the data with the current version in a copy, and the version that they had.

    All fields of older versions exist in the current one. After the data have become a mission,
    `newer_fields` finds fields that the older version did not have, and `upgrade` restores the
    meaning of the others. Data without a version, or of an unknown one, are returned unchanged,
    with the current version as the second result.
    """
    version = data.get("version", VERSION)
    if isinstance(version, bool) or version not in range(1, VERSION):
        return data, VERSION
    return {**data, "version": VERSION}, int(version)


def newer_fields(mission: Mission, version: int) -> Iterator[tuple[JsonPath, str]]:
    """Yield path and name of each non-default field that is newer than `version`.

    This includes the `action` of WAIT tasks, with the name `WAIT`, and the `type` of conditions
    that are newer, with the name of the type.
    """
    if version < 3:
        yield from _fields_newer_than_2(mission)
    if version < VERSION:
        yield from _fields_newer_than_3(mission)


def _fields_newer_than_2(mission: Mission) -> Iterator[tuple[JsonPath, str]]:
    for name, new_fields in _FIELDS_OF_3.items():
        for i, part in enumerate(getattr(mission, name)):
            for field in new_fields:
                if getattr(part, field) != type(part).model_fields[field].default:
                    yield (name, i, field), field
    if mission.before:
        yield ("before",), "before"
    for i, task in enumerate(mission.tasks):
        if task.action is Action.WAIT:
            yield ("tasks", i, "action"), "WAIT"


def _fields_newer_than_3(mission: Mission) -> Iterator[tuple[JsonPath, str]]:
    waits = [(("tasks", i, "wait"), t.wait) for i, t in enumerate(mission.tasks) if t.wait]
    reactions = [(("reactions", i), reaction) for i, reaction in enumerate(mission.reactions)]
    for path, part in (*waits, *reactions):
        for field in _CHARGING_FIELDS:
            if getattr(part, field) is not None:
                yield (*path, field), field
    for path, condition in _conditions(mission):
        if condition.type is ConditionType.UNREACHABLE:
            yield (*path, "type"), condition.type


def _conditions(mission: Mission) -> Iterator[tuple[JsonPath, Condition]]:
    """Yield path and condition of each condition of the mission."""
    for i, task in enumerate(mission.tasks):
        for k, transition in enumerate(task.transitions):
            for c, condition in enumerate(transition.conditions):
                yield ("tasks", i, "transitions", k, "conditions", c), condition
        for c, condition in enumerate(task.wait.conditions if task.wait else ()):
            yield ("tasks", i, "wait", "conditions", c), condition
    for i, group in enumerate(mission.groups):
        for c, condition in enumerate(group.until):
            yield ("groups", i, "until", c), condition


def upgrade(mission: Mission, version: int) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """Return a mission with the meaning that its data had in an older version, and warnings.

    The warnings name meanings that the current version can't express. Version 2 added reactions,
    failure policies, the dock and inclusive bounds; a mission without these means the same in
    versions 1 and 2. Version 4 added the levels to which a battery is charged, and unreachable
    readings; a mission of version 3 means the same in it.
    """
    return _to_3(mission) if version < 3 else (mission, ())


def _to_3(mission: Mission) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """Return a mission of version 1 or 2 as one of version 3 that means the same, and warnings.

    New in version 3: a velocity applies to the path to its task, not to the path to the next one;
    the poses of a MEASURE and of a RETURN reaction are used; and a reaction without a priority gets
    its rank from its event. So velocities are moved, these poses are removed, and missing
    priorities become 0.
    """
    warnings = tuple(_changes(mission))
    mission, differ = departure_to_approach_velocities(mission)
    if differ:
        warnings = (*warnings, _velocity_warning(differ))
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
    return mission.model_copy(update={"tasks": tasks, "reactions": reactions}), warnings


def _changes(mission: Mission) -> Iterator[Diagnostic]:
    """Yield a warning for each part of an older mission that means something else now."""
    compared = {c.object_id for task in mission.tasks for t in task.transitions
                 for c in t.conditions}  # fmt: skip
    failing = [
        task.name
        for task in mission.tasks
        if task.action is Action.MEASURE
        and task.object_id in compared
        and task.on_failure is OnFailure.CONTINUE
    ]
    if failing:
        yield diagnostic_of(
            "file.meaning-changed",
            Message(
                "if {failing} fails, conditions no longer use the value of an earlier measurement",
                failing=brief_quoted_list(failing),
            ),
            "add a transition with a READING_FAILED condition, or a `failure_target`, for this "
            "case",
            "tasks",
        )
    interrupting = [r for r in mission.reactions if r.response is not Response.REPORT]
    for reaction in interrupting:
        safety = reaction.response is Response.ABORT or reaction.event is EventKind.EMERGENCY_STOP
        others = (r.priority or 0 for r in interrupting if r is not reaction)
        if safety and any(priority >= (reaction.priority or 0) for priority in others):
            yield diagnostic_of(
                "file.meaning-changed",
                Message(
                    "the reaction to {event} now comes before all others, regardless of their "
                    "priorities",
                    event=reaction.event,
                ),
                "if that is intended, change nothing",
                f"reactions['{reaction.event}']",
            )
    if mission.mode is Mode.SUPERVISORY:
        yield diagnostic_of(
            "file.meaning-changed",
            "a mission in supervisory mode now starts paused, until a person resumes it",
            "set `mode` to autonomous if the mission must start by itself",
            "mode",
        )
    if with_pose := [task.name for task in mission.tasks if _has_own_pose(task)]:
        yield diagnostic_of(
            "file.meaning-changed",
            Message(
                "the pose of {with_pose} was never used, and has been removed",
                with_pose=brief_quoted_list(with_pose),
            ),
            "set it again if the robot must measure from that pose",
            "tasks",
        )


def _has_own_pose(task: Task) -> bool:
    return task.action is Action.MEASURE and task.pose is not None


def _velocity_warning(differ: tuple[str, ...]) -> Diagnostic:
    return diagnostic_of(
        "file.meaning-changed",
        Message(
            "the velocity of the path to {differ} depended on the previous task; it is "
            "now the lowest of these velocities",
            differ=brief_quoted_list(differ),
        ),
        Message(
            "a velocity now applies to the path to its task, from wherever the robot "
            "comes: save the mission as version {version}, and set `velocity` of the "
            "task",
            version=VERSION,
        ),
        "tasks",
    )
