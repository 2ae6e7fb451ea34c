"""Mutable form of a mission for edits: tasks and groups refer to tasks by object, not by name."""

from collections.abc import Collection
from dataclasses import dataclass

from argo_compiler.base.message import Message
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.errors import EditConflict, ambiguous, conflict, unknown
from argo_compiler.editing.linked_list import LinkedList, ListItem
from argo_compiler.editing.targets import default_targets, with_default_target, with_renamed_targets
from argo_compiler.il import Action, Group, Mission, Task
from argo_compiler.il.grouping import (
    GroupNesting,
    GroupRange,
    parent_name,
    valid_ranges_parents_first,
)
from argo_compiler.il.transitions import default_target


@dataclass(eq=False, slots=True)
class DraftTask(ListItem):
    """Task of the draft. Mutable."""

    task: Task
    leads_to_next: bool = True
    """whether its unconditional transition leads to the next task of the list, whichever that is;
    if there is none, the mission ends after this task"""
    shown_in_group: bool = False
    """whether it is displayed in the innermost group around it, whichever that is"""


@dataclass(eq=False, slots=True)
class DraftGroup:
    """Group of the draft. Mutable."""

    group: Group
    first: DraftTask | None
    """first task of the group; None if the group's start or end does not exist, or if they are in
    the wrong order: such a group stays unchanged"""
    last: DraftTask | None
    """last task of the group; None in the same cases"""


class MissionDraft:
    """Mutable form of a mission for edits; `mission` returns the result.

    The result shares its unchanged parts with the original mission.
    """

    def __init__(self, mission: Mission) -> None:
        self.original = mission
        self.names_match_nesting = _names_match_nesting(mission)
        self.tasks: LinkedList[DraftTask] = LinkedList()
        self.new_names: dict[str, str] = {}
        self.current = mission.current
        self._by_name: dict[str, DraftTask] = {}
        self._ambiguous_names: set[str] = set()
        self._read_tasks()
        self.groups = self._read_groups()

    def _read_tasks(self) -> None:
        tasks = self.original.tasks
        around = _groups_around(self.original) if self.names_match_nesting else [""] * len(tasks)
        for task, group, following in zip(tasks, around, following_names(tasks), strict=True):
            is_shown = self.names_match_nesting and task.group == group
            entry = DraftTask(task, _leads_to(task, following), is_shown)
            self.tasks.append(entry)
            if self._by_name.setdefault(task.name, entry) is not entry:
                self._ambiguous_names.add(task.name)

    def _read_groups(self) -> list[DraftGroup]:
        position = {task.name: i for i, task in reversed(list(enumerate(self.original.tasks)))}
        groups = []
        for group in self.original.groups:
            first, last = position.get(group.start), position.get(group.end)
            is_valid = first is not None and last is not None and first <= last
            ends = (
                (self._by_name[group.start], self._by_name[group.end]) if is_valid else (None, None)
            )
            groups.append(DraftGroup(group, *ends))
        return groups

    # ---- look-up by name

    def find(self, name: str) -> DraftTask:
        """Return the task of this name. Raises EditNotFound, or EditConflict if several have it."""
        if name in self._ambiguous_names:
            raise ambiguous(name)
        entry = self._by_name.get(name)
        if entry is None:
            raise unknown("task", name, self._by_name)
        return entry

    @property
    def names(self) -> Collection[str]:
        """Names of all tasks."""
        return self._by_name.keys()

    def has_task(self, name: str) -> bool:
        """Return True if a task has this name."""
        return name in self._by_name

    def find_group(self, name: str) -> DraftGroup:
        """Return the group of this name. Raises EditNotFound."""
        group = next((g for g in self.groups if g.group.name == name), None)
        if group is None:
            raise unknown("group", name, [g.group.name for g in self.groups])
        return group

    def positions_by_entry_id(self) -> dict[int, int]:
        """Return the position of each task in the list, by the `id()` of its DraftTask."""
        return {id(entry): i for i, entry in enumerate(self.tasks)}

    # ---- changes

    def remove(self, entry: DraftTask) -> None:
        """Remove a task from the list.

        A group that started or ended with it now starts or ends with its neighbour; a group of this
        task alone is removed.
        """
        for g in self.groups:
            if _is_only_task(entry, g):
                continue
            if g.first is entry:
                g.first = entry.after
            if g.last is entry:
                g.last = entry.before
        self.groups = [g for g in self.groups if not _is_only_task(entry, g)]
        self.tasks.remove(entry)

    def move(self, entry: DraftTask, after: DraftTask | None, into: str | None) -> None:
        """Move a task behind the task `after`; to the start of the list if that is None.

        The effects on groups are those of `remove` and `insert`; `into` is as there. If the moved
        task was the last one of a group, the group's new last task takes over the target of the
        moved task's unconditional transition; but if the moved task then follows the group
        directly, it keeps that target. Raises EditNotFound, or EditConflict if the task can't be
        inserted there or a group that it ends can't end with its neighbour.
        """
        if into is not None and _is_only_task(entry, self.find_group(into)):
            raise conflict(
                "edit.not-beside-group",
                Message(
                    "'{task}' is the only task of group '{into}', which would be removed with it",
                    task=entry.task.name,
                    into=into,
                ),
                "add another task to the group first",
                subject_of("groups", into),
            )
        new_end, stays = entry.before, after in (entry, entry.before)
        ended_groups = [g for g in self.groups if g.last is entry and g.first is not entry]
        if stays and into is not None:
            ended_groups = [
                g for g in ended_groups if not f"{into}/".startswith(f"{g.group.name}/")
            ]
        if ended_groups and new_end is not None:
            if not new_end.leads_to_next:
                raise _group_end_conflict(ended_groups, entry, new_end)
            if not stays and not entry.leads_to_next:
                _take_over_target(entry, new_end)
        if after is entry:
            after = entry.before
        self.remove(entry)
        self.insert(entry, after, into)

    def insert(self, entry: DraftTask, after: DraftTask | None, into: str | None) -> None:
        """Insert a task behind the task `after`; at the start of the list if that is None.

        At a group's border the task is outside of the group, or inside if `into` names it. If it
        becomes the group's last task, it takes over the target of the former last task, unless it
        already leads to another task than the next one; in both cases the former last task then
        leads to the new one. Raises EditNotFound if there is no such group, EditConflict if the
        group does not extend to this position.
        """
        self.tasks.insert_after(after, entry)
        if into is not None:
            self._add_to_groups(entry, into)

    def rename_with_references(self, entry: DraftTask, name: str) -> None:
        """Rename a task; `mission` then returns it with the new name wherever it is named."""
        self.new_names[entry.task.name] = name
        entry.task = entry.task.model_copy(update={"name": name})

    def _add_to_groups(self, entry: DraftTask, into: str) -> None:
        self.find_group(into)
        position = self.positions_by_entry_id()
        at = position[id(entry)]
        for g in self.groups:
            if g.first is None or g.last is None:
                continue
            name = g.group.name
            inside = position[id(g.first)] < at < position[id(g.last)]
            is_wanted = into == name or into.startswith(f"{name}/")
            if inside and not is_wanted:
                message = Message(
                    "this position is in group '{name}', which does not contain '{into}'",
                    name=name,
                    into=into,
                )
            elif not is_wanted or inside:
                continue
            elif g.last is entry.before:
                _replace_group_end(g.last, entry)
                g.last = entry
                continue
            elif g.first is entry.after:
                g.first = entry
                continue
            else:
                message = Message("group '{name}' does not extend to this position", name=name)
            hint = Message("choose a position next to a task of group '{into}'", into=into)
            raise conflict("edit.not-beside-group", message, hint, subject_of("groups", name))

    # ---- the mission

    def mission(self) -> Mission:
        """Return the edited mission."""
        entries = list(self.tasks)
        tasks: list[Task] = []
        following: str | None = None
        for entry in reversed(entries):
            task = (
                with_renamed_targets(entry.task, self.new_names) if self.new_names else entry.task
            )
            if entry.leads_to_next and not _leads_to(task, following):
                task = with_default_target(task, following)
            if task.action is not Action.START:
                following = task.name
            tasks.append(task)
        tasks.reverse()
        mission = self.original.model_copy(
            update={
                "tasks": tuple(tasks),
                "groups": tuple(map(self._group_model, self.groups)),
                "current": self._new_name(self.current) if self.current is not None else None,
                "before": self._precedences({task.name for task in tasks}),
            }
        )
        return self._show_groups(mission, entries) if self.names_match_nesting else mission

    def _precedences(self, names: set[str]) -> tuple[tuple[str, str], ...]:
        """Return the precedences of the mission with new names and without removed tasks.

        `names` are the names of the tasks that the edited mission has.
        """
        pairs = [(self._new_name(a), self._new_name(b)) for a, b in self.original.before]
        removed = {task.name for task in self.original.tasks} - names - set(self.new_names)
        return tuple(pair for pair in pairs if not removed.intersection(pair))

    def _new_name(self, name: str) -> str:
        return self.new_names.get(name, name)

    def _group_model(self, g: DraftGroup) -> Group:
        start = self._new_name(g.group.start) if g.first is None else g.first.task.name
        end = self._new_name(g.group.end) if g.last is None else g.last.task.name
        if (start, end) == (g.group.start, g.group.end):
            return g.group
        return g.group.model_copy(update={"start": start, "end": end})

    def _show_groups(self, mission: Mission, entries: list[DraftTask]) -> Mission:
        """Return the mission with the `group` field of each task set to the group around it now.

        Only tasks that were displayed in the group around them before are changed.
        """
        tasks = [
            task.model_copy(update={"group": group})
            if entry.shown_in_group and task.group != group
            else task
            for task, group, entry in zip(
                mission.tasks, _groups_around(mission), entries, strict=True
            )
        ]
        return mission.model_copy(update={"tasks": tuple(tasks)})


def _groups_around(mission: Mission) -> list[str]:
    """Return the name of the innermost group around each task; empty if there is none."""
    if not mission.groups:
        return [""] * len(mission.tasks)
    nesting = GroupNesting.from_mission(mission)
    return ["" if i is None else nesting.ranges[i].group.name for i in nesting.innermost]


def _is_only_task(entry: DraftTask, g: DraftGroup) -> bool:
    return g.first is entry and g.last is entry


def _replace_group_end(last: DraftTask, entry: DraftTask) -> None:
    """Adapt the targets of a group's last task, `last`, and of `entry`, which takes its place."""
    leads_there = default_target(last.task) == entry.task.name
    if not last.leads_to_next and entry.leads_to_next and not leads_there:
        _take_over_target(last, entry)
    last.leads_to_next = True


def _take_over_target(last: DraftTask, entry: DraftTask) -> None:
    """Replace the unconditional target of `entry` by that of `last`, which then leads onwards.

    `entry` is a group's new last task and `last` the former one. `last` then leads to the next task
    of the list.
    """
    entry.task = with_default_target(entry.task, default_target(last.task))
    entry.leads_to_next = False
    last.leads_to_next = True


def _group_end_conflict(
    groups: list[DraftGroup], entry: DraftTask, new_end: DraftTask
) -> EditConflict:
    inner = max((g.group.name for g in groups), key=lambda name: name.count("/"))
    target = default_target(new_end.task)
    leads = (
        Message("ends the mission")
        if target is None
        else Message("leads to '{target}'", target=target)
    )
    old_name, new_name = entry.task.name, new_end.task.name
    return conflict(
        "edit.ends-round",
        Message(
            "'{old_name}' ends the rounds of group '{inner}', and the round can't end "
            "with '{new_name}' in its place, which {leads}",
            old_name=old_name,
            inner=inner,
            new_name=new_name,
            leads=leads,
        ),
        Message(
            "lead the unconditional transition of '{new_name}' to '{old_name}' first, "
            "or change where the group ends",
            new_name=new_name,
            old_name=old_name,
        ),
        subject_of("tasks", new_name),
    )


def following_names(tasks: tuple[Task, ...]) -> list[str | None]:
    """Return, for each task, the name of the next task in the list that is not START, or None."""
    following: list[str | None] = []
    name = None
    for task in reversed(tasks):
        following.append(name)
        if task.action is not Action.START:
            name = task.name
    following.reverse()
    return following


def _leads_to(task: Task, following: str | None) -> bool:
    transitions = task.transitions
    if len(transitions) == 1 and not transitions[0].conditions:
        return transitions[0].target == following
    return len(default_targets(task)) < 2 and default_target(task) == following


def _names_match_nesting(mission: Mission) -> bool:
    """Return True if the names and the ranges of the mission's groups give the same nesting."""
    ranges = valid_ranges_parents_first(mission)
    names = {r.group.name for r in ranges}
    if not len(names) == len(ranges) == len(mission.groups):
        return False
    around: list[GroupRange] = []
    for r in ranges:
        while around and around[-1].last < r.first:
            around.pop()
        outer = around[-1] if around else None
        if parent_name(r.group.name) != (None if outer is None else outer.group.name):
            return False
        if outer is not None and outer.last < r.last:
            return False
        around.append(r)
    return True
