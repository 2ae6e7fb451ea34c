"""Ideal sensor: it knows the true values, but returns only those that a camera could see."""

from collections.abc import Mapping

import numpy as np

from argo_compiler.base.message import Message
from argo_env.navigation.views import camera_positions, face_normal, sight_target
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.seeding import draw
from argo_env.sensing.sensor import Measurement, MeasurementError, PoorViewError
from argo_env.site import Site
from argo_env.world.without_physics import AnyWorld


class IdealSensor:
    """Sensor that returns true values of faces that the camera could see and read."""

    name = "ideal"

    def __init__(self, world: AnyWorld, robot: RobotSpec, truth: Mapping[int, float]) -> None:
        self._world = world
        self._robot = robot
        self._truth = truth

    def measure(self, checkpoint_id: int, pose: BodyPose) -> Measurement:
        """Return the true value of the checkpoint, and the camera's distance from it.

        Raises MeasurementError if the raised camera of a robot at `pose` is too near, too far, or
        too oblique to the checkpoint's face, or if something hides the face.
        """
        checkpoint = self._world.actual_checkpoint(checkpoint_id)
        sensor = self._robot.sensor
        camera = camera_positions(np.array([[pose.x, pose.y, pose.z, pose.yaw]]), self._robot)[0]
        target = sight_target(checkpoint)
        sight = target - camera
        distance = float(np.linalg.norm(sight))
        if not sensor.min_range <= distance <= sensor.max_range:
            raise MeasurementError(
                Message(
                    "{checkpoint} is {distance:.2f} m away; the camera reads from {min_range} "
                    "m to {max_range} m",
                    checkpoint=checkpoint.name,
                    distance=distance,
                    min_range=sensor.min_range,
                    max_range=sensor.max_range,
                )
            )
        cosine = float(-sight @ face_normal(checkpoint)) / distance
        obliqueness = float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
        if obliqueness > sensor.max_obliqueness:
            raise PoorViewError(
                Message(
                    "{checkpoint} is seen at {obliqueness:.0f} degrees to its face; the camera "
                    "reads up to {max_obliqueness:.0f}",
                    checkpoint=checkpoint.name,
                    obliqueness=obliqueness,
                    max_obliqueness=sensor.max_obliqueness,
                )
            )
        obstacle = self._world.obstacle_between(tuple(camera.tolist()), tuple(target.tolist()))
        if obstacle is not None:
            raise PoorViewError(
                Message(
                    "{checkpoint} is hidden behind {obstacle}",
                    checkpoint=checkpoint.name,
                    obstacle=obstacle,
                )
            )
        return Measurement(self._truth[checkpoint_id], distance)


def draw_nominal_values(site: Site, rng: np.random.Generator) -> dict[int, float]:
    """Draw a true value for each checkpoint from its nominal range; return them by its id.

    Values are in the checkpoint's unit, lie on its scale, and have two decimals, except where the
    range is too narrow for that.
    """
    values = {}
    for c in site.checkpoints:
        scale, nominal = c.range, c.nominal
        low, high = (min(max(v, scale.low), scale.high) for v in (nominal.low, nominal.high))
        values[c.id] = draw(rng, low, high, 2)
    return values
