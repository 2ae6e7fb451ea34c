"""The pipe between the service and the worker: requests of people, texts of the robot, news."""

from collections import deque
from collections.abc import Sequence
from multiprocessing.connection import Connection
from typing import Any

from argo_compiler.base.model import Model
from argo_planner.service.runs.requests import RunRequest


class RobotText(Model):
    """What the robot's line carries, from one end to the other."""

    text: str


class BrokenOff(Model):
    """The process can't go on with the run, or could not begin it; it ends now."""

    problem: str


class WorkerPipe:
    """Tells the service what happens, and holds what has come from it."""

    def __init__(self, pipe: Connection) -> None:
        self._pipe = pipe
        self._requests: deque[tuple[RunRequest, str]] = deque()
        self._texts: list[str] = []

    def tell(self, message: Model) -> None:
        """Tells the service."""
        self._pipe.send(message)

    def wait(self, seconds: float) -> None:
        """Waits until something has come, that long at most."""
        if not self._requests:
            self._take(seconds)

    def requests(self) -> Sequence[tuple[RunRequest, str]]:
        """The requests that have come, with who asks."""
        self._take(0.0)
        found = tuple(self._requests)
        self._requests.clear()
        return found

    # the link to a robot that is somewhere else

    def send(self, message: str) -> None:
        """A text for the robot."""
        self._pipe.send(RobotText(text=message))

    def receive(self) -> Sequence[str]:
        """The texts of the robot that have come."""
        self._take(0.0)
        found, self._texts = self._texts, []
        return found

    def _take(self, seconds: float) -> None:
        while self._pipe.poll(max(0.0, seconds)):
            came: Any = self._pipe.recv()
            if isinstance(came, RobotText):
                self._texts.append(came.text)
            else:
                self._requests.append(came)
            seconds = 0.0
