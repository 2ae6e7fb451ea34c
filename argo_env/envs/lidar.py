"""Distances that Drive-v0 observes: a level ring of rays, and the height of the ground."""

import math

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.world.world import World

RAYS = 32
RANGE = 5.0  # m
HEIGHT = 0.45  # m from the robot's point on the ground up to the ring
ALONG = np.linspace(-1.25, 1.25, 11)  # m ahead of the robot's middle, where the ground is observed
ASIDE = (-0.23, 0.23)  # m to the left: below the right and the left track
DEPTH = 1.0  # m up and down, the limits of the observed heights
_ABOVE = 0.8  # m above the robot's point, where the rays down start

_ANGLES = 2 * math.pi * np.arange(RAYS) / RAYS
_GROUND = np.array([(x, y) for x in ALONG for y in ASIDE])


def ray_distances(world: World, pose: BodyPose) -> NDArray[np.float64]:
    """Return the distances (m) to the nearest solid in each direction, shape (RAYS,).

    The directions are level and counter-clockwise from straight ahead, HEIGHT above the robot's
    point on the ground. Where nothing is within RANGE, the distance is RANGE.
    """
    angles = pose.yaw + _ANGLES
    origin = (pose.x, pose.y, pose.z + HEIGHT)
    ends = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(RAYS)]) * RANGE
    return np.minimum(world.hit_distances_or_inf(origin, ends + np.array(origin)), RANGE)


def relative_heights_along_tracks(world: World, pose: BodyPose) -> NDArray[np.float64]:
    """Return the heights (m) of the ground relative to the robot's point on the ground.

    From rear to front, each position has a height below the right and one below the left track,
    shape (2 * len(ALONG),). They are limited to ±DEPTH.
    """
    cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
    points = _GROUND @ np.array([[cos, sin], [-sin, cos]]) + np.array([pose.x, pose.y])
    heights = world.surface_or_ray_end_heights(points, np.full(len(points), pose.z + _ABOVE))
    return np.clip(heights - pose.z, -DEPTH, DEPTH)
