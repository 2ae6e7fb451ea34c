"""The way through nested machines to the task that was chosen."""

from bisect import bisect

from flexbe_core import EventState

from .robot import robot


class RouteState(EventState):
    """Goes on towards the target that the memory has.

    -- outcomes         string[]  The states of this machine, or `left`.
    -- depth            int       How many groups the machine lies in, itself included.
    -- inside           list      First task and outcome of each part of the machine, in order.
    -- last             int       The last task of the machine.
    -- limit            float     For the beginning of a group with a hard stop: its duration (s);
                                  0.0 for that of another group; None elsewhere.

    #> memory           dict      What the mission knows.
    """

    def __init__(self, outcomes, depth, inside, last, limit=None):
        super().__init__(outcomes=outcomes, input_keys=["memory"], output_keys=["memory"])
        self._depth = depth
        self._firsts = [first for first, _ in inside]
        self._parts = [outcome for _, outcome in inside]
        self._last = last
        self._limit = limit

    def execute(self, userdata):
        memory = userdata.memory
        if self._limit is not None:
            group = {"round": 1, "entered": robot().now(), "limit": self._limit}
            memory["groups"] = [*memory["groups"][: self._depth - 1], group]
        to = memory["to"]
        if isinstance(to, str):
            if self._depth:
                return "left"
            return "failures" if to == "end" and memory["failures"] else to
        if to < 0:
            return "round" if -to == self._depth else "left"
        if not self._firsts or not self._firsts[0] <= to <= self._last:
            return "left"
        return self._parts[bisect(self._firsts, to) - 1]
