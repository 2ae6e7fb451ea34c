"""What an edit has made of a mission, what else had to change for it, and whether it may stay."""

from collections import Counter
from collections.abc import Iterator, Mapping

from argo_compiler.base.model import Model
from argo_compiler.checks import check
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.refusals import EditConflict, EditInvalid
from argo_compiler.il import Action, Group, Mission, Task, Transition
from argo_compiler.il.ways import beginning, branches, default_target

_SENSELESS = frozenset(
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
"""errors that lie in what was given alone"""


class Consequence(Model):
    """Something that changed with an edit besides what was asked for."""

    subject: str
    """what it is about in the mission as it is now, as diagnostics name it; what is gone has the
    name that it had"""
    message: str
    """the same in words"""
    before: str | None = None
    after: str | None = None
    """None: there is none"""


class Edited(Model):
    """A mission after an edit."""

    mission: Mission
    consequences: tuple[Consequence, ...] = ()
    """what else had to change, in the mission's order"""


def edited(
    before: Mission,
    after: Mission,
    *,
    asked: frozenset[str] = frozenset(),
    tasks: Mapping[str, str] | None = None,
    groups: Mapping[str, str] | None = None,
) -> Edited:
    """The result of an edit: `after`, with all that differs from `before` and was not asked for.

    `asked` has the subjects that were, without what is inside of them; `tasks` and `groups` the new
    names of what was renamed. Linear time.

    Raises:
        EditConflict, EditInvalid: `check` finds errors in the mission that it had not before.
    """
    new = new_errors(before, after)
    if new:
        kind = EditInvalid if all(f.code in _SENSELESS for f in new) else EditConflict
        raise kind(new)
    found = (
        *_of_tasks(before, after, asked, tasks or {}),
        *_of_groups(before, after, asked, groups or {}),
        *_of_header(before, after, asked),
    )
    return Edited.model_construct(mission=after, consequences=found)


# ---- errors


def new_errors(before: Mission, after: Mission) -> list[Diagnostic]:
    """The errors of a kind of which the mission had fewer before the edit."""
    if not before.tasks:
        # Of a mission without tasks nothing else is looked at.
        begun = {"tasks": (Task(name="START", action=Action.START),)}
        before = before.model_copy(update=begun)
        after = after if after.tasks else after.model_copy(update=begun)
    errors = [f for f in check(after) if f.severity is Severity.ERROR]
    if not errors:
        return []
    had = [f for f in check(before) if f.severity is Severity.ERROR]
    counts = Counter(f.code for f in had)
    if any(f.subject and f.subject.startswith("groups") for f in had):
        # Whether a group is endless is looked at only where nothing else is wrong with groups.
        counts["il.endless-group"] = len(before.groups)
    subjects = {(f.code, f.subject) for f in had}
    grown = {code for code, n in Counter(f.code for f in errors).items() if n > counts[code]}
    new = [f for f in errors if f.code in grown]
    return [f for f in new if (f.code, f.subject) not in subjects] or new


# ---- tasks


def _of_tasks(
    before: Mission, after: Mission, asked: frozenset[str], renamed: Mapping[str, str]
) -> Iterator[Consequence]:
    first = beginning(after)
    former = beginning(before)
    if renamed:
        known = {renamed.get(task.name, task.name): task for task in before.tasks}
    else:
        known = {task.name: task for task in before.tasks}
    same = set(map(id, before.tasks))
    for task in after.tasks:
        if id(task) in same or (old := known.get(task.name)) is None:
            continue
        at = subject_of("tasks", task.name)
        if at in asked:
            continue
        if old.transitions is not task.transitions:
            yield from _of_ways(at, old, task, first)
        yield from _of_branches(at, old, task)
        if old.group != task.group:
            place = f"in group '{task.group}'" if task.group else "outside of all groups"
            message = f"task '{task.name}' is shown {place} now"
            yield _consequence(f"{at}.group", message, old.group or None, task.group or None)
    if first != former and first is not None and renamed.get(former or "", former) != first:
        message = f"the mission begins with '{first}' now" + (f", not '{former}'" if former else "")
        yield _consequence("tasks", message, former, first)


def _of_ways(at: str, old: Task, new: Task, first: str | None) -> Iterator[Consequence]:
    was, is_now = default_target(old), default_target(new)
    if was != is_now:
        if new.action is Action.START and is_now is None and first is not None:
            message = f"task '{new.name}' leads nowhere now; the mission begins with '{first}'"
        elif is_now is None:
            message = f"the mission ends after task '{new.name}' now; it led to '{was}'"
        elif was is None and new.action is Action.START:
            message = f"task '{new.name}' leads to '{is_now}' now"
        elif was is None:
            message = f"task '{new.name}' leads to '{is_now}' now; the mission ended there"
        else:
            message = f"task '{new.name}' leads to '{is_now}' now, not to '{was}'"
        place = next((k for k, way in enumerate(new.transitions) if not way.conditions), None)
        where = f"{at}.transitions" if place is None else f"{at}.transitions[{place}].target"
        yield _consequence(where, message, was, is_now)
    kept = iter([(k, way) for k, way in enumerate(new.transitions) if way.conditions])
    k, now = next(kept, (0, None))
    for way in old.transitions:
        if not way.conditions:
            continue
        if now is None or now.conditions != way.conditions:
            message = (
                f"a transition of task '{new.name}' with conditions, to '{way.target}', is gone"
            )
            yield _consequence(f"{at}.transitions", message, way.target, None)
            continue
        if now.target != way.target:
            message = f"{_which(new, way)} leads to '{now.target}' now, not to '{way.target}'"
            yield _consequence(f"{at}.transitions[{k}].target", message, way.target, now.target)
        k, now = next(kept, (0, None))


def _of_branches(at: str, old: Task, new: Task) -> Iterator[Consequence]:
    if (old.failure_target, old.window) == (new.failure_target, new.window):
        return
    former, now = branches(old), branches(new)
    for field, words in _BRANCHES.items():
        was, is_now = former.get(field), now.get(field)
        if was != is_now:
            message = f"when task '{new.name}' has {words}, '{is_now}' follows now, not '{was}'"
            yield _consequence(f"{at}.{field}", message, was, is_now)


_BRANCHES = {"failure_target": "failed", "window.missed_target": "missed its window"}


def _which(task: Task, way: Transition) -> str:
    about = " and ".join(f"checkpoint {c.object_id}" for c in way.conditions)
    return f"the transition of task '{task.name}' on {about}"


# ---- groups and header


def _of_groups(
    before: Mission, after: Mission, asked: frozenset[str], renamed: Mapping[str, str]
) -> Iterator[Consequence]:
    if before.groups is after.groups or before.groups == after.groups:
        return
    now = {group.name: group for group in after.groups}
    former = {group.name for group in before.groups}
    for old in before.groups:
        name = renamed.get(old.name, old.name)
        at = subject_of("groups", name)
        new = now.get(name)
        inherited = name != old.name and name in former  # from a group around it, which is gone
        if at in asked and not inherited:
            continue
        if new is None:
            message = f"group '{old.name}' is gone, as it has no tasks any more"
            yield _consequence(at, message, old.name, None)
            continue
        if name != old.name:
            message = f"group '{old.name}' is called '{name}' now"
            yield _consequence(f"{at}.name", message, old.name, name)
        yield from _of_ends(at, old, new)


def _of_ends(at: str, old: Group, new: Group) -> Iterator[Consequence]:
    if old.start != new.start:
        message = f"group '{new.name}' begins with task '{new.start}' now, not '{old.start}'"
        yield _consequence(f"{at}.start", message, old.start, new.start)
    if old.end != new.end:
        message = f"group '{new.name}' ends with task '{new.end}' now, not '{old.end}'"
        yield _consequence(f"{at}.end", message, old.end, new.end)


def _of_header(before: Mission, after: Mission, asked: frozenset[str]) -> Iterator[Consequence]:
    if before.current != after.current and "current" not in asked:
        what = f"task '{after.current}' is" if after.current is not None else "no task is"
        yield _consequence("current", f"{what} the current one now", before.current, after.current)
    if len(after.before) < len(before.before) and "before" not in asked:
        gone = {task.name for task in before.tasks} - {task.name for task in after.tasks}
        for first, second in before.before:
            if not gone.isdisjoint((first, second)):
                message = f"that '{first}' comes before '{second}' is not asked for any more"
                yield _consequence("before", message, f"'{first}' before '{second}'", None)


def _consequence(subject: str, message: str, before: str | None, after: str | None) -> Consequence:
    return Consequence(subject=subject, message=message, before=before, after=after)
