"""The pose at which a mission starts."""

from collections.abc import Mapping

from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Mission


def start_pose_or_area_dock(mission: Mission, docks: Mapping[int, Pose]) -> Pose:
    """Return the pose of the mission's START task or, without one, the dock of its starting area.

    If the mission names no starting area, or one that is not among `docks`, it is the dock with the
    lowest number. `docks` has the pose of the docked robot by the number of the area.
    """
    for task in mission.tasks:
        if task.action is Action.START and task.pose is not None:
            return task.pose
    first = docks[min(docks)]
    return first if mission.start_area is None else docks.get(mission.start_area, first)
