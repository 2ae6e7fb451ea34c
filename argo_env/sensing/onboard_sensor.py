"""The sensor for checkpoints with what can go wrong in it, and its self-test."""

from dataclasses import replace

import numpy as np

from argo_env.robot.pose import BodyPose
from argo_env.sensing.sensor import Measurement, MeasurementError, Sensor
from argo_env.site import Site

_HEALTHY_NOISE = 0.001  # of the scale, in the picture of the test pattern
_SHOTS = 8  # pictures of the test pattern in one self-test


class OnboardSensor:
    """A sensor that may fail. Holds how it stands; faults change that."""

    def __init__(self, sensor: Sensor, site: Site, rng: np.random.Generator) -> None:
        self._sensor = sensor
        self._site = site
        self._rng = rng
        self.name = sensor.name
        self.failed = False
        """whether the camera gives no picture"""
        self.noise = 0.0
        """standard deviation of what it adds to values, as a share of their scale"""

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Reads the checkpoint as the sensor does, as far as it works."""
        if self.failed:
            raise MeasurementError("the camera gives no picture")
        found = self._sensor.measure(checkpoint_id, pose)
        if not self.noise:
            return found
        scale = self._site.checkpoint(checkpoint_id).range
        value = found.value + self.noise * (scale.high - scale.low) * self._rng.standard_normal()
        return replace(found, value=round(min(max(value, scale.low), scale.high), 2))

    def test(self) -> tuple[float, ...] | None:
        """What the camera makes of the test pattern inside its housing, which stands at 0 of 1, in
        several pictures; None if there is no picture."""
        if self.failed:
            return None
        spread = max(self.noise, _HEALTHY_NOISE)
        return tuple((spread * self._rng.standard_normal(_SHOTS)).tolist())
