"""Views of a checkpoint: camera positions that the arm reaches, with the checkpoint in sight.

Sight is planned with the map of the site; only contacts of the arm are checked in the world.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from argo_env.robot.pose import BodyPose
from argo_env.robot.spec import SensorSpec
from argo_env.sensing.vision.align import FacePose
from argo_env.sensing.vision.arm import JOINTS, CameraPose, forward_kinematics, inverse_kinematics
from argo_env.site import Site
from argo_env.site.shapes import Solid, crossing, half_extents
from argo_env.world.world import World

_AZIMUTHS = np.radians(np.arange(-75, 76, 15))
_ELEVATIONS = np.radians([0, -18, 18, 36])
_DISTANCES = np.array([0.35, 0.45, 0.55, 0.7, 0.9, 1.15, 1.5, 1.9])  # m
_CLEARANCE = 0.02  # m that the arm keeps from everything
_STEP = 0.05  # rad of the joint that turns most, between the arm poses that are checked
_FAR_COST = 0.25  # cost of a metre of distance; obliqueness costs its square in rad²
_SAME_COST = 0.9  # cost of a position from which a picture was taken already
_HIDDEN_COST = 1.5  # cost of a face that is out of sight


@dataclass(frozen=True)
class ArmView:
    """Pose of the arm, and of the camera on it, for a picture of a face."""

    joints: NDArray[np.float64]
    """rad, in the order of `arm.JOINTS`"""
    camera: CameraPose
    obliqueness: float
    """rad, between the line of sight and the face's normal, which may be an estimate"""
    distance: float
    """m, from the camera to the middle of the face"""


def solids_with_box_near(site: Site, point: NDArray[np.float64], reach: float) -> tuple[Solid, ...]:
    """Return the site's solids whose bounding box is within `reach` (m) of a point on each axis."""
    return tuple(
        solid
        for element in site.elements
        for solid in element.solids
        if (np.abs(np.array(solid.center) - point) - half_extents(solid) < reach).all()
    )


def plan_views_cheapest_first(
    world: World,
    pose: BodyPose,
    face: FacePose,
    solids: Sequence[Solid],
    size: float,
    used_positions: Sequence[NDArray[np.float64]],
    same_direction_angle: float,
) -> Iterator[ArmView]:
    """Yield views of the face from a robot at `pose`, those with the least cost first.

    Views cost less if they are frontal and near, and if their direction from the face differs from
    that of used positions. Views are left out if most of the face is hidden, or if the arm can't
    reach them without contact.

    Args:
        world: world in which contacts of the arm are checked.
        pose: pose of the robot.
        face: pose of the face, as far as it is known.
        solids: solids that may hide the face.
        size: radius in m about the middle of the face that should not be hidden.
        used_positions: camera positions in m from which pictures were taken already.
        same_direction_angle: angle in rad from which on two directions count as different.
    """
    eyes = _camera_positions(face, world.robot.sensor)
    eyes = eyes[_are_reachable(eyes, pose)]
    if not len(eyes):
        return
    cost = _costs(eyes, face, solids, size, used_positions, same_direction_angle)
    for k in np.argsort(cost, kind="stable"):
        if not math.isfinite(cost[k]):
            return
        for joints in inverse_kinematics(eyes[k], face.center, pose):
            if _can_reach(world, joints):
                sight = eyes[k] - face.center
                distance = float(np.linalg.norm(sight))
                cosine = float(sight @ face.normal) / distance
                yield ArmView(
                    joints, forward_kinematics(joints, pose), math.acos(min(1.0, cosine)), distance
                )
                break


def _can_reach(world: World, joints: NDArray[np.float64]) -> bool:
    """Return True if the raised arm can move to these joint positions and back without contact.

    All joints turn at the same time, each at a constant rate.
    """
    raised = np.radians([world.robot.arm_raised[name] for name in JOINTS])
    difference = raised - joints
    count = max(1, math.ceil(float(np.abs(difference).max()) / _STEP))
    # Start at the far end, since most obstacles are near the checkpoint.
    return all(
        world.arm_obstacle(
            dict(zip(JOINTS, (joints + k / count * difference).tolist(), strict=True)), _CLEARANCE
        )
        is None
        for k in range(count)
    )


def _camera_positions(face: FacePose, sensor: SensorSpec) -> NDArray[np.float64]:
    """Return positions for the camera in front of the face, in m, shape (n, 3)."""
    offsets = []
    for azimuth, elevation, distance in product(_AZIMUTHS, _ELEVATIONS, _DISTANCES):
        if sensor.min_range <= distance <= sensor.max_range:
            around = face.yaw + azimuth
            level = distance * math.cos(elevation)
            offsets.append(
                (level * math.cos(around), level * math.sin(around), distance * math.sin(elevation))
            )
    return np.array(offsets) + face.center


def _are_reachable(eyes: NDArray[np.float64], pose: BodyPose) -> NDArray[np.bool_]:
    """Return which camera positions the arm can roughly reach; the others need not be tried."""
    shoulder = np.array([pose.x - 0.1 * math.cos(pose.yaw), pose.y - 0.1 * math.sin(pose.yaw)])
    away = np.hypot(*(eyes[:, :2] - shoulder).T)
    return np.asarray(np.hypot(away, eyes[:, 2] - pose.z - 0.66) < 1.08)


def _costs(
    eyes: NDArray[np.float64],
    face: FacePose,
    solids: Sequence[Solid],
    size: float,
    used_positions: Sequence[NDArray[np.float64]],
    same_direction_angle: float,
) -> NDArray[np.float64]:
    sight = eyes - face.center
    distance = np.linalg.norm(sight, axis=1)
    toward = sight / distance[:, None]
    oblique = np.arccos(np.clip(toward @ face.normal, -1.0, 1.0))
    cost = oblique**2 + _FAR_COST * distance
    for eye in used_positions:
        used_direction = (eye - face.center) / np.linalg.norm(eye - face.center)
        angle = np.arccos(np.clip(toward @ used_direction, -1.0, 1.0))
        cost += _SAME_COST * np.maximum(0.0, 1.0 - angle / same_direction_angle)
    side = np.array([-math.sin(face.yaw), math.cos(face.yaw), 0.0])
    points = [
        face.center + 0.01 * face.normal + size * (y * side + np.array([0.0, 0.0, z]))
        for y, z in ((0, 0), (-1, 0), (1, 0), (0, -1), (0, 1))
    ]
    low, high = np.vstack([eyes, *points]).min(axis=0), np.vstack([eyes, *points]).max(axis=0)
    between = [
        solid
        for solid in solids
        if (np.array(solid.center) + half_extents(solid) >= low).all()
        and (np.array(solid.center) - half_extents(solid) <= high).all()
    ]
    seen = np.zeros(len(eyes))
    for point in points:
        clear = np.ones(len(eyes), dtype=bool)
        for solid in between:
            entry, leave = crossing(solid, eyes, point - eyes)
            clear &= ~((entry <= 1.0) & (leave >= 0.0))
        seen += clear / len(points)
    return np.asarray(np.where(seen < 0.3, np.inf, cost + _HIDDEN_COST * (1.0 - seen)))
