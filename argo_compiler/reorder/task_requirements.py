"""Requirements of single tasks, written into the tasks of a mission."""

from argo_compiler.il import Mission, Task, TimeWindow
from argo_compiler.reorder.requirements import RequiredWindow, Requirements
from argo_compiler.reorder.visits import Visits


def with_requirements(mission: Mission, visits: Visits, requirements: Requirements) -> Mission:
    """Return the mission whose tasks have the required windows, priorities and optionality.

    A required value replaces the task's own.
    Raises ArgoError if a requirement names something that the mission does not have.
    """
    changed: dict[str, dict[str, object]] = {}
    tasks = {task.name: task for task in mission.tasks}

    def change(leaf: int, **fields: object) -> None:
        changed.setdefault(visits.chain.name(leaf), {}).update(fields)

    for priority in requirements.optional:
        for k in visits.resolve_visits(priority.what):
            change(visits.task_units[k].entry, priority=priority.priority)
        for k in visits.with_whole_groups(visits.resolve_visits(priority.what)):
            for leaf in visits.task_units[k].leaves:
                change(leaf, optional=True)
    for what in requirements.mandatory:
        for k in visits.with_whole_groups(visits.resolve_visits(what)):
            for leaf in visits.task_units[k].leaves:
                change(leaf, optional=False)
    for window in requirements.windows:
        for k in visits.resolve_visits(window.what):
            entry = visits.task_units[k].entry
            change(entry, window=_window(tasks[visits.chain.name(entry)], window))
    if not changed:
        return mission
    return mission.model_copy(
        update={
            "tasks": tuple(
                task.model_copy(update=changed.get(task.name, {})) for task in mission.tasks
            )
        }
    )


def _window(task: Task, required: RequiredWindow) -> TimeWindow:
    """Return the required window as a hard one with the missed target of the task's own window."""
    own = task.window.missed_target if task.window and required.latest is not None else None
    return TimeWindow(earliest=required.earliest, latest=required.latest, missed_target=own)
