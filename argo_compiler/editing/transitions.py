"""Edits of the transitions of a task and of their conditions; both go by their positions from 0."""

from collections.abc import Sequence

from argo_compiler.diagnostics import diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, edited
from argo_compiler.editing.refusals import EditNotFound, conflict, only_one, require_kind, unknown
from argo_compiler.il import Condition, Mission, Task, Transition


def set_transitions(mission: Mission, task: str, transitions: Sequence[Transition]) -> Edited:
    """The mission with these transitions of a task instead of those that it had.

    Raises:
        EditNotFound: there is no such task, or none to lead to.
        EditConflict: more than one of them is unconditional, or a group would never end.
        EditInvalid: a condition never holds.
    """
    at = _index(mission, task)
    names = {other.name for other in mission.tasks}
    for way in transitions:
        require_kind(way, Transition, f"a transition of task '{task}'")
        if way.target not in names:
            raise unknown("task", way.target, names)
    unconditional = [k for k, way in enumerate(transitions) if not way.conditions]
    if len(unconditional) > 1:
        first, second = (f"'{transitions[k].target}'" for k in unconditional[:2])
        raise conflict(
            "edit.second-default",
            f"task '{task}' would have an unconditional transition to {first} and one to {second}",
            "give one of them a condition, or remove one",
            subject_of("tasks", task, f".transitions[{unconditional[0]}]"),
        )
    changed = mission.tasks[at].model_copy(update={"transitions": tuple(transitions)})
    made = mission.model_copy(
        update={"tasks": (*mission.tasks[:at], changed, *mission.tasks[at + 1 :])}
    )
    return edited(mission, made, asked=frozenset([subject_of("tasks", task)]))


def add_transition(
    mission: Mission, task: str, transition: Transition, at: int | None = None
) -> Edited:
    """The mission with one more transition of a task, before the one at that position or last.

    Raises as `set_transitions` does.
    """
    ways = _task(mission, task).transitions
    at = len(ways) if at is None else at
    require_kind(at, int, "the position")
    if not 0 <= at <= len(ways):
        raise _no_such("transition", f"task '{task}'", at, len(ways))
    return set_transitions(mission, task, (*ways[:at], transition, *ways[at:]))


def remove_transition(mission: Mission, task: str, at: int) -> Edited:
    """The mission without one transition of a task. Without an unconditional one the mission ends
    there if no other can be made.

    Raises as `set_transitions` does.
    """
    ways = _task(mission, task).transitions
    _way(task, ways, at)
    return set_transitions(mission, task, (*ways[:at], *ways[at + 1 :]))


def set_target(mission: Mission, task: str, at: int, target: str) -> Edited:
    """The mission with another target of one transition. Raises as `set_transitions` does."""
    return _with_way(mission, task, at, {"target": target})


def set_conditions(mission: Mission, task: str, at: int, conditions: Sequence[Condition]) -> Edited:
    """The mission with these conditions of a transition; none make it unconditional.

    Raises as `set_transitions` does.
    """
    for condition in conditions:
        require_kind(condition, Condition, f"a condition of task '{task}'")
    return _with_way(mission, task, at, {"conditions": tuple(conditions)})


def add_condition(mission: Mission, task: str, at: int, condition: Condition) -> Edited:
    """The mission with one more condition of a transition, which must hold beside the others.

    Raises as `set_transitions` does.
    """
    way = _way(task, _task(mission, task).transitions, at)
    return set_conditions(mission, task, at, (*way.conditions, condition))


def remove_condition(mission: Mission, task: str, at: int, condition: int) -> Edited:
    """The mission without one condition of a transition. Raises as `set_transitions` does."""
    require_kind(condition, int, "the position of the condition")
    held = _way(task, _task(mission, task).transitions, at).conditions
    if not 0 <= condition < len(held):
        raise _no_such("condition", f"transition {at} of task '{task}'", condition, len(held))
    return set_conditions(mission, task, at, (*held[:condition], *held[condition + 1 :]))


def _with_way(mission: Mission, task: str, at: int, update: dict[str, object]) -> Edited:
    ways = _task(mission, task).transitions
    changed = _way(task, ways, at).model_copy(update=update)
    return set_transitions(mission, task, (*ways[:at], changed, *ways[at + 1 :]))


def _way(task: str, ways: Sequence[Transition], at: int) -> Transition:
    require_kind(at, int, "the position")
    if not 0 <= at < len(ways):
        raise _no_such("transition", f"task '{task}'", at, len(ways))
    return ways[at]


def _no_such(kind: str, of: str, at: int, count: int) -> EditNotFound:
    hint = f"it has {count}, counted from 0"
    return EditNotFound([diagnostic_of(f"edit.unknown-{kind}", f"{of} has no {kind} {at}", hint)])


def _task(mission: Mission, name: str) -> Task:
    return mission.tasks[_index(mission, name)]


def _index(mission: Mission, name: str) -> int:
    found = [i for i, task in enumerate(mission.tasks) if task.name == name]
    return only_one(name, found, {task.name for task in mission.tasks})
