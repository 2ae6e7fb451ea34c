"""When faults begin and end, and which of them count where several meet."""

import math
from collections.abc import Sequence

from argo_env.faults.fault import Fault
from argo_env.faults.kinds import AnyFault
from argo_env.faults.targets import FaultTargets


class Schedule:
    """Lets faults begin and end at their times. Holds how far it has come, and what has begun."""

    def __init__(self, faults: Sequence[AnyFault], targets: FaultTargets) -> None:
        """The faults must be settled."""
        self.faults = tuple(faults)
        self._targets = targets
        self._moments = _moments(faults)
        self._next = 0
        self._active: list[AnyFault] = []  # in the order in which they began

    @property
    def pending(self) -> bool:
        """Whether anything is still to begin or to end."""
        return self._next < len(self._moments)

    @property
    def next_change(self) -> float:
        """When something begins or ends next (s); infinite if nothing does."""
        return self._moments[self._next][0] if self.pending else math.inf

    @property
    def last_change(self) -> float:
        """When something began or ended last (s); 0 if nothing has."""
        return self._moments[self._next - 1][0] if self._next else 0.0

    def add(self, fault: AnyFault) -> None:
        """One more, settled, of which nothing is over yet."""
        self.faults = (*self.faults, fault)
        ahead = [*self._moments[self._next :], *_moments([fault])]
        self._moments[self._next :] = sorted(ahead, key=_order)

    def advance(self, now: float) -> None:
        """Carries out all that is due at time `now` (s)."""
        while self.pending and self._moments[self._next][0] <= now + 1e-9:
            at, begins, fault = self._moments[self._next]
            self._next += 1
            if begins:
                self._active.append(fault)
                fault.begin(self._targets, at)
            else:
                self._active.remove(fault)
                fault.end(self._targets, at)
                self._renew(type(fault), at)

    def _renew(self, kind: type[Fault], now: float) -> None:
        """Lets those of a kind that have not ended take effect again after one that has."""
        for fault in self._active:
            if type(fault) is kind and not kind.adds_up:
                fault.begin(self._targets, now)


_Moment = tuple[float, bool, AnyFault]
"""When (s), whether it begins then rather than ends, and what."""


def _moments(faults: Sequence[AnyFault]) -> list[_Moment]:
    moments: list[_Moment] = [(f.begins, True, f) for f in faults]
    moments += [(f.ends, False, f) for f in faults if f.ends is not None]
    return sorted(moments, key=_order)


def _order(moment: _Moment) -> tuple[float, bool]:
    # Of one time, ends come first; else they are in the order of the list.
    return moment[:2]
