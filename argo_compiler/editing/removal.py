"""Taking a task out of a mission so that every run of it is otherwise the same.

What led to the task leads to where the task's unconditional transition led. Where a mission can't
say that, the removal is refused: a transition with conditions can't end a mission, and none can end
a round.
"""

from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Consequence, Edited, edited
from argo_compiler.editing.draft import DraftGroup, DraftTask, MissionDraft
from argo_compiler.editing.refusals import EditConflict, conflict
from argo_compiler.editing.ways import defaults, retargeted
from argo_compiler.il import Action, Mission, Task
from argo_compiler.il.ways import beginning, branches, default_target

_NAMES = 3
"""names that a message lists"""


def remove_task(mission: Mission, name: str) -> Edited:
    """The mission without a task: what led to it leads to its successor.

    The successor is where its unconditional transition led; its other ways go with it. The
    groups that it began or ended begin or end with its neighbour; a group of this task alone goes.

    Raises:
        EditNotFound: there is no such task.
        EditConflict: without it a run of the mission would differ by more than the task, and the
            diagnostic says at which other task; or it is the only one.
    """
    draft = MissionDraft(mission)
    entry = draft.find(name)
    if draft.tasks.first is draft.tasks.last:
        raise conflict(
            "edit.last-task",
            f"'{name}' is the only task of the mission",
            "add another task first: a mission that does nothing has a START task only",
            subject_of("tasks", name),
        )
    successor = None
    if entry.task.action is not Action.START:
        successor = _Removal(draft, entry).lead_on()
        if draft.current == name:
            draft.current = successor
    elif draft.current == name:
        draft.current = None
    draft.take_out(entry)
    made = draft.mission()
    _require_beginning(name, successor, mission, made)
    result = edited(mission, made)
    if default_target(entry.task) != name or entry.task.action is Action.START:
        return result
    told = Consequence(
        subject="tasks",
        message=f"a run that came to '{name}' stayed there, as it led to itself; it "
        + ("ends now" if successor is None else f"goes on with '{successor}' now"),
        before=name,
        after=successor,
    )
    return Edited(mission=made, consequences=(*result.consequences, told))


def _require_beginning(name: str, successor: str | None, before: Mission, after: Mission) -> None:
    first = beginning(before)
    wanted = successor if first == name else first
    found = beginning(after)
    if found != wanted:
        ends = f"with '{wanted}'" if wanted is not None else "and end at once"
        raise conflict(
            "edit.beginning",
            f"without '{name}' the mission would begin with '{found}', and it would have to begin "
            + ends,
            "lead a START task to where it is to begin, or move that task to the front",
            subject_of("tasks", name),
        )


class _Removal:
    """A task that is to be taken out, and what stands around it."""

    def __init__(self, draft: MissionDraft, entry: DraftTask) -> None:
        self.draft = draft
        self.entry = entry
        self.name = entry.task.name
        self.position = draft.positions()
        self.successor = self._successor()
        self.leading = [
            other for other in draft.tasks if other is not entry and self._leads_here(other.task)
        ]

    def lead_on(self) -> str | None:
        """Leads all that leads to the task to its successor, and returns that."""
        self._require_round_ends()
        self._require_round_starts()
        self._require_same_groups()
        for other in self.leading:
            if self.name in defaults(other.task):
                other.goes_on = other.goes_on and self.entry.goes_on
            if self.successor is not None:
                other.task = retargeted(other.task, {self.name: self.successor})
            else:
                self._end_after(other)
        return self.successor

    def _leads_here(self, task: Task) -> bool:
        return any(way.target == self.name for way in task.transitions) or self._branches_here(task)

    def _branches_here(self, task: Task) -> bool:
        return self.name in branches(task).values()

    def _successor(self) -> str | None:
        target = default_target(self.entry.task)
        if target != self.name:
            return target
        # It led to itself: a run never went on from there.
        following = self.entry.after
        while following is not None and following.task.action is Action.START:
            following = following.after
        return None if following is None else following.task.name

    def _end_after(self, other: DraftTask) -> None:
        """Lets the mission end where a task led to the one that goes."""
        task = other.task
        conditional = [way for way in task.transitions if way.conditions]
        while conditional and conditional[-1].target == self.name:
            conditional.pop()
        # Where nothing else can be done, the mission ends, but for another round of a group.
        ends = all(target == self.name for target in defaults(task))
        ends = ends and all(g.last is not other for g in self.draft.groups)
        dropped = [way for way in task.transitions if way.conditions and way.target == self.name]
        hint = f"lead it to another task before '{self.name}' is removed"
        if dropped and not (ends and all(way.target != self.name for way in conditional)):
            raise self._conflict(
                "edit.ends-by-condition",
                f"a transition of task '{task.name}' with conditions leads to '{self.name}', after "
                "which the mission ends, and no condition can end a mission",
                hint,
                task.name,
            )
        if self._branches_here(task):
            raise self._conflict(
                "edit.ends-by-condition",
                f"when task '{task.name}' has failed or missed its window, '{self.name}' follows, "
                "after which the mission ends, and no branch can end a mission",
                hint,
                task.name,
            )
        kept = tuple(way for way in task.transitions if way.target != self.name)
        other.task = task.model_copy(update={"transitions": kept})

    # ---- groups

    def _require_round_ends(self) -> None:
        """A round that ends with the task has to end with the one before it."""
        ended = [g for g in self.draft.groups if g.last is self.entry and g.first is not self.entry]
        before = self.entry.before
        if not ended or before is None:
            return
        ways = [(o, way) for o in self.leading for way in o.task.transitions]
        wrong = {
            o.task.name: None
            for o, way in ways
            if way.target == self.name and (o is not before or way.conditions)
        }
        wrong |= {o.task.name: None for o in self.leading if self._branches_here(o.task)}
        if default_target(before.task) != self.name:
            wrong[before.task.name] = None
        if default_target(self.entry.task) == self.name:
            wrong[self.name] = None
        if wrong:
            inner = min(ended, key=lambda g: -g.group.name.count("/"))
            listed = ", ".join(f"'{name}'" for name in list(wrong)[:_NAMES])
            raise self._conflict(
                "edit.ends-round",
                f"'{self.name}' ends the rounds of group '{inner.group.name}', and the round can't "
                f"end with '{before.task.name}' in its place: see the transitions of {listed}",
                f"lead only the unconditional transition of '{before.task.name}' to "
                f"'{self.name}', or change where the group ends",
                next(iter(wrong)),
            )

    def _require_round_starts(self) -> None:
        """A round that starts with the task has to start with its successor."""
        after = self.entry.after
        for g in self.draft.groups:
            if g.first is not self.entry or g.last is self.entry or after is None:
                continue
            if self.successor != after.task.name:
                raise self._conflict(
                    "edit.starts-round",
                    f"'{self.name}' begins the rounds of group '{g.group.name}' and leads to "
                    f"'{self.successor}', but without it they would begin with '{after.task.name}'",
                    f"lead '{self.name}' to '{after.task.name}', or change where the group starts",
                    self.name,
                )

    def _require_same_groups(self) -> None:
        """What left a group and entered it anew by the task has to do so without it."""
        target = None if self.successor is None else self.draft.find(self.successor)
        if target is None:
            return
        for g in self.draft.groups:
            if not self._contains(g, target) or self._contains(g, self.entry):
                continue
            for other in self.leading:
                if self._contains(g, other) and self._jumps(other, g):
                    raise self._conflict(
                        "edit.leaves-group",
                        f"by way of '{self.name}', task '{other.task.name}' leaves group "
                        f"'{g.group.name}' and enters it anew; without it that would be a jump "
                        "inside the round",
                        f"lead '{other.task.name}' elsewhere first",
                        other.task.name,
                    )

    def _jumps(self, other: DraftTask, g: DraftGroup) -> bool:
        """Whether a transition to the task can be taken without ending a round of the group."""
        return self._branches_here(other.task) or any(
            way.target == self.name and (way.conditions or g.last is not other)
            for way in other.task.transitions
        )

    def _contains(self, g: DraftGroup, entry: DraftTask) -> bool:
        if g.first is None or g.last is None:
            return False
        at = self.position
        return at[id(g.first)] <= at[id(entry)] <= at[id(g.last)]

    def _conflict(self, code: str, message: str, hint: str, task: str) -> EditConflict:
        return conflict(code, message, hint, subject_of("tasks", task))
