"""The drives by name. What a drive needs is imported when one is made."""

from collections.abc import Callable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_env.drives.drive import Drive
    from argo_env.robot.spec import RobotSpec
    from argo_env.world.world import World

ROUTE = "route"
"""The drive that goes by travel times alone, and has no world."""


def _kinematic(world: "World", robot: "RobotSpec") -> "Drive":
    from argo_env.drives.kinematic import KinematicDrive

    return KinematicDrive(world, robot)


def _tracked(world: "World", robot: "RobotSpec") -> "Drive":
    from argo_env.drives.tracked.drive import TrackedDrive

    return TrackedDrive(world, robot)


WORLD_DRIVES: dict[str, Callable[["World", "RobotSpec"], "Drive"]] = {
    "kinematic": _kinematic,
    "tracked": _tracked,
}
"""What makes the drives that move the robot in PyBullet's world."""

DRIVES = (ROUTE, *WORLD_DRIVES)
"""The names of all drives."""
