"""Processes that work for another one."""

import errno
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import wait
from multiprocessing.context import ForkServerContext, ForkServerProcess

NEEDED_TO_DRIVE = (
    "argo_env.site.build",
    "scipy.ndimage",
    "scipy.sparse.csgraph",
    "scipy.spatial.transform",
)
"""modules that a process otherwise loads with its first path, as little else needs them"""
_ATTEMPTS = 5
"""to begin a process"""
_PAUSE = 0.1  # s between two attempts
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


class _Process(ForkServerProcess):
    """A process that begins even if the one that it is forked from is killed meanwhile: that one is
    begun again."""

    def start(self) -> None:
        """Begin the process. Raises OSError if it can't."""
        for attempts_left in reversed(range(_ATTEMPTS)):
            try:
                super().start()
                return
            except (EOFError, ConnectionError) as error:
                if not attempts_left:
                    why = "the process that it would be forked from has ended"
                    raise ChildProcessError(errno.ECHILD, why) from error
                time.sleep(_PAUSE)  # it may not be known yet that it has ended


class _Context(ForkServerContext):
    Process = _Process


def context_with(*modules: str) -> ForkServerContext:
    """Return a context in which each process is forked from one that has loaded these modules and
    what driving needs, so that it begins at once rather than after seconds.

    That one is begun with the first of them, does nothing else, and ends with this process, which
    has one of this kind only.
    """
    context = _Context()
    context.set_forkserver_preload([*modules, *NEEDED_TO_DRIVE])
    return context


def end_with_parent(parent: int | None = None) -> None:
    """Leave interruptions to the process that began this one, and end with it, even if it is
    killed.

    `parent`: its id, where it is not `multiprocessing` that began this one.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    begun_by = multiprocessing.parent_process()
    if begun_by is not None and begun_by.sentinel is not None:
        end: Callable[[], object] = partial(wait, [begun_by.sentinel])
    elif parent is not None:
        end = partial(_wait_for, parent)
    else:
        return
    threading.Thread(target=_end_after, args=(end,), daemon=True).start()


def _wait_for(parent: int) -> None:
    while os.getppid() == parent:
        time.sleep(_PERIOD)


def _end_after(end: Callable[[], object]) -> None:
    end()
    os._exit(1)
