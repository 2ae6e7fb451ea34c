"""Where tasks lead, read as a list and changed."""

from collections.abc import Mapping

from argo_compiler.il import Task, Transition


def defaults(task: Task) -> list[str]:
    """The targets of the task's unconditional transitions: one, or none where the mission ends."""
    return [way.target for way in task.transitions if not way.conditions]


def with_default(task: Task, target: str | None) -> Task:
    """The task with its unconditional transition to the target, or without one.

    It stays where it is among the transitions; a new one stands behind all.
    """
    ways: list[Transition] = []
    found = False
    for way in task.transitions:
        if way.conditions:
            ways.append(way)
            continue
        found = True
        if target is not None:
            ways.append(way.model_copy(update={"target": target}))
    if target is not None and not found:
        ways.append(Transition(target=target))
    return task.model_copy(update={"transitions": tuple(ways)})


def retargeted(task: Task, called: Mapping[str, str]) -> Task:
    """The task with other targets of all its ways; `called` has the new ones by the former."""
    update: dict[str, object] = {}
    if any(way.target in called for way in task.transitions):
        update["transitions"] = tuple(
            way.model_copy(update={"target": called.get(way.target, way.target)})
            for way in task.transitions
        )
    if (failed := called.get(task.failure_target or "")) is not None:
        update["failure_target"] = failed
    window = task.window
    if window and (missed := called.get(window.missed_target or "")) is not None:
        update["window"] = window.model_copy(update={"missed_target": missed})
    return task.model_copy(update=update) if update else task
