"""Targets of a task's transitions and branches, and copies of tasks with other targets."""

from collections.abc import Mapping

from argo_compiler.il import Task, Transition


def default_targets(task: Task) -> list[str]:
    """Return the targets of a task's unconditional transitions: a valid task has one or none."""
    return [transition.target for transition in task.transitions if not transition.conditions]


def with_default_target(task: Task, target: str | None) -> Task:
    """Return the task with an unconditional transition to `target`, or without one for None.

    The transition keeps its position among the transitions; a new one comes last.
    """
    transitions: list[Transition] = []
    replaced = False
    for transition in task.transitions:
        if transition.conditions:
            transitions.append(transition)
            continue
        replaced = True
        if target is not None:
            transitions.append(transition.model_copy(update={"target": target}))
    if target is not None and not replaced:
        transitions.append(Transition(target=target))
    return task.model_copy(update={"transitions": tuple(transitions)})


def with_renamed_targets(task: Task, new_names: Mapping[str, str]) -> Task:
    """Return the task with new names in the targets of its transitions and after failures.

    `new_names` maps former names to new names.
    """
    update: dict[str, object] = {}
    if any(transition.target in new_names for transition in task.transitions):
        update["transitions"] = tuple(
            transition.model_copy(
                update={"target": new_names.get(transition.target, transition.target)}
            )
            for transition in task.transitions
        )
    if (failed := new_names.get(task.failure_target or "")) is not None:
        update["failure_target"] = failed
    window = task.window
    if window and (missed := new_names.get(window.missed_target or "")) is not None:
        update["window"] = window.model_copy(update={"missed_target": missed})
    return task.model_copy(update=update) if update else task
