"""The end of a group's round."""

from flexbe_core import EventState

from .memory import holds
from .robot import robot


class CountState(EventState):
    """Counts the rounds of a group, and decides whether it wants another one.

    -- depth            int       How many groups are around, this one included.
    -- count            int       Rounds in all; 0: no limit.
    -- duration         float     s since the group was entered; 0.0: no limit.
    -- until            list      Conditions; no other round begins once all hold. [] : none.
    -- start            int       The task that a round begins with.
    -- onward           int       The target after the last round, or `end`.

    #> memory           dict      What the mission knows.

    <= again                      Another round begins.
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
            more = not all(holds(condition, memory, now) for condition in self._until)
        if more:
            group["round"] += 1
        memory["to"] = self._start if more else self._onward
        return "again" if more else "over"
