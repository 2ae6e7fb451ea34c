"""Work in a process of its own, which tells how far it is and can be ended at any moment; and which
ends with the service, even where that is killed."""

import asyncio
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar

from argo_compiler.base.errors import ArgoError, Unavailable

Result = TypeVar("Result")
Tell = Callable[[Any], None]
"""what the work is given to tell how far it is"""
_SPAWN = multiprocessing.get_context("spawn")


class JobProcess(Generic[Result]):
    """One piece of work under way. Holds the process."""

    def __init__(self, work: Callable[..., Result], *arguments: Any, parent: bool = False) -> None:
        """Begins the work, `work(*arguments, tell)`; all of it can be pickled. `parent`: whether
        it has processes of its own, which then have to end by themselves once it has."""
        self._here, there = _SPAWN.Pipe(duplex=False)
        self._process = _SPAWN.Process(target=_carried_out, args=(there, work, arguments))
        self._process.daemon = not parent
        self._process.start()
        there.close()

    async def result(self, heard: Tell) -> Result:
        """What came of the work; `heard` is told how far it is.

        Raises the ArgoError that the work has raised, or Unavailable if its process has died.
        """
        loop = asyncio.get_running_loop()
        with ThreadPoolExecutor(1) as thread:
            while True:
                try:
                    kind, what = await loop.run_in_executor(thread, self._here.recv)
                except (EOFError, OSError):
                    raise Unavailable("the process that worked on it has died: try again") from None
                match kind:
                    case "told":
                        heard(what)
                    case "raised":
                        raise what
                    case _:
                        result: Result = what
                        return result

    def end(self) -> None:
        """Ends the process, whatever it does."""
        self._process.kill()
        self._process.join()


def end_with_parent() -> None:
    """From now on this process ends as soon as the one that began it has, and leaves interruptions
    to it: Ctrl-C is sent to both."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_after, args=(parent.sentinel,), daemon=True).start()


def _end_after(sentinel: int) -> None:
    wait([sentinel])
    os._exit(1)


def _carried_out(pipe: Connection, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    end_with_parent()

    def tell(what: Any) -> None:
        pipe.send(("told", what))

    try:
        result = work(*arguments, tell)
    except ArgoError as error:
        pipe.send(("raised", error))
    else:
        pipe.send(("done", result))
