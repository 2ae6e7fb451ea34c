"""How a machine under way goes on: its mission, the reactions that interrupt it, and persons."""

import math
from collections import deque
from collections.abc import Sequence

from argo_compiler.hfsm.events import Outcome
from argo_compiler.hfsm.model import RETURN
from argo_compiler.hfsm.progress import ByHand, Phase
from argo_compiler.hfsm.reactions import Pending, Reactions
from argo_compiler.hfsm.restoring import queues
from argo_compiler.hfsm.rounds_and_clocks import Configuration
from argo_compiler.hfsm.tables import CompiledTransition, LeafNode, Tables
from argo_compiler.hfsm.trace import Cause, RawEntry
from argo_compiler.il import Afterwards, EventKind, Response


class Control:
    """Where a machine stands. It changes with each step, and knows nothing of what runs."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.place = Configuration(tables)
        self.reactions = Reactions()
        self.by_hand: dict[str, deque[ByHand]] = {}
        self.now = -math.inf
        """s, of the last step"""
        self.time_up_at = math.inf
        """when TIME_UP occurs (s); infinite when it has, or never will"""
        self.time_up = False
        self.paused = False
        self.outcome: Outcome | None = None
        # What has been decides nothing, so it is only ever added to.
        self.trace: list[RawEntry] = []
        self.ended: list[tuple[str, str | None, bool]] = []

    @property
    def active(self) -> str | None:
        leaf = self.place.leaf
        return None if leaf is None else leaf.name

    @property
    def interrupted(self) -> bool:
        return self.paused or self.reactions.active is not None

    @property
    def holding(self) -> bool:
        return self.reactions.active is not None and self.reactions.phase is Phase.HOLDING

    @property
    def due(self) -> float:
        """When something comes about by time alone (s); infinite if nothing does."""
        return min(self.place.due, self.time_up_at)

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

    # Time

    def let_pass(self, until: float) -> None:
        """What comes about by time alone up to then, in the order of time."""
        while (at := self.due) <= until:
            self.now = at
            self.settle()

    def settle(self) -> None:
        """All that comes about now without an action: the end, time-outs, what was done by hand.

        What was done by hand counts for a visit in which an action would be started, so time-outs
        come before it.
        """
        place = self.place
        while self.outcome is None:
            if place.leaf is None and not self.interrupted:
                self.outcome = Outcome.COMPLETED
                self.time_up_at = math.inf
            elif self.time_up_at <= min(place.due, self.now):
                self.occur(EventKind.TIME_UP, "")
            elif place.due <= self.now:
                self._leave_group()
            elif self.interrupted or not self._pass_over():
                return

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

    # Events and reactions

    def occur(self, kind: EventKind, detail: str) -> None:
        """Reports an event and begins the reaction to it, if there is one and its turn is now."""
        if kind is EventKind.TIME_UP:
            self.time_up = True
            self.time_up_at = math.inf
        self.note(Cause.REPORT, event=kind, detail=detail)
        own = self.tables.reactions.get(kind)
        begun = self.reactions.occur(kind, own, self.paused)
        if begun is not None:
            self._begin(begun)
        else:
            self._check_hold()

    def _begin(self, pending: Pending) -> None:
        reaction = pending.reaction
        self.note(Cause.REACTION, event=reaction.event, detail=str(reaction.response))
        if reaction.response is Response.ABORT:
            self.end(Outcome.ABORTED, Cause.END, event=reaction.event)
            return
        self.place.interrupt(self.now)
        self.reactions.begin(pending)
        self.reactions.visit = self.place.new_visit()
        if reaction.response is Response.PAUSE:
            self.hold()
        else:
            self.reactions.phase = Phase.DRIVING

    def fail_drive(self, reason: str) -> None:
        """The active reaction can't be carried out."""
        active = self.reactions.active
        assert active is not None
        reaction = active.reaction
        if reaction.afterwards is Afterwards.END:
            self.end(Outcome.FAILED, Cause.FAILURE, event=reaction.event, failure=reason)
        else:
            self.reactions.active = None
            self.pause(event=reaction.event, failure=reason)

    def hold(self) -> None:
        """The active reaction is where it wants to be."""
        active = self.reactions.active
        assert active is not None
        self.reactions.phase = Phase.HOLDING
        reaction = active.reaction
        waits = reaction.until is not None or reaction.response is Response.PAUSE
        if waits and not active.over:
            self.note(Cause.HOLD, event=reaction.event)
        else:
            self._end_hold()

    def _check_hold(self) -> None:
        active = self.reactions.active
        if active is not None and active.over and self.holding and not self.paused:
            self._end_hold()

    def _end_hold(self) -> None:
        active = self.reactions.active
        assert active is not None
        reaction = active.reaction
        self.reactions.active = None
        if reaction.response is Response.PAUSE or reaction.afterwards is Afterwards.RESUME:
            if not self.paused:
                self._take_up(reaction.event)
        elif reaction.afterwards is Afterwards.WAIT:
            self.pause(event=reaction.event)
        else:
            returned = reaction.response is Response.RETURN
            outcome = Outcome.RETURNED if returned else Outcome.SHELTERED
            self.end(outcome, Cause.END, event=reaction.event)

    def _take_up(self, over: EventKind | None = None) -> None:
        """The next reaction that waits, or else the mission."""
        following = self.reactions.next()
        if following is not None:
            self._begin(following)
        elif self.reactions.active is None:
            if over is not None:
                self.note(Cause.MISSION, event=over)
            self.go_on()
        else:
            self._check_hold()

    def go_on(self) -> None:
        """The mission takes up its place again."""
        self.place.go_on(self.now)
        self.settle()

    # Persons

    def pause(
        self, event: EventKind | None = None, failure: str | None = None, detail: str = ""
    ) -> None:
        """Stands still until a person resumes, who may have paused it, or a reaction did."""
        self.paused = True
        self.place.interrupt(self.now)
        self.note(Cause.PAUSE, event=event, failure=failure, detail=detail)

    def give_back(self, by_hand: Sequence[ByHand]) -> None:
        """A person lets the mission go on, and has done these meanwhile."""
        self.place.set_aside(sum(done.duration for done in by_hand), self.now)
        for task, queue in queues(by_hand).items():
            self.by_hand.setdefault(task, deque()).extend(queue)
        self.resume()

    def resume(self) -> None:
        if self.paused:
            self.paused = False
            self.note(Cause.RESUME)
            self._take_up()
        elif self.reactions.active is not None and self.holding:
            self.note(Cause.RESUME, event=self.reactions.active.reaction.event)
            self._end_hold()

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
        self.paused = False
        self.reactions.clear()
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
