"""Schedule of faults: it applies and reverts them, also where faults of a kind overlap."""

import math
from collections.abc import Sequence

from argo_env.faults.fault import Fault
from argo_env.faults.kinds import AnyFault
from argo_env.faults.targets import FaultTargets


class FaultSchedule:
    """Schedule that starts and ends faults at their times. It holds the active faults.

    Attributes:
        faults: All faults of the schedule.
    """

    def __init__(self, faults: Sequence[AnyFault], targets: FaultTargets) -> None:
        """`faults` must be resolved."""
        self.faults = tuple(faults)
        self._targets = targets
        self._changes = _changes(faults)
        self._next = 0
        self._active: list[AnyFault] = []  # in the order in which they began

    @property
    def has_changes_left(self) -> bool:
        """True if a fault is still to begin or to end."""
        return self._next < len(self._changes)

    @property
    def next_change_time(self) -> float:
        """Time in s at which the next fault begins or ends; infinite if there is none."""
        return self._changes[self._next][0] if self.has_changes_left else math.inf

    @property
    def latest_change_time_or_zero(self) -> float:
        """Time in s of the most recent start or end of a fault; 0 before the first one."""
        return self._changes[self._next - 1][0] if self._next else 0.0

    def add(self, fault: AnyFault) -> None:
        """Add a resolved fault, which must not begin before the time of the last `advance`."""
        self.faults = (*self.faults, fault)
        upcoming = [*self._changes[self._next :], *_changes([fault])]
        self._changes[self._next :] = sorted(upcoming, key=_change_key)

    def advance(self, now: float) -> None:
        """Apply and revert all faults that begin or end up to time `now` (s), in order of time."""
        while self.has_changes_left and self._changes[self._next][0] <= now + 1e-9:
            at, begins, fault = self._changes[self._next]
            self._next += 1
            if begins:
                self._active.append(fault)
                fault.apply(self._targets, at)
            else:
                self._active.remove(fault)
                fault.revert(self._targets, at)
                self._renew(type(fault), at)

    def _renew(self, kind: type[Fault], now: float) -> None:
        """Apply the active faults of a kind again, after one of them has ended."""
        for fault in self._active:
            if type(fault) is kind and not kind.adds_up:
                fault.apply(self._targets, now)


_Change = tuple[float, bool, AnyFault]
"""Time (s), True for the start of a fault and False for its end, and the fault."""


def _changes(faults: Sequence[AnyFault]) -> list[_Change]:
    changes: list[_Change] = [(f.start_time, True, f) for f in faults]
    changes += [(f.end_time, False, f) for f in faults if f.end_time is not None]
    return sorted(changes, key=_change_key)


def _change_key(change: _Change) -> tuple[float, bool]:
    # At equal times ends come first; otherwise the order is that of the list.
    return change[:2]
