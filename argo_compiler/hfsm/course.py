"""The mission part of a machine under way: its tasks and groups, their ends and their times."""

import math
from collections import deque

from argo_compiler.hfsm.events import Outcome
from argo_compiler.hfsm.model import RETURN
from argo_compiler.hfsm.progress import ByHand
from argo_compiler.hfsm.rounds_and_clocks import Configuration
from argo_compiler.hfsm.tables import CompiledTransition, LeafNode, Tables
from argo_compiler.hfsm.trace import Cause, RawEntry
from argo_compiler.il import EventKind


class Course:
    """Where the mission stands and how it goes on. It changes with each step.

    It knows nothing of reactions and persons, nor of what runs: `interrupt` and `go_on` tell it.
    """

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.place = Configuration(tables)
        self.by_hand: dict[str, deque[ByHand]] = {}
        self.now = -math.inf
        """s, of the last step"""
        self.time_up_at = math.inf
        """when TIME_UP occurs (s); infinite when it has, or never will"""
        self.time_up = False
        self.outcome: Outcome | None = None
        # What has been decides nothing, so it is only ever added to.
        self.trace: list[RawEntry] = []
        self.ended: list[tuple[str, str | None, bool]] = []

    @property
    def active(self) -> str | None:
        leaf = self.place.leaf
        return None if leaf is None else leaf.name

    @property
    def due(self) -> float:
        """When something comes about by time alone (s); infinite if nothing does."""
        return min(self.place.due, self.time_up_at)

    @property
    def time_is_up(self) -> bool:
        """Whether TIME_UP occurs now, before all else."""
        return self.time_up_at <= min(self.place.due, self.now)

    def mark_time_up(self) -> None:
        """TIME_UP has occurred, by itself or because somebody said so."""
        self.time_up = True
        self.time_up_at = math.inf

    def interrupt(self) -> None:
        """The mission stands still, if it does not yet."""
        self.place.interrupt(self.now)

    def go_on(self) -> None:
        """The mission takes up its place again."""
        self.place.go_on(self.now)

    def step(self) -> bool:
        """One thing that comes about now without an action: the end, a time-out, a task that was
        done by hand; whether there was one. The mission is not interrupted.

        What was done by hand counts for a visit in which an action would be started, so time-outs
        come before it.
        """
        if self.place.leaf is None:
            self.outcome = Outcome.COMPLETED
            self.time_up_at = math.inf
        elif self.place.due <= self.now:
            self._leave_group()
        else:
            return self._pass_over()
        return True

    def fail(self, leaf: LeafNode, reason: str) -> None:
        """The action of the task that the mission stands at has failed."""
        if self.place.attempt < leaf.retries:
            self.place.attempt += 1
            self.note(Cause.RETRY, failure=reason)
        elif leaf.id == RETURN:
            self.end(Outcome.FAILED, Cause.FAILURE, failure=reason)
        elif leaf.failure is None:
            self.leave(leaf, reason)
        elif leaf.failure.target is None:
            self.ended.append((leaf.name, reason, False))
            self.end(Outcome.ABORTED, Cause.FAILURE, failure=reason)
        else:
            self.ended.append((leaf.name, reason, False))
            self._take((leaf.failure,), failure=reason)

    def leave(self, leaf: LeafNode, failure: str | None) -> None:
        """The mission goes on from a task that has ended."""
        if leaf.id == RETURN:
            self.end(Outcome.RETURNED, Cause.END)
            return
        self.ended.append((leaf.name, failure, False))
        self._take(leaf.ways, failure)

    def leave_late(self, leaf: LeafNode) -> None:
        """A task has been done that the mission had left before."""
        if leaf.id != RETURN:
            self.ended.append((leaf.name, None, False))
            self.note(Cause.LATE, detail=leaf.name)

    def end(
        self,
        outcome: Outcome,
        cause: Cause,
        event: EventKind | None = None,
        failure: str | None = None,
    ) -> None:
        """Ends the mission at once, whatever it was doing."""
        source = self.active
        self.outcome = outcome
        self.place.leave()
        self.time_up_at = math.inf
        self.note(cause, source, event=event, failure=failure, detail=str(outcome))

    def note(
        self,
        cause: Cause,
        source: str | None = "",
        event: EventKind | None = None,
        failure: str | None = None,
        detail: str = "",
    ) -> None:
        """An entry of the trace; without a source it stays where it is."""
        target = self.active
        origin = target if source == "" else source
        self.trace.append(
            RawEntry(self.now, origin, target, cause, failure=failure, event=event, detail=detail)
        )

    def _take(
        self,
        ways: tuple[CompiledTransition, ...],
        failure: str | None = None,
        timed_out: str | None = None,
        by_hand: ByHand | None = None,
    ) -> None:
        place = self.place
        source = place.leaf
        way, repeated = place.take(ways, self.now)
        target = place.leaf
        self.trace.append(
            RawEntry(
                self.now,
                None if source is None else source.name,
                None if target is None else target.name,
                way.cause if timed_out is None else Cause.TIMEOUT,
                way.conditions,
                timed_out,
                None if repeated is None else repeated.name,
                failure,
                by_hand=by_hand is not None,
                skipped=by_hand is not None and by_hand.skipped,
            )
        )

    def _pass_over(self) -> bool:
        """Ends the present task if it was done by hand; whether it was."""
        leaf = self.place.leaf
        if not self.by_hand or leaf is None or leaf.id == RETURN:
            return False
        queue = self.by_hand.get(leaf.name)
        if queue is None:
            return False
        done = queue.popleft()
        if not queue:
            del self.by_hand[leaf.name]
        self.place.advance_clocks(done.duration, self.now)
        if done.value is not None and leaf.measures is not None and not done.skipped:
            self.place.values[leaf.measures] = done.value, self.now + self.place.shift
        self.ended.append((leaf.name, None, True))
        self._take(leaf.ways, by_hand=done)
        return True

    def _leave_group(self) -> None:
        """The time of a group is up."""
        group = self.place.timed_out
        assert group is not None
        assert group.timeout is not None
        self._take((group.timeout,), timed_out=group.name)
