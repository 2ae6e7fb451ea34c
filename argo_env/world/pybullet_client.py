"""PyBullet without its chatter: the only place that imports it, and what its users share."""

import ctypes
import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_env.closing import Closing
from argo_env.site.shapes import Vector


@contextmanager
def quiet() -> Iterator[None]:
    """Sends what native code prints to nowhere. PyBullet greets, warns and reports on stdout."""
    sys.stdout.flush()
    sys.stderr.flush()
    saved = os.dup(1), os.dup(2)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        yield
    finally:
        # What C has buffered would else come out at the end of the process.
        ctypes.CDLL(None).fflush(None)
        for target, copy in enumerate(saved, start=1):
            os.dup2(copy, target)
            os.close(copy)
        os.close(nowhere)


with quiet():
    import pybullet

__all__ = ["SUN", "Connection", "pybullet", "quiet"]

SUN: Vector = (0.55, -0.75, 1.25)
"""direction towards the light of all pictures"""


class Connection(Closing):
    """A world of bodies in PyBullet. Holds a connection; close it, or use it as a context."""

    def __init__(self, gui: bool = False) -> None:
        with quiet():
            self._client: int = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)

    def close(self) -> None:
        """Ends the connection; the object is of no use afterwards."""
        pybullet.disconnect(physicsClientId=self._client)

    def _render(
        self, view: Sequence[float], projection: Sequence[float], size: tuple[int, int]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
        """What a camera sees in daylight, without shadows: red, green and blue, shape (height,
        width, 3), and OpenGL's depth buffer, shape (height, width). The matrices are OpenGL's,
        column by column; `size` is width and height in px."""
        width, height = size
        image = pybullet.getCameraImage(
            width,
            height,
            view,
            projection,
            lightDirection=SUN,
            lightAmbientCoeff=0.62,
            lightDiffuseCoeff=0.42,
            lightSpecularCoeff=0.0,
            shadow=0,
            renderer=pybullet.ER_TINY_RENDERER,
            flags=pybullet.ER_NO_SEGMENTATION_MASK,
            physicsClientId=self._client,
        )
        colours = np.asarray(image[2], dtype=np.uint8).reshape(height, width, 4)[:, :, :3]
        return colours, np.asarray(image[3], dtype=np.float64).reshape(height, width)

    def _load(self, path: Path, fixed: bool) -> int:
        body: int = pybullet.loadURDF(str(path), useFixedBase=fixed, physicsClientId=self._client)
        return body

    def _place(self, body: int, origin: Vector, rpy: Vector) -> None:
        # PyBullet places the centre of mass of the base; we speak of the frame of its link.
        info = pybullet.getDynamicsInfo(body, -1, physicsClientId=self._client)
        position, orientation = pybullet.multiplyTransforms(
            origin, pybullet.getQuaternionFromEuler(rpy), info[3], info[4]
        )
        pybullet.resetBasePositionAndOrientation(
            body, position, orientation, physicsClientId=self._client
        )

    def _parts(self, body: int) -> dict[int, tuple[str, str]]:
        """Number of each joint, its name and the name of the link that it carries."""
        count = pybullet.getNumJoints(body, physicsClientId=self._client)
        infos = [pybullet.getJointInfo(body, k, physicsClientId=self._client) for k in range(count)]
        return {k: (info[1].decode(), info[12].decode()) for k, info in enumerate(infos)}
