"""Removal of a task from a mission so that every run is otherwise the same.

What led to the task leads to the target of the task's unconditional transition. If a mission can't
express that, the removal is refused: a conditional transition can't end a mission, and no
conditional transition or branch can end a round.
"""

from argo_compiler.base.message import Listing, Message
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Consequence, Edited, checked_edit_result
from argo_compiler.editing.draft import DraftGroup, DraftTask, MissionDraft
from argo_compiler.editing.errors import EditConflict, conflict
from argo_compiler.editing.targets import default_targets, with_renamed_targets
from argo_compiler.il import Action, Mission, Task
from argo_compiler.il.transitions import default_target, failure_targets_by_field, initial_task

_NAMES = 3
"""largest number of names that a message lists"""


def remove_task(mission: Mission, name: str) -> Edited:
    """Remove a task and lead what led to the task to its successor.

    The successor is the target of the task's unconditional transition; its other transitions are
    removed with it. A group that started or ended with it now starts or ends with its neighbour; a
    group of this task alone is removed.

    Raises:
        EditNotFound: there is no such task.
        EditConflict: without it a run of the mission would differ by more than the task, and the
            diagnostic names the other task concerned; or it is the only task.
    """
    draft = MissionDraft(mission)
    entry = draft.find(name)
    if draft.tasks.first is draft.tasks.last:
        raise conflict(
            "edit.last-task",
            Message("'{name}' is the only task of the mission", name=name),
            "add another task first: a mission that does nothing has a START task only",
            subject_of("tasks", name),
        )
    successor = None
    if entry.task.action is not Action.START:
        successor = _Removal(draft, entry).redirect()
        if draft.current == name:
            draft.current = successor
    elif draft.current == name:
        draft.current = None
    draft.remove(entry)
    after = draft.mission()
    _require_beginning(name, successor, mission, after)
    result = checked_edit_result(mission, after)
    if default_target(entry.task) != name or entry.task.action is Action.START:
        return result
    consequence = Consequence(
        subject="tasks",
        message=Message(
            "a run that reached '{name}' stayed there, because it led to itself; it ", name=name
        )
        + (
            Message("ends now")
            if successor is None
            else Message("continues with '{successor}' now", successor=successor)
        ),
        before=name,
        after=successor,
    )
    return Edited(mission=after, consequences=(*result.consequences, consequence))


def _require_beginning(name: str, successor: str | None, before: Mission, after: Mission) -> None:
    first = initial_task(before)
    required = successor if first == name else first
    actual = initial_task(after)
    if actual != required:
        how = (
            Message("with '{required}'", required=required)
            if required is not None
            else Message("and end at once")
        )
        raise conflict(
            "edit.beginning",
            Message(
                "without '{name}' the mission would begin with '{actual}', but it would "
                "have to begin ",
                name=name,
                actual=actual,
            )
            + how,
            "lead a START task to the task that it must begin with, or move that task to the front",
            subject_of("tasks", name),
        )


class _Removal:
    """Removal of one task: its successor and the tasks that lead to it. Changes the draft."""

    def __init__(self, draft: MissionDraft, entry: DraftTask) -> None:
        self.draft = draft
        self.entry = entry
        self.name = entry.task.name
        self.position = draft.positions_by_entry_id()
        self.successor = self._successor()
        self.leading = [
            other for other in draft.tasks if other is not entry and self._leads_to_it(other.task)
        ]

    def redirect(self) -> str | None:
        """Redirect all that leads to the task to its successor, and return the successor's name.

        Returns None if the mission ends after the task. Raises EditConflict if a run of the mission
        would differ by more than the task.
        """
        self._require_round_ends()
        self._require_round_starts()
        self._require_same_groups()
        for other in self.leading:
            if self.name in default_targets(other.task):
                other.leads_to_next = other.leads_to_next and self.entry.leads_to_next
            if self.successor is not None:
                other.task = with_renamed_targets(other.task, {self.name: self.successor})
            else:
                self._end_mission_after(other)
        return self.successor

    def _leads_to_it(self, task: Task) -> bool:
        return any(
            transition.target == self.name for transition in task.transitions
        ) or self._branches_to_it(task)

    def _branches_to_it(self, task: Task) -> bool:
        return self.name in failure_targets_by_field(task).values()

    def _successor(self) -> str | None:
        target = default_target(self.entry.task)
        if target != self.name:
            return target
        # It led to itself, so a run never left it: take the next task of the list.
        following = self.entry.after
        while following is not None and following.task.action is Action.START:
            following = following.after
        return None if following is None else following.task.name

    def _end_mission_after(self, other: DraftTask) -> None:
        """Let the mission end after `other`, which led to the removed task.

        Raises EditConflict if a condition or a failure of `other` would have to end the mission,
        which is not possible.
        """
        task = other.task
        conditional = [transition for transition in task.transitions if transition.conditions]
        while conditional and conditional[-1].target == self.name:
            conditional.pop()
        # Conditional transitions to the removed task can be dropped if they come last and the
        # mission ends anyway after `task`: it has no other target and is not the last of a group.
        ends = all(target == self.name for target in default_targets(task))
        ends = ends and all(g.last is not other for g in self.draft.groups)
        dropped = [
            transition
            for transition in task.transitions
            if transition.conditions and transition.target == self.name
        ]
        hint = Message("lead it to another task before '{name}' is removed", name=self.name)
        if dropped and not (
            ends and all(transition.target != self.name for transition in conditional)
        ):
            raise self._conflict(
                "edit.ends-by-condition",
                Message(
                    "a conditional transition of task '{task}' leads to '{name}', after which "
                    "the mission ends, and no condition can end a mission",
                    task=task.name,
                    name=self.name,
                ),
                hint,
                task.name,
            )
        if self._branches_to_it(task):
            raise self._conflict(
                "edit.ends-by-condition",
                Message(
                    "when task '{task}' has failed or missed its window, '{name}' follows, "
                    "after which the mission ends, and no branch can end a mission",
                    task=task.name,
                    name=self.name,
                ),
                hint,
                task.name,
            )
        remaining = tuple(
            transition for transition in task.transitions if transition.target != self.name
        )
        other.task = task.model_copy(update={"transitions": remaining})

    # ---- groups

    def _require_round_ends(self) -> None:
        """Raise EditConflict if a round that ends with the task can't end one task earlier."""
        ended = [g for g in self.draft.groups if g.last is self.entry and g.first is not self.entry]
        before = self.entry.before
        if not ended or before is None:
            return
        transitions = [(o, transition) for o in self.leading for transition in o.task.transitions]
        wrong = {
            o.task.name: None
            for o, transition in transitions
            if transition.target == self.name and (o is not before or transition.conditions)
        }
        wrong |= {o.task.name: None for o in self.leading if self._branches_to_it(o.task)}
        if default_target(before.task) != self.name:
            wrong[before.task.name] = None
        if default_target(self.entry.task) == self.name:
            wrong[self.name] = None
        if wrong:
            inner = min(ended, key=lambda g: -g.group.name.count("/"))
            listed = Listing(Message("'{name}'", name=name) for name in list(wrong)[:_NAMES])
            raise self._conflict(
                "edit.ends-round",
                Message(
                    "'{name}' ends the rounds of group '{group}', and the round can't end with "
                    "'{task}' in its place: see the transitions of {listed}",
                    name=self.name,
                    group=inner.group.name,
                    task=before.task.name,
                    listed=listed,
                ),
                Message(
                    "lead only the unconditional transition of '{task}' to '{name}', or change "
                    "where the group ends",
                    task=before.task.name,
                    name=self.name,
                ),
                next(iter(wrong)),
            )

    def _require_round_starts(self) -> None:
        """Raise EditConflict if a round that starts with the task can't start one task later."""
        after = self.entry.after
        for g in self.draft.groups:
            if g.first is not self.entry or g.last is self.entry or after is None:
                continue
            if self.successor != after.task.name:
                raise self._conflict(
                    "edit.starts-round",
                    Message(
                        "'{name}' begins the rounds of group '{group}' and leads to '{successor}', "
                        "but without it they would begin with '{task}'",
                        name=self.name,
                        group=g.group.name,
                        successor=self.successor,
                        task=after.task.name,
                    ),
                    Message(
                        "lead '{name}' to '{task}', or change where the group starts",
                        name=self.name,
                        task=after.task.name,
                    ),
                    self.name,
                )

    def _require_same_groups(self) -> None:
        """Raise EditConflict if a task leaves a group and, by the removed task, enters it again."""
        target = None if self.successor is None else self.draft.find(self.successor)
        if target is None:
            return
        for g in self.draft.groups:
            if not self._contains(g, target) or self._contains(g, self.entry):
                continue
            for other in self.leading:
                if self._contains(g, other) and self._is_jump_in_round(other, g):
                    raise self._conflict(
                        "edit.leaves-group",
                        Message(
                            "task '{task}' leaves group '{group}' and enters it again through "
                            "'{name}'; without '{name}' it would jump inside the round",
                            task=other.task.name,
                            group=g.group.name,
                            name=self.name,
                        ),
                        Message("lead '{task}' elsewhere first", task=other.task.name),
                        other.task.name,
                    )

    def _is_jump_in_round(self, other: DraftTask, g: DraftGroup) -> bool:
        """Return True if `other` leads to the removed task other than by ending the group's round.

        That is, by a condition or a failure, or because `other` is not the last task of the group.
        """
        return self._branches_to_it(other.task) or any(
            transition.target == self.name and (transition.conditions or g.last is not other)
            for transition in other.task.transitions
        )

    def _contains(self, g: DraftGroup, entry: DraftTask) -> bool:
        if g.first is None or g.last is None:
            return False
        at = self.position
        return at[id(g.first)] <= at[id(entry)] <= at[id(g.last)]

    def _conflict(self, code: str, message: str, hint: str, task: str) -> EditConflict:
        return conflict(code, message, hint, subject_of("tasks", task))
