"""A mission while it is edited: tasks know their neighbours, and groups their tasks, not names."""

from collections.abc import Collection
from dataclasses import dataclass

from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.linked import Linked, LinkedList
from argo_compiler.editing.refusals import EditConflict, ambiguous, conflict, unknown
from argo_compiler.editing.ways import defaults, retargeted, with_default
from argo_compiler.il import Action, Group, Mission, Task
from argo_compiler.il.grouping import GroupNesting, GroupRange, group_ranges, parent_name
from argo_compiler.il.ways import default_target


@dataclass(eq=False, slots=True)
class DraftTask(Linked):
    """A task of the draft."""

    task: Task
    goes_on: bool = True
    """whether its unconditional transition leads to what follows it in the list, whatever that is;
    where nothing follows, the mission ends there"""
    shown: bool = False
    """whether it is displayed with the group around it, whichever that is"""


@dataclass(eq=False, slots=True)
class DraftGroup:
    """A group of the draft. Without a first and last task it stays as it is: they are not there, or
    not in order."""

    group: Group
    first: DraftTask | None
    last: DraftTask | None


class MissionDraft:
    """A mission while it is edited. Has state; `mission` gives what has become of it.

    What nobody touched is shared with the mission that it began with.
    """

    def __init__(self, mission: Mission) -> None:
        self.before = mission
        self.nested = _nest(mission)
        self.tasks: LinkedList[DraftTask] = LinkedList()
        self.renamed: dict[str, str] = {}
        self.current = mission.current
        self._found: dict[str, DraftTask] = {}
        self._repeated: set[str] = set()
        self._read_tasks()
        self.groups = self._read_groups()

    def _read_tasks(self) -> None:
        tasks = self.before.tasks
        around = _groups_around(self.before) if self.nested else [""] * len(tasks)
        for task, group, following in zip(tasks, around, following_names(tasks), strict=True):
            shown = self.nested and task.group == group
            entry = DraftTask(task, _goes_on(task, following), shown)
            self.tasks.append(entry)
            if self._found.setdefault(task.name, entry) is not entry:
                self._repeated.add(task.name)

    def _read_groups(self) -> list[DraftGroup]:
        position = {task.name: i for i, task in reversed(list(enumerate(self.before.tasks)))}
        found = []
        for group in self.before.groups:
            first, last = position.get(group.start), position.get(group.end)
            sound = first is not None and last is not None and first <= last
            ends = (self._found[group.start], self._found[group.end]) if sound else (None, None)
            found.append(DraftGroup(group, *ends))
        return found

    # ---- what is named

    def find(self, name: str) -> DraftTask:
        """The task of this name. Raises EditNotFound, or EditConflict if several have it."""
        if name in self._repeated:
            raise ambiguous(name)
        entry = self._found.get(name)
        if entry is None:
            raise unknown("task", name, self._found)
        return entry

    @property
    def names(self) -> Collection[str]:
        """The names of all tasks."""
        return self._found.keys()

    def has_task(self, name: str) -> bool:
        """Whether a task has this name."""
        return name in self._found

    def find_group(self, name: str) -> DraftGroup:
        """The group of this name. Raises EditNotFound."""
        found = next((g for g in self.groups if g.group.name == name), None)
        if found is None:
            raise unknown("group", name, [g.group.name for g in self.groups])
        return found

    def positions(self) -> dict[int, int]:
        """The place of each task in the list, by the identity of its entry."""
        return {id(entry): i for i, entry in enumerate(self.tasks)}

    # ---- changes

    def take_out(self, entry: DraftTask) -> None:
        """Takes a task out of the list. The groups that it began or ended begin or end with its
        neighbour, and what has no task left is no group any more."""
        for g in self.groups:
            if _is_alone(entry, g):
                continue
            if g.first is entry:
                g.first = entry.after
            if g.last is entry:
                g.last = entry.before
        self.groups = [g for g in self.groups if not _is_alone(entry, g)]
        self.tasks.remove(entry)

    def move(self, entry: DraftTask, behind: DraftTask | None, into: str | None) -> None:
        """Moves a task behind another one, or before all, as `take_out` and `put` do.

        A group that it ended still leads to where it led, but now from the task that ends it;
        a task that comes to stand directly behind that group leads there itself.
        Raises EditNotFound, or EditConflict if it can't be there or the groups that it ends can't
        end with its neighbour.
        """
        if into is not None and _is_alone(entry, self.find_group(into)):
            raise conflict(
                "edit.not-beside-group",
                f"'{entry.task.name}' is the only task of group '{into}', which goes with it",
                "put another task into the group first",
                subject_of("groups", into),
            )
        new_end, stays = entry.before, behind in (entry, entry.before)
        left = [g for g in self.groups if g.last is entry and g.first is not entry]
        if stays and into is not None:
            left = [g for g in left if not f"{into}/".startswith(f"{g.group.name}/")]
        if left and new_end is not None:
            if not new_end.goes_on:
                raise _no_end(left, entry, new_end)
            if not stays and not entry.goes_on:
                _hand_on(entry, new_end)
        if behind is entry:
            behind = entry.before
        self.take_out(entry)
        self.put(entry, behind, into)

    def put(self, entry: DraftTask, behind: DraftTask | None, into: str | None) -> None:
        """Puts a task behind another one; None: before all.

        At a group's border it stands outside; with `into` it stands in that group. Where it ends
        the group it leads to where the group led, unless it leads elsewhere itself; in either case
        the task that ended the group goes on with it.
        Raises EditNotFound or EditConflict if it can't stand in it there.
        """
        self.tasks.insert_after(behind, entry)
        if into is not None:
            self._widen(entry, into)

    def rename(self, entry: DraftTask, name: str) -> None:
        """Gives a task another name, wherever it is named."""
        self.renamed[entry.task.name] = name
        entry.task = entry.task.model_copy(update={"name": name})

    def _widen(self, entry: DraftTask, into: str) -> None:
        self.find_group(into)
        position = self.positions()
        at = position[id(entry)]
        for g in self.groups:
            if g.first is None or g.last is None:
                continue
            name = g.group.name
            inside = position[id(g.first)] < at < position[id(g.last)]
            wanted = into == name or into.startswith(f"{name}/")
            if inside and not wanted:
                message = f"this place lies in group '{name}', which lies not around '{into}'"
            elif not wanted or inside:
                continue
            elif g.last is entry.before:
                _end_in_place_of(g.last, entry)
                g.last = entry
                continue
            elif g.first is entry.after:
                g.first = entry
                continue
            else:
                message = f"group '{name}' does not reach to this place"
            hint = f"choose a place beside a task of group '{into}'"
            raise conflict("edit.not-beside-group", message, hint, subject_of("groups", name))

    # ---- the mission

    def mission(self) -> Mission:
        """The mission that the draft has become."""
        entries = list(self.tasks)
        tasks: list[Task] = []
        following: str | None = None
        for entry in reversed(entries):
            task = retargeted(entry.task, self.renamed) if self.renamed else entry.task
            if entry.goes_on and not _goes_on(task, following):
                task = with_default(task, following)
            if task.action is not Action.START:
                following = task.name
            tasks.append(task)
        tasks.reverse()
        made = self.before.model_copy(
            update={
                "tasks": tuple(tasks),
                "groups": tuple(map(self._frozen, self.groups)),
                "current": self._name_now(self.current) if self.current is not None else None,
                "before": self._before({task.name for task in tasks}),
            }
        )
        return self._displayed(made, entries) if self.nested else made

    def _before(self, names: set[str]) -> tuple[tuple[str, str], ...]:
        """What has to come before what, without the tasks that were taken out."""
        found = [(self._name_now(a), self._name_now(b)) for a, b in self.before.before]
        gone = {task.name for task in self.before.tasks} - names - set(self.renamed)
        return tuple(pair for pair in found if not gone.intersection(pair))

    def _name_now(self, name: str) -> str:
        return self.renamed.get(name, name)

    def _frozen(self, g: DraftGroup) -> Group:
        start = self._name_now(g.group.start) if g.first is None else g.first.task.name
        end = self._name_now(g.group.end) if g.last is None else g.last.task.name
        if (start, end) == (g.group.start, g.group.end):
            return g.group
        return g.group.model_copy(update={"start": start, "end": end})

    def _displayed(self, made: Mission, entries: list[DraftTask]) -> Mission:
        """The mission with the tasks shown in the groups that are around them now."""
        tasks = [
            task.model_copy(update={"group": group})
            if entry.shown and task.group != group
            else task
            for task, group, entry in zip(made.tasks, _groups_around(made), entries, strict=True)
        ]
        return made.model_copy(update={"tasks": tuple(tasks)})


def _groups_around(mission: Mission) -> list[str]:
    """For each task, the name of the innermost group around it; empty: there is none."""
    if not mission.groups:
        return [""] * len(mission.tasks)
    layout = GroupNesting.of(mission)
    return ["" if i is None else layout.ranges[i].group.name for i in layout.innermost]


def _is_alone(entry: DraftTask, g: DraftGroup) -> bool:
    return g.first is entry and g.last is entry


def _end_in_place_of(last: DraftTask, entry: DraftTask) -> None:
    """Lets a task end a group whose last one it follows."""
    leads_there = default_target(last.task) == entry.task.name
    if not last.goes_on and entry.goes_on and not leads_there:
        _hand_on(last, entry)
    last.goes_on = True


def _hand_on(last: DraftTask, entry: DraftTask) -> None:
    """Lets a task that ends a group in place of another one lead to where that one led."""
    entry.task = with_default(entry.task, default_target(last.task))
    entry.goes_on = False
    last.goes_on = True


def _no_end(groups: list[DraftGroup], entry: DraftTask, new_end: DraftTask) -> EditConflict:
    inner = max((g.group.name for g in groups), key=lambda name: name.count("/"))
    target = default_target(new_end.task)
    leads = "ends the mission" if target is None else f"leads to '{target}'"
    end, before = entry.task.name, new_end.task.name
    return conflict(
        "edit.ends-round",
        f"'{end}' ends the rounds of group '{inner}', and the round can't end with '{before}' in "
        f"its place, which {leads}",
        f"lead the unconditional transition of '{before}' to '{end}' first, or change where the "
        "group ends",
        subject_of("tasks", before),
    )


def following_names(tasks: tuple[Task, ...]) -> list[str | None]:
    """For each task, the next one of the list that is not START."""
    following: list[str | None] = []
    name = None
    for task in reversed(tasks):
        following.append(name)
        if task.action is not Action.START:
            name = task.name
    following.reverse()
    return following


def _goes_on(task: Task, following: str | None) -> bool:
    ways = task.transitions
    if len(ways) == 1 and not ways[0].conditions:
        return ways[0].target == following
    return len(defaults(task)) < 2 and default_target(task) == following


def _nest(mission: Mission) -> bool:
    """Whether names and ranges of the mission's groups tell the same story."""
    ranges = group_ranges(mission)
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
