"""Where tasks lead: their unconditional transitions, and where a mission begins."""

from argo_compiler.il import Action, Mission, Task, Transition


def defaults(task: Task) -> list[str]:
    """The targets of the task's unconditional transitions: one, or none where the mission ends."""
    return [way.target for way in task.transitions if not way.conditions]


def default_target(task: Task) -> str | None:
    """The target of the unconditional transition; None: the mission ends after the task."""
    return next(iter(defaults(task)), None)


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


def beginning(mission: Mission) -> str | None:
    """The task that the mission begins with (rule M1); None: it has none but START."""
    start = next((task for task in mission.tasks if task.action is Action.START), None)
    target = None if start is None else default_target(start)
    if target is not None:
        return target
    return next((task.name for task in mission.tasks if task.action is not Action.START), None)
