"""The mission that is asked for: what requirements say of single tasks is said by the tasks."""

from argo_compiler.il import Mission, Task, TimeWindow
from argo_compiler.reorder.requirements import RequiredWindow, Requirements
from argo_compiler.reorder.visits import Visits


def with_requirements(mission: Mission, visits: Visits, requirements: Requirements) -> Mission:
    """The mission whose tasks have the windows and priorities that are asked for, in the place of
    their own, and are optional or not as it is asked for.

    Raises ArgoError if a requirement names something that the mission does not have.
    """
    changed: dict[str, dict[str, object]] = {}
    tasks = {task.name: task for task in mission.tasks}

    def change(leaf: int, **fields: object) -> None:
        changed.setdefault(visits.spine.name(leaf), {}).update(fields)

    for one in requirements.optional:
        for k in visits.find(one.what):
            change(visits.stops[k].entry, priority=one.priority)
        for k in visits.whole(visits.find(one.what)):
            for leaf in visits.stops[k].leaves:
                change(leaf, optional=True)
    for what in requirements.mandatory:
        for k in visits.whole(visits.find(what)):
            for leaf in visits.stops[k].leaves:
                change(leaf, optional=False)
    for window in requirements.windows:
        for k in visits.find(window.what):
            entry = visits.stops[k].entry
            change(entry, window=_window(tasks[visits.spine.name(entry)], window))
    if not changed:
        return mission
    return mission.model_copy(
        update={
            "tasks": tuple(
                task.model_copy(update=changed.get(task.name, {})) for task in mission.tasks
            )
        }
    )


def _window(task: Task, asked: RequiredWindow) -> TimeWindow:
    """A hard one, which is missed where the task's own was."""
    own = task.window.missed_target if task.window and asked.latest is not None else None
    return TimeWindow(earliest=asked.earliest, latest=asked.latest, missed_target=own)
