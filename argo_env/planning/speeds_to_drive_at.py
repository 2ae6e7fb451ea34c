"""Whether a mission's tasks ask for speeds that the robot is known to drive at."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Mission

if TYPE_CHECKING:
    from argo_env.robot.spec import RobotSpec


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
