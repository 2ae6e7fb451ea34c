"""Edits of a mission's tasks: add, replace, change, move and rename; `removal` removes them."""

from collections.abc import Collection
from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.base.message import Message
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, checked_edit_result
from argo_compiler.editing.draft import DraftTask, MissionDraft
from argo_compiler.editing.errors import (
    EditInvalid,
    invalid,
    name_taken,
    require_kind,
    require_name,
    require_single_position,
    unknown,
)
from argo_compiler.editing.header import invalid_value_diagnostics, require_known_fields
from argo_compiler.il import Action, JointState, Mission, OnFailure, Task, TimeWindow, WaitRule
from argo_compiler.il.transitions import failure_targets_by_field


class TaskFields(TypedDict, total=False):
    """Fields of a task that an edit can change; see `Task`."""

    object_id: str | None
    pose: Pose | None
    wait: WaitRule | None
    velocity: float | None
    joint_states: JointState | None
    retries: int
    on_failure: OnFailure
    failure_target: str | None
    time_limit: float | None
    reading_limit: float | None
    optional: bool
    priority: int
    window: TimeWindow | None


def add_task(
    mission: Mission,
    task: Task,
    *,
    before: str | None = None,
    after: str | None = None,
    first: bool = False,
    into: str | None = None,
) -> Edited:
    """Add a task: before or after another one, `first` of all but START, or last.

    A task without transitions leads to the next task of the list; one with transitions keeps them.
    If the unconditional transition of the task before it led to the next task of the list, it now
    leads to the new one. At a group's border the task is outside of the group; with `into` it is in
    that group. Without a `group` of its own it is displayed in the group around it.

    Raises:
        EditConflict: a task of this name exists, or the group does not extend to this position.
        EditNotFound: the task that it is placed next to or leads to does not exist, or the group.
        EditInvalid: more than one position is given, or the task is invalid for every mission.
    """
    require_kind(task, Task, Message("the task"))
    draft = MissionDraft(mission)
    if draft.has_task(task.name):
        raise name_taken("task", task.name, subject_of("tasks", task.name))
    _require_targets(draft.names, task)
    entry = DraftTask(
        task,
        leads_to_next=not task.transitions,
        shown_in_group=draft.names_match_nesting and not task.group,
    )
    draft.insert(entry, _anchor(draft, before, after, first), into)
    return checked_edit_result(mission, draft.mission())


def replace_task(mission: Mission, name: str, task: Task) -> Edited:
    """Replace a task by another one, which may have another name.

    If the new task has no transitions, it gets those of the replaced task; if it has no `group`, it
    is displayed where the replaced task was. References to the replaced task name the new one.

    Raises EditNotFound, EditConflict and EditInvalid as `add_task` does.
    """
    require_kind(task, Task, Message("the task"))
    draft = MissionDraft(mission)
    entry = draft.find(name)
    if task.name != name:
        if draft.has_task(task.name):
            raise name_taken("task", task.name, subject_of("tasks", task.name))
        draft.rename_with_references(entry, task.name)
    _require_targets(draft.names, task)
    if task.transitions:
        entry.leads_to_next = False
    else:
        task = task.model_copy(update={"transitions": entry.task.transitions})
    if not task.group:
        task = task.model_copy(update={"group": entry.task.group})
    else:
        entry.shown_in_group = False
    entry.task = task
    requested = frozenset([subject_of("tasks", task.name)])
    return checked_edit_result(
        mission, draft.mission(), requested=requested, renamed_tasks=draft.new_names
    )


def change_task(mission: Mission, name: str, **fields: Unpack[TaskFields]) -> Edited:
    """Set fields of a task; fields that are not given stay unchanged.

    Raises:
        EditNotFound: there is no such task, or a new target of its failure or window is missing.
        EditInvalid: a value is invalid, or this edit can't change the field.
        EditConflict: the mission lacks what the task needs, such as a dock to return to.
    """
    # No draft: none of these fields changes the order of tasks or a transition.
    known = dict.fromkeys(task.name for task in mission.tasks)
    positions = [i for i, task in enumerate(mission.tasks) if task.name == name]
    at = require_single_position(name, positions, known)
    task = mission.tasks[at]
    require_known_fields(fields, TaskFields.__annotations__, Message("a task"))
    try:
        values = Task.model_validate({"name": name, "action": task.action, **fields})
    except ValidationError as error:
        raise EditInvalid(invalid_value_diagnostics(error)) from None
    _require_targets(known, values)
    changed = task.model_copy(update={field: getattr(values, field) for field in fields})
    tasks = (*mission.tasks[:at], changed, *mission.tasks[at + 1 :])
    after = mission.model_copy(update={"tasks": tasks})
    return checked_edit_result(mission, after, requested=frozenset([subject_of("tasks", name)]))


def move_task(
    mission: Mission,
    name: str,
    *,
    before: str | None = None,
    after: str | None = None,
    first: bool = False,
    into: str | None = None,
) -> Edited:
    """Move a task: before or after another one, `first` of all but START, or last.

    An unconditional transition that led to the next task of the list leads to the next one in the
    new order; a transition that led elsewhere still leads there. At a group's border the task is
    outside of the group; with `into` it is in that group. A group that started or ended with it now
    starts or ends with its neighbour; a group of this task alone is removed.

    Raises EditNotFound, EditConflict and EditInvalid as `add_task` does.
    """
    draft = MissionDraft(mission)
    entry = draft.find(name)
    if name in (before, after):
        message = Message("task '{name}' can't be moved before or after itself", name=name)
        raise invalid("edit.place", message, "name another task")
    draft.move(entry, _anchor(draft, before, after, first), into)
    return checked_edit_result(mission, draft.mission())


def rename_task(mission: Mission, name: str, new_name: str) -> Edited:
    """Rename a task wherever it is named.

    Raises EditNotFound, EditConflict if the name is taken, EditInvalid if it can't be a name.
    """
    draft = MissionDraft(mission)
    entry = draft.find(name)
    require_name(Message("task '{name}'", name=name), new_name)
    if new_name != name:
        if draft.has_task(new_name):
            raise name_taken("task", new_name, subject_of("tasks", new_name))
        draft.rename_with_references(entry, new_name)
    return checked_edit_result(mission, draft.mission(), renamed_tasks=draft.new_names)


def _anchor(
    draft: MissionDraft, before: str | None, after: str | None, first: bool
) -> DraftTask | None:
    """Return the task behind which a task is inserted, or None for the start of the list."""
    if (before is not None) + (after is not None) + first > 1:
        message = Message(
            "more than one of `before`, `after` and `first` is given for the task's position"
        )
        raise invalid("edit.place", message, "keep one of them")
    if after is not None:
        return draft.find(after)
    if before is not None:
        return draft.find(before).before
    if first:
        for entry in draft.tasks:
            if entry.task.action is not Action.START:
                return entry.before
    return draft.tasks.last


def _require_targets(known: Collection[str], task: Task) -> None:
    for target in (
        *(transition.target for transition in task.transitions),
        *failure_targets_by_field(task).values(),
    ):
        if target != task.name and target not in known:
            raise unknown("task", target, known)
