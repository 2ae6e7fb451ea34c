"""The process of a run, as the service sees it."""

import multiprocessing
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from argo_compiler.model import Model
from argo_planner.service.runs.requests import RunOrder
from argo_planner.service.runs.state import RunState
from argo_planner.service.runs.worker import carry_out

_SPAWN = multiprocessing.get_context("spawn")


class RunProcess:
    """The process of a run, and the service's end of the pipe to it."""

    def __init__(
        self, folder: Path, order: RunOrder, first: RunState, foxglove: int | None
    ) -> None:
        self._pipe, there = _SPAWN.Pipe()
        arguments = (there, folder, order, first, foxglove)
        self._process = _SPAWN.Process(target=carry_out, args=arguments)
        self._process.daemon = True
        self._process.start()
        there.close()

    def send(self, message: object) -> None:
        try:
            self._pipe.send(message)
        except OSError:
            return  # it has ended, and whoever reads from it hears of that

    def read(self, heard: Callable[[Model], object], ended: Callable[[], object]) -> None:
        """From now on tells what comes from the process, from a thread of its own, and its end."""

        def reading() -> None:
            with suppress(EOFError, OSError):
                while True:
                    heard(self._pipe.recv())
            self._process.join()
            ended()

        self._reader = threading.Thread(target=reading, daemon=True)
        self._reader.start()

    def end(self) -> None:
        """Ends the process; the loop that is told of it still runs."""
        self._process.kill()
        self._reader.join()
        self._pipe.close()

    def how_it_ended(self) -> str:
        status = self._process.exitcode
        return f"signal {-status}" if status is not None and status < 0 else f"status {status}"
