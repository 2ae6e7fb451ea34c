"""What interrupts a mission under way: events and the reactions to them, and persons."""

from collections import deque
from collections.abc import Sequence

from argo_compiler.hfsm.course import Course
from argo_compiler.hfsm.events import Outcome
from argo_compiler.hfsm.progress import ByHand, Phase
from argo_compiler.hfsm.reactions import Pending, Reactions
from argo_compiler.hfsm.restoring import queues
from argo_compiler.hfsm.tables import Tables
from argo_compiler.hfsm.trace import Cause
from argo_compiler.il import Afterwards, EventKind, Response


class Control:
    """A mission's course, the reactions and the persons that interrupt it. It changes with each
    step, and knows nothing of what runs."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.course = Course(tables)
        self.reactions = Reactions()
        self.paused = False

    @property
    def outcome(self) -> Outcome | None:
        return self.course.outcome

    @property
    def interrupted(self) -> bool:
        return self.paused or self.reactions.active is not None

    @property
    def holding(self) -> bool:
        return self.reactions.active is not None and self.reactions.phase is Phase.HOLDING

    @property
    def due(self) -> float:
        """When something comes about by time alone (s); infinite if nothing does."""
        return self.course.due

    # Time

    def let_pass(self, until: float) -> None:
        """What comes about by time alone up to then, in the order of time."""
        while (at := self.due) <= until:
            self.course.now = at
            self.settle()

    def settle(self) -> None:
        """All that comes about now without an action."""
        course = self.course
        while course.outcome is None:
            if course.time_is_up:
                self.occur(EventKind.TIME_UP, "")
            elif self.interrupted or not course.step():
                break
        if course.outcome is not None:
            self.paused = False
            self.reactions.clear()

    # Events and reactions

    def occur(self, kind: EventKind, detail: str) -> None:
        """Reports an event and begins the reaction to it, if there is one and its turn is now."""
        if kind is EventKind.TIME_UP:
            self.course.mark_time_up()
        self.course.note(Cause.REPORT, event=kind, detail=detail)
        own = self.tables.reactions.get(kind)
        begun = self.reactions.occur(kind, own, self.paused)
        if begun is not None:
            self._begin(begun)
        else:
            self._check_hold()

    def _begin(self, pending: Pending) -> None:
        reaction = pending.reaction
        self.course.note(Cause.REACTION, event=reaction.event, detail=str(reaction.response))
        if reaction.response is Response.ABORT:
            self.end(Outcome.ABORTED, Cause.END, event=reaction.event)
            return
        self.course.interrupt()
        self.reactions.begin(pending)
        self.reactions.visit = self.course.place.new_visit()
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
            self.course.note(Cause.HOLD, event=reaction.event)
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
                self.course.note(Cause.MISSION, event=over)
            self.go_on()
        else:
            self._check_hold()

    def go_on(self) -> None:
        """The mission takes up its place again."""
        self.course.go_on()
        self.settle()

    # Persons

    def pause(
        self, event: EventKind | None = None, failure: str | None = None, detail: str = ""
    ) -> None:
        """Stands still until a person resumes, who may have paused it, or a reaction did."""
        self.paused = True
        self.course.interrupt()
        self.course.note(Cause.PAUSE, event=event, failure=failure, detail=detail)

    def give_back(self, by_hand: Sequence[ByHand]) -> None:
        """A person lets the mission go on, and has done these meanwhile."""
        self.course.place.set_aside(sum(done.duration for done in by_hand), self.course.now)
        for task, queue in queues(by_hand).items():
            self.course.by_hand.setdefault(task, deque()).extend(queue)
        self.resume()

    def resume(self) -> None:
        if self.paused:
            self.paused = False
            self.course.note(Cause.RESUME)
            self._take_up()
        elif self.reactions.active is not None and self.holding:
            self.course.note(Cause.RESUME, event=self.reactions.active.reaction.event)
            self._end_hold()

    def end(
        self,
        outcome: Outcome,
        cause: Cause,
        event: EventKind | None = None,
        failure: str | None = None,
    ) -> None:
        """Ends the mission at once, whatever it was doing."""
        self.paused = False
        self.reactions.clear()
        self.course.end(outcome, cause, event, failure)
