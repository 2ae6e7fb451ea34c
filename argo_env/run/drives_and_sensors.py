"""Extension points of drives and sensors.

The modules that one of Argo's own needs are imported when it is made.
"""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

from argo_compiler.base.extensions import ExtensionPoint, function_problem

if TYPE_CHECKING:
    from argo_env.drives.drive import Drive
    from argo_env.robot.spec import RobotSpec
    from argo_env.sensing.sensor import Sensor
    from argo_env.world.world import World

ROUTE = "route"
"""Name of the drive that uses travel times alone and has no world."""
KINEMATIC = "kinematic"
"""Name of the fastest drive that has a world."""
REMOTE = "remote"
"""Name of the drive of a robot that connects to the planning service."""


def _kinematic(world: "World", robot: "RobotSpec", friction: float) -> "Drive":  # noqa: ARG001
    from argo_env.drives.kinematic import KinematicDrive

    return KinematicDrive(world, robot)


def _tracked(world: "World", robot: "RobotSpec", friction: float) -> "Drive":
    from argo_env.drives.tracked.belts import Traction
    from argo_env.drives.tracked.drive import TrackedDrive

    return TrackedDrive(world, robot, traction=Traction().with_scaled_grip(friction))


WORLD_DRIVES: ExtensionPoint[Callable[["World", "RobotSpec", float], "Drive"]] = ExtensionPoint(
    "argo.drives",
    "drive",
    {KINEMATIC: _kinematic, "tracked": _tracked},
    function_problem,
    reserved=(ROUTE, REMOTE),
)
"""Factories of the drives that move the robot in PyBullet's world; their last argument is the
friction as a factor of the calibrated one."""


def drive_names() -> tuple[str, ...]:
    """Return the names of all drives that a simulated run can have."""
    return (ROUTE, *WORLD_DRIVES)


IDEAL = "ideal"
"""Name of the sensor that knows the true values; the only one that needs no simulated world."""


def _ideal(world: "World", truth: Mapping[int, float], seed: int) -> "Sensor":  # noqa: ARG001
    from argo_env.sensing.ideal import IdealSensor

    return IdealSensor(world, world.robot, truth)


def _camera(world: "World", truth: Mapping[int, float], seed: int) -> "Sensor":  # noqa: ARG001
    from argo_env.sensing.vision.sensor import CameraSensor

    return CameraSensor(world, seed)


SENSORS: ExtensionPoint[Callable[["World", Mapping[int, float], int], "Sensor"]] = ExtensionPoint(
    "argo.sensors", "sensor", {IDEAL: _ideal, "camera": _camera}, function_problem
)
"""Factories of the sensors, from the world, the true values of the checkpoints, and a seed."""
