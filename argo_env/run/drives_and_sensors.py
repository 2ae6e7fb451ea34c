"""The drives and the sensors by name. What one of them needs is imported when it is made."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_env.drives.drive import Drive
    from argo_env.robot.spec import RobotSpec
    from argo_env.sensing.sensor import Sensor
    from argo_env.world.world import World

ROUTE = "route"
"""The drive that goes by travel times alone, and has no world."""


def _kinematic(world: "World", robot: "RobotSpec", friction: float) -> "Drive":  # noqa: ARG001
    from argo_env.drives.kinematic import KinematicDrive

    return KinematicDrive(world, robot)


def _tracked(world: "World", robot: "RobotSpec", friction: float) -> "Drive":
    from argo_env.drives.tracked.belts import Traction
    from argo_env.drives.tracked.drive import TrackedDrive

    return TrackedDrive(world, robot, traction=Traction().scaled(friction))


WORLD_DRIVES: dict[str, Callable[["World", "RobotSpec", float], "Drive"]] = {
    "kinematic": _kinematic,
    "tracked": _tracked,
}
"""What makes the drives that move the robot in PyBullet's world, with the friction beside the
calibrated one."""

DRIVES = (ROUTE, *WORLD_DRIVES)
"""The names of all drives."""

IDEAL = "ideal"
"""The sensor that knows the true values; the only one that needs no world to look at."""


def _ideal(world: "World", truth: Mapping[int, float], seed: int) -> "Sensor":  # noqa: ARG001
    from argo_env.sensing.ideal import IdealSensor

    return IdealSensor(world, world.robot, truth)


def _camera(world: "World", truth: Mapping[int, float], seed: int) -> "Sensor":  # noqa: ARG001
    from argo_env.sensing.vision.sensor import CameraSensor

    return CameraSensor(world, seed)


SENSORS: dict[str, Callable[["World", Mapping[int, float], int], "Sensor"]] = {
    IDEAL: _ideal,
    "camera": _camera,
}
"""What makes a sensor for the world, in which the checkpoints have these true values, with a
seed."""
