"""Processes that work for another one."""

import os
import signal
import threading
import time

_PERIOD = 1.0  # s between two looks whether the parent is there


def usable_processors() -> int:
    """Return how many processors this process may use; PYTHON_CPU_COUNT says it as it does to
    Python 3.13."""
    said = os.environ.get("PYTHON_CPU_COUNT", "")
    if said.isdecimal() and int(said):
        return int(said)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def serve_parent(parent: int) -> None:
    """To be called in a worker, with the id of the process that it works for: the worker leaves
    interruptions to it, and ends with it, even where it is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_PERIOD)
    os._exit(1)
