"""Expert for Drive-v0, which follows the navigator's path as the drive `tracked` does."""

import math
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Pose
from argo_env.drives.tracked.body import FLIPPER_LIMITS
from argo_env.drives.tracked.flippers import CAREFUL_SPEED, Flight, Flippers, measure_flight
from argo_env.drives.tracked.follower import Follower
from argo_env.envs.drive import PERIOD, SPEED, TURN_RATE, DriveEnv
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose

_MAX_DEVIATION = 0.3  # m from the path, beyond which the expert plans a new one
# Within this angle (rad) of a turn's end, the expert waits until the robot is at rest: with one
# command in 0.1 s, the lowest turn rate of the follower would make it swing to and fro for ever.
_TURN_TOLERANCE = math.radians(0.5)


class Expert:
    """Expert that drives one episode, for imitation or as a reference.

    It holds the path, the progress along it, and the angle of the flippers. It knows the robot's
    true pose, the plan of the site and the path, but acts by actions alone. Another policy may
    drive in between: if the robot is off the path on level ground, the expert plans a new path.
    """

    def __init__(self, env: gym.Env[Any, Any]) -> None:
        """Plan a path for the present episode of `env`: create a new expert after each reset.

        `env` is Drive-v0, wrapped or not; for any other environment ArgoError is raised. Raises
        Unreachable if there is no path to the goal, for example if faults block it.
        """
        drive = env.unwrapped
        if not isinstance(drive, DriveEnv):
            raise Invalid("the expert drives argo/Drive-v0 and no other environment")
        self._env = drive
        self._flippers = Flippers()
        self._flight: tuple[Motion, Flight] | None = None
        self._plan()

    def act(self) -> NDArray[np.float32]:
        """Return the expert's action for the present step, shape (3,), from -1 to 1.

        Call it once per step: it advances the flippers, and plans a new path if that is needed.
        """
        site, pose = self._env.site, self._env.pose
        motion = self._follower.motion
        if motion is None or self._is_off_path(motion, pose):
            self._plan()
        step = self._follower.step(pose, site.body.velocity)
        flight = self._find_flight(step.motion)
        careful = self._flippers.step_and_should_go_slowly(flight, step.motion, pose, PERIOD)
        speed = max(-CAREFUL_SPEED, min(CAREFUL_SPEED, step.speed)) if careful else step.speed
        rate = 0.0 if self._is_turn_complete(step.motion, pose) else step.turn_rate
        low, high = FLIPPER_LIMITS
        flipper = 2 * (self._flippers.angle - low) / (high - low) - 1
        action = np.array([speed / SPEED, rate / TURN_RATE, flipper], dtype=np.float32)
        return np.clip(action, np.float32(-1.0), np.float32(1.0))

    def _plan(self) -> None:
        site, pose = self._env.site, self._env.pose
        x, y, z = self._env.goal
        start = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
        # The heading at the goal is free: take that of the straight line to it.
        yaw = math.atan2(y - pose.y, x - pose.x)
        path = site.navigator.plan(start, Pose(x=x, y=y, z=z, yaw=yaw))
        self._follower = Follower(path, site.robot, None, site.body.turn_center_x)

    def _is_turn_complete(self, motion: Motion | None, pose: BodyPose) -> bool:
        """Return True if the motion is a turn, and the robot has its end's heading."""
        if motion is None or not motion.turn:
            return False
        return abs(wrap(motion.end.yaw - pose.yaw)) < _TURN_TOLERANCE

    def _is_off_path(self, motion: Motion, pose: BodyPose) -> bool:
        if motion.on_stairs:
            return False
        if motion.turn:
            return math.hypot(pose.x - motion.start.x, pose.y - motion.start.y) > _MAX_DEVIATION
        return abs(self._follower.left_offset_and_heading_error(motion, pose)[0]) > _MAX_DEVIATION

    def _find_flight(self, motion: Motion | None) -> Flight | None:
        """Return the flight of stairs of a motion, None on the level; cache the last one."""
        if motion is None or not motion.on_stairs:
            return None
        if self._flight is None or self._flight[0] is not motion:
            site = self._env.site
            self._flight = motion, measure_flight(site.world, motion, site.robot.track_gauge)
        return self._flight[1]
