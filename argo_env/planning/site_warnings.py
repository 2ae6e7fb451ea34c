"""Warnings about a mission on its site.

They are about poses that checkpoints can't be read from, and speeds above the robot's own.
"""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Unreachable
from argo_compiler.base.message import Message
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Diagnostic, diagnostic_of
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Action, Mission, Task

if TYPE_CHECKING:
    from argo_env.navigation import Navigator
    from argo_env.planning.opening import OpenedSite
    from argo_env.robot.spec import RobotSpec


def not_seen_from_pose_warnings(mission: Mission, site: "OpenedSite") -> Iterator[Diagnostic]:
    """Yield a warning for each MEASURE task with a pose from which its checkpoint can't be read.

    The hint has the nearest pose from which it can.

    Everything is taken to be where the site's description has it. Tasks whose pose can't be reached
    get no warning, as the analysis reports them; nor do those without a pose.
    """
    for task, reason, seeing in _hidden_checkpoints(mission, site):
        if reason is None:
            continue
        nearest = Message("another pose")
        if seeing is not None:
            nearest = Message("the nearest pose that sees it ({text})", text=_text(seeing))
        yield diagnostic_of(
            "site.not-seen-from-pose",
            Message(
                "task '{task}' measures from a pose from which its checkpoint is not "
                "visible: {reason}",
                task=task.name,
                reason=reason,
            ),
            hint=Message("give {nearest}, or none, so that the robot chooses one", nearest=nearest),
            subject=subject_of("tasks", task.name, ".pose"),
            span=task.source,
        )


def with_seeing_poses(
    mission: Mission, site: "OpenedSite"
) -> tuple[Mission, tuple[Diagnostic, ...]]:
    """Replace each pose from which a checkpoint can't be read by the nearest one that sees it.

    Returns:
        The mission, and a warning for each replaced pose of this mission of isar. A task whose
        checkpoint is not seen from anywhere keeps its pose.
    """
    moved = {
        task: (why or Message("the robot can't stand there"), pose)
        for task, why, pose in _hidden_checkpoints(mission, site)
        if pose
    }
    warnings = tuple(
        diagnostic_of(
            "isar.pose-moved",
            Message(
                "task '{task}' measures from {text}, the nearest pose that sees its "
                "checkpoint, and not from the given one: {why}",
                task=task.name,
                text=_text(pose),
                why=why,
            ),
            hint="check that the robot may stand there",
            subject=subject_of("tasks", task.name, ".pose"),
        )
        for task, (why, pose) in moved.items()
    )
    tasks = tuple(
        task.model_copy(update={"pose": moved[task][1]}) if task in moved else task
        for task in mission.tasks
    )
    return mission.model_copy(update={"tasks": tasks}), warnings


def _hidden_checkpoints(
    mission: Mission, site: "OpenedSite"
) -> Iterator[tuple[Task, str | None, Pose | None]]:
    """Yield each task that can't measure from its pose, why, and the nearest pose where it can.

    The reason is None if the robot can't stand at the pose.
    """
    known = {str(checkpoint.id) for checkpoint in site.site.checkpoints}
    for task in mission.tasks:
        if task.action is not Action.MEASURE or task.pose is None or task.object_id not in known:
            continue
        try:
            reason = _find_obstruction(task, task.pose, site.navigator)
        except Unreachable:
            yield task, None, _nearest_seeing_pose(task, task.pose, site.navigator)
            continue
        if reason is not None:
            yield task, reason, _nearest_seeing_pose(task, task.pose, site.navigator)


def _nearest_seeing_pose(task: Task, pose: Pose, navigator: "Navigator") -> Pose | None:
    checkpoint = navigator.site.checkpoint_for(task.object_id)
    views = navigator.views_by_distance(pose, checkpoint.id)
    return next((one for one in views if not _find_obstruction(task, one, navigator)), None)


def _text(pose: Pose) -> str:
    return Message(
        "x {x:.2f}, y {y:.2f}, z {z:.2f}, yaw {yaw:.2f}", x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw
    )


def _find_obstruction(task: Task, pose: Pose, navigator: "Navigator") -> str | None:
    """Return why a task can't measure from a pose; None: it can.

    Raises Unreachable if the robot can't stand there.
    """
    # Imported here, as a mission without such poses is checked without these modules.
    from argo_env.robot.pose import BodyPose
    from argo_env.sensing.ideal import IdealSensor
    from argo_env.sensing.sensor import MeasurementError
    from argo_env.world.without_physics import WorldWithoutPhysics

    checkpoint = navigator.site.checkpoint_for(task.object_id)
    world = WorldWithoutPhysics(navigator.site, navigator.robot)
    sensor = IdealSensor(world, navigator.robot, {checkpoint.id: checkpoint.nominal.low})
    try:
        snapped = navigator.snap_keeping_heading(pose)
        sensor.measure(checkpoint.id, BodyPose(snapped.x, snapped.y, snapped.z, snapped.yaw))
    except MeasurementError as error:
        return str(error)
    return None


def above_own_speed_warnings(mission: Mission, robot: "RobotSpec") -> Iterator[Diagnostic]:
    """Yield a warning for each task whose velocity is above the robot's own speed.

    The robot's own speed is the one with which travel times are computed for tasks without a
    velocity.
    """
    for task in mission.tasks:
        if task.velocity is None or task.velocity <= robot.speed:
            continue
        yield diagnostic_of(
            "site.faster-than-robot",
            Message(
                "the path to task '{task}' is to be driven at {velocity:g} m/s, but the "
                "robot {robot} is not known to drive faster than {speed:g} m/s",
                task=task.name,
                velocity=task.velocity,
                robot=robot.name,
                speed=robot.speed,
            ),
            hint=Message("give at most {speed:g} m/s", speed=robot.speed),
            subject=subject_of("tasks", task.name, ".velocity"),
            span=task.source,
        )
