"""The sensors for checkpoints by name. What a sensor needs is imported when one is made."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from argo_env.sensing.sensor import Sensor
    from argo_env.world.world import World

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
