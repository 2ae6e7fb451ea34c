"""The process of a run, on the side of the service."""

import queue
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from argo_compiler.base.errors import Unavailable
from argo_compiler.base.message import Message
from argo_compiler.base.model import Model
from argo_planner.service.processes.context import CONTEXT
from argo_planner.service.runs.pipe import RobotText
from argo_planner.service.runs.requests import RunOrder, RunRequest
from argo_planner.service.runs.state import RunState
from argo_planner.service.runs.worker import run_worker

MOST_WAITING = 200
"""messages that may wait to be sent to a process"""
MOST_AT_ONCE = 500
"""messages from a process that are handled in one call"""


class RunProcess:
    """The process of a run, and the service's end of the pipe to it.

    Holds a queue of messages to the process. A separate thread sends them, so that nothing blocks
    if the process does not read.
    """

    def __init__(
        self,
        folder: Path,
        order: RunOrder,
        first: RunState,
        foxglove: int | None,
        request: tuple[RunRequest, str] | None,
    ) -> None:
        """Start the process; raises OSError if that is not possible.

        Args:
            folder: Folder of the run.
            order: Order of the run.
            first: State of the run before the process starts.
            foxglove: Port at which the run is shown live; None: it is not.
            request: Request that resumes or stops an interrupted run, with its author; None: the
                run was not interrupted, or resumes without a request.
        """
        self.run = first.id
        self.for_stop = request is not None and request[0].kind == "stop"
        """whether the process was started only to stop the run"""
        self.problem: str | None = None
        """why the process can't continue, by its last message; None: it sent no such message"""
        self._pipe, worker_end = CONTEXT.Pipe()
        arguments = (worker_end, folder, order, first, foxglove, request)
        self._process = CONTEXT.Process(
            target=run_worker, args=arguments, name=Message("run {run}", run=self.run), daemon=True
        )
        self._process.start()
        worker_end.close()
        self._waiting: queue.Queue[object] = queue.Queue(MOST_WAITING)
        self._sender = threading.Thread(target=self._send_waiting, daemon=True)
        self._sender.start()

    def require_queue_space(self) -> None:
        """Raise Unavailable if the queue of messages to the process is full."""
        if self._waiting.full():
            raise self._overload_error()

    def send(self, message: object) -> None:
        """Queue a message for the process; raises Unavailable if the queue is full."""
        try:
            self._waiting.put_nowait(message)
        except queue.Full:
            raise self._overload_error() from None

    def queue_unless_half_full(self, message: str) -> None:
        """Queue a message of the remote robot for the process; drop it if the queue is half full.

        The rest of the queue is left for people's requests. The robot repeats a dropped message, as
        it gets no acknowledgement.
        """
        if self._waiting.qsize() < MOST_WAITING // 2:
            self.send(RobotText(text=message))

    def start_reading(
        self, on_messages: Callable[[Sequence[Model]], object], on_exit: Callable[[], object]
    ) -> None:
        """Start a thread that calls `on_messages` with messages of the process, then `on_exit`.

        Messages that arrive during a call of `on_messages` are passed on together in the next one.
        `on_exit` is called after the process has ended.
        """

        def pass_on() -> None:
            try:
                while messages := self._receive_messages():
                    on_messages(messages)
            except BaseException:
                self._process.kill()
                raise
            finally:
                self._process.join()
                self._stop_sender()
                self._pipe.close()
                on_exit()

        self._reader = threading.Thread(target=pass_on, daemon=True)
        self._reader.start()

    def kill(self) -> None:
        """Kill the process, unless it has ended; the reading thread then calls `on_exit`."""
        self._process.kill()

    def kill_and_wait(self) -> None:
        """Kill the process, and wait until the reading thread has called `on_exit` and ended.

        Call this in another thread than the one in which the callbacks do their work.
        """
        self._process.kill()
        self._reader.join()

    def exit_reason(self) -> str:
        """Return the signal or the exit status with which the process ended, as text."""
        status = self._process.exitcode
        return (
            Message("signal {value}", value=-status)
            if status is not None and status < 0
            else Message("status {status}", status=status)
        )

    def _receive_messages(self) -> Sequence[Model]:
        """Wait for messages; return at least one, or none if the process has ended."""
        messages: list[Model] = []
        with suppress(EOFError, OSError):
            messages.append(self._pipe.recv())
            while len(messages) < MOST_AT_ONCE and self._pipe.poll():
                messages.append(self._pipe.recv())
        return messages

    def _send_waiting(self) -> None:
        while (message := self._waiting.get()) is not None:
            try:
                self._pipe.send(message)
            except OSError:
                return  # the process has ended, which the reading thread notices

    def _stop_sender(self) -> None:
        with suppress(queue.Empty):
            while True:
                self._waiting.get_nowait()
        with suppress(queue.Full):
            self._waiting.put_nowait(None)
        self._sender.join()

    def _overload_error(self) -> Unavailable:
        return Unavailable(
            Message(
                "the process of run {run} accepts no more messages: {most_waiting} are "
                "waiting. Try again in a moment; if it hangs, end process {pid} and resume "
                "the run from its journal",
                run=self.run,
                most_waiting=MOST_WAITING,
                pid=self._process.pid,
            )
        )
