"""Pictures of the simulated camera, with a real one's errors, and their brightness and redness."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.arm import CameraPose
from argo_env.world.world import World

NEAR, FAR = 0.05, 30.0  # m

# Of full scale, for one exposure in daylight; in the range of industrial cameras with 8 bits.
_SHOT_NOISE = 0.012
_READ_NOISE = 0.008
_MAX_BLUR = 0.8  # px, from the lens and from vibration of the arm


@dataclass(frozen=True)
class Lens:
    """Lens of a pinhole camera with square pixels, whose centre is in the middle of the picture."""

    size: int
    """px, width and height of its pictures"""
    focal: float
    """px"""

    def project(self, points: NDArray[np.float64], pose: CameraPose) -> NDArray[np.float64]:
        """Return column and row (px) of points (m, in the site's frame): (..., 3) to (..., 2).

        They are 0 at the middle of the first pixel, and meaningless for points behind the camera.
        """
        seen = (points - pose.position) @ pose.rotation
        middle = (self.size - 1) / 2
        return np.asarray(middle + self.focal * seen[..., :2] / seen[..., 2:])


def take_picture(
    world: World, lens: Lens, pose: CameraPose, rng: np.random.Generator
) -> NDArray[np.uint8]:
    """Take a picture with the camera at `pose`: red, green and blue, shape (size, size, 3).

    Its brightness is that of the world's light. Lens and sensor add blur, shot noise that grows
    with the root of the light, and read noise that does not depend on the light.
    """
    import cv2

    picture = world.render_picture(_view(pose), _projection(lens), (lens.size, lens.size))
    blurred = cv2.GaussianBlur(
        picture.astype(np.float32) / 255, (0, 0), 0.3 + rng.uniform(0.0, _MAX_BLUR - 0.3)
    )
    light = np.asarray(blurred) * np.float32(world.light)
    noise = rng.standard_normal(light.shape, dtype=np.float32)
    noisy = light + noise * np.sqrt(_SHOT_NOISE**2 * light + _READ_NOISE**2)
    return np.asarray(np.clip(np.rint(noisy * 255), 0, 255).astype(np.uint8))


def _view(pose: CameraPose) -> tuple[float, ...]:
    # OpenGL's camera looks along -z with y up.
    matrix = np.eye(4)
    matrix[:3, :3] = (pose.rotation * np.array([1.0, -1.0, -1.0])).T
    matrix[:3, 3] = -matrix[:3, :3] @ pose.position
    return tuple(matrix.T.ravel().tolist())


def _projection(lens: Lens) -> tuple[float, ...]:
    scale = 2 * lens.focal / lens.size
    matrix = np.zeros((4, 4))
    matrix[0, 0] = matrix[1, 1] = scale
    matrix[2, 2] = -(FAR + NEAR) / (FAR - NEAR)
    matrix[2, 3] = -2 * FAR * NEAR / (FAR - NEAR)
    matrix[3, 2] = -1.0
    return tuple(matrix.T.ravel().tolist())


_DENOISE = 0.7  # px


@dataclass(frozen=True)
class Photo:
    """Picture prepared for reading, with the lens and the camera's pose that it was taken with."""

    brightness: NDArray[np.float32]
    """0 to 1, shape (size, size)"""
    redness: NDArray[np.float32]
    """0 to 1, shape (size, size)"""
    lens: Lens
    pose: CameraPose

    def blurred(self, sigma: float) -> "Photo":
        """Return the photo with its brightness blurred by a Gaussian filter.

        `sigma` is the standard deviation of the filter in px. The redness is not blurred.
        Below 0.4 px the photo itself is returned.
        """
        import cv2

        if sigma < 0.4:
            return self
        soft = cv2.GaussianBlur(self.brightness, (0, 0), sigma)
        return Photo(np.asarray(soft), self.redness, self.lens, self.pose)


def make_photo(picture: NDArray[np.uint8], lens: Lens, pose: CameraPose) -> Photo:
    """Return a photo with the picture's brightness and redness, blurred a little against noise.

    The redness does not depend on the light.
    """
    import cv2

    colours = np.asarray(cv2.GaussianBlur(picture.astype(np.float32) / 255, (0, 0), _DENOISE))
    red, green, blue = colours[..., 0], colours[..., 1], colours[..., 2]
    brightness = colours @ np.array([0.299, 0.587, 0.114], dtype=np.float32)
    # Grey is 0, pure red 1; the constant prevents that noise in black pixels counts as a colour.
    redness = np.clip((red - np.maximum(green, blue)) / (red + 0.02) * 1.25, 0.0, 1.0)
    return Photo(np.ascontiguousarray(brightness), np.ascontiguousarray(redness), lens, pose)
