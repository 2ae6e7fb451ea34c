"""State that leads through nested machines to the target of a transition."""

from bisect import bisect

from flexbe_core import EventState

from .robot import robot


class RouteState(EventState):
    """State that leads on to the target that is stored in the memory.

    -- outcomes         string[]  States of this machine, or `left`.
    -- depth            int       Number of groups that contain the state, this group included.
    -- inside           list      First task and outcome of each state of the machine, in order.
    -- last             int       Last task of the machine.
    -- limit            float     At the start of a group: its duration in s if it has a hard stop,
                                  else 0.0. None if the state is not the start of a group.

    #> memory           dict      State of the mission, shared by its states.
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
