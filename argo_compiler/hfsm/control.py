"""Control of a mission under way: events, the reactions to them, and commands of persons."""

import math
from collections.abc import Sequence

from argo_compiler.hfsm.charging import AwaitedCharge, awaited_charge
from argo_compiler.hfsm.interrupt_state import AppliedRow, InterruptState, rows_taken_at
from argo_compiler.hfsm.interrupts import Effect, Stage, Trigger
from argo_compiler.hfsm.kinds import Cause, Outcome
from argo_compiler.hfsm.machine_state import MachineState
from argo_compiler.hfsm.progress import ByHand
from argo_compiler.hfsm.tables import ReactionNode, Tables
from argo_compiler.il import EventKind, Reaction, WaitRule

_GOING = Stage.GOING  # used with each event; the look-up of an enumeration's member is slow
_MISSION_ENDS = (Trigger.DONE, Trigger.ENDED)


class Control:
    """State of the mission, and who controls the robot: the mission, a reaction or a person.

    Each step changes both. It does not know which action runs. The table in
    `argo_compiler.hfsm.interrupts` decides what follows from a trigger; this class applies the rows
    to the state of the mission and writes the trace.
    """

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.mission = MachineState(tables)
        self.interrupt_state = InterruptState()
        self.drive_turn = 0
        """turn of the active reaction's drive; unique among the turns of visits"""
        self.held_since = 0.0
        """time (s) at which the present hold began"""
        self.hold_due = math.inf
        """time (s) at which the present hold's limit ends; infinite without a limit"""
        self._reactions = {event: node.state.reaction for event, node in tables.reactions.items()}

    @property
    def outcome(self) -> Outcome | None:
        return self.mission.outcome

    @property
    def paused(self) -> bool:
        return self.interrupt_state.paused

    @property
    def active_reaction(self) -> ReactionNode | None:
        """The active reaction; None if no reaction is active."""
        active = self.interrupt_state.active
        return None if active is None else self.tables.reactions[active]

    @property
    def interrupted(self) -> bool:
        return self.interrupt_state.stage is not Stage.GOING

    @property
    def reaction_is_driving(self) -> bool:
        return self.interrupt_state.stage is Stage.DRIVING

    @property
    def reaction_is_holding(self) -> bool:
        return self.interrupt_state.stage is Stage.HOLDING

    @property
    def next_due(self) -> float:
        """Earliest time (s) at which the mission or hold changes without an event; or infinity."""
        due = self.mission.next_due
        return due if due < self.hold_due else self.hold_due

    @property
    def awaited_charges(self) -> tuple[AwaitedCharge, ...]:
        """Charges of the battery for which the present hold and the active WAIT wait."""
        awaited: list[tuple[Reaction | WaitRule, float]] = []
        active, charged = self.active_reaction, EventKind.BATTERY_CHARGED
        if active is not None and self.reaction_is_holding:
            reaction = active.state.reaction
            if reaction.until is charged and not self.interrupt_state.active_until_occurred:
                awaited.append((reaction, self.held_since))
        visit = self.mission.configuration.visit
        wait = None if visit.leaf is None else visit.leaf.task.wait
        if wait is not None and wait.event is charged and not visit.occurred:
            awaited.append((wait, visit.since))
        return tuple(
            awaited_charge(rule.charge_to, rule.charge_for, since) for rule, since in awaited
        )

    def start(self, supervised: bool) -> None:
        """Start the mission, or continue it as restored; if `supervised`, paused until `resume`."""
        if supervised:
            self.pause("it begins under supervision")
        if self.interrupted:
            self.mission.interrupt()
        else:
            self.mission.resume()
        self._advance(Trigger.ALWAYS)
        self.process_due_changes()

    # Time

    def process_changes_until(self, until: float) -> None:
        """Process all changes that are due up to the time `until` (s), in the order of time."""
        while (at := self.next_due) <= until:
            self.mission.now = at
            self.process_due_changes()

    def process_due_changes(self) -> None:
        """Process all changes that are due now and need no action of the robot.

        These are starts of rounds, ends of waits, time-outs, TIME_UP, tasks done by hand, the limit
        of a hold, and the end of the mission.
        """
        mission = self.mission
        configuration = mission.configuration
        while mission.outcome is None:
            now = mission.now
            if self.interrupt_state.stage is _GOING:
                if configuration.visit.leaf is None:
                    mission.step()
                    self._advance(Trigger.DONE)
                elif configuration.visit_due <= now and mission.end_wait_if_over():
                    continue
                elif mission.time_up_at <= now:
                    self.handle_event(EventKind.TIME_UP, "")
                elif (
                    configuration.group_due > now
                    and configuration.visit_due > now
                    and not mission.by_hand
                ) or not mission.step():
                    return
            elif mission.time_up_at <= now:
                self.handle_event(EventKind.TIME_UP, "")
            elif self.hold_due <= now:
                self._advance(Trigger.LIMIT)
            else:
                return
        if self.interrupt_state.outcome is None:
            self._advance(Trigger.ENDED)

    # Events and reactions

    def handle_event(self, kind: EventKind, detail: str) -> None:
        """Add an event to the trace; its reaction, if any, starts or waits, by its urgency."""
        self.mission.handle_wait_or_time_up_event(kind)
        self.mission.add_entry(Cause.REPORT, event=kind, detail=detail)
        self._advance(Trigger.EVENT, kind)

    def finish_drive(self) -> None:
        """Handle the success of the active reaction's drive."""
        self._advance(Trigger.DRIVEN)

    def fail_drive(self, reason: str) -> None:
        """Handle the failure of the active reaction's drive."""
        self._advance(Trigger.STUCK, failure=reason)

    # Persons

    def pause(self, detail: str = "") -> None:
        """Pause the mission at a person's command; `detail` is for the trace."""
        self._advance(Trigger.PAUSE, detail=detail)

    def give_back(self, by_hand: Sequence[ByHand]) -> None:
        """Resume the mission after a person has done or skipped the tasks in `by_hand`."""
        self.mission.queue_tasks_done_by_hand(by_hand, self.mission.now)
        self.resume()

    def resume(self) -> None:
        """Resume the mission, or end the hold of a reaction, at a person's command."""
        self._advance(Trigger.RESUME)

    def cancel(self) -> None:
        """End the mission at a person's command."""
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
        outcome = self.mission.outcome
        for step in rows_taken_at(self.interrupt_state, self._reactions, trigger, event, outcome):
            self.interrupt_state = step.after
            if step.row.effects and step.row.effects[-1] is Effect.DROP:
                over = step.before.active
            self._apply(step, trigger, event, failure, detail, over)
        self._update_hold_due()

    def _apply(
        self,
        step: AppliedRow,
        trigger: Trigger,
        event: EventKind | None,
        failure: str | None,
        detail: str,
        over: EventKind | None,
    ) -> None:
        """Apply a row of the table of interruptions to the state of the mission and to the trace.

        `trigger`, `event`, `failure` and `detail` are those that the rows were taken for; `over` is
        the event of the reaction that these rows have ended, if they have.
        """
        mission, row, active = self.mission, step.row, step.before.active
        if step.before.stage is Stage.GOING and row.target is not None:
            mission.interrupt()
        if row.trigger is Trigger.LIMIT and row.target is not None:
            mission.add_entry(Cause.LIMIT, event=active)
        if Effect.PAUSE in row.effects:
            reason = None if row.trigger is Trigger.PAUSE else active
            mission.add_entry(Cause.PAUSE, event=reason, failure=failure, detail=detail)
        elif row.trigger is Trigger.RESUME and step.after != step.before:
            mission.add_entry(Cause.RESUME, event=None if step.before.paused else active)
        if row.target is Stage.BEGINNING:
            started = self.active_reaction
            assert started is not None
            self._add_reaction_entry(started)
            self.drive_turn = mission.configuration.new_visit_or_turn_number()
        elif row.target is Stage.HOLDING:
            self.held_since = mission.now
            mission.add_entry(Cause.HOLD, event=active)
        elif row.target is Stage.GOING:
            if over is not None:
                mission.add_entry(Cause.MISSION, event=over)
            mission.resume()
        elif row.target is Stage.ENDING and trigger not in _MISSION_ENDS:
            self._end(step, event, failure)

    def _end(self, step: AppliedRow, event: EventKind | None, failure: str | None) -> None:
        """End the mission at once, whatever the mission was doing.

        Args:
            step: row of the table of interruptions that was taken, which leads to the end.
            event: event that the row was taken for, if any; a reaction to it that ends the mission
                is added to the trace.
            failure: why the mission failed; None: it did not.
        """
        outcome = step.after.outcome
        assert outcome is not None
        ended_by = step.before.active
        cause = Cause.FAILURE if step.row.trigger is Trigger.STUCK else Cause.END
        if step.row.trigger is Trigger.CANCEL:
            cause, ended_by = Cause.CANCEL, None
        elif event is not None and step.row.trigger is Trigger.EVENT:
            self._add_reaction_entry(self.tables.reactions[event])
            ended_by = event
        self.mission.end(outcome, cause, ended_by, failure)

    def _add_reaction_entry(self, node: ReactionNode) -> None:
        reaction = node.state.reaction
        self.mission.add_entry(Cause.REACTION, event=reaction.event, detail=str(reaction.response))

    def _update_hold_due(self) -> None:
        self.hold_due = math.inf
        active = self.active_reaction
        if active is None or not self.reaction_is_holding or self.paused:
            return
        limit = active.state.reaction.hold_limit
        if limit is not None:
            self.hold_due = max(self.held_since + limit, self.mission.now)
