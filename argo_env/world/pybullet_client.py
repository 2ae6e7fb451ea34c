"""PyBullet without its chatter: the only place that imports it, and what its users share."""

import ctypes
import os
import sys
import threading
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Unavailable
from argo_env.closing import Closing
from argo_env.site.shapes import Vector

_one = threading.Lock()
"""held by whoever sets what PyBullet has once only, for all connections and threads"""
_breaking: float | None = None
"""the `contact_breaking` (m) that was set last; None: PyBullet's own, or it may be"""


@contextmanager
def _unheard() -> Iterator[None]:
    """What native code prints by C's streams is not heard. File descriptors stay as they are, so
    nothing is lost of what Python prints meanwhile, in whatever thread.

    For the greeting of PyBullet when it is imported, on stderr, and those of its window. Without a
    window it prints nothing: what it loads lacks nothing that it would warn about.
    """
    if not sys.platform.startswith("linux"):
        yield
        return
    libc = ctypes.CDLL(None)
    libc.fopen.restype = ctypes.c_void_p
    streams = [ctypes.c_void_p.in_dll(libc, name) for name in ("stdout", "stderr")]
    with _one:
        kept = [stream.value for stream in streams]
        # Never closed: another thread may still be writing to it.
        nowhere = libc.fopen(os.fsencode(os.devnull), b"we")
        try:
            for stream in streams:
                stream.value = nowhere or stream.value
            yield
        finally:
            for stream, value in zip(streams, kept, strict=True):
                stream.value = value


with _unheard():
    import pybullet

__all__ = ["SUN", "Connection", "pybullet"]

SUN: Vector = (0.55, -0.75, 1.25)
"""direction towards the light of all pictures"""


class Connection(Closing):
    """A world of bodies in PyBullet. Holds a connection; close it, or use it as a context.

    Connections do not disturb each other, in one thread or several.
    """

    contact_breaking = 0.02
    """m between two bodies from where on PyBullet keeps no contact of theirs"""

    def __init__(self, gui: bool = False) -> None:
        global _breaking
        if gui:
            with _unheard():
                self._client: int = pybullet.connect(pybullet.GUI)
        else:
            self._client = pybullet.connect(pybullet.DIRECT)
        with _one:
            _breaking = None
        if self._client < 0:
            raise Unavailable("PyBullet gives no connection: it has 1,024 at most")
        # There are no more than 1,024 connections, and not all that holds one gets closed.
        self._end = weakref.finalize(self, _disconnect, self._client)

    def close(self) -> None:
        """Ends the connection; the object is of no use afterwards."""
        self._end()

    @contextmanager
    def _in_contact(self) -> Iterator[None]:
        """For all that looks for contacts: PyBullet has one `contact_breaking` for all connections,
        so it is set where another had its own, and no other thread gets in between."""
        with _one:
            self._set_breaking()
            yield

    def _set_breaking(self) -> None:
        global _breaking
        if _breaking != self.contact_breaking:
            _breaking = self.contact_breaking
            pybullet.setPhysicsEngineParameter(
                contactBreakingThreshold=_breaking, physicsClientId=self._client
            )

    def _detect(self) -> None:
        """Looks for collisions; rays are tested against where bodies were at the last time."""
        with _one:  # not `_in_contact`, as it runs in each time step
            self._set_breaking()
            pybullet.performCollisionDetection(physicsClientId=self._client)

    def _simulate(self) -> None:
        """One step of the physics."""
        with _one:  # likewise
            self._set_breaking()
            pybullet.stepSimulation(physicsClientId=self._client)

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


def _disconnect(client: int) -> None:
    pybullet.disconnect(physicsClientId=client)
