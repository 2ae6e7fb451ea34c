"""What measuring and driving have in common."""

from flexbe_core import EventState

from .memory import time_up
from .robot import robot


class ActionState(EventState):
    """One action of the robot, begun at the first execution and cancelled on leaving."""

    def __init__(self, task, retries, depth, joint_names, joint_positions):
        super().__init__(
            outcomes=["done", "failed", "time_up"],
            input_keys=["memory"],
            output_keys=["memory"],
        )
        self._task = task
        self._retries = retries
        self._depth = depth
        self._joints = joint_names, joint_positions
        self._failures = 0
        self._runs = False

    def on_enter(self, _userdata):
        self._failures = 0
        self._runs = False

    def execute(self, userdata):
        memory = userdata.memory
        result = robot().result() if self._runs else None
        if result is None:
            target = time_up(self._depth, memory, robot().now())
            if target is not None:
                memory["to"] = target
                return "time_up"
            if not self._runs:
                self._begin(memory)
                self._runs = True
            return None
        self._runs = False
        outcome, value = result
        if outcome == "done":
            self._done(memory, value)
            return "done"
        self._failures += 1
        return "failed" if self._failures > self._retries else None

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
