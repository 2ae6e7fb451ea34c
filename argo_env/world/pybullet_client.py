"""Connections to PyBullet, without its messages on the console; only this module imports it.

This module can be imported where PyBullet is not installed: then each use of it raises Unavailable.
"""

import ctypes
import importlib
import os
import sys
import threading
import weakref
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from argo_compiler.base.errors import Unavailable
from argo_env.closing import Closing
from argo_env.site.shapes import Vector

_lock = threading.Lock()
"""protects what PyBullet has only once for all connections and threads"""
_applied_breaking: float | None = None
"""the `contact_breaking` (m) that was set last; None: unknown, perhaps PyBullet's default"""


@contextmanager
def _silenced_native_output() -> Iterator[None]:
    """Discard what native code prints to C's stdout and stderr in this context.

    File descriptors are not changed, so Python's own output is not lost, in any thread.

    PyBullet prints messages to stderr when it is imported, and when it opens a window. Without a
    window it prints nothing, since the files that it loads cause no warnings.
    """
    if not sys.platform.startswith("linux"):
        yield
        return
    libc = ctypes.CDLL(None)
    libc.fopen.restype = ctypes.c_void_p
    streams = [ctypes.c_void_p.in_dll(libc, name) for name in ("stdout", "stderr")]
    with _lock:
        originals = [stream.value for stream in streams]
        # Never closed, since another thread may still write to it.
        null_file = libc.fopen(os.fsencode(os.devnull), b"we")
        try:
            for stream in streams:
                stream.value = null_file or stream.value
            yield
        finally:
            for stream, value in zip(streams, originals, strict=True):
                stream.value = value


class _MissingPyBullet:
    """Stand-in for PyBullet where it can't be imported: each use of it raises Unavailable."""

    def __init__(self, reason: ImportError) -> None:
        self._reason = reason

    def __getattr__(self, name: str) -> NoReturn:
        if name.startswith("__"):  # what Python itself looks for
            raise AttributeError(name)
        raise Unavailable(
            f"this needs the physics engine PyBullet, which can't be imported ({self._reason}); "
            "without it, choose the drive `route`, and neither camera pictures nor films"
        )


def _import_pybullet() -> Any:
    with _silenced_native_output():
        try:
            return importlib.import_module("pybullet")
        except ImportError as error:
            return _MissingPyBullet(error)


pybullet = _import_pybullet()

__all__ = ["SUN", "Connection", "has_pybullet", "pybullet", "require_pybullet"]

SUN: Vector = (0.55, -0.75, 1.25)
"""direction towards the light in all pictures"""


def has_pybullet() -> bool:
    """Return True if PyBullet can be used."""
    return not isinstance(pybullet, _MissingPyBullet)


def require_pybullet() -> None:
    """Raise Unavailable if PyBullet can't be used; call it before long work that needs it."""
    _ = pybullet.connect


class Connection(Closing):
    """Connection to a physics client of PyBullet; close it, or use it as a context.

    Each connection has bodies of its own. Connections do not affect each other, in one thread or in
    several.
    """

    contact_breaking = 0.02
    """m between two bodies beyond which PyBullet stores no contact points of them"""

    def __init__(self, gui: bool = False) -> None:
        global _applied_breaking
        if gui:
            with _silenced_native_output():
                self._client: int = pybullet.connect(pybullet.GUI)
        else:
            self._client = pybullet.connect(pybullet.DIRECT)
        with _lock:
            _applied_breaking = None
        if self._client < 0:
            raise Unavailable("PyBullet opens no connection: it allows 1,024 at the same time")
        # PyBullet has 1,024 connections at most, and owners may forget to close theirs.
        self._finalizer = weakref.finalize(self, _disconnect, self._client)

    def close(self) -> None:
        """End the connection; the object can't be used afterwards."""
        self._finalizer()

    @contextmanager
    def _contact_breaking_applied(self) -> Iterator[None]:
        """Apply this connection's `contact_breaking`, and lock out other threads in this context.

        PyBullet has one value for all connections, so each search for contacts must set its own.
        """
        with _lock:
            self._apply_contact_breaking()
            yield

    def _apply_contact_breaking(self) -> None:
        global _applied_breaking
        if _applied_breaking != self.contact_breaking:
            _applied_breaking = self.contact_breaking
            pybullet.setPhysicsEngineParameter(
                contactBreakingThreshold=_applied_breaking, physicsClientId=self._client
            )

    def _detect(self) -> None:
        """Detect collisions; rays are tested against the poses of bodies at the last detection."""
        with _lock:  # not `_contact_breaking_applied`, which is too slow for each time step
            self._apply_contact_breaking()
            pybullet.performCollisionDetection(physicsClientId=self._client)

    def _simulate(self) -> None:
        """Simulate one time step of the physics."""
        with _lock:  # as in `_detect`
            self._apply_contact_breaking()
            pybullet.stepSimulation(physicsClientId=self._client)

    def _render(
        self, view: Sequence[float], projection: Sequence[float], size: tuple[int, int]
    ) -> tuple[NDArray[np.uint8], NDArray[np.float64]]:
        """Render a camera's picture in daylight, without shadows.

        Args:
            view: OpenGL's view matrix, column by column.
            projection: OpenGL's projection matrix, column by column.
            size: width and height in px.

        Returns:
            Red, green and blue, shape (height, width, 3), and OpenGL's depth buffer, shape (height,
            width).
        """
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
        # PyBullet sets the pose of the base's centre of mass; `origin` and `rpy` are of its link.
        info = pybullet.getDynamicsInfo(body, -1, physicsClientId=self._client)
        position, orientation = pybullet.multiplyTransforms(
            origin, pybullet.getQuaternionFromEuler(rpy), info[3], info[4]
        )
        pybullet.resetBasePositionAndOrientation(
            body, position, orientation, physicsClientId=self._client
        )

    def _parts(self, body: int) -> dict[int, tuple[str, str]]:
        """Return names of each joint and of the link that it carries, by the joint's number."""
        count = pybullet.getNumJoints(body, physicsClientId=self._client)
        infos = [pybullet.getJointInfo(body, k, physicsClientId=self._client) for k in range(count)]
        return {k: (info[1].decode(), info[12].decode()) for k, info in enumerate(infos)}


def _disconnect(client: int) -> None:
    pybullet.disconnect(physicsClientId=client)
