"""Edits of a mission's groups: wrap tasks into a group, dissolve, rename or change a group.

The full name of a group is the name of the group around it, a `/`, and its own name; an edit that
changes the nesting also changes the names.
"""

from collections.abc import Iterable, Mapping
from typing import TypedDict, Unpack

from pydantic import ValidationError

from argo_compiler.base.message import Message
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, checked_edit_result
from argo_compiler.editing.draft import DraftGroup, DraftTask, MissionDraft
from argo_compiler.editing.errors import (
    EditInvalid,
    conflict,
    invalid,
    name_taken,
    require_kind,
    require_name,
)
from argo_compiler.editing.header import invalid_value_diagnostics, require_known_fields
from argo_compiler.il import Action, Condition, Group, Mission, Stop
from argo_compiler.il.grouping import parent_name
from argo_compiler.il.transitions import default_target


class GroupFields(TypedDict, total=False):
    """Fields of a group that an edit can change; see `Group`."""

    start: str
    end: str
    max_repeat_count: int
    max_repeat_duration: float
    count_interruptions: bool
    stop: Stop
    every: float
    until: tuple[Condition, ...]


def wrap_tasks(mission: Mission, group: Group) -> Edited:
    """Add a group around the tasks from the group's start to its end.

    Groups inside the new group get its name as a prefix; if it is inside another group, it gets
    that group's name as a prefix. If a group has the same tasks, the new group becomes the outer
    one, unless its name starts with the other group's name.

    Raises:
        EditNotFound: its start or end is not a task.
        EditConflict: it would overlap another group, its name is taken, START is among its tasks,
            or it would never end.
        EditInvalid: its end comes before its start, or its name can't be a group's name.
    """
    require_kind(group, Group, Message("the group"))
    draft = MissionDraft(mission)
    new = _draft_group(draft, group)
    ranges = _TaskRanges(draft)
    inner: list[str] = []
    parent: str | None = None
    for g in draft.groups:
        name = g.group.name
        relation = ranges.relation(g, new)
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
    return _with_renamed_groups(draft, renamed, requested=full)


def dissolve_group(mission: Mission, name: str) -> Edited:
    """Remove a group; its tasks stay, and groups in it move one level up, also in their names.

    Raises EditNotFound, or EditConflict if a group in it would get a name that is taken.
    """
    draft = MissionDraft(mission)
    dissolved = draft.find_group(name)
    outer = parent_name(name)
    prefix = "" if outer is None else f"{outer}/"
    inner = [g.group.name for g in draft.groups if g.group.name.startswith(f"{name}/")]
    renamed = {old: prefix + old.removeprefix(f"{name}/") for old in inner}
    draft.groups.remove(dissolved)
    _require_free(mission, renamed.values(), without=(*renamed, name))
    return _with_renamed_groups(draft, renamed, requested=name)


def rename_group(mission: Mission, name: str, own_name: str) -> Edited:
    """Rename a group, and with it the groups inside it.

    `own_name` may have the name of the group around it as a prefix, or not.

    Raises EditNotFound, EditConflict if the name is taken, EditInvalid if it can't be a group's
    name.
    """
    draft = MissionDraft(mission)
    draft.find_group(name)
    if own_name != "":
        require_name(Message("group '{name}'", name=name), own_name)
    outer = parent_name(name)
    prefix = "" if outer is None else f"{outer}/"
    own = own_name.removeprefix(prefix)
    _require_own_name(own)
    full = prefix + own
    if full == name:
        return checked_edit_result(mission, mission)
    renamed = {
        old: full + old.removeprefix(name)
        for g in draft.groups
        if (old := g.group.name) == name or old.startswith(f"{name}/")
    }
    _require_free(mission, renamed.values(), without=renamed)
    return _with_renamed_groups(draft, renamed, requested=full)


def change_group(mission: Mission, name: str, **fields: Unpack[GroupFields]) -> Edited:
    """Set fields of a group; fields that are not given stay unchanged.

    The nesting stays: the group's borders can't cross those of another group.

    Raises:
        EditNotFound: there is no such group, or its new start or end is not a task.
        EditConflict: it would overlap another group, START would be among its tasks, it would never
            end, or a round would end too early, because its former last task leads out of it.
        EditInvalid: a value is invalid, or an edit can't change this field.
    """
    draft = MissionDraft(mission)
    changed = draft.find_group(name)
    require_known_fields(fields, GroupFields.__annotations__, Message("a group"))
    try:
        values = Group.model_validate({"name": name, "start": "", "end": "", **fields})
    except ValidationError as error:
        raise EditInvalid(invalid_value_diagnostics(error)) from None
    group = changed.group.model_copy(update={field: getattr(values, field) for field in fields})
    changed.group = group
    if "start" in fields or "end" in fields:
        new = _draft_group(draft, group)
        former_end, changed.first, changed.last = changed.last, new.first, new.last
        ranges = _TaskRanges(draft)
        if former_end is not None:
            ranges.require_end_is_reached(former_end, changed)
        for g in draft.groups:
            if g is not changed:
                _require_nesting_stays(g, changed, ranges.relation(g, changed))
    return checked_edit_result(
        mission, draft.mission(), requested=frozenset([subject_of("groups", name)])
    )


# ---- ranges


class _TaskRanges:
    """Ranges of a draft's groups in its list of tasks."""

    def __init__(self, draft: MissionDraft) -> None:
        self.names = [entry.task.name for entry in draft.tasks]
        self.position = draft.positions_by_entry_id()

    def relation(self, g: DraftGroup, new: DraftGroup) -> str:
        """Return how group `g` lies to `new`: "inside", "around", "apart" or "same" (same tasks).

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

    def require_end_is_reached(self, former_end: DraftTask, changed: DraftGroup) -> None:
        """Raise EditConflict if a round would not get from the former last task to the new end.

        That is so if the unconditional transition of `former_end` does not lead to a later task of
        the changed group.
        """
        first, last = self._range(changed)
        at = self.position[id(former_end)]
        if not first <= at < last:
            return
        target = default_target(former_end.task)
        if target in self.names[at + 1 : last + 1]:
            return
        name, end = former_end.task.name, changed.group.end
        leads = (
            Message("ends the mission")
            if target is None
            else Message("leads to '{target}'", target=target)
        )
        following = self.names[at + 1]
        raise conflict(
            "edit.ends-round",
            Message(
                "group '{group}' ends with '{name}', which {leads}: a round would never "
                "reach '{end}'",
                group=changed.group.name,
                name=name,
                leads=leads,
                end=end,
            ),
            Message(
                "lead '{name}' to '{following}' first, and '{end}' to the task after the group",
                name=name,
                following=following,
                end=end,
            ),
            subject_of("tasks", name),
        )

    def _range(self, g: DraftGroup) -> tuple[int, int]:
        if g.first is None or g.last is None:
            return (-1, -1)
        return self.position[id(g.first)], self.position[id(g.last)]


def _overlap(other: Group, group: Group) -> Exception:
    return conflict(
        "edit.group-overlap",
        Message(
            "the tasks from '{start}' to '{end}' and those of group '{other}', from "
            "'{start_2}' to '{end_2}', overlap",
            start=group.start,
            end=group.end,
            other=other.name,
            start_2=other.start,
            end_2=other.end,
        ),
        Message("nest one in the other, or dissolve group '{other}' first", other=other.name),
        subject_of("groups", other.name),
    )


def _require_nesting_stays(g: DraftGroup, changed: DraftGroup, relation: str) -> None:
    """Raise EditConflict if the position of `g` to `changed` contradicts their names.

    `relation` is the result of `_TaskRanges.relation`. A group's name says which group it is in.
    """
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


def _draft_group(draft: MissionDraft, group: Group) -> DraftGroup:
    first, last = draft.find(group.start), draft.find(group.end)
    entry: DraftTask | None = first
    while entry is not None:
        if entry.task.action is Action.START:
            raise conflict(
                "edit.start-in-group",
                Message(
                    "the START task '{task}' would be in group '{group}'",
                    task=entry.task.name,
                    group=group.name,
                ),
                "move START before the group: START can't be repeated",
                subject_of("tasks", entry.task.name),
            )
        if entry is last:
            return DraftGroup(group, first, last)
        entry = entry.after
    message = Message("task '{end}' comes before task '{start}'", end=group.end, start=group.start)
    raise invalid("edit.group-order", message, "swap the group's start and end, or move a task")


# ---- names


def _require_own_name(own: str) -> None:
    if not own or "/" in own:
        raise invalid(
            "edit.group-name",
            Message("'{own}' can't be a group's own name", own=own),
            "give it a name without `/`: the name of the group around it is added as a prefix",
        )


def _require_free(mission: Mission, names: Iterable[str], without: Iterable[str]) -> None:
    taken = {g.name for g in mission.groups}.difference(without)
    for name in names:
        if name in taken:
            raise name_taken("group", name, subject_of("groups", name))


def _with_renamed_groups(draft: MissionDraft, renamed: Mapping[str, str], requested: str) -> Edited:
    """Return the result of an edit after groups are renamed wherever the draft names them.

    `renamed` maps former names to new names; `requested` is the name of the group that the edit is
    about, whose change is no consequence.
    """
    for g in draft.groups:
        name = renamed.get(g.group.name)
        if name is not None:
            g.group = g.group.model_copy(update={"name": name})
    for entry in draft.tasks:
        new_name = renamed.get(entry.task.group)
        if new_name is not None:
            entry.task = entry.task.model_copy(update={"group": new_name})
    after = draft.mission()
    subjects = frozenset([subject_of("groups", requested)])
    return checked_edit_result(draft.original, after, requested=subjects, renamed_groups=renamed)
