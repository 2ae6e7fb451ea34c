"""Back end with worker processes on this machine, by loky."""

import os
import re
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from typing import Any

from loky.backend.context import LokyContext
from loky.process_executor import BrokenProcessPool

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.operating_system import niceness, set_niceness
from argo_compiler.base.process_pool import ProcessPool
from argo_env.evaluation.pool.backend import WorkerDiedError
from argo_env.worker_processes import WorkerContext, ignore_sigint_and_end_with_parent


class ProcessBackend:
    """Back end with worker processes on this machine.

    If one worker dies, all of them must be replaced, and all calls being executed are lost.
    """

    name = "processes"
    isolates_deaths = False

    def __init__(self, workers: int, context: WorkerContext | None = None) -> None:
        """Start the workers; without a `context`, each worker imports all modules itself.

        A `context` is a fork server that has imported them.
        """
        self.workers = workers
        # Loky's context removes its semaphores silently, even if this process is killed.
        self._context = LokyContext()
        if context is not None:
            self._context.Process = context.Process
        self._broken = False
        self._executor = self._start()

    def submit(self, function: Callable[[Any], Any], argument: Any) -> "Future[Any]":
        try:
            future = self._executor.submit(function, argument)
        except BrokenProcessPool as broken:
            self._broken = True
            raise _death(broken) from None
        except OSError as error:
            raise Unavailable(f"no worker process can start: {error.strerror}") from error
        return future

    def wait(self, calls: Sequence["Future[Any]"]) -> Sequence["Future[Any]"]:
        if not calls:
            return ()
        ended = wait(calls, return_when=FIRST_COMPLETED).done
        return [call for call in calls if call in ended]

    def result(self, call: "Future[Any]") -> Any:
        try:
            return call.result()
        except BrokenProcessPool as broken:
            self._broken = True
            raise _death(broken) from None

    def replace_dead_workers(self) -> None:
        if self._broken:
            self.close()
            self._executor = self._start()
            self._broken = False

    def close(self) -> None:
        self._executor.shutdown(wait=True, kill_workers=True)

    def _start(self) -> ProcessPool:
        return ProcessPool(
            self.workers,
            context=self._context,
            initializer=_initialize,
            initargs=(os.getpid(), niceness()),
        )


def _initialize(parent: int, niceness_of_parent: int) -> None:
    ignore_sigint_and_end_with_parent(parent)
    set_niceness(niceness_of_parent)


def _death(broken: BrokenProcessPool) -> WorkerDiedError:
    """Return the error with the reason for the end of a worker, parsed from loky's message."""
    codes = re.findall(r"(SIG[A-Z]+|EXIT)\((-?\d+)\)", str(broken))
    # Loky itself ends the remaining workers by SIGTERM, which is no reason.
    reasons = [(name, code) for name, code in codes if name != "SIGTERM"] or codes
    if not reasons:
        return WorkerDiedError("the worker process ended")
    name, code = reasons[0]
    if name == "EXIT":
        return WorkerDiedError(f"the worker process ended with code {code}")
    killed = name in ("SIGKILL", "SIGTERM")
    return WorkerDiedError(f"the worker process was ended by {name}", killed)
