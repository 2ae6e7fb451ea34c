"""The pipe between the service and the process of a run, and the messages that only it carries."""

from collections import deque
from collections.abc import Sequence
from multiprocessing.connection import Connection
from typing import Any

from argo_compiler.base.model import Model
from argo_compiler.base.wording import Text, Wording, wording_field
from argo_planner.service.runs.requests import RunRequest


class RobotText(Model):
    """Message from a remote robot to the run, or from the run to the robot, as text."""

    text: str


class WorkerFailed(Model):
    """Last message of a process that can't start or continue the run."""

    problem: Text
    problem_wording: Wording | None = wording_field("problem")


class WorkerPipe:
    """The worker's end of the pipe, with the received messages that were not taken yet."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self._requests: deque[tuple[RunRequest, str]] = deque()
        self._texts: list[str] = []

    def send_to_service(self, message: Model) -> None:
        self._pipe.send(message)

    def wait_for_message(self, timeout: float) -> None:
        """Wait for any message, at most `timeout` s; not at all if a request is to be taken."""
        if not self._requests:
            self._receive(timeout)

    def take_requests(self) -> Sequence[tuple[RunRequest, str]]:
        """Remove and return the requests received since the last call, each with its author.

        This does not wait: there may be none.
        """
        self._receive(0.0)
        requests = tuple(self._requests)
        self._requests.clear()
        return requests

    # The link to a remote robot (`argo_env.remote.channel`)

    def send(self, message: str) -> None:
        """Send a message to the robot, through the service."""
        self._pipe.send(RobotText(text=message))

    def receive(self) -> Sequence[str]:
        """Remove and return the messages that the robot has sent since the last call."""
        self._receive(0.0)
        texts, self._texts = self._texts, []
        return texts

    def _receive(self, timeout: float) -> None:
        while self._pipe.poll(max(0.0, timeout)):
            message: Any = self._pipe.recv()
            if isinstance(message, RobotText):
                self._texts.append(message.text)
            else:
                self._requests.append(message)
            timeout = 0.0
