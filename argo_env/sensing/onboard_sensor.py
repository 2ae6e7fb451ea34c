"""The sensor for checkpoints with what can go wrong in it, and its self-test."""

from dataclasses import replace

from argo_env.robot.pose import BodyPose
from argo_env.seeding import generator
from argo_env.sensing.sensor import Measurement, MeasurementError, Sensor
from argo_env.site import Site

_HEALTHY_NOISE = 0.001  # of the scale, in the picture of the test pattern
_SHOTS = 8  # pictures of the test pattern in one self-test


class OnboardSensor:
    """A sensor that may fail. Holds how it stands; faults change that."""

    def __init__(self, sensor: Sensor, site: Site, seed: int, usual_noise: float = 0.0) -> None:
        """`usual_noise`: that of a sensor in order, as a share of the scale."""
        self._sensor = sensor
        self._site = site
        self._seed = seed
        self._tests = generator(seed, "instrument")
        self.name = sensor.name
        self.moment = 0.0
        """s, when it reads next"""
        self.failed = False
        """whether the camera gives no picture"""
        self.usual_noise = usual_noise
        """standard deviation of what it adds to values while nothing is wrong with it, as a share
        of their scale"""
        self.noise = usual_noise
        """the same as it is now"""

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Reads the checkpoint as the sensor does, as far as it works."""
        if self.failed:
            raise MeasurementError("the camera gives no picture")
        found = self._sensor.measure(checkpoint_id, pose)
        if not self.noise:
            return found
        scale = self._site.checkpoint(checkpoint_id).range
        # Of checkpoint and moment alone: what else was read before changes nothing.
        rng = generator(self._seed, "reading", checkpoint_id, round(1000 * self.moment))
        value = found.value + self.noise * (scale.high - scale.low) * rng.standard_normal()
        return replace(found, value=round(min(max(value, scale.low), scale.high), 2))

    def test(self) -> tuple[float, ...] | None:
        """What the camera makes of the test pattern inside its housing, which stands at 0 of 1, in
        several pictures; None if there is no picture."""
        if self.failed:
            return None
        spread = max(self.noise, _HEALTHY_NOISE)
        return tuple((spread * self._tests.standard_normal(_SHOTS)).tolist())
