"""PyBullet without its chatter: the only place that imports it, and what its users share."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import TracebackType
from typing import Self

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

__all__ = ["Connection", "pybullet", "quiet"]


class Connection:
    """A world of bodies in PyBullet. Holds a connection; close it, or use it as a context."""

    def __init__(self, gui: bool = False) -> None:
        with quiet():
            self._client: int = pybullet.connect(pybullet.GUI if gui else pybullet.DIRECT)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends the connection; the object is of no use afterwards."""
        pybullet.disconnect(physicsClientId=self._client)

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
