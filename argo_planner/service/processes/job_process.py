"""Job in a separate process, which reports its progress and can be ended at any time.

The process ends with the service, even if the service is killed.
"""

import asyncio
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from threading import Lock
from typing import Any, Generic, TypeVar

from argo_compiler.base.errors import ArgoError, Unavailable, reason_text
from argo_compiler.base.limited_process import CallLimits, exceeded_limit
from argo_compiler.base.message import Message
from argo_env.worker_processes import ignore_sigint_and_end_with_parent
from argo_planner.service.processes.context import CONTEXT

Result = TypeVar("Result")
ReportProgress = Callable[[Any], None]
"""function that the work calls with its progress"""


class JobProcess(Generic[Result]):
    """Function call in a separate process, which is started when the result is awaited."""

    def __init__(
        self,
        work: Callable[..., Result],
        *arguments: Any,
        parent: bool = False,
        limits: CallLimits | None = None,
    ) -> None:
        """Prepare the call `work(*arguments, report)`; all of it and its result must be picklable.

        Args:
            work: The function; its last argument is a `ReportProgress`.
            arguments: Its other arguments.
            parent: True if the work starts processes of its own, which it could not do in a daemon
                process. `end` does not end these: they have to end by themselves after it.
            limits: Limits that the work sets itself (`limited`), of which the time is enforced
                here too; None: it has none.
        """
        self._limits = limits
        self._receiver, self._sender = CONTEXT.Pipe(duplex=False)
        self._process = CONTEXT.Process(target=_run_work, args=(self._sender, work, arguments))
        self._process.daemon = not parent
        self._turn = Lock()
        """held while the process is started or ended, or its end is awaited"""
        self._ended = False

    async def start_and_wait(self, on_progress: ReportProgress) -> Result:
        """Start the process, wait for the work to end, and return its result.

        Meanwhile, `on_progress` is called with each progress that the work reports. Raises the
        ArgoError that the work has raised, LimitExceeded if it has limits and exceeds them, or
        Unavailable if its process can't start or has died.
        """
        timed_out = False

        def stop() -> None:
            nonlocal timed_out
            timed_out = True
            self._process.kill()

        loop = asyncio.get_running_loop()
        thread = ThreadPoolExecutor(1)
        timer: asyncio.TimerHandle | None = None
        try:
            await loop.run_in_executor(thread, self._start)
            if self._limits is not None:
                timer = loop.call_later(self._limits.total_seconds, stop)
            while True:
                try:
                    kind, content = await loop.run_in_executor(thread, self._receiver.recv)
                except (EOFError, OSError):
                    if self._limits is not None:
                        await loop.run_in_executor(thread, self._wait_for_exit)
                        if not self._ended:
                            code = self._process.exitcode
                            raise exceeded_limit(self._limits, code, timed_out) from None
                    raise Unavailable("the process of this job has died: try again") from None
                match kind:
                    case "told":
                        on_progress(content)
                    case "raised":
                        raise content
                    case _:
                        result: Result = content
                        return result
        finally:
            if timer is not None:
                timer.cancel()
            thread.shutdown(wait=False)

    def _start(self) -> None:
        # The first process starts after its modules are loaded, which takes seconds.
        with self._turn:
            try:
                if not self._ended:
                    self._process.start()
            except OSError as error:
                why = Message(
                    "the process of this job can't start: {reason}", reason=reason_text(error)
                )
                raise Unavailable(Message("{why}; try again", why=why)) from error
            finally:
                self._sender.close()

    def _wait_for_exit(self) -> None:
        with self._turn:  # of two threads that wait, one does not learn the exit code
            if self._process.pid is not None:
                self._process.join()

    async def end(self) -> None:
        """Kill the process, or prevent its start; `start_and_wait` then raises Unavailable."""
        await asyncio.to_thread(self._end)

    def _end(self) -> None:
        with self._turn:
            self._ended = True
            if self._process.pid is not None:
                self._process.kill()
                self._process.join()


def _run_work(pipe: Connection, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    ignore_sigint_and_end_with_parent()
    os.umask(0o077)

    def report(progress: Any) -> None:
        pipe.send(("told", progress))

    try:
        result = work(*arguments, report)
    except ArgoError as error:
        pipe.send(("raised", error))
    else:
        pipe.send(("done", result))
