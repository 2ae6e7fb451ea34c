"""The camera that follows the robot from behind and above, where nothing hides it."""

import math

import numpy as np
from numpy.typing import NDArray

from argo_env.navigation.path import wrap
from argo_env.pictures.camera import Camera
from argo_env.pictures.scene import Scene
from argo_env.robot.pose import BodyPose

_DISTANCE = 4.0  # m from the robot
_FIELD_OF_VIEW = 48.0  # deg
_TARGET_HEIGHT = 0.45  # m above the ground, of the point that the camera looks at
_SIDES = np.radians(np.arange(-180, 180, 20))
_HEIGHTS = np.radians([32.0, 48.0, 64.0])
_HEIGHT_COST = np.array([0.0, 0.25, 0.6])
_OCCLUDED_COST = 2.0  # of a hidden robot; a view from the front costs 1
_TURN_COST = 0.6  # of half a turn about the robot, so that only a better view is worth it
_EASE = 0.7  # s, time constant with which the camera moves to a better position


class ChaseCamera:
    """Camera that follows the robot from frame to frame.

    It holds its position, so that it moves smoothly.
    """

    def __init__(self, scene: Scene, size: tuple[int, int], frame_time: float) -> None:
        """Initialise the camera before its first frame.

        Args:
            scene: Scene that shows what may hide the robot.
            size: Width and height of the frames in px.
            frame_time: Duration (s) for which each frame of the film is shown.
        """
        self._scene = scene
        self._size = size
        self._share = 1.0 - math.exp(-frame_time / _EASE)
        self._side: float | None = None
        self._height = float(_HEIGHTS[0])

    def next_camera(self, pose: BodyPose) -> Camera:
        """Return the camera for the next frame, with the robot at `pose`; move towards a good view.

        The scene must show the floors that the frame shows.
        """
        target = np.array([pose.x, pose.y, pose.z + _TARGET_HEIGHT])
        side, height = self._best(pose, target)
        if self._side is None:
            self._side, self._height = side, height
        else:
            self._side += self._share * wrap(side - self._side)
            self._height += self._share * (height - self._height)
        eye = _eyes(target, np.array([self._side]), np.array([self._height]))[0]
        return Camera(
            (float(eye[0]), float(eye[1]), float(eye[2])),
            (float(target[0]), float(target[1]), float(target[2])),
            self._size,
            _FIELD_OF_VIEW,
        )

    def _best(self, pose: BodyPose, target: NDArray[np.float64]) -> tuple[float, float]:
        """Return the direction from the robot to the camera, and the camera's elevation, in rad.

        They have the least cost of those that are tried: a camera behind the robot, low, and near
        its last position costs less, and one from which the robot is hidden costs much more.
        """
        behind = pose.yaw + math.pi
        now = behind if self._side is None else self._side
        sides, heights = (g.ravel() for g in np.meshgrid(behind + _SIDES, _HEIGHTS))
        ends = [(float(x), float(y), float(z)) for x, y, z in _eyes(target, sides, heights)]
        start = (float(target[0]), float(target[1]), float(target[2]) + 0.3)
        turns = np.array([abs(wrap(float(s) - now)) for s in sides]) / math.pi
        cost = (
            np.abs(np.tile(_SIDES, len(_HEIGHTS))) / math.pi
            + np.repeat(_HEIGHT_COST, len(_SIDES))
            + _TURN_COST * turns
            + _OCCLUDED_COST * self._scene.occluded(start, ends)
        )
        best = int(np.argmin(cost))
        return float(sides[best]), float(heights[best])


def _eyes(
    target: NDArray[np.float64], sides: NDArray[np.float64], heights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return positions at the camera's distance from the target, shape (n, 3).

    `sides` and `heights` have the azimuth and the elevation (rad) of each, shape (n,).
    """
    level = np.cos(heights)
    ways = np.column_stack([level * np.cos(sides), level * np.sin(sides), np.sin(heights)])
    return np.asarray(target + _DISTANCE * ways)
