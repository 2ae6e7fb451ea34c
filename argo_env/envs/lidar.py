"""What Drive-v0 sees: a level ring of rays around the robot, and the ground below and about it."""

import math

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.world.world import World

RAYS = 32
RANGE = 5.0  # m
HEIGHT = 0.45  # m of the ring above the robot's point on the ground
ALONG = np.linspace(-1.25, 1.25, 11)  # m ahead of the robot's middle, of the points on the ground
ASIDE = (-0.23, 0.23)  # m to the left: below the tracks
DEPTH = 1.0  # m up and down that the ground is told of
_ABOVE = 0.8  # m over the robot's point from where the ground is looked for

_ANGLES = 2 * math.pi * np.arange(RAYS) / RAYS
_GROUND = np.array([(x, y) for x in ALONG for y in ASIDE])


def ring(world: World, pose: BodyPose) -> NDArray[np.float64]:
    """Distances (m) to the first thing in each direction, counter-clockwise from straight ahead,
    at most RANGE, shape (RAYS,)."""
    angles = pose.yaw + _ANGLES
    origin = (pose.x, pose.y, pose.z + HEIGHT)
    ends = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(RAYS)]) * RANGE
    return np.minimum(world.ranges(origin, ends + np.array(origin)), RANGE)


def ground(world: World, pose: BodyPose) -> NDArray[np.float64]:
    """Heights (m) of the ground above the robot's point, at most DEPTH up or down, along the right
    and the left track from rear to front, shape (2 * len(ALONG),)."""
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    points = _GROUND @ np.array([[cos, sin], [-sin, cos]]) + np.array([pose.x, pose.y])
    heights = world.heights(points, np.full(len(points), pose.z + _ABOVE))
    return np.clip(heights - pose.z, -DEPTH, DEPTH)
