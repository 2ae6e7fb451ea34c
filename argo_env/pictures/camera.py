"""Pinhole cameras, and the projection between points of the site and pixels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.site.shapes import Vector
from argo_env.world.pybullet_client import pybullet


@dataclass(frozen=True)
class Camera:
    """A pinhole camera at `eye` that looks at `target` (both in m), upright."""

    eye: Vector
    target: Vector
    size: tuple[int, int]
    """width and height of its pictures in px"""
    field_of_view: float
    """vertical angle in deg"""
    near: float = 0.1
    """distance in m, nearer things are invisible"""
    far: float = 100.0
    """distance in m, farther things are invisible"""

    @property
    def view_matrix(self) -> tuple[float, ...]:
        """Transformation from the site's frame to the camera's, column by column."""
        matrix: tuple[float, ...] = pybullet.computeViewMatrix(self.eye, self.target, (0, 0, 1))
        return matrix

    @property
    def projection_matrix(self) -> tuple[float, ...]:
        """Transformation from the camera's frame to clip space, column by column."""
        width, height = self.size
        matrix: tuple[float, ...] = pybullet.computeProjectionMatrixFOV(
            self.field_of_view, width / height, self.near, self.far
        )
        return matrix

    def project_with_depth(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return column and row (px) and depth (m) of points (m), shape (n, 3), in the same shape.

        The depth is along the camera's line of sight, less than 0 behind the camera.
        """
        view = np.array(self.view_matrix).reshape(4, 4).T
        projection = np.array(self.projection_matrix).reshape(4, 4).T
        clip = np.column_stack([points, np.ones(len(points))]) @ (projection @ view).T
        width, height = self.size
        return np.column_stack(
            [
                (clip[:, 0] / clip[:, 3] + 1) / 2 * width,
                (1 - clip[:, 1] / clip[:, 3]) / 2 * height,
                clip[:, 3],
            ]
        )

    def unproject(
        self, column: NDArray[np.intp], row: NDArray[np.intp], depth: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the points of the site (m) that pixels show at given depths (m), shape (n, 3)."""
        view = np.array(self.view_matrix).reshape(4, 4).T
        projection = np.array(self.projection_matrix).reshape(4, 4).T
        width, height = self.size
        x = ((column + 0.5) / width * 2 - 1) / projection[0, 0]
        y = (1 - (row + 0.5) / height * 2) / projection[1, 1]
        seen = np.stack([x * depth, y * depth, -depth], axis=-1)
        return np.asarray((seen - view[:3, 3]) @ view[:3, :3])


def depth_in_metres(buffer: NDArray[np.float64], camera: Camera) -> NDArray[np.float64]:
    """Return the depths along the line of sight (m) for a depth buffer with values from 0 to 1.

    The depth is infinite where there is nothing.
    """
    near, far = camera.near, camera.far
    depth = far * near / (far - (far - near) * buffer)
    # The depth of an empty pixel is only approximately that of the far end.
    return np.where(depth < 0.98 * far, depth, np.inf)
