"""Pool of worker processes that Ctrl-C can't interrupt while they start."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from loky import ProcessPoolExecutor

from argo_compiler.base.operating_system import sigint_blocked


class ProcessPool(ProcessPoolExecutor):  # type: ignore[misc]  # loky has no types
    """Pool of worker processes, as loky's, that another thread starts with SIGINT blocked.

    Ctrl-C interrupts the main thread, and all processes of the terminal. A worker process whose
    start that interrupts, on either side, would end with a traceback.
    """

    def submit(self, function: Callable[..., Any], *args: Any, **kwargs: Any) -> "Future[Any]":
        """Call a function in a worker process, which starts if needed.

        Raises BrokenProcessPool if a process has died, even after `shutdown`, and OSError if none
        can start.
        """
        with ThreadPoolExecutor(1) as starter:
            return starter.submit(self._submit, function, *args, **kwargs).result()

    def _submit(self, function: Callable[..., Any], *args: Any, **kwargs: Any) -> "Future[Any]":
        with sigint_blocked():
            future: Future[Any] = super().submit(function, *args, **kwargs)
        return future
