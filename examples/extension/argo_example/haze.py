"""Sensor in hazy air: it reads the true value, but only from near."""

from collections.abc import Mapping

from argo_env.robot.pose import BodyPose
from argo_env.sensing.ideal import IdealSensor
from argo_env.sensing.sensor import Measurement, PoorViewError
from argo_env.world.world import World

SIGHT = 2.0
"""m, the largest distance from which anything can be read"""


class HazeSensor:
    """Sensor that reads from at most `SIGHT` m, and is less sure the farther away it is."""

    name = "haze"

    def __init__(self, clear: IdealSensor) -> None:
        self._clear = clear

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Read the checkpoint as in clear air; raise PoorViewError if it is too far away."""
        measured = self._clear.measure(checkpoint_id, pose)
        if measured.distance > SIGHT:
            raise PoorViewError(f"it is {measured.distance:.1f} m away, and haze hides it")
        sureness = 1.0 - 0.5 * measured.distance / SIGHT
        return Measurement(measured.value, measured.distance, sureness)


def make_sensor(world: World, truth: Mapping[int, float], seed: int) -> HazeSensor:  # noqa: ARG001
    """Return the sensor for a run; `truth` has the values by checkpoint, `seed` is the run's."""
    return HazeSensor(IdealSensor(world, world.robot, truth))
