"""Poses from which the robot reads the checkpoints of a mission, for the export to isar."""

from argo_compiler.base.model import Pose
from argo_compiler.export import InspectionView
from argo_compiler.il import Action, Mission
from argo_env.navigation import Navigator


def inspection_views_by_object_id(
    mission: Mission, navigator: Navigator
) -> dict[str, InspectionView]:
    """Return the viewing pose for each checkpoint that a mission measures, by its `object_id`.

    They are the poses of a robot that executes the tasks in the order of the list and chooses by
    itself from where it measures: the poses of MEASURE tasks are not used. If a checkpoint is
    measured several times, the pose is that of the first time. Checkpoints that are not on the site
    are left out. Raises Unreachable if a checkpoint has no viewing pose.
    """
    known = {str(checkpoint.id): checkpoint for checkpoint in navigator.site.checkpoints}
    docks = navigator.site.docks
    pose: Pose | None = docks[min(docks)] if docks else None
    views: dict[str, InspectionView] = {}
    for task in mission.tasks:
        checkpoint = known.get(task.object_id or "")
        if task.action is not Action.MEASURE:
            pose = task.pose or pose
        elif checkpoint and task.object_id not in views:
            path = navigator.plan_to_view(pose or _some_pose(navigator), checkpoint.id)
            pose = path.end
            views[str(checkpoint.id)] = InspectionView(
                pose=pose, target=checkpoint.position, name=checkpoint.name
            )
    return views


def _some_pose(navigator: Navigator) -> Pose:
    """Return a pose that can be reached on the site's lowest floor, for a site without docks."""
    x, y, z, _ = navigator.turning_poses(navigator.site.spec.floors[0].number)[0].tolist()
    return Pose(x=x, y=y, z=z)
