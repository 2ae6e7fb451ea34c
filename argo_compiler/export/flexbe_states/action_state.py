"""Base class of the states that measure and drive."""

from flexbe_core import EventState

from .memory import time_up
from .robot import robot


class ActionState(EventState):
    """State of one action, which starts at the first execution and is cancelled on exit.

    Derived classes start the action in `_start`.
    """

    def __init__(self, task, way, retries, time_limit, depth):
        super().__init__(
            outcomes=["done", "failed", "time_up"],
            input_keys=["memory"],
            output_keys=["memory"],
        )
        self._task = task
        self._retries = retries
        self._depth = depth
        self._way = way
        self._time_limit = time_limit
        self._failures = 0
        self._is_running = False
        self._started_at = 0.0

    def on_enter(self, _userdata):
        self._failures = 0
        self._is_running = False

    def execute(self, userdata):
        memory = userdata.memory
        result = robot().result() if self._is_running else None
        if result is None:
            now = robot().now()
            target = time_up(self._depth, memory, now)
            if target is not None:
                memory["to"] = target
                return "time_up"
            if not self._is_running:
                self._start()
                self._is_running, self._started_at = True, now
                return None
            if not self._time_limit or now < self._started_at + self._time_limit:
                return None
            self._cancel()
            result = "failed", None
        self._is_running = False
        outcome, value = result
        if outcome == "done":
            self._record_result(memory, value)
            return "done"
        self._failures += 1
        if self._failures <= self._retries:
            return None
        self._record_failure(memory, outcome)
        return "failed"

    def on_exit(self, _userdata):
        self._cancel()

    def on_stop(self):
        self._cancel()

    def on_pause(self):
        self._cancel()

    def _cancel(self):
        if self._is_running:
            robot().cancel()
            self._is_running = False

    def _record_result(self, memory, value):
        """Store the action's value. No-op unless a derived class measures."""

    def _record_failure(self, memory, outcome):
        """Store the failure. No-op unless a derived class measures."""
