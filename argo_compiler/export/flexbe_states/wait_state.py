"""State that waits."""

from flexbe_core import EventState

from .memory import time_up
from .robot import robot


class WaitState(EventState):
    """State in which the robot waits for a duration.

    -- duration         float     Duration in s; 0.0: no wait, only a junction of transitions.
    -- depth            int       Number of groups that contain the state.

    #> memory           dict      State of the mission, shared by its states.

    <= done                       The duration is over.
    <= time_up                    The time of a containing group is up.
    """

    def __init__(self, duration, depth):
        super().__init__(
            outcomes=["done", "time_up"], input_keys=["memory"], output_keys=["memory"]
        )
        self._duration = duration
        self._depth = depth
        self._end = 0.0

    def on_enter(self, _userdata):
        self._end = robot().now() + self._duration

    def execute(self, userdata):
        memory, now = userdata.memory, robot().now()
        if now >= self._end:
            return "done"
        memory["to"] = time_up(self._depth, memory, now)
        return None if memory["to"] is None else "time_up"
