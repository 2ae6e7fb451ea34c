"""Edits of a mission's tasks: added, changed, replaced, moved, renamed. `removal` takes them
out."""

from collections.abc import Collection
from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.base.model import Pose
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, edited
from argo_compiler.editing.draft import DraftTask, MissionDraft
from argo_compiler.editing.header import require_fields, wrong_values
from argo_compiler.editing.refusals import (
    EditInvalid,
    invalid,
    name_taken,
    only_one,
    require_kind,
    require_name,
    unknown,
)
from argo_compiler.il import Action, JointState, Mission, OnFailure, Task, TimeWindow, WaitRule
from argo_compiler.il.ways import branches


class TaskFields(TypedDict, total=False):
    """What may be changed of a task; see `Task`."""

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
    """The mission with one more task: before or after another one, `first` of all but START, or
    last.

    A task without transitions goes on with what follows it; one with transitions keeps them as they
    are. What went on with the following task goes on with the new one. At a group's border the task
    stands outside of the group, with `into` it stands in that one. Without a `group` of its own it
    is shown in the group around it.

    Raises:
        EditConflict: there is a task of this name, or the group does not reach to the place.
        EditNotFound: there is no such task or group to put it beside or into, or to lead to.
        EditInvalid: more than one place, or a task that makes no sense.
    """
    require_kind(task, Task, "the task")
    draft = MissionDraft(mission)
    if draft.has_task(task.name):
        raise name_taken("task", task.name, subject_of("tasks", task.name))
    _require_targets(draft.names, task)
    entry = DraftTask(task, goes_on=not task.transitions, shown=draft.nested and not task.group)
    draft.put(entry, _place(draft, before, after, first), into)
    return edited(mission, draft.mission())


def replace_task(mission: Mission, name: str, task: Task) -> Edited:
    """The mission with another task in the place of one, under its own name.

    Without transitions it gets those of the task that it replaces, without a `group` the place
    where that is shown. What named the former task names it.

    Raises EditNotFound, EditConflict and EditInvalid as `add_task` does.
    """
    require_kind(task, Task, "the task")
    draft = MissionDraft(mission)
    entry = draft.find(name)
    if task.name != name:
        if draft.has_task(task.name):
            raise name_taken("task", task.name, subject_of("tasks", task.name))
        draft.rename(entry, task.name)
    _require_targets(draft.names, task)
    if task.transitions:
        entry.goes_on = False
    else:
        task = task.model_copy(update={"transitions": entry.task.transitions})
    if not task.group:
        task = task.model_copy(update={"group": entry.task.group})
    else:
        entry.shown = False
    entry.task = task
    asked = frozenset([subject_of("tasks", task.name)])
    return edited(mission, draft.mission(), asked=asked, tasks=draft.renamed)


def change_task(mission: Mission, name: str, **fields: Unpack[TaskFields]) -> Edited:
    """The mission with other values of a task's fields that are given.

    Raises:
        EditNotFound: there is no such task, or none that is to follow when it has failed.
        EditInvalid: a value that the field can't have, or a field that can't be changed like this.
        EditConflict: the mission does not have what is needed, as a dock to return to.
    """
    # No draft: none of these fields changes where anything stands or leads on.
    known = dict.fromkeys(task.name for task in mission.tasks)
    places = [place for place, task in enumerate(mission.tasks) if task.name == name]
    at = only_one(name, places, known)
    task = mission.tasks[at]
    require_fields(fields, TaskFields.__annotations__, "a task")
    try:
        values = Task.model_validate({"name": name, "action": task.action, **fields})
    except ValidationError as error:
        raise EditInvalid(wrong_values(error)) from None
    _require_targets(known, values)
    changed = task.model_copy(update={field: getattr(values, field) for field in fields})
    tasks = (*mission.tasks[:at], changed, *mission.tasks[at + 1 :])
    after = mission.model_copy(update={"tasks": tasks})
    return edited(mission, after, asked=frozenset([subject_of("tasks", name)]))


def move_task(
    mission: Mission,
    name: str,
    *,
    before: str | None = None,
    after: str | None = None,
    first: bool = False,
    into: str | None = None,
) -> Edited:
    """The mission with a task in another place: before or after another one, `first` or last.

    What went on in the list's order goes on in the new order; a transition that led elsewhere still
    leads there. At a group's border the task stands outside of the group, with `into` it stands in
    that one. The groups that it began or ended begin or end with its neighbour; a group of this
    task alone goes.

    Raises EditNotFound, EditConflict and EditInvalid as `add_task` does.
    """
    draft = MissionDraft(mission)
    entry = draft.find(name)
    if name in (before, after):
        message = f"task '{name}' is to stand before or after itself"
        raise invalid("edit.place", message, "name another task")
    draft.move(entry, _place(draft, before, after, first), into)
    return edited(mission, draft.mission())


def rename_task(mission: Mission, name: str, new_name: str) -> Edited:
    """The mission with another name for a task, wherever the task is named.

    Raises EditNotFound, EditConflict if the name is taken, EditInvalid if it can't be a name.
    """
    draft = MissionDraft(mission)
    entry = draft.find(name)
    require_name(f"task '{name}'", new_name)
    if new_name != name:
        if draft.has_task(new_name):
            raise name_taken("task", new_name, subject_of("tasks", new_name))
        draft.rename(entry, new_name)
    return edited(mission, draft.mission(), tasks=draft.renamed)


def _place(
    draft: MissionDraft, before: str | None, after: str | None, first: bool
) -> DraftTask | None:
    """The task behind which something is put; None: it is put before all."""
    if (before is not None) + (after is not None) + first > 1:
        message = "more than one of `before`, `after` and `first` says where the task is to stand"
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
    for target in (*(way.target for way in task.transitions), *branches(task).values()):
        if target != task.name and target not in known:
            raise unknown("task", target, known)
