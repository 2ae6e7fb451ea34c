"""Worker processes: their number, start, and end with the process that started them."""

import errno
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable
from functools import partial
from multiprocessing import resource_tracker
from multiprocessing.connection import wait

from argo_compiler.base.operating_system import sigint_blocked, wait_for_parent_end

if sys.platform == "win32":
    from multiprocessing.context import SpawnContext as WorkerContext
else:
    from multiprocessing.context import ForkServerContext as WorkerContext
    from multiprocessing.context import ForkServerProcess

__all__ = [
    "NEEDED_TO_DRIVE",
    "WorkerContext",
    "context_with",
    "ignore_sigint_and_end_with_parent",
    "usable_processors",
]

NEEDED_TO_DRIVE = (
    "argo_env.site.build",
    "scipy.ndimage",
    "scipy.sparse.csgraph",
    "scipy.spatial.transform",
)
"""modules that a process otherwise loads with its first path, because little else needs them"""
_ATTEMPTS = 5
"""maximum number of attempts to start a process"""
_PAUSE = 0.1  # s between two attempts


def usable_processors() -> int:
    """Return the number of processors that this process may use.

    PYTHON_CPU_COUNT overrides it, as in Python 3.13.
    """
    override = os.environ.get("PYTHON_CPU_COUNT", "")
    if override.isdecimal() and int(override):
        return int(override)
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


if sys.platform == "win32":

    def context_with(*modules: str) -> WorkerContext:  # noqa: ARG001
        """Return a `multiprocessing` context; each process loads what it needs itself."""
        return WorkerContext()

else:

    class _Process(ForkServerProcess):
        """Process that starts even if the fork server is killed meanwhile; it is restarted."""

        def start(self) -> None:
            """Start the process. Raises OSError if that fails."""
            for attempts_left in reversed(range(_ATTEMPTS)):
                try:
                    resource_tracker.ensure_running()  # its start would unblock SIGINT
                    with sigint_blocked():
                        super().start()
                    return
                except (EOFError, ConnectionError) as error:
                    if not attempts_left:
                        why = "the process that it would be forked from has ended"
                        raise ChildProcessError(errno.ECHILD, why) from error
                    time.sleep(_PAUSE)  # the end of the fork server may not be known yet

    class _Context(WorkerContext):
        Process = _Process

    def context_with(*modules: str) -> WorkerContext:
        """Return a `multiprocessing` context whose processes have loaded `modules` at their start.

        Each process is forked from a fork server that has loaded `modules` and those that driving
        needs. The fork server starts with the first process, does nothing else, and ends with this
        process. There is only one: after it has started, it does not load the modules of other
        calls.
        """
        context = _Context()
        context.set_forkserver_preload([*modules, *NEEDED_TO_DRIVE])
        return context


def ignore_sigint_and_end_with_parent(parent_outside_multiprocessing: int | None = None) -> None:
    """Ignore SIGINT, and end this process when its parent ends, even if the parent is killed.

    Args:
        parent_outside_multiprocessing: process id of the parent, needed only if
            `multiprocessing` did not start this process. If it is needed and None, the process does
            not end with its parent.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    known_parent = multiprocessing.parent_process()
    if known_parent is not None and known_parent.sentinel is not None:
        end: Callable[[], object] = partial(wait, [known_parent.sentinel])
    elif parent_outside_multiprocessing is not None:
        end = partial(wait_for_parent_end, parent_outside_multiprocessing)
    else:
        return
    threading.Thread(target=_end_after, args=(end,), daemon=True).start()


def _end_after(end: Callable[[], object]) -> None:
    end()
    os._exit(1)
