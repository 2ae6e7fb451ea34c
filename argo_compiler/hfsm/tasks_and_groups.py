"""The mission part of a machine under way: its tasks and groups, their ends and their times."""

import math
from collections import defaultdict, deque
from collections.abc import Iterable
from typing import NamedTuple

from argo_compiler.hfsm.conditions import CheckpointReading, all_words
from argo_compiler.hfsm.configuration import Configuration
from argo_compiler.hfsm.kinds import Cause, Outcome, ReadingKind
from argo_compiler.hfsm.progress import ByHand
from argo_compiler.hfsm.tables import CompiledTransition, LeafNode, Tables
from argo_compiler.hfsm.trace import KeptStep, RawEntry, new_tuple
from argo_compiler.il import EventKind

_VALUE = ReadingKind.VALUE
_OVER = "its time window is over"


class DoneByHand(NamedTuple):
    """What a person did and the machine has not come to."""

    number: int
    """in the order in which they were given"""
    what: ByHand
    at: float
    """s, when it was done"""


class MissionCourse:
    """Where the mission stands and how it goes on. It changes with each step.

    It knows nothing of reactions and persons, nor of what runs: `interrupt` and `go_on` tell it.
    """

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.place = Configuration(tables)
        self.by_hand: dict[str, deque[DoneByHand]] = {}
        """by task"""
        self._given_by_hand = 0
        self.now = -math.inf
        """s, of the last step"""
        self.time_up_at = math.inf
        """when TIME_UP occurs (s); infinite when it has, or never will"""
        self.time_up = False
        self.failed = False
        """whether a failure counts as one of the mission"""
        self.outcome: Outcome | None = None
        self.tallies: defaultdict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
        """by task, how many visits have ended: done, failed, by hand"""
        # What has been decides nothing, so it is only ever added to.
        self.trace: list[RawEntry | KeptStep] = []
        self.ended: list[tuple[str, str | None, bool]] = []

    @property
    def active(self) -> str | None:
        leaf = self.place.leaf
        return None if leaf is None else leaf.name

    @property
    def due(self) -> float:
        """When something comes about by time alone (s); infinite if nothing does."""
        place = self.place
        due = place.due if place.due < place.own_due else place.own_due
        return due if due < self.time_up_at else self.time_up_at

    def occur(self, kind: EventKind) -> None:
        """Takes note of an event: TIME_UP, or what a WAIT waits for."""
        if kind is EventKind.TIME_UP:
            self.time_up = True
            self.time_up_at = math.inf
        place, leaf = self.place, self.place.leaf
        if leaf is None or leaf.wait is None or leaf.wait.event is not kind or place.round_of:
            return
        place.visit.occurred = True
        place.find_own_due()

    def give_by_hand(self, done: Iterable[ByHand], now: float) -> None:
        """What a person did counts for the next visits of these tasks."""
        for one in done:
            self._given_by_hand += 1
            given = DoneByHand(self._given_by_hand, one, now - (one.age or 0.0))
            self.by_hand.setdefault(one.task, deque()).append(given)

    def interrupt(self) -> None:
        """The mission stands still, if it does not yet."""
        self.place.interrupt(self.now)

    def go_on(self) -> None:
        """The mission takes up its place again."""
        self.place.go_on(self.now)

    def end_wait(self) -> bool:
        """Ends the WAIT that the mission stands at, if it is over now; whether it was.

        The mission is not interrupted. What was done by hand comes before it, but after time-outs.
        """
        place, visit = self.place, self.place.visit
        leaf = visit.leaf
        if leaf is None or leaf.wait is None or place.round_of or leaf.name in self.by_hand:
            return False
        if not visit.wait_at(place.began) <= self.now <= visit.missed_at(place.began):
            return False
        wait = leaf.wait
        if wait.duration is not None:
            why = f"waited {wait.duration:g} s"
        elif visit.occurred:
            assert wait.event is not None
            why = f"{wait.event.replace('_', ' ')} has occurred"
        else:
            visit.look_at = math.inf
            if not wait.guards or not place.hold(wait.guards, self.now):
                place.find_own_due()
                return False
            why = all_words(wait.conditions)
        self.leave(leaf, why)
        return True

    def step(self) -> bool:
        """One thing that comes about now without an action: the end, a time-out, a task that was
        done by hand, what the visit's own times bring about; whether there was one. The mission is
        not interrupted.
        """
        place = self.place
        leaf = place.visit.leaf
        if leaf is None:
            failed = self.failed
            self.outcome = Outcome.COMPLETED_WITH_FAILURES if failed else Outcome.COMPLETED
            self.time_up_at = math.inf
        elif place.due <= self.now:
            self._leave_group()
        elif self.by_hand and not leaf.returns and leaf.name in self.by_hand:
            self._pass_over(leaf)
        elif place.own_due <= self.now:
            return self._own_time(leaf)
        else:
            return False
        return True

    def _own_time(self, leaf: LeafNode) -> bool:
        """What the visit's own times bring about now, other than the end of a WAIT."""
        place, visit = self.place, self.place.visit
        if place.round_of is not None:
            frame = place.round_of
            place.begin_round(self.now)
            self.note(Cause.ROUND, detail=f"{frame.round} of '{frame.group.name}'")
        elif visit.missed_at(place.began) <= self.now:
            self._fail_for_good(leaf, _OVER, leaf.missed or leaf.failure)
        elif visit.action_due <= self.now:
            self.fail(leaf, f"not done within {leaf.time_limit:g} s")
        elif visit.limit_at <= self.now:
            assert leaf.wait is not None
            self._fail_for_good(leaf, f"waited {leaf.wait.limit:g} s in vain", leaf.failure)
        else:
            return False
        return True

    def limit_action(self, seconds: float, not_before: float | None) -> None:
        """The action of the present visit has been started, and has a time limit."""
        begins = self.now if not_before is None else max(self.now, not_before)
        self.place.visit.action_due = begins + seconds
        self.place.find_own_due()

    def unlimit_action(self) -> None:
        """The action that ran has ended."""
        if self.place.visit.action_due < math.inf:
            self.place.visit.action_due = math.inf
            self.place.find_own_due()

    def by_hand_progress(self) -> tuple[ByHand, ...]:
        """What a person did and the machine has not come to, with its age."""
        left = sorted(done for queue in self.by_hand.values() for done in queue)
        return tuple(
            what.model_copy(update={"age": max(0.0, self.now - at)}) for _, what, at in left
        )

    def measure(self, object_id: str, leaf: LeafNode, value: float | None, abnormal: bool) -> None:
        """The action of a task has ended well, with what it read at the checkpoint."""
        place, now = self.place, self.now
        if value is None:
            place.readings[object_id] = CheckpointReading(ReadingKind.UNREADABLE, now)
        else:
            place.readings[object_id] = new_tuple(CheckpointReading, (_VALUE, now, value, abnormal))
        if place.visit.leaf is not leaf:
            place.reading_changed(now)

    def tell(self, object_id: str, value: float, abnormal: bool, at: float) -> None:
        """A value was read at a checkpoint at the time `at` (s)."""
        self.place.read(object_id, CheckpointReading(_VALUE, at, value, abnormal), self.now)

    def fail(self, leaf: LeafNode, reason: str, unreadable: bool = False) -> None:
        """The action of the task that the mission stands at has failed."""
        visit = self.place.visit
        if visit.attempt < leaf.retries:
            visit.attempt += 1
            visit.turn = self.place.new_number()
            visit.action_due = math.inf
            self.place.find_own_due()
            self.note(Cause.RETRY, failure=reason)
        elif leaf.returns:
            self.end(Outcome.FAILED, Cause.FAILURE, failure=reason)
        else:
            self._fail_for_good(leaf, reason, leaf.failure, unreadable)

    def _fail_for_good(
        self,
        leaf: LeafNode,
        reason: str,
        way: CompiledTransition | None,
        unreadable: bool = False,
    ) -> None:
        if leaf.measures is not None:
            self._read(leaf.measures, ReadingKind.UNREADABLE if unreadable else ReadingKind.FAILED)
        self.failed = self.failed or not leaf.optional
        self._count(leaf, failure=reason)
        if way is None:
            self._take(leaf.ways, reason)
        elif way.target is None:
            self.end(Outcome.ABORTED, Cause.FAILURE, failure=reason)
        else:
            self._take((way,), reason)

    def leave(self, leaf: LeafNode, detail: str = "") -> None:
        """The mission goes on from a task that has ended."""
        if leaf.returns:
            self.end(Outcome.RETURNED, Cause.END)
            return
        # As `_count` and `_take`: most events come by here.
        self.tallies[leaf.name][0] += 1
        self.ended.append(leaf.done)
        place, now = self.place, self.now
        way = place.take(leaf.ways, now)
        self.trace.append((now, leaf, place.visit.leaf, way, detail))

    def leave_late(self, leaf: LeafNode) -> None:
        """A task has been done that the mission had left before."""
        if not leaf.returns:
            self._count(leaf)
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

    def _count(self, leaf: LeafNode, failure: str | None = None, by_hand: bool = False) -> None:
        """A visit of a task has ended."""
        self.tallies[leaf.name][2 if by_hand else 0 if failure is None else 1] += 1
        self.ended.append((leaf.name, failure, by_hand))

    def _read(self, object_id: str, kind: ReadingKind) -> None:
        """A measurement gave no value."""
        self.place.read(object_id, CheckpointReading(kind, self.now), self.now)

    def _take(
        self,
        ways: tuple[CompiledTransition, ...],
        failure: str | None = None,
        timed_out: str | None = None,
        by_hand: ByHand | None = None,
    ) -> None:
        place, now = self.place, self.now
        source = place.visit.leaf
        way = place.take(ways, now)
        target, repeated = place.visit.leaf, way.repeats
        self.trace.append(
            RawEntry(
                now,
                None if source is None else source.name,
                None if target is None else target.name,
                way.cause if timed_out is None else Cause.TIMEOUT,
                way.conditions,
                timed_out,
                None if repeated is None else repeated.name,
                failure,
                None,
                by_hand is not None,
                by_hand is not None and by_hand.skipped,
            )
        )

    def _pass_over(self, leaf: LeafNode) -> None:
        """The present task was done by hand, so it has ended."""
        queue = self.by_hand[leaf.name]
        _, done, at = queue.popleft()
        if not queue:
            del self.by_hand[leaf.name]
        if self.place.round_of is not None:
            self.place.begin_round(self.now)
        self.place.advance_clocks(done.duration, self.now)
        if leaf.measures is not None:
            if done.value is None or done.skipped:
                self.place.read(leaf.measures, None, self.now)
            else:
                self.tell(leaf.measures, done.value, done.abnormal, at)
        self._count(leaf, by_hand=True)
        self._take(leaf.ways, by_hand=done)

    def _leave_group(self) -> None:
        """The time of a group is up."""
        group = self.place.timed_out
        assert group is not None
        assert group.timeout is not None
        self._take((group.timeout,), timed_out=group.name)
