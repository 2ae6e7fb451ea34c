"""PyBullet without its chatter: the only place that imports it."""

import ctypes
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager


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

__all__ = ["pybullet", "quiet"]
