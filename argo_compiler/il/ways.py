"""Where tasks lead: the unconditional transition, what follows a failure, and the beginning."""

from argo_compiler.il.mission import Action, Mission, Task


def default_target(task: Task) -> str | None:
    """The target of the unconditional transition; None: the mission ends after the task."""
    for transition in task.transitions:
        if not transition.conditions:
            return transition.target
    return None


def branches(task: Task) -> dict[str, str]:
    """Where the task leads when it has failed or has missed its window, by the field that says
    so."""
    found = {}
    if task.failure_target is not None:
        found["failure_target"] = task.failure_target
    if task.window is not None and task.window.missed_target is not None:
        found["window.missed_target"] = task.window.missed_target
    return found


def start_task(mission: Mission) -> Task | None:
    """Where a mission says that the robot stands at its beginning; None: it does not say."""
    return next((task for task in mission.tasks if task.action is Action.START), None)


def beginning(mission: Mission) -> str | None:
    """The task that the mission begins with (rule M1); None: it has none but START."""
    start = start_task(mission)
    target = None if start is None else default_target(start)
    if target is not None:
        return target
    return next((task.name for task in mission.tasks if task.action is not Action.START), None)
