"""Where to go on when a task has ended."""

from flexbe_core import EventState

from .memory import holds
from .robot import robot


class DecideState(EventState):
    """Takes the first way whose conditions all hold.

    -- outcomes         string[]  The states of this machine that a way begins with, or `left`.
    -- ways             list      Outcome, target, and conditions; the last one has none.
    -- fails            bool      Whether the mission has failures from here on.

    #> memory           dict      What the mission knows.
    """

    def __init__(self, outcomes, ways, fails=False):
        super().__init__(outcomes=outcomes, input_keys=["memory"], output_keys=["memory"])
        self._ways = ways
        self._fails = fails

    def execute(self, userdata):
        memory, now = userdata.memory, robot().now()
        memory["failures"] = memory["failures"] or self._fails
        for outcome, target, conditions in self._ways:
            if all(holds(condition, memory, now) for condition in conditions):
                memory["to"] = target
                return outcome
        raise AssertionError("the last way has no conditions")
