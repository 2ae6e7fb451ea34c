"""Standing still."""

from flexbe_core import EventState

from .memory import time_up
from .robot import robot


class WaitState(EventState):
    """Stands still for a time.

    -- duration         float     s; 0.0: ways only meet here.
    -- depth            int       How many groups are around.

    #> memory           dict      What the mission knows.

    <= done                       The time is over.
    <= time_up                    The time of a group around is up.
    """

    def __init__(self, duration, depth):
        super().__init__(
            outcomes=["done", "time_up"], input_keys=["memory"], output_keys=["memory"]
        )
        self._duration = duration
        self._depth = depth
        self._ends = 0.0

    def on_enter(self, _userdata):
        self._ends = robot().now() + self._duration

    def execute(self, userdata):
        memory, now = userdata.memory, robot().now()
        if now >= self._ends:
            return "done"
        memory["to"] = time_up(self._depth, memory, now)
        return None if memory["to"] is None else "time_up"
