"""Where the tasks of a mission stand in its list."""

from collections.abc import Mapping

from argo_compiler.base.remembering import remembering
from argo_compiler.il.mission import Mission


@remembering
def task_positions(mission: Mission) -> Mapping[str, int]:
    """The position of each task by its name; of several with one name, the first one's."""
    names = [task.name for task in mission.tasks]
    return dict(zip(reversed(names), range(len(names) - 1, -1, -1), strict=True))
