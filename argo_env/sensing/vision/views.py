"""Where to look from: places for the camera that the arm reaches, with the checkpoint in sight.

Planned with the site as it is drawn; only that the arm touches nothing is asked of the world.
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
from argo_env.sensing.vision.arm import JOINTS, CameraPose, forward, inverse
from argo_env.site import Site
from argo_env.site.shapes import Solid, crossing, half_extents
from argo_env.world.world import World

_AZIMUTHS = np.radians(np.arange(-75, 76, 15))
_ELEVATIONS = np.radians([0, -18, 18, 36])
_DISTANCES = np.array([0.35, 0.45, 0.55, 0.7, 0.9, 1.15, 1.5, 1.9])  # m
_CLEARANCE = 0.02  # m that the arm keeps from everything
_STEP = 0.05  # rad of the joint that turns most, between the places of the arm that are checked
_FAR_COST = 0.25  # rad of obliqueness that a metre of distance is worth
_SAME_COST = 0.9  # rad of obliqueness that a look from the same place as before is worth
_HIDDEN_COST = 1.5  # rad of obliqueness that a face out of sight is worth


@dataclass(frozen=True)
class ArmView:
    """A pose of the arm and of the camera on it."""

    joints: NDArray[np.float64]
    """rad, in the order of `arm.JOINTS`"""
    camera: CameraPose
    obliqueness: float
    """rad, between the face's normal, as far as it is known, and the line of sight"""
    distance: float
    """m, from the camera to the middle of the face"""


def solids_near(site: Site, point: NDArray[np.float64], reach: float) -> tuple[Solid, ...]:
    """What is drawn within `reach` (m) of a point, along each axis."""
    return tuple(
        solid
        for element in site.elements
        for solid in element.solids
        if (np.abs(np.array(solid.center) - point) - half_extents(solid) < reach).all()
    )


def plan_views(
    world: World,
    pose: BodyPose,
    face: FacePose,
    solids: Sequence[Solid],
    size: float,
    used: Sequence[NDArray[np.float64]],
    spread: float,
) -> Iterator[ArmView]:
    """Views of the face from a robot at `pose`, best first: as frontal as possible, near, and from
    elsewhere than the eyes `used`, as seen from the face at least `spread` (rad) apart.

    `size` (m) is the radius about the middle of the face that should be in sight of the `solids`.
    """
    eyes = _eyes(face, world.robot.sensor)
    eyes = eyes[_reachable(eyes, pose)]
    if not len(eyes):
        return
    cost = _costs(eyes, face, solids, size, used, spread)
    for k in np.argsort(cost, kind="stable"):
        if not math.isfinite(cost[k]):
            return
        for joints in inverse(eyes[k], face.center, pose):
            if _within_reach(world, joints):
                sight = eyes[k] - face.center
                distance = float(np.linalg.norm(sight))
                cosine = float(sight @ face.normal) / distance
                yield ArmView(joints, forward(joints, pose), math.acos(min(1.0, cosine)), distance)
                break


def _within_reach(world: World, joints: NDArray[np.float64]) -> bool:
    """Whether the arm, raised, gets there and back with all joints turning evenly, and touches
    nothing."""
    raised = np.radians([world.robot.arm_raised[name] for name in JOINTS])
    way = raised - joints
    count = max(1, math.ceil(float(np.abs(way).max()) / _STEP))
    # From the far end, since most of what is in the way is near the checkpoint.
    return all(
        world.arm_obstacle(
            dict(zip(JOINTS, (joints + k / count * way).tolist(), strict=True)), _CLEARANCE
        )
        is None
        for k in range(count)
    )


def _eyes(face: FacePose, sensor: SensorSpec) -> NDArray[np.float64]:
    """Places for the camera in front of the face, shape (n, 3)."""
    found = []
    for azimuth, elevation, distance in product(_AZIMUTHS, _ELEVATIONS, _DISTANCES):
        if sensor.min_range <= distance <= sensor.max_range:
            around = face.yaw + azimuth
            level = distance * math.cos(elevation)
            found.append(
                (level * math.cos(around), level * math.sin(around), distance * math.sin(elevation))
            )
    return np.array(found) + face.center


def _reachable(eyes: NDArray[np.float64], pose: BodyPose) -> NDArray[np.bool_]:
    """Roughly which eyes the arm reaches: all others would be tried in vain."""
    shoulder = np.array([pose.x - 0.1 * math.cos(pose.yaw), pose.y - 0.1 * math.sin(pose.yaw)])
    away = np.hypot(*(eyes[:, :2] - shoulder).T)
    return np.asarray(np.hypot(away, eyes[:, 2] - pose.z - 0.66) < 1.08)


def _costs(
    eyes: NDArray[np.float64],
    face: FacePose,
    solids: Sequence[Solid],
    size: float,
    used: Sequence[NDArray[np.float64]],
    spread: float,
) -> NDArray[np.float64]:
    sight = eyes - face.center
    distance = np.linalg.norm(sight, axis=1)
    toward = sight / distance[:, None]
    oblique = np.arccos(np.clip(toward @ face.normal, -1.0, 1.0))
    cost = oblique**2 + _FAR_COST * distance
    for eye in used:
        before = (eye - face.center) / np.linalg.norm(eye - face.center)
        apart = np.arccos(np.clip(toward @ before, -1.0, 1.0))
        cost += _SAME_COST * np.maximum(0.0, 1.0 - apart / spread)
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
