"""From a picture in colours to what the reader looks at: brightness and redness."""

import numpy as np
from numpy.typing import NDArray

from argo_env.sensing.vision.align import Photo
from argo_env.sensing.vision.arm import CameraPose
from argo_env.sensing.vision.camera import Lens

_DENOISE = 0.7  # px


def make_photo(picture: NDArray[np.uint8], lens: Lens, pose: CameraPose) -> Photo:
    """The picture's brightness, and how red each pixel is, whatever the light."""
    import cv2

    colours = np.asarray(cv2.GaussianBlur(picture.astype(np.float32) / 255, (0, 0), _DENOISE))
    red, green, blue = colours[..., 0], colours[..., 1], colours[..., 2]
    brightness = colours @ np.array([0.299, 0.587, 0.114], dtype=np.float32)
    # Grey is 0, pure red 1; the constant keeps the noise of black from being a colour.
    redness = np.clip((red - np.maximum(green, blue)) / (red + 0.02) * 1.25, 0.0, 1.0)
    return Photo(np.ascontiguousarray(brightness), np.ascontiguousarray(redness), lens, pose)
