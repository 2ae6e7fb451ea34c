"""From a picture in colours to what the reader looks at: brightness and redness."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.arm import CameraPose
from argo_env.sensing.vision.camera import Lens

_DENOISE = 0.7  # px


@dataclass(frozen=True)
class Photo:
    """A picture to read in: its brightness and its redness (both 0 to 1, shape (size, size)), and
    what it was taken with."""

    brightness: NDArray[np.float32]
    redness: NDArray[np.float32]
    lens: Lens
    pose: CameraPose

    def blurred(self, sigma: float) -> "Photo":
        """The picture blurred by `sigma` (px)."""
        import cv2

        if sigma < 0.4:
            return self
        soft = cv2.GaussianBlur(self.brightness, (0, 0), sigma)
        return Photo(np.asarray(soft), self.redness, self.lens, self.pose)


def make_photo(picture: NDArray[np.uint8], lens: Lens, pose: CameraPose) -> Photo:
    """The picture's brightness, and how red each pixel is, whatever the light."""
    import cv2

    colours = np.asarray(cv2.GaussianBlur(picture.astype(np.float32) / 255, (0, 0), _DENOISE))
    red, green, blue = colours[..., 0], colours[..., 1], colours[..., 2]
    brightness = colours @ np.array([0.299, 0.587, 0.114], dtype=np.float32)
    # Grey is 0, pure red 1; the constant keeps the noise of black from being a colour.
    redness = np.clip((red - np.maximum(green, blue)) / (red + 0.02) * 1.25, 0.0, 1.0)
    return Photo(np.ascontiguousarray(brightness), np.ascontiguousarray(redness), lens, pose)
