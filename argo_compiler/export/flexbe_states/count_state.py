"""State at the end of a group's round."""

from flexbe_core import EventState

from .memory import is_satisfied
from .robot import robot


class CountState(EventState):
    """State that counts the rounds of a group and decides whether another round starts.

    -- depth            int       Number of groups that contain the state, this group included.
    -- count            int       Number of rounds; 0: no limit.
    -- duration         float     Limit in s since the group was entered; 0.0: no limit.
    -- until            list      Conditions; no round starts once all are satisfied. []: none.
    -- start            int       First task of a round.
    -- onward           int       Target after the last round, or `end`.

    #> memory           dict      State of the mission, shared by its states.

    <= again                      Another round starts.
    <= over                       The group has ended.
    """

    def __init__(self, depth, count, duration, until, start, onward):
        super().__init__(outcomes=["again", "over"], input_keys=["memory"], output_keys=["memory"])
        self._depth = depth
        self._count = count
        self._duration = duration
        self._until = until
        self._start = start
        self._onward = onward

    def execute(self, userdata):
        memory = userdata.memory
        group = memory["groups"][self._depth - 1]
        more = not self._count or group["round"] < self._count
        if more and self._duration:
            more = robot().now() - group["entered"] < self._duration
        if more and self._until:
            now = robot().now()
            more = not all(is_satisfied(condition, memory, now) for condition in self._until)
        if more:
            group["round"] += 1
        memory["to"] = self._start if more else self._onward
        return "again" if more else "over"
