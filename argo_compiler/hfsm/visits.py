"""One visit of a task, and what its own times bring about."""

import math
from dataclasses import dataclass

from argo_compiler.hfsm.tables import LeafNode


@dataclass(slots=True, eq=False)
class TaskVisit:
    """The machine's stay at a task. It changes while the machine stands there."""

    leaf: LeafNode | None
    """None: the mission has not begun, or nothing is left to do"""
    number: int
    """tells two visits of a task apart"""
    turn: int
    """tells two actions of a visit apart: the number at first, another one after a failure of the
    action and after an interruption"""
    since: float
    """s, when it began"""
    look_at: float = -math.inf
    """when the conditions of a WAIT are looked at next (s)"""
    attempt: int = 0
    """failures of the action"""
    occurred: bool = False
    """whether the event that a WAIT waits for has occurred"""
    action_due: float = math.inf
    """when the time limit of the running action is over (s)"""

    def wait_at(self, began: float) -> float:
        """When a WAIT may end (s), its conditions apart. `began`: the mission's start (s)."""
        leaf = self.leaf
        if leaf is None or leaf.wait is None:
            return math.inf
        if leaf.wait.duration is not None:
            at = self.since + leaf.wait.duration
        else:
            at = self.since if self.occurred else self.look_at
        return max(at, began + leaf.earliest) if leaf.earliest else at

    @property
    def limit_at(self) -> float:
        """When a WAIT has waited too long (s)."""
        leaf = self.leaf
        if leaf is None or leaf.wait is None or leaf.wait.limit is None:
            return math.inf
        return self.since + leaf.wait.limit

    def missed_at(self, began: float) -> float:
        """When the task's hard window is over (s)."""
        leaf = self.leaf
        return math.inf if leaf is None or leaf.latest is None else began + leaf.latest

    def due(self, began: float) -> float:
        """When the first of these is due (s)."""
        return min(self.wait_at(began), self.limit_at, self.missed_at(began), self.action_due)
