"""State that chooses the next transition when a task has ended."""

from flexbe_core import EventState

from .memory import is_satisfied
from .robot import robot


class DecideState(EventState):
    """State that takes the first transition whose conditions are all satisfied.

    -- outcomes         string[]  States of this machine to which a transition leads, or `left`.
    -- ways             list      Transitions: outcome, target, conditions; the last one has none.
    -- fails            bool      True if the mission has a failure from here on.

    #> memory           dict      State of the mission, shared by its states.
    """

    def __init__(self, outcomes, ways, fails=False):
        super().__init__(outcomes=outcomes, input_keys=["memory"], output_keys=["memory"])
        self._ways = ways
        self._fails = fails

    def execute(self, userdata):
        memory, now = userdata.memory, robot().now()
        memory["failures"] = memory["failures"] or self._fails
        for outcome, target, conditions in self._ways:
            if all(is_satisfied(condition, memory, now) for condition in conditions):
                memory["to"] = target
                return outcome
        raise AssertionError("the last transition must have no conditions")
