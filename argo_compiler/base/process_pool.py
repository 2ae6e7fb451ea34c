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

    def __init__(self, max_workers: int, **options: Any) -> None:
        super().__init__(max_workers, **options)
        self._starter = ThreadPoolExecutor(1)

    def submit(self, function: Callable[..., Any], *args: Any, **kwargs: Any) -> "Future[Any]":
        """Call a function in a worker process, which starts if needed.

        Raises BrokenProcessPool if a process has died, and OSError if none can start.
        """
        return self._starter.submit(self._submit, function, *args, **kwargs).result()

    def shutdown(self, wait: bool = True, kill_workers: bool = False) -> None:
        """End the processes; with `wait`, those as well that are starting."""
        self._starter.shutdown(wait=wait)
        super().shutdown(wait=wait, kill_workers=kill_workers)

    def _submit(self, function: Callable[..., Any], *args: Any, **kwargs: Any) -> "Future[Any]":
        with sigint_blocked():
            future: Future[Any] = super().submit(function, *args, **kwargs)
        return future
