"""Where a mission begins."""

from collections.abc import Mapping

from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Mission


def start_pose(mission: Mission, docks: Mapping[int, Pose]) -> Pose:
    """The pose of START, or the dock of the starting area; of the first one where none is named."""
    for task in mission.tasks:
        if task.action is Action.START and task.pose is not None:
            return task.pose
    first = docks[min(docks)]
    return first if mission.start_area is None else docks.get(mission.start_area, first)
