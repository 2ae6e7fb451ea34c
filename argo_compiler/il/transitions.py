"""Targets of tasks: unconditional, after a failure, and at the mission's start."""

from argo_compiler.il.mission import Action, Mission, Task


def default_target(task: Task) -> str | None:
    """Return the target of a task's unconditional transition; None: none, the mission ends."""
    for transition in task.transitions:
        if not transition.conditions:
            return transition.target
    return None


def failure_targets_by_field(task: Task) -> dict[str, str]:
    """Return the targets after a failure and a missed window, by the field that contains them."""
    targets = {}
    if task.failure_target is not None:
        targets["failure_target"] = task.failure_target
    if task.window is not None and task.window.missed_target is not None:
        targets["window.missed_target"] = task.window.missed_target
    return targets


def find_start_pose_task(mission: Mission) -> Task | None:
    """Return the START task, which has the robot's initial pose, or None if there is none."""
    return next((task for task in mission.tasks if task.action is Action.START), None)


def initial_task(mission: Mission) -> str | None:
    """Return the name of the task that the mission starts with (rule M1).

    Returns None if the mission has no task but START.
    """
    start = find_start_pose_task(mission)
    target = None if start is None else default_target(start)
    if target is not None:
        return target
    return next((task.name for task in mission.tasks if task.action is not Action.START), None)
