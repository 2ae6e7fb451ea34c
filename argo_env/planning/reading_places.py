"""From where each checkpoint of a mission would be read: what isar's missions have to say."""

from argo_compiler.base.model import Pose
from argo_compiler.il import Action, Mission
from argo_compiler.isar import InspectionView
from argo_env.navigation import Navigator


def inspection_views(mission: Mission, navigator: Navigator) -> dict[str, InspectionView]:
    """For each checkpoint that the mission measures, by its `object_id`, the place that a robot
    reads it from that does the tasks in list order. Checkpoints that the site has not are left out.

    Raises Unreachable where there is no such place.
    """
    known = {str(checkpoint.id): checkpoint for checkpoint in navigator.site.checkpoints}
    docks = navigator.site.docks
    here: Pose | None = docks[min(docks)] if docks else None
    views: dict[str, InspectionView] = {}
    for task in mission.tasks:
        checkpoint = known.get(task.object_id or "")
        if task.action is not Action.MEASURE:
            here = task.pose or here
        elif checkpoint and task.object_id not in views:
            path = navigator.plan_to_view(here or _anywhere(navigator), checkpoint.id)
            here = path.end
            views[str(checkpoint.id)] = InspectionView(
                pose=here, target=checkpoint.position, name=checkpoint.name
            )
    return views


def _anywhere(navigator: Navigator) -> Pose:
    x, y, z, _ = navigator.turning_poses(navigator.site.spec.floors[0].number)[0].tolist()
    return Pose(x=x, y=y, z=z)
