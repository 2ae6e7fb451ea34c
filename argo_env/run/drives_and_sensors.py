"""Drives and sensors by name; the modules that one of them needs are imported when it is made."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_env.drives.drive import Drive
    from argo_env.robot.spec import RobotSpec
    from argo_env.sensing.sensor import Sensor
    from argo_env.world.world import World

ROUTE = "route"
"""Name of the drive that uses travel times alone and has no world."""


def _kinematic(world: "World", robot: "RobotSpec", friction: float) -> "Drive":  # noqa: ARG001
    from argo_env.drives.kinematic import KinematicDrive

    return KinematicDrive(world, robot)


def _tracked(world: "World", robot: "RobotSpec", friction: float) -> "Drive":
    from argo_env.drives.tracked.belts import Traction
    from argo_env.drives.tracked.drive import TrackedDrive

    return TrackedDrive(world, robot, traction=Traction().with_scaled_grip(friction))


WORLD_DRIVES: dict[str, Callable[["World", "RobotSpec", float], "Drive"]] = {
    "kinematic": _kinematic,
    "tracked": _tracked,
}
"""Factories of the drives that move the robot in PyBullet's world; their last argument is the
friction as a factor of the calibrated one."""

DRIVES = (ROUTE, *WORLD_DRIVES)
"""Names of all drives."""

IDEAL = "ideal"
"""Name of the sensor that knows the true values; the only one that needs no simulated world."""


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
"""Factories of the sensors, from the world, the true values of the checkpoints, and a seed."""
