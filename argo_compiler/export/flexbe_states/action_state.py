"""What measuring and driving have in common."""

from flexbe_core import EventState

from .memory import time_up
from .robot import robot


class ActionState(EventState):
    """One action of the robot, begun at the first execution and cancelled on leaving."""

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
        self._runs = False
        self._begun = 0.0

    def on_enter(self, _userdata):
        self._failures = 0
        self._runs = False

    def execute(self, userdata):
        memory = userdata.memory
        result = robot().result() if self._runs else None
        if result is None:
            now = robot().now()
            target = time_up(self._depth, memory, now)
            if target is not None:
                memory["to"] = target
                return "time_up"
            if not self._runs:
                self._begin()
                self._runs, self._begun = True, now
                return None
            if not self._time_limit or now < self._begun + self._time_limit:
                return None
            self._cancel()
            result = "failed", None
        self._runs = False
        outcome, value = result
        if outcome == "done":
            self._done(memory, value)
            return "done"
        self._failures += 1
        if self._failures <= self._retries:
            return None
        self._failed(memory, outcome)
        return "failed"

    def on_exit(self, _userdata):
        self._cancel()

    def on_stop(self):
        self._cancel()

    def on_pause(self):
        self._cancel()

    def _cancel(self):
        if self._runs:
            robot().cancel()
            self._runs = False

    def _done(self, memory, value):
        """Takes note of what was read."""

    def _failed(self, memory, outcome):
        """Takes note that nothing was read."""
