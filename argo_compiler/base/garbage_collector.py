"""Holds Python's cyclic garbage collector off while much data is built that stays."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

_SELDOM = 200_000
"""containers made since the last search that the next one waits for; Python's own number is 700"""

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


def collect_again(seldom: bool = False) -> None:
    """Turn the collector on where it was turned off; what lives by now is never looked at.

    With `seldom`, which is for commands that end soon, it hardly ever looks: the tables by which a
    script is read are 150,000 containers that stay, and to look through them takes a twentieth of
    the time of `argo check`.
    """
    if not gc.isenabled():
        gc.freeze()
        if seldom:
            gc.set_threshold(_SELDOM)
        gc.enable()
