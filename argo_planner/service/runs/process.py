"""The process of a run, as the service sees it."""

import queue
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.model import Model
from argo_planner.service.processes.context import CONTEXT
from argo_planner.service.runs.pipe import RobotText
from argo_planner.service.runs.requests import RunOrder, RunRequest
from argo_planner.service.runs.state import RunState
from argo_planner.service.runs.worker import carry_out

MOST_WAITING = 200
"""messages for a process that does not read them"""
MOST_AT_ONCE = 500
"""messages of a process that are heard together"""


class RunProcess:
    """The process of a run, and the service's end of the pipe to it. Holds what waits to be sent:
    a thread of its own sends it, so that nobody waits for a process that does not read."""

    def __init__(
        self,
        folder: Path,
        order: RunOrder,
        first: RunState,
        foxglove: int | None,
        asked: tuple[RunRequest, str] | None,
    ) -> None:
        """`asked`: for what the process of an interrupted run begins, and who wants it. Raises
        OSError if it can't begin."""
        self.run = first.id
        self.for_stop = asked is not None and asked[0].kind == "stop"
        self.problem: str | None = None
        """why it says it has broken off"""
        self._pipe, there = CONTEXT.Pipe()
        arguments = (there, folder, order, first, foxglove, asked)
        self._process = CONTEXT.Process(
            target=carry_out, args=arguments, name=f"run {self.run}", daemon=True
        )
        self._process.start()
        there.close()
        self._waiting: queue.Queue[object] = queue.Queue(MOST_WAITING)
        self._sender = threading.Thread(target=self._sending, daemon=True)
        self._sender.start()

    def require_room(self) -> None:
        """Raises Unavailable if so much waits for the process that it takes nothing more."""
        if self._waiting.full():
            raise self._no_room()

    def send(self, message: object) -> None:
        """Sends a message in its turn. Raises Unavailable."""
        try:
            self._waiting.put_nowait(message)
        except queue.Full:
            raise self._no_room() from None

    def send_text(self, text: str) -> None:
        """Sends a text of the robot, which tells again what is not acknowledged: half of the room
        is left for people."""
        if self._waiting.qsize() < MOST_WAITING // 2:
            self.send(RobotText(text=text))

    def read(self, heard: Callable[[Sequence[Model]], object], ended: Callable[[], object]) -> None:
        """From now on tells what comes from the process, from a thread of its own, and its end.
        What comes while that is heard is told together."""

        def reading() -> None:
            try:
                while messages := self._received():
                    heard(messages)
            except BaseException:
                self._process.kill()
                raise
            finally:
                self._process.join()
                self._end_sending()
                self._pipe.close()
                ended()

        self._reader = threading.Thread(target=reading, daemon=True)
        self._reader.start()

    def end(self) -> None:
        """Ends the process; the loop that is told of it still runs."""
        self._process.kill()
        self._reader.join()

    def how_it_ended(self) -> str:
        status = self._process.exitcode
        return f"signal {-status}" if status is not None and status < 0 else f"status {status}"

    def _received(self) -> Sequence[Model]:
        """What has come, at least one message; nothing once the process has ended."""
        found: list[Model] = []
        with suppress(EOFError, OSError):
            found.append(self._pipe.recv())
            while len(found) < MOST_AT_ONCE and self._pipe.poll():
                found.append(self._pipe.recv())
        return found

    def _sending(self) -> None:
        while (message := self._waiting.get()) is not None:
            try:
                self._pipe.send(message)
            except OSError:
                return  # it has ended, and whoever reads from it hears of that

    def _end_sending(self) -> None:
        with suppress(queue.Empty):
            while True:
                self._waiting.get_nowait()
        with suppress(queue.Full):
            self._waiting.put_nowait(None)
        self._sender.join()

    def _no_room(self) -> Unavailable:
        return Unavailable(
            f"the process of run {self.run} takes nothing: {MOST_WAITING} messages wait for it. "
            f"Ask again in a moment; if it hangs, end process {self._process.pid}, and the run can "
            "go on from its journal"
        )
