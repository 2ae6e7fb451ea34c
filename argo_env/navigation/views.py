"""Views: states from which a checkpoint's face is in range and in line of sight."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.lattice import LEVEL, Lattice
from argo_env.robot.spec import RobotSpec
from argo_env.site import Site, SiteCheckpoint
from argo_env.site.shapes import crossing

FACE_GAP = 0.02  # m in front of a checkpoint's face where a line of sight ends
_OBLIQUE_COST = 6.0  # s that the most oblique view costs more than a frontal one
_FAR_COST = 3.0  # s that a view at full range costs more than one at half the range


def face_normal(checkpoint: SiteCheckpoint) -> NDArray[np.float64]:
    """Return the unit vector from the checkpoint's face towards whoever reads it, shape (3,)."""
    return np.array([np.cos(checkpoint.yaw), np.sin(checkpoint.yaw), 0.0])


def sight_target(checkpoint: SiteCheckpoint) -> NDArray[np.float64]:
    """Return the point (m) 2 cm in front of the face, which the camera must see, shape (3,)."""
    return np.array(checkpoint.position) + FACE_GAP * face_normal(checkpoint)


def camera_positions(poses: NDArray[np.float64], robot: RobotSpec) -> NDArray[np.float64]:
    """Return the positions (m) of the camera on the raised arm, shape (n, 3).

    The robot's `poses` are x, y, z (m) and yaw (rad), shape (n, 4).
    """
    along, left, up = robot.sensor.offset
    cos, sin = np.cos(poses[:, 3]), np.sin(poses[:, 3])
    shift = np.column_stack([along * cos - left * sin, along * sin + left * cos])
    return np.column_stack([poses[:, :2] + shift, poses[:, 2] + up])


def find_view_states_and_costs(
    site: Site, checkpoint: SiteCheckpoint, lattice: Lattice
) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the states from which the checkpoint can be read, and the cost of each view in s.

    A view costs more the more oblique it is, and if the camera is farther than half its range away.
    Both arrays are empty if there is no such state.
    """
    sensor, target = lattice.robot.sensor, sight_target(checkpoint)
    views = candidate_views(checkpoint, lattice)
    seen = has_line_of_sight(site, views.cameras, target)
    far = np.maximum(0.0, views.distance[seen] / sensor.max_range - 0.5) * 2
    oblique = (views.obliqueness[seen] / sensor.max_obliqueness) ** 2
    return views.states[seen], _OBLIQUE_COST * oblique + _FAR_COST * far**2


@dataclass(frozen=True)
class CandidateViews:
    """States from which a face is in range and not too oblique, whatever stands between.

    For each there are the position of the camera (m, shape (n, 3)), its distance from the face (m),
    and the obliqueness (deg).
    """

    states: NDArray[np.int64]
    cameras: NDArray[np.float64]
    distance: NDArray[np.float64]
    obliqueness: NDArray[np.float64]


def candidate_views(checkpoint: SiteCheckpoint, lattice: Lattice) -> CandidateViews:
    """Return the states from which a checkpoint's face is in range and not too oblique.

    Only states on level ground count. Solids between camera and face are ignored.
    """
    sensor, target = lattice.robot.sensor, sight_target(checkpoint)
    reach = sensor.max_range + math.hypot(*sensor.offset[:2])
    states = lattice.state_of[lattice.surface.cells_in_square(target[0], target[1], reach)]
    states = states[states >= 0]
    states = states[np.abs(lattice.rise[states]) <= LEVEL]
    cameras = camera_positions(lattice.state_poses(states), lattice.robot)
    sight = target - cameras
    distance = np.linalg.norm(sight, axis=1)
    cosine = -(sight @ face_normal(checkpoint)) / np.maximum(distance, 1e-9)
    obliqueness = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    good = (
        (distance >= sensor.min_range)
        & (distance <= sensor.max_range)
        & (obliqueness <= sensor.max_obliqueness)
    )
    return CandidateViews(states[good], cameras[good], distance[good], obliqueness[good])


def has_line_of_sight(
    site: Site, origins: NDArray[np.float64], target: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return a mask of the `origins` from which no solid of the site hides `target`.

    `origins` has the shape (n, 3) and `target` (3,), both in m.
    """
    clear = np.ones(len(origins), dtype=bool)
    if not len(origins):
        return clear
    low = np.minimum(origins.min(axis=0), target)
    high = np.maximum(origins.max(axis=0), target)
    index = site.solids
    for solid in index.touching_box(low, high):
        entry, leave = crossing(solid, origins, target - origins)
        clear &= ~((entry <= 1.0) & (leave >= 0.0))
    return clear
