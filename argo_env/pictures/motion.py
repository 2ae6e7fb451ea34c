"""The robot's motion according to a record: its pose and its joints at any time."""

import math

import numpy as np

from argo_compiler.base.errors import Conflict, Invalid
from argo_env.drives.drive import FLAT, RAISED
from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import RobotSpec
from argo_env.run.record import RunRecord
from argo_env.site import Site

_STAIR_PITCH = math.radians(5.0)  # above which the flippers are flat
_PITCH_RAMP = math.radians(2.0)  # to each side of it, in which they move, so that they don't jump
_ARM_TIME = 2.0  # s to raise or to stow the arm


class RecordedMotion:
    """The motion of a record, interpolated between the samples of its path."""

    def __init__(self, record: RunRecord, robot: RobotSpec) -> None:
        """Initialise the motion from a record.

        Raises:
            Invalid: The record has no path.
        """
        if not record.path:
            raise Invalid("the record has no path: there is nothing to draw")
        path = record.path
        self._robot = robot
        self._times = np.array([s.t for s in path])
        self._floors = [s.floor for s in path]
        yaws = np.unwrap([s.yaw for s in path])
        self._values = np.array([(s.x, s.y, s.z, s.pitch) for s in path])
        self._values = np.column_stack([self._values, yaws])
        self._readings = [r.t for r in record.readings]

    @property
    def end_time(self) -> float:
        """Time (s) of the last sample."""
        return float(self._times[-1])

    def pose_at(self, t: float) -> BodyPose:
        """Return the pose at the time t (s), interpolated; outside the path, its nearest end."""
        x, y, z, pitch, yaw = (float(np.interp(t, self._times, v)) for v in self._values.T)
        return BodyPose(x, y, z, yaw, pitch)

    def floor_at(self, t: float) -> int:
        """Return the floor of the last sample up to the time t (s), or of the first one."""
        return self._floors[max(0, int(np.searchsorted(self._times, t, side="right")) - 1)]

    def joint_degrees_at(self, t: float) -> dict[str, float]:
        """Return the positions of the robot's joints at the time t (s), in degrees, by name.

        They are computed from the pitch and the times of the readings: the record has no joints.
        """
        stairs = (abs(self.pose_at(t).pitch) - _STAIR_PITCH) / _PITCH_RAMP
        level = min(1.0, max(0.0, (1.0 - stairs) / 2))
        flippers = math.degrees(FLAT + level * (RAISED - FLAT))
        raised = self._raised(t)
        stowed, up = self._robot.arm_stowed, self._robot.arm_raised
        arm = {name: stowed[name] + raised * (up[name] - stowed[name]) for name in stowed}
        return arm | {"left_flipper_joint": flippers, "right_flipper_joint": flippers}

    def _raised(self, t: float) -> float:
        """Return how far the arm is raised at the time t (s): 0 is stowed, 1 is fully raised."""
        share = 0.0
        for end in self._readings:
            since, left = t - (end - self._robot.sensor.measuring_time), end - t
            share = max(share, min(1.0, since / _ARM_TIME, left / _ARM_TIME))
        return share


def check_record_site(record: RunRecord, site: Site) -> None:
    """Raise an error if the record is of a run on another site.

    Raises:
        Conflict: The sites differ.
    """
    if record.site != site.name:
        raise Conflict(
            f"the record is of a run on site `{record.site}`, not on `{site.name}`: load that site"
        )
