"""An expert for Drive-v0: it follows the navigator's path as the drive `tracked` does."""

import math
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Invalid
from argo_compiler.base.model import Pose
from argo_env.drives.tracked.body import FLIPPER_LIMITS
from argo_env.drives.tracked.flippers import CAREFUL_SPEED, Flight, Flippers, find_flight
from argo_env.drives.tracked.follower import Follower
from argo_env.envs.drive import PERIOD, SPEED, TURN_RATE, DriveEnv
from argo_env.navigation.path import Motion, wrap
from argo_env.robot.pose import BodyPose

_ASTRAY = 0.3  # m beside its line, from where it plans anew
_TURNED = math.radians(0.5)  # from a turn's end, where it waits for the robot to rest: with one
# command in 0.1 s, the least rate of the follower would swing it to and fro for ever


class Expert:
    """Drives one episode. Holds the path, how far it is done, and the angle of the flippers.

    It knows the robot's true pose, the plan of the site and the path, and acts only by actions. Its
    actions are meant for imitation, or as a yardstick. Another policy may drive in between: where
    the robot is off the path, on the level, the expert plans anew.
    """

    def __init__(self, env: gym.Env[Any, Any]) -> None:
        """For the episode that `env` is in, a Drive-v0 in wrappers or not: make it after the reset.

        Raises Unreachable if there is no way to the goal, as with what faults have blocked.
        """
        drive = env.unwrapped
        if not isinstance(drive, DriveEnv):
            raise Invalid("the expert drives argo/Drive-v0 and no other environment")
        self._env = drive
        self._flippers = Flippers()
        self._flight: tuple[Motion, Flight] | None = None
        self._plan()

    def act(self) -> NDArray[np.float32]:
        """The action for the moment that the episode is in, shape (3,). Call it once a step."""
        site, pose = self._env.site, self._env.pose
        motion = self._follower.motion
        if motion is None or self._astray(motion, pose):
            self._plan()
        step = self._follower.step(pose, site.body.velocity)
        flight = self._flight_of(step.motion)
        careful = self._flippers.step(flight, step.motion, pose, PERIOD)
        speed = max(-CAREFUL_SPEED, min(CAREFUL_SPEED, step.speed)) if careful else step.speed
        rate = 0.0 if self._turned(step.motion, pose) else step.turn_rate
        low, high = FLIPPER_LIMITS
        flipper = 2 * (self._flippers.angle - low) / (high - low) - 1
        action = np.array([speed / SPEED, rate / TURN_RATE, flipper], dtype=np.float32)
        return np.clip(action, np.float32(-1.0), np.float32(1.0))

    def _plan(self) -> None:
        site, pose = self._env.site, self._env.pose
        x, y, z = self._env.goal
        here = Pose(x=pose.x, y=pose.y, z=pose.z, yaw=pose.yaw)
        # However the robot is turned there will do: as it comes along the straight way.
        yaw = math.atan2(y - pose.y, x - pose.x)
        path = site.navigator.plan(here, Pose(x=x, y=y, z=z, yaw=yaw))
        self._follower = Follower(path, site.robot, None, site.body.pivot)

    def _turned(self, motion: Motion | None, pose: BodyPose) -> bool:
        """Whether the turn that is under way, if one is, only has to come to rest."""
        if motion is None or not motion.turn:
            return False
        return abs(wrap(motion.end.yaw - pose.yaw)) < _TURNED

    def _astray(self, motion: Motion, pose: BodyPose) -> bool:
        if motion.on_stairs:
            return False
        if motion.turn:
            return math.hypot(pose.x - motion.start.x, pose.y - motion.start.y) > _ASTRAY
        return abs(self._follower.deviation(motion, pose)[0]) > _ASTRAY

    def _flight_of(self, motion: Motion | None) -> Flight | None:
        """The flight that a motion goes over; looked at once."""
        if motion is None or not motion.on_stairs:
            return None
        if self._flight is None or self._flight[0] is not motion:
            site = self._env.site
            self._flight = motion, find_flight(site.world, motion, site.robot.track_gauge)
        return self._flight[1]
