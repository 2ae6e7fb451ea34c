"""What interrupts a mission under way: events and the reactions to them, and persons."""

import math
from collections.abc import Sequence

from argo_compiler.hfsm.interrupts import Effect, Stage, Trigger
from argo_compiler.hfsm.kinds import Cause, Outcome
from argo_compiler.hfsm.progress import ByHand
from argo_compiler.hfsm.standing import InterruptState, TakenRow, advance
from argo_compiler.hfsm.tables import ReactionNode, Tables
from argo_compiler.hfsm.tasks_and_groups import MissionCourse
from argo_compiler.il import EventKind

_GOING = Stage.GOING  # looked at with each event, and an enumeration's member is found slowly
_PLAN_ENDS = (Trigger.DONE, Trigger.ENDED)


class Control:
    """A mission's course, and who has the robot. It changes with each step, and knows nothing of
    what runs. What follows from what is in the table (`argo_compiler.hfsm.interrupts`); here it is
    told to the course and to the trace."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.course = MissionCourse(tables)
        self.standing = InterruptState()
        self.drive_turn = 0
        """of the active reaction's drive, among those of the visits"""
        self.held_since = 0.0
        """s, when the present hold began"""
        self.hold_due = math.inf
        """when its limit is over (s)"""
        self._reactions = {event: node.state.reaction for event, node in tables.reactions.items()}

    @property
    def outcome(self) -> Outcome | None:
        return self.course.outcome

    @property
    def paused(self) -> bool:
        return self.standing.paused

    @property
    def active(self) -> ReactionNode | None:
        """The active reaction."""
        active = self.standing.active
        return None if active is None else self.tables.reactions[active]

    @property
    def interrupted(self) -> bool:
        return self.standing.stage is not Stage.GOING

    @property
    def driving(self) -> bool:
        return self.standing.stage is Stage.DRIVING

    @property
    def holding(self) -> bool:
        return self.standing.stage is Stage.HOLDING

    @property
    def due(self) -> float:
        """When something comes about by time alone (s); infinite if nothing does."""
        due = self.course.due
        return due if due < self.hold_due else self.hold_due

    def begin(self, supervised: bool) -> None:
        """The mission begins, under supervision or not, or goes on as it was restored."""
        if supervised:
            self.pause("it begins under supervision")
        if self.interrupted:
            self.course.interrupt()
        else:
            self.course.go_on()
        self._advance(Trigger.ALWAYS)
        self.settle()

    # Time

    def let_pass(self, until: float) -> None:
        """What comes about by time alone up to then, in the order of time."""
        while (at := self.due) <= until:
            self.course.now = at
            self.settle()

    def settle(self) -> None:
        """All that comes about now without an action."""
        course = self.course
        place = course.place
        while course.outcome is None:
            now = course.now
            if self.standing.stage is _GOING:
                if place.visit.leaf is None:
                    course.step()
                    self._advance(Trigger.DONE)
                elif place.own_due <= now and course.end_wait():
                    continue
                elif course.time_up_at <= now:
                    self.occur(EventKind.TIME_UP, "")
                elif (
                    place.due > now and place.own_due > now and not course.by_hand
                ) or not course.step():
                    return
            elif course.time_up_at <= now:
                self.occur(EventKind.TIME_UP, "")
            elif self.hold_due <= now:
                self._advance(Trigger.LIMIT)
            else:
                return
        if self.standing.outcome is None:
            self._advance(Trigger.ENDED)

    # Events and reactions

    def occur(self, kind: EventKind, detail: str) -> None:
        """Reports an event, and does what the mission has for it."""
        self.course.occur(kind)
        self.course.note(Cause.REPORT, event=kind, detail=detail)
        self._advance(Trigger.EVENT, kind)

    def arrive(self) -> None:
        """The active reaction is where it wants to be."""
        self._advance(Trigger.DRIVEN)

    def fail_drive(self, reason: str) -> None:
        """The active reaction can't be carried out."""
        self._advance(Trigger.STUCK, failure=reason)

    # Persons

    def pause(self, detail: str = "") -> None:
        """A person pauses the mission."""
        self._advance(Trigger.PAUSE, detail=detail)

    def give_back(self, by_hand: Sequence[ByHand]) -> None:
        """A person lets the mission go on, and has done these meanwhile."""
        self.course.give_by_hand(by_hand, self.course.now)
        self.resume()

    def resume(self) -> None:
        """A person lets the mission go on, or ends a hold."""
        self._advance(Trigger.RESUME)

    def cancel(self) -> None:
        """A person ends the mission."""
        self._advance(Trigger.CANCEL)

    # The table

    def _advance(
        self,
        trigger: Trigger,
        event: EventKind | None = None,
        failure: str | None = None,
        detail: str = "",
    ) -> None:
        over: EventKind | None = None
        outcome = self.course.outcome
        for step in advance(self.standing, self._reactions, trigger, event, outcome):
            self.standing = step.after
            if step.row.effects and step.row.effects[-1] is Effect.DROP:
                over = step.before.active
            self._carry_out(step, trigger, event, failure, detail, over)
        self._time_the_hold()

    def _carry_out(
        self,
        step: TakenRow,
        trigger: Trigger,
        event: EventKind | None,
        failure: str | None,
        detail: str,
        over: EventKind | None,
    ) -> None:
        """Tells the course and the trace of a row that was taken."""
        course, row, active = self.course, step.row, step.before.active
        if step.before.stage is Stage.GOING and row.target is not None:
            course.interrupt()
        if row.trigger is Trigger.LIMIT and row.target is not None:
            course.note(Cause.LIMIT, event=active)
        if Effect.PAUSE in row.effects:
            reason = None if row.trigger is Trigger.PAUSE else active
            course.note(Cause.PAUSE, event=reason, failure=failure, detail=detail)
        elif row.trigger is Trigger.RESUME and step.after != step.before:
            course.note(Cause.RESUME, event=None if step.before.paused else active)
        if row.target is Stage.BEGINNING:
            began = self.active
            assert began is not None
            self._note_reaction(began)
            self.drive_turn = course.place.new_number()
        elif row.target is Stage.HOLDING:
            self.held_since = course.now
            course.note(Cause.HOLD, event=active)
        elif row.target is Stage.GOING:
            if over is not None:
                course.note(Cause.MISSION, event=over)
            course.go_on()
        elif row.target is Stage.ENDING and trigger not in _PLAN_ENDS:
            self._end(step, event, failure)

    def _end(self, step: TakenRow, event: EventKind | None, failure: str | None) -> None:
        """Ends the mission at once, whatever it was doing."""
        outcome = step.after.outcome
        assert outcome is not None
        ended_by = step.before.active
        cause = Cause.FAILURE if step.row.trigger is Trigger.STUCK else Cause.END
        if step.row.trigger is Trigger.CANCEL:
            cause, ended_by = Cause.CANCEL, None
        elif event is not None and step.row.trigger is Trigger.EVENT:
            self._note_reaction(self.tables.reactions[event])
            ended_by = event
        self.course.end(outcome, cause, ended_by, failure)

    def _note_reaction(self, node: ReactionNode) -> None:
        reaction = node.state.reaction
        self.course.note(Cause.REACTION, event=reaction.event, detail=str(reaction.response))

    def _time_the_hold(self) -> None:
        self.hold_due = math.inf
        active = self.active
        if active is None or not self.holding or self.paused:
            return
        limit = active.state.reaction.hold_limit
        if limit is not None:
            self.hold_due = max(self.held_since + limit, self.course.now)
