"""The seam to what has the worker processes."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol


class WorkerDiedError(Exception):
    """The worker process ended before the call did; holds what is known of why."""

    def __init__(self, reason: str, killed: bool = False) -> None:
        """`killed`: somebody else has ended it, as far as that is known."""
        super().__init__(reason)
        self.killed = killed


class WorkerBackend(Protocol):
    """Has worker processes, and calls a function in them. What is called and what it is given and
    returns can be pickled."""

    name: str
    workers: int
    """how many calls are carried out at once"""
    names_the_dead: bool
    """whether a worker that dies tells which call it died of, and takes no other along"""

    def submit(self, call: Callable[[Any], Any], argument: Any) -> Any:
        """Hands the call to the workers; returns what stands for it."""

    def wait(self, calls: Sequence[Any]) -> Sequence[Any]:
        """Waits until some of these have ended, and returns those."""

    def result(self, call: Any) -> Any:
        """What a call that has ended has returned; raises what it raised, or WorkerDiedError."""

    def mend(self) -> None:
        """New workers in place of those that have died."""

    def close(self) -> None:
        """Ends the workers, whatever they do."""
