"""The events that a run is given beforehand, at their times."""

import math
from collections.abc import Iterable

from argo_compiler.hfsm import Event, GiveBack, Resume
from argo_env.run.log import LoggedEvent


class GivenEvents:
    """Gives out events when they are due. Holds how many have occurred."""

    def __init__(self, events: Iterable[tuple[float, LoggedEvent]]) -> None:
        self._events: list[tuple[float, Event]] = []
        self.occurred = 0
        self.add(events)

    @property
    def pending(self) -> bool:
        """Whether any are still to occur."""
        return self.occurred < len(self._events)

    @property
    def next_time(self) -> float:
        """When the next one occurs (s); infinite if none does."""
        return self._events[self.occurred][0] if self.pending else math.inf

    @property
    def ahead(self) -> tuple[tuple[float, LoggedEvent], ...]:
        """Those that are still to occur."""
        return tuple((t, LoggedEvent.of(event)) for t, event in self._events[self.occurred :])

    def add(self, events: Iterable[tuple[float, LoggedEvent]]) -> None:
        """More of them; of equal times, those that were there before come first."""
        ahead = [*self._events[self.occurred :], *((t, event.original()) for t, event in events)]
        self._events[self.occurred :] = sorted(ahead, key=lambda given: given[0])

    def due(self, now: float, at_rest: bool, acting: bool = False) -> list[Event]:
        """Those that occur now, at time `now` (s). A robot is given back only `at_rest`, without
        an action, and in a step of its own; and where it is `acting` by hand the mission is not
        resumed. What comes after waits as well."""
        first = self.occurred
        while self.pending and self._events[self.occurred][0] <= now:
            if self._gives_back and (not at_rest or self.occurred > first):
                break
            if acting and isinstance(self._events[self.occurred][1], Resume):
                break
            self.occurred += 1
        return [event for _, event in self._events[first : self.occurred]]

    def waits_to_give_back(self, now: float) -> bool:
        """Whether something should have been given back by `now` (s), and waits."""
        return self.pending and self._events[self.occurred][0] <= now and self._gives_back

    @property
    def _gives_back(self) -> bool:
        return isinstance(self._events[self.occurred][1], GiveBack)
