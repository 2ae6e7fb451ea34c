"""Edits of a mission's groups: tasks wrapped into one, a group dissolved or changed.

The full name of a group is that of the group around it, a `/`, and its own; an edit that changes
what lies in what changes the names with it.
"""

from collections.abc import Iterable, Mapping
from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, edited
from argo_compiler.editing.draft import DraftGroup, DraftTask, MissionDraft
from argo_compiler.editing.header import require_fields, wrong_values
from argo_compiler.editing.refusals import (
    EditInvalid,
    conflict,
    invalid,
    name_taken,
    require_kind,
    require_name,
)
from argo_compiler.il import Action, Condition, Group, Mission, Stop
from argo_compiler.il.grouping import parent_name
from argo_compiler.il.ways import default_target


class GroupFields(TypedDict, total=False):
    """What may be changed of a group; see `Group`."""

    start: str
    end: str
    max_repeat_count: int
    max_repeat_duration: float
    count_interruptions: bool
    stop: Stop
    every: float
    until: tuple[Condition, ...]


def wrap_tasks(mission: Mission, group: Group) -> Edited:
    """The mission with one more group, over the tasks from its start to its end.

    Groups that lie in it are renamed to say so, and if it lies in another one, so is the new one.
    Of a group over the same tasks it becomes the outer one, unless its name says otherwise.

    Raises:
        EditNotFound: its start or end is no task.
        EditConflict: it would overlap another group, its name is taken, START is among its tasks,
            or it would never end.
        EditInvalid: its end stands before its start, or its name is no name.
    """
    require_kind(group, Group, "the group")
    draft = MissionDraft(mission)
    new = _drafted(draft, group)
    spans = _Spans(draft)
    inner: list[str] = []
    parent: str | None = None
    for g in draft.groups:
        name = g.group.name
        relation = spans.relation(g, new)
        if relation == "same":
            relation = "around" if group.name.startswith(f"{name}/") else "inside"
        if relation == "inside":
            inner.append(name)
        elif relation == "around" and (parent is None or name.startswith(f"{parent}/")):
            parent = name
    prefix = "" if parent is None else f"{parent}/"
    own = group.name.removeprefix(prefix)
    _require_own_name(own)
    full = prefix + own
    renamed = {name: f"{full}/{name.removeprefix(prefix)}" for name in inner}
    _require_free(mission, (full,), without=())
    _require_free(mission, renamed.values(), without=renamed)
    draft.groups.append(new)
    new.group = new.group.model_copy(update={"name": full})
    return _renamed(draft, renamed, asked=full)


def dissolve_group(mission: Mission, name: str) -> Edited:
    """The mission without a group: its tasks stay, and the groups in it lie where it lay.

    Raises EditNotFound, EditConflict if a group in it would get a name that is taken.
    """
    draft = MissionDraft(mission)
    found = draft.find_group(name)
    outer = parent_name(name)
    prefix = "" if outer is None else f"{outer}/"
    inner = [g.group.name for g in draft.groups if g.group.name.startswith(f"{name}/")]
    renamed = {old: prefix + old.removeprefix(f"{name}/") for old in inner}
    draft.groups.remove(found)
    _require_free(mission, renamed.values(), without=(*renamed, name))
    return _renamed(draft, renamed, asked=name)


def rename_group(mission: Mission, name: str, own_name: str) -> Edited:
    """The mission with another name for a group, and for the groups in it.

    `own_name` is without that of the group around it, or with it.

    Raises EditNotFound, EditConflict if the name is taken, EditInvalid if it is no name.
    """
    draft = MissionDraft(mission)
    draft.find_group(name)
    if own_name != "":
        require_name(f"group '{name}'", own_name)
    outer = parent_name(name)
    prefix = "" if outer is None else f"{outer}/"
    own = own_name.removeprefix(prefix)
    _require_own_name(own)
    full = prefix + own
    if full == name:
        return edited(mission, mission)
    renamed = {
        old: full + old.removeprefix(name)
        for g in draft.groups
        if (old := g.group.name) == name or old.startswith(f"{name}/")
    }
    _require_free(mission, renamed.values(), without=renamed)
    return _renamed(draft, renamed, asked=full)


def change_group(mission: Mission, name: str, **fields: Unpack[GroupFields]) -> Edited:
    """The mission with other values of a group's fields that are given.

    What lies in what stays: its borders can't cross those of another group.

    Raises:
        EditNotFound: there is no such group, or its new start or end is no task.
        EditConflict: it would overlap another group, START would be among its tasks, it would never
            end, or its rounds would, with the task that ends it now and leads out of it.
        EditInvalid: a value that the field can't have.
    """
    draft = MissionDraft(mission)
    found = draft.find_group(name)
    require_fields(fields, GroupFields.__annotations__, "a group")
    try:
        values = Group.model_validate({"name": name, "start": "", "end": "", **fields})
    except ValidationError as error:
        raise EditInvalid(wrong_values(error)) from None
    group = found.group.model_copy(update={field: getattr(values, field) for field in fields})
    found.group = group
    if "start" in fields or "end" in fields:
        new = _drafted(draft, group)
        former, found.first, found.last = found.last, new.first, new.last
        spans = _Spans(draft)
        if former is not None:
            spans.require_way_on(former, found)
        for g in draft.groups:
            if g is not found:
                _require_relation(g, found, spans.relation(g, found))
    return edited(mission, draft.mission(), asked=frozenset([subject_of("groups", name)]))


# ---- ranges


class _Spans:
    """Where the groups of a draft lie in its list of tasks."""

    def __init__(self, draft: MissionDraft) -> None:
        self.names = [entry.task.name for entry in draft.tasks]
        self.position = draft.positions()

    def relation(self, g: DraftGroup, new: DraftGroup) -> str:
        """Where `g` lies: inside of `new`, around it, apart from it, or over the same tasks.

        Raises EditConflict if they overlap in part.
        """
        first, last = self._range(g)
        start, end = self._range(new)
        if last < start or end < first:
            return "apart"
        if (first, last) == (start, end):
            return "same"
        if start <= first and last <= end:
            return "inside"
        if first <= start and end <= last:
            return "around"
        raise _overlap(g.group, new.group)

    def require_way_on(self, former: DraftTask, changed: DraftGroup) -> None:
        """That the task that ended a group does not lead out of it before its new end."""
        first, last = self._range(changed)
        at = self.position[id(former)]
        if not first <= at < last:
            return
        target = default_target(former.task)
        if target in self.names[at + 1 : last + 1]:
            return
        name, end = former.task.name, changed.group.end
        leads = "ends the mission" if target is None else f"leads to '{target}'"
        following = self.names[at + 1]
        raise conflict(
            "edit.ends-round",
            f"group '{changed.group.name}' ends with '{name}', which {leads}: a round would never "
            f"get to '{end}'",
            f"lead '{name}' to '{following}' first, and '{end}' to where the group is to lead",
            subject_of("tasks", name),
        )

    def _range(self, g: DraftGroup) -> tuple[int, int]:
        if g.first is None or g.last is None:
            return (-1, -1)
        return self.position[id(g.first)], self.position[id(g.last)]


def _overlap(other: Group, group: Group) -> Exception:
    return conflict(
        "edit.group-overlap",
        f"the tasks from '{group.start}' to '{group.end}' and those of group '{other.name}', from "
        f"'{other.start}' to '{other.end}', overlap",
        f"let one lie in the other, or dissolve group '{other.name}' first",
        subject_of("groups", other.name),
    )


def _require_relation(g: DraftGroup, changed: DraftGroup, relation: str) -> None:
    """That another group lies where its name says."""
    name, own = g.group.name, changed.group.name
    wanted: tuple[str, ...]
    if name.startswith(f"{own}/"):
        wanted = ("inside", "same")
    elif own.startswith(f"{name}/"):
        wanted = ("around", "same")
    else:
        wanted = ("apart",)
    if relation not in wanted:
        raise _overlap(g.group, changed.group)


def _drafted(draft: MissionDraft, group: Group) -> DraftGroup:
    first, last = draft.find(group.start), draft.find(group.end)
    entry: DraftTask | None = first
    while entry is not None:
        if entry.task.action is Action.START:
            raise conflict(
                "edit.start-in-group",
                f"the START task '{entry.task.name}' would lie in group '{group.name}'",
                "move START before the group: it is not repeated",
                subject_of("tasks", entry.task.name),
            )
        if entry is last:
            return DraftGroup(group, first, last)
        entry = entry.after
    message = f"task '{group.end}' stands before task '{group.start}'"
    raise invalid("edit.group-order", message, "swap the group's start and end, or move a task")


# ---- names


def _require_own_name(own: str) -> None:
    if not own or "/" in own:
        raise invalid(
            "edit.group-name",
            f"'{own}' can't be a group's own name",
            "give it a name without `/`: that of the group around it is put before it",
        )


def _require_free(mission: Mission, names: Iterable[str], without: Iterable[str]) -> None:
    kept = {g.name for g in mission.groups}.difference(without)
    for name in names:
        if name in kept:
            raise name_taken("group", name, subject_of("groups", name))


def _renamed(draft: MissionDraft, renamed: Mapping[str, str], asked: str) -> Edited:
    """The result, with the groups' new names wherever groups are named."""
    for g in draft.groups:
        name = renamed.get(g.group.name)
        if name is not None:
            g.group = g.group.model_copy(update={"name": name})
    for entry in draft.tasks:
        shown = renamed.get(entry.task.group)
        if shown is not None:
            entry.task = entry.task.model_copy(update={"group": shown})
    made = draft.mission()
    subjects = frozenset([subject_of("groups", asked)])
    return edited(draft.before, made, asked=subjects, groups=renamed)
