"""Visit of a task, and the times at which it changes by itself."""

import math
from dataclasses import dataclass

from argo_compiler.hfsm.tables import LeafNode


@dataclass(slots=True, eq=False)
class TaskVisit:
    """Visit of a task. The machine changes it during the visit and reuses it for the next one."""

    leaf: LeafNode | None
    """leaf of the task; None before the mission's start, or if nothing remains to be done"""
    number: int
    """unique number of the visit"""
    turn: int
    """unique number of the action within the visit: at first that of the visit, a new one after a
    failure of the action and after an interruption"""
    since: float
    """time (s) at which it began"""
    check_at: float = -math.inf
    """time (s) of the next check of a WAIT's conditions"""
    attempt: int = 0
    """number of failures of the action"""
    occurred: bool = False
    """whether the event that a WAIT waits for has occurred"""
    action_due: float = math.inf
    """time (s) at which the time limit of the running action ends"""

    def earliest_wait_end_or_check(self, mission_started_at: float) -> float:
        """Return the earliest time (s) at which a WAIT may end by duration, event or next check.

        Whether its conditions are satisfied is not checked. The result is infinite if the task is
        no WAIT. `mission_started_at` is a time (s).
        """
        leaf = self.leaf
        if leaf is None or leaf.wait is None:
            return math.inf
        if leaf.wait.duration is not None:
            at = self.since + leaf.wait.duration
        else:
            at = self.since if self.occurred else self.check_at
        return max(at, mission_started_at + leaf.earliest) if leaf.earliest else at

    @property
    def wait_limit_at(self) -> float:
        """Time (s) at which the limit of a WAIT ends; infinite without one."""
        leaf = self.leaf
        if leaf is None or leaf.wait is None or leaf.wait.limit is None:
            return math.inf
        return self.since + leaf.wait.limit

    def window_missed_at(self, mission_started_at: float) -> float:
        """Return the time (s) at which the task's hard window ends; infinite without one.

        `mission_started_at` is a time (s).
        """
        leaf = self.leaf
        return math.inf if leaf is None or leaf.latest is None else mission_started_at + leaf.latest

    def next_due(self, mission_started_at: float) -> float:
        """Return the earliest time (s) at which the visit may change without an event.

        It changes when its wait, the wait's limit, the task's hard window or the running action's
        time limit ends. `mission_started_at` is a time (s).
        """
        return min(
            self.earliest_wait_end_or_check(mission_started_at),
            self.wait_limit_at,
            self.window_missed_at(mission_started_at),
            self.action_due,
        )
