"""Worker processes on this machine, by loky."""

import os
import re
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from multiprocessing.context import ForkServerContext
from typing import Any

from loky import ProcessPoolExecutor
from loky.backend.context import LokyContext
from loky.process_executor import BrokenProcessPool

from argo_compiler.base.errors import Unavailable
from argo_env.evaluation.pool.backend import WorkerDiedError
from argo_env.worker_processes import end_with_parent


class Processes:
    """Workers that are processes of this machine. If one dies, all of them are begun anew, and with
    it the calls that were under way.

    Each is begun as a process of the context is; without one it loads anew what it needs.
    """

    name = "processes"
    names_the_dead = False

    def __init__(self, workers: int, context: ForkServerContext | None = None) -> None:
        self.workers = workers
        # Its semaphores are cleared away without a word even where this process is killed.
        self._context = LokyContext()
        if context is not None:
            self._context.Process = context.Process
        self._broken = False
        self._executor = self._begun()

    def submit(self, call: Callable[[Any], Any], argument: Any) -> "Future[Any]":
        try:
            future: Future[Any] = self._executor.submit(call, argument)
        except BrokenProcessPool as broken:
            self._broken = True
            raise _death(broken) from None
        except OSError as error:
            raise Unavailable(f"no worker process can begin: {error.strerror}") from error
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

    def mend(self) -> None:
        if self._broken:
            self.close()
            self._executor = self._begun()
            self._broken = False

    def close(self) -> None:
        self._executor.shutdown(wait=True, kill_workers=True)

    def _begun(self) -> ProcessPoolExecutor:
        niceness = os.getpriority(os.PRIO_PROCESS, 0)
        return ProcessPoolExecutor(
            self.workers,
            context=self._context,
            initializer=_begin,
            initargs=(os.getpid(), niceness),
        )


def _begin(parent: int, niceness: int) -> None:
    end_with_parent(parent)
    os.setpriority(os.PRIO_PROCESS, 0, niceness)


def _death(broken: BrokenProcessPool) -> WorkerDiedError:
    """What loky knows of the end of its workers, in a few words."""
    codes = re.findall(r"(SIG[A-Z]+|EXIT)\((-?\d+)\)", str(broken))
    # Its own end of those that were left is no reason.
    own = [(name, code) for name, code in codes if name != "SIGTERM"] or codes
    if not own:
        return WorkerDiedError("the worker process ended")
    name, code = own[0]
    if name == "EXIT":
        return WorkerDiedError(f"the worker process ended with code {code}")
    killed = name in ("SIGKILL", "SIGTERM")
    return WorkerDiedError(f"the worker process was ended by {name}", killed)
