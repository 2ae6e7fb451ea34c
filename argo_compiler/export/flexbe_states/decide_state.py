"""Where to go on when a task has ended."""

from flexbe_core import EventState

from .memory import holds
from .robot import robot


class DecideState(EventState):
    """Takes the first way whose conditions all hold.

    -- outcomes         string[]  The states of this machine that a way begins with, or `left`.
    -- ways             list      Outcome, target, and conditions; the last one has none.
    -- velocity         float     m/s on the way to the next task; 0.0: the robot's own.

    #> memory           dict      What the mission knows.
    """

    def __init__(self, outcomes, ways, velocity):
        super().__init__(outcomes=outcomes, input_keys=["memory"], output_keys=["memory"])
        self._ways = ways
        self._velocity = velocity

    def execute(self, userdata):
        memory, now = userdata.memory, robot().now()
        memory["velocity"] = self._velocity
        for outcome, target, conditions in self._ways:
            if all(holds(condition, memory, now) for condition in conditions):
                memory["to"] = target
                return outcome
        raise AssertionError("the last way has no conditions")
