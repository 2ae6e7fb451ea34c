"""The end of a group's round."""

from flexbe_core import EventState

from .robot import robot


class CountState(EventState):
    """Counts the rounds of a group, and decides whether it wants another one.

    -- depth            int       How many groups are around, this one included.
    -- count            int       Rounds in all; 0: no limit.
    -- duration         float     s since the group was entered; 0.0: no limit.
    -- start            int       The task that a round begins with.
    -- onward           int       The target after the last round, or `end`.

    #> memory           dict      What the mission knows.

    <= again                      Another round begins.
    <= over                       The group has ended.
    """

    def __init__(self, depth, count, duration, start, onward):
        super().__init__(outcomes=["again", "over"], input_keys=["memory"], output_keys=["memory"])
        self._depth = depth
        self._count = count
        self._duration = duration
        self._start = start
        self._onward = onward

    def execute(self, userdata):
        memory = userdata.memory
        group = memory["groups"][self._depth - 1]
        more = not self._count or group["round"] < self._count
        if more and self._duration:
            more = robot().now() - group["entered"] < self._duration
        if more:
            group["round"] += 1
        memory["to"] = self._start if more else self._onward
        return "again" if more else "over"
