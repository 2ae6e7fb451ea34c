"""Pauses of Python's cyclic garbage collector while large data is built that stays in use."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

_SELDOM = 200_000
"""threshold of the collector: new containers between two collections; Python's own value is 700"""

_holding = Lock()
"""lock of the one thread that pauses the collector"""


@contextmanager
def collector_held() -> Iterator[None]:
    """Pause the garbage collector; a large mission is built in half the time.

    The collector examines all live objects each time that many new ones have been created, and
    finds nothing to free while the new data is still in use. There is one collector for the whole
    process, so only one thread at a time pauses it. Another thread that enters meanwhile runs its
    block at once, and the collector may run again before that block is done.
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


def enable_garbage_collector(seldom: bool = False) -> None:
    """Turn the collector on to skip the objects that exist already; do nothing if it is on.

    With `seldom`, which is for commands that end soon, the collector hardly ever runs: the tables
    for parsing scripts are 150,000 containers that stay, and examining them takes a twentieth of
    the time of `argo check`.
    """
    if not gc.isenabled():
        gc.freeze()
        if seldom:
            gc.set_threshold(_SELDOM)
        gc.enable()
