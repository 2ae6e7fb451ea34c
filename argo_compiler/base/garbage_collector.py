"""Holds Python's cyclic garbage collector off while much data is built that stays."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

_THRESHOLD = 200_000
"""containers made since the last search that a command's next one waits for; Python's own is 700"""

_holding = Lock()
"""held by the one thread that holds the collector off"""


@contextmanager
def collector_held() -> Iterator[None]:
    """No collection inside; a large mission is built in half the time.

    The collector looks through all that lives each time that enough was added, and finds nothing
    while what is built is still in use. It is the process' own, so one thread at a time holds it
    off; what others build meanwhile may see it come back before they are done.
    """
    if not _holding.acquire(blocking=False):
        yield
        return
    try:
        if not gc.isenabled():
            yield
            return
        gc.disable()
        try:
            yield
        finally:
            gc.enable()
    finally:
        _holding.release()


def collect_again() -> None:
    """Turn the collector on where it was turned off; what lives by now is never looked at.

    A command makes some 150,000 containers that stay, of the tables by which a script is read: to
    look through them for garbage takes a twentieth of a short command's time.
    """
    if not gc.isenabled():
        gc.freeze()
        gc.set_threshold(_THRESHOLD)
        gc.enable()
