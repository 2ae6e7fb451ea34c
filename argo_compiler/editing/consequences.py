"""Result of an edit: the mission, its consequences, and the errors that forbid the edit."""

from collections import Counter
from collections.abc import Iterator, Mapping

from argo_compiler.base.message import Listing, Message
from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, wording_field
from argo_compiler.checks import check
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.errors import EditConflict, EditInvalid
from argo_compiler.il import Action, Group, Mission, Task, Transition
from argo_compiler.il.transitions import default_target, failure_targets_by_field, initial_task

_INVALID_IN_THEMSELVES = frozenset(
    [
        "il.battery-level",
        "il.branch-without-target",
        "il.condition-bound",
        "il.group-duration",
        "il.group-name",
        "il.joint-states",
        "il.measure-without-object",
        "il.reserved-name",
        "il.safe-area-without-pose",
        "il.stale-without-age",
        "il.until-itself",
        "il.wait-rule",
        "il.waypoint-without-pose",
        "il.window-order",
        "il.within-bounds",
    ]
)
"""codes of errors that the given values have in every mission"""


class Consequence(Model):
    """Change that an edit caused besides the requested one."""

    subject: str
    """the changed part of the edited mission, named as in diagnostics; a removed part has its
    former name"""
    message: Text
    """the change in words"""
    message_wording: Wording | None = wording_field("message")
    before: str | None = None
    """former value; None if there was none"""
    after: str | None = None
    """new value; None if there is none"""


class Edited(Model):
    """Mission after an edit, with the consequences of the edit."""

    mission: Mission
    consequences: tuple[Consequence, ...] = ()
    """further changes that the edit required, in the mission's order"""


def checked_edit_result(
    before: Mission,
    after: Mission,
    *,
    requested: frozenset[str] = frozenset(),
    renamed_tasks: Mapping[str, str] | None = None,
    renamed_groups: Mapping[str, str] | None = None,
) -> Edited:
    """Return the mission `after` an edit, and its consequences: what else differs from `before`.

    `requested` are the subjects (paths of parts of the mission) whose change was requested, with
    all their parts: such a change is no consequence. `renamed_tasks` and `renamed_groups` map
    former names to new names; None: nothing is renamed. Takes linear time.

    Raises EditConflict or EditInvalid if `check` finds errors in `after` that `before` does not
    have: EditInvalid if all of them are errors in every mission.
    """
    new = new_errors(before, after)
    if new:
        kind = EditInvalid if all(f.code in _INVALID_IN_THEMSELVES for f in new) else EditConflict
        raise kind(new)
    consequences = (
        *_task_consequences(before, after, requested, renamed_tasks or {}),
        *_group_consequences(before, after, requested, renamed_groups or {}),
        *_header_consequences(before, after, requested),
    )
    return Edited.model_construct(mission=after, consequences=consequences)


# ---- errors


def new_errors(before: Mission, after: Mission) -> list[Diagnostic]:
    """Return the errors of `after` whose codes occur there more often than in `before`.

    If the subject (part of the mission) of some of them had no error of the same code before, only
    these are returned.
    """
    if not before.tasks:
        # `check` examines nothing else in a mission without tasks.
        start_only = {"tasks": (Task(name="START", action=Action.START),)}
        before = before.model_copy(update=start_only)
        after = after if after.tasks else after.model_copy(update=start_only)
    errors = [f for f in check(after) if f.severity is Severity.ERROR]
    if not errors:
        return []
    former_errors = [f for f in check(before) if f.severity is Severity.ERROR]
    counts = Counter(f.code for f in former_errors)
    if any(f.subject and f.subject.startswith("groups") for f in former_errors):
        # `check` looks for endless groups only if it finds no other error in groups.
        counts["il.endless-group"] = len(before.groups)
    subjects = {(f.code, f.subject) for f in former_errors}
    more_frequent = {
        code for code, n in Counter(f.code for f in errors).items() if n > counts[code]
    }
    new = [f for f in errors if f.code in more_frequent]
    return [f for f in new if (f.code, f.subject) not in subjects] or new


# ---- tasks


def _task_consequences(
    before: Mission, after: Mission, requested: frozenset[str], renamed: Mapping[str, str]
) -> Iterator[Consequence]:
    first = initial_task(after)
    former = initial_task(before)
    if renamed:
        known = {renamed.get(task.name, task.name): task for task in before.tasks}
    else:
        known = {task.name: task for task in before.tasks}
    same = set(map(id, before.tasks))
    for task in after.tasks:
        if id(task) in same or (old := known.get(task.name)) is None:
            continue
        at = subject_of("tasks", task.name)
        if at in requested:
            continue
        if old.transitions is not task.transitions:
            yield from _transition_consequences(at, old, task, first)
        yield from _branch_consequences(at, old, task)
        if old.group != task.group:
            where = (
                Message("in group '{group}'", group=task.group)
                if task.group
                else Message("outside of all groups")
            )
            message = Message("task '{task}' is shown {where} now", task=task.name, where=where)
            yield _consequence(f"{at}.group", message, old.group or None, task.group or None)
    if first != former and first is not None and renamed.get(former or "", former) != first:
        message = Message("the mission begins with '{first}' now", first=first) + (
            Message(", not '{former}'", former=former) if former else ""
        )
        yield _consequence("tasks", message, former, first)


def _transition_consequences(
    at: str, old: Task, new: Task, first: str | None
) -> Iterator[Consequence]:
    was, is_now = default_target(old), default_target(new)
    if was != is_now:
        if new.action is Action.START and is_now is None and first is not None:
            message = Message(
                "task '{new}' leads nowhere now; the mission begins with '{first}'",
                new=new.name,
                first=first,
            )
        elif is_now is None:
            message = Message(
                "the mission ends after task '{new}' now; it led to '{was}'", new=new.name, was=was
            )
        elif was is None and new.action is Action.START:
            message = Message("task '{new}' leads to '{is_now}' now", new=new.name, is_now=is_now)
        elif was is None:
            message = Message(
                "task '{new}' leads to '{is_now}' now; the mission ended there",
                new=new.name,
                is_now=is_now,
            )
        else:
            message = Message(
                "task '{new}' leads to '{is_now}' now, not to '{was}'",
                new=new.name,
                is_now=is_now,
                was=was,
            )
        position = next(
            (k for k, transition in enumerate(new.transitions) if not transition.conditions), None
        )
        subject = (
            f"{at}.transitions" if position is None else f"{at}.transitions[{position}].target"
        )
        yield _consequence(subject, message, was, is_now)
    conditional = iter(
        [(k, transition) for k, transition in enumerate(new.transitions) if transition.conditions]
    )
    k, now = next(conditional, (0, None))
    for transition in old.transitions:
        if not transition.conditions:
            continue
        if now is None or now.conditions != transition.conditions:
            message = Message(
                "a conditional transition of task '{new}', to '{target}', was removed",
                new=new.name,
                target=transition.target,
            )
            yield _consequence(f"{at}.transitions", message, transition.target, None)
            continue
        if now.target != transition.target:
            message = Message(
                "{conditional_transition} leads to '{target}' now, not to '{target_2}'",
                conditional_transition=_conditional_transition(new, transition),
                target=now.target,
                target_2=transition.target,
            )
            yield _consequence(
                f"{at}.transitions[{k}].target", message, transition.target, now.target
            )
        k, now = next(conditional, (0, None))


def _branch_consequences(at: str, old: Task, new: Task) -> Iterator[Consequence]:
    if (old.failure_target, old.window) == (new.failure_target, new.window):
        return
    former, now = failure_targets_by_field(old), failure_targets_by_field(new)
    for field, occasion in _BRANCHES.items():
        was, is_now = former.get(field), now.get(field)
        if was != is_now:
            message = Message(
                "when task '{new}' has {occasion}, '{is_now}' follows now, not '{was}'",
                new=new.name,
                occasion=occasion,
                is_now=is_now,
                was=was,
            )
            yield _consequence(f"{at}.{field}", message, was, is_now)


_BRANCHES = {
    "failure_target": Message("failed"),
    "window.missed_target": Message("missed its window"),
}


def _conditional_transition(task: Task, transition: Transition) -> str:
    about = Listing(
        Message("checkpoint {object_id}", object_id=c.object_id) for c in transition.conditions
    )
    return Message("the transition of task '{task}' on {about:and}", task=task.name, about=about)


# ---- groups and header


def _group_consequences(
    before: Mission, after: Mission, requested: frozenset[str], renamed: Mapping[str, str]
) -> Iterator[Consequence]:
    if before.groups is after.groups or before.groups == after.groups:
        return
    now = {group.name: group for group in after.groups}
    former = {group.name for group in before.groups}
    for old in before.groups:
        name = renamed.get(old.name, old.name)
        at = subject_of("groups", name)
        new = now.get(name)
        inherited = name != old.name and name in former  # the name of a dissolved group around it
        if at in requested and not inherited:
            continue
        if new is None:
            message = Message(
                "group '{old}' was removed because it has no tasks any more", old=old.name
            )
            yield _consequence(at, message, old.name, None)
            continue
        if name != old.name:
            message = Message("group '{old}' is called '{name}' now", old=old.name, name=name)
            yield _consequence(f"{at}.name", message, old.name, name)
        yield from _border_consequences(at, old, new)


def _border_consequences(at: str, old: Group, new: Group) -> Iterator[Consequence]:
    if old.start != new.start:
        message = Message(
            "group '{new}' begins with task '{start}' now, not '{start_2}'",
            new=new.name,
            start=new.start,
            start_2=old.start,
        )
        yield _consequence(f"{at}.start", message, old.start, new.start)
    if old.end != new.end:
        message = Message(
            "group '{new}' ends with task '{end}' now, not '{end_2}'",
            new=new.name,
            end=new.end,
            end_2=old.end,
        )
        yield _consequence(f"{at}.end", message, old.end, new.end)


def _header_consequences(
    before: Mission, after: Mission, requested: frozenset[str]
) -> Iterator[Consequence]:
    if before.current != after.current and "current" not in requested:
        which = (
            Message("task '{current}' is", current=after.current)
            if after.current is not None
            else Message("no task is")
        )
        yield _consequence(
            "current",
            Message("{which} the current one now", which=which),
            before.current,
            after.current,
        )
    if len(after.before) < len(before.before) and "before" not in requested:
        removed = {task.name for task in before.tasks} - {task.name for task in after.tasks}
        for first, second in before.before:
            if not removed.isdisjoint((first, second)):
                message = Message(
                    "the rule that '{first}' comes before '{second}' was removed",
                    first=first,
                    second=second,
                )
                yield _consequence(
                    "before",
                    message,
                    Message("'{first}' before '{second}'", first=first, second=second),
                    None,
                )


def _consequence(subject: str, message: str, before: str | None, after: str | None) -> Consequence:
    return Consequence(subject=subject, message=message, before=before, after=after)
