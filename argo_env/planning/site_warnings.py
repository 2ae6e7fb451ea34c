"""Warnings about a mission on its site: poses that checkpoints can't be read from, and speeds that
the robot is not known to drive at."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from argo_compiler.base.errors import Unreachable
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Action, Mission, Task

if TYPE_CHECKING:
    from argo_env.navigation import Navigator
    from argo_env.planning.opening import OpenedSite
    from argo_env.robot.spec import RobotSpec


def unseen_from_poses(mission: Mission, site: "OpenedSite") -> Iterator[Diagnostic]:
    """A warning for each MEASURE whose pose does not see the checkpoint, with all where the plan
    has it. Of poses that can't be reached the analysis tells."""
    known = {str(checkpoint.id) for checkpoint in site.site.checkpoints}
    for task in mission.tasks:
        if task.action is not Action.MEASURE or task.pose is None or task.object_id not in known:
            continue
        why = _why_unseen(task, task.pose, site.navigator)
        if why is not None:
            yield Diagnostic(
                code="site.not-seen-from-pose",
                severity=Severity.WARNING,
                message=f"task '{task.name}' measures from a pose that does not see its "
                f"checkpoint: {why}",
                hint="give another pose, or none: then the robot chooses one",
                subject=subject_of("tasks", task.name, ".pose"),
                span=task.source,
            )


def _why_unseen(task: Task, pose: Pose, navigator: "Navigator") -> str | None:
    # A mission without such poses is checked without these.
    from argo_env.robot.pose import BodyPose
    from argo_env.sensing.ideal import IdealSensor
    from argo_env.sensing.sensor import MeasurementError
    from argo_env.world.without_physics import WorldWithoutPhysics

    checkpoint = navigator.site.checkpoint_for(task.object_id)
    world = WorldWithoutPhysics(navigator.site, navigator.robot)
    sensor = IdealSensor(world, navigator.robot, {checkpoint.id: checkpoint.nominal.low})
    try:
        place = navigator.snap(pose)
        sensor.measure(checkpoint.id, BodyPose(place.x, place.y, place.z, place.yaw))
    except MeasurementError as error:
        return str(error)
    except Unreachable:
        return None
    return None


def too_fast(mission: Mission, robot: "RobotSpec") -> Iterator[Diagnostic]:
    """A warning for each task whose way is to be driven faster than the robot's own speed, with
    which all else counts."""
    for task in mission.tasks:
        if task.velocity is None or task.velocity <= robot.speed:
            continue
        yield Diagnostic(
            code="site.faster-than-robot",
            severity=Severity.WARNING,
            message=f"the way to task '{task.name}' is to be driven at {task.velocity:g} m/s; the "
            f"robot {robot.name} drives at {robot.speed:g} m/s, and is not known to go any faster",
            hint=f"ask for at most {robot.speed:g} m/s",
            subject=subject_of("tasks", task.name, ".velocity"),
            span=task.source,
        )
