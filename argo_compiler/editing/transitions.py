"""Edits of a task's transitions and their conditions, identified by their positions from 0."""

from collections.abc import Sequence

from argo_compiler.base.message import Message
from argo_compiler.diagnostics import diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.editing.consequences import Edited, checked_edit_result
from argo_compiler.editing.errors import (
    EditNotFound,
    conflict,
    require_kind,
    require_single_position,
    unknown,
)
from argo_compiler.il import Condition, Mission, Task, Transition


def set_transitions(mission: Mission, task: str, transitions: Sequence[Transition]) -> Edited:
    """Replace all transitions of a task.

    Raises:
        EditNotFound: the task or a target does not exist.
        EditConflict: more than one of them is unconditional, or a group would never end.
        EditInvalid: a condition can never be true.
    """
    at = _task_index(mission, task)
    names = {other.name for other in mission.tasks}
    for transition in transitions:
        require_kind(transition, Transition, Message("a transition of task '{task}'", task=task))
        if transition.target not in names:
            raise unknown("task", transition.target, names)
    unconditional = [k for k, transition in enumerate(transitions) if not transition.conditions]
    if len(unconditional) > 1:
        first, second = (Message("'{name}'", name=transitions[k].target) for k in unconditional[:2])
        raise conflict(
            "edit.second-default",
            Message(
                "task '{task}' would have an unconditional transition to {first} and one "
                "to {second}",
                task=task,
                first=first,
                second=second,
            ),
            "give one of them a condition, or remove one",
            subject_of("tasks", task, f".transitions[{unconditional[0]}]"),
        )
    changed = mission.tasks[at].model_copy(update={"transitions": tuple(transitions)})
    after = mission.model_copy(
        update={"tasks": (*mission.tasks[:at], changed, *mission.tasks[at + 1 :])}
    )
    return checked_edit_result(mission, after, requested=frozenset([subject_of("tasks", task)]))


def add_transition(
    mission: Mission, task: str, transition: Transition, at: int | None = None
) -> Edited:
    """Add a transition to a task, before the one at a position; as the last one if `at` is None.

    Positions count from 0; the number of transitions means the end, too. Raises as
    `set_transitions` does, and EditNotFound for other positions.
    """
    old_transitions = _find_task(mission, task).transitions
    at = len(old_transitions) if at is None else at
    require_kind(at, int, Message("the position"))
    if not 0 <= at <= len(old_transitions):
        raise _unknown_position(
            "transition", Message("task '{task}'", task=task), at, len(old_transitions)
        )
    return set_transitions(
        mission, task, (*old_transitions[:at], transition, *old_transitions[at:])
    )


def remove_transition(mission: Mission, task: str, at: int) -> Edited:
    """Remove the transition of a task at a position, counted from 0.

    A task without an unconditional transition ends the mission if no condition is true.
    Raises as `add_transition` does.
    """
    old_transitions = _find_task(mission, task).transitions
    _transition_at(task, old_transitions, at)
    return set_transitions(mission, task, (*old_transitions[:at], *old_transitions[at + 1 :]))


def set_target(mission: Mission, task: str, at: int, target: str) -> Edited:
    """Set the target of the transition at a position. Raises as `add_transition` does."""
    return _change_transition(mission, task, at, {"target": target})


def set_conditions(mission: Mission, task: str, at: int, conditions: Sequence[Condition]) -> Edited:
    """Replace the conditions of a transition; without conditions it is unconditional.

    Raises as `add_transition` does.
    """
    for condition in conditions:
        require_kind(condition, Condition, Message("a condition of task '{task}'", task=task))
    return _change_transition(mission, task, at, {"conditions": tuple(conditions)})


def add_condition(mission: Mission, task: str, at: int, condition: Condition) -> Edited:
    """Add a condition to a transition; it must be true in addition to the others.

    Raises as `add_transition` does.
    """
    transition = _transition_at(task, _find_task(mission, task).transitions, at)
    return set_conditions(mission, task, at, (*transition.conditions, condition))


def remove_condition(mission: Mission, task: str, at: int, condition: int) -> Edited:
    """Remove the condition at a position, counted from 0, of a transition.

    A transition without conditions is unconditional. Raises as `add_transition` does.
    """
    require_kind(condition, int, Message("the position of the condition"))
    conditions = _transition_at(task, _find_task(mission, task).transitions, at).conditions
    if not 0 <= condition < len(conditions):
        raise _unknown_position(
            "condition",
            Message("transition {at} of task '{task}'", at=at, task=task),
            condition,
            len(conditions),
        )
    return set_conditions(
        mission, task, at, (*conditions[:condition], *conditions[condition + 1 :])
    )


def _change_transition(mission: Mission, task: str, at: int, update: dict[str, object]) -> Edited:
    old_transitions = _find_task(mission, task).transitions
    changed = _transition_at(task, old_transitions, at).model_copy(update=update)
    return set_transitions(
        mission, task, (*old_transitions[:at], changed, *old_transitions[at + 1 :])
    )


def _transition_at(task: str, transitions: Sequence[Transition], at: int) -> Transition:
    require_kind(at, int, Message("the position"))
    if not 0 <= at < len(transitions):
        raise _unknown_position(
            "transition", Message("task '{task}'", task=task), at, len(transitions)
        )
    return transitions[at]


def _unknown_position(kind: str, owner: str, at: int, count: int) -> EditNotFound:
    hint = Message("it has {count}, counted from 0", count=count)
    return EditNotFound(
        [
            diagnostic_of(
                f"edit.unknown-{kind}",
                Message("{owner} has no transition {at}", owner=owner, at=at)
                if kind == "transition"
                else Message("{owner} has no condition {at}", owner=owner, at=at),
                hint,
            )
        ]
    )


def _find_task(mission: Mission, name: str) -> Task:
    return mission.tasks[_task_index(mission, name)]


def _task_index(mission: Mission, name: str) -> int:
    positions = [i for i, task in enumerate(mission.tasks) if task.name == name]
    return require_single_position(name, positions, {task.name for task in mission.tasks})
