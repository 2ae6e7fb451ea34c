"""Work in a process of its own, which tells how far it is and can be ended at any moment; and which
ends with the service, even where that is killed."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from threading import Lock
from typing import Any, Generic, TypeVar

from argo_compiler.base.errors import ArgoError, Unavailable
from argo_env.worker_processes import end_with_parent
from argo_planner.service.processes.context import CONTEXT

Result = TypeVar("Result")
Tell = Callable[[Any], None]
"""what the work is given to tell how far it is"""


class JobProcess(Generic[Result]):
    """Piece of work in a process of its own, which is begun when the result is awaited."""

    def __init__(self, work: Callable[..., Result], *arguments: Any, parent: bool = False) -> None:
        """The work is `work(*arguments, tell)`; all of it can be pickled. `parent`: whether it has
        processes of its own, which then have to end by themselves once it has."""
        self._here, self._there = CONTEXT.Pipe(duplex=False)
        self._process = CONTEXT.Process(target=_carried_out, args=(self._there, work, arguments))
        self._process.daemon = not parent
        self._turn = Lock()
        """held while the process begins or is ended"""
        self._ended = False

    async def result(self, heard: Tell) -> Result:
        """What came of the work; `heard` is told how far it is.

        Raises the ArgoError that the work has raised, or Unavailable if its process can't begin or
        has died.
        """
        loop = asyncio.get_running_loop()
        thread = ThreadPoolExecutor(1)
        try:
            await loop.run_in_executor(thread, self._begin)
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
        finally:
            thread.shutdown(wait=False)

    def _begin(self) -> None:
        # The first process begins when its modules are loaded, which takes seconds.
        with self._turn:
            try:
                if not self._ended:
                    self._process.start()
            except OSError as error:
                why = f"the process that is to work on it can't begin: {error.strerror}"
                raise Unavailable(f"{why}; try again") from error
            finally:
                self._there.close()

    async def end(self) -> None:
        """Ends the process, whatever it does."""
        await asyncio.to_thread(self._end)

    def _end(self) -> None:
        with self._turn:
            self._ended = True
            if self._process.pid is not None:
                self._process.kill()
                self._process.join()


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
