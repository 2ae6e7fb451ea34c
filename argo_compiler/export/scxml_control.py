"""Region `control` of an SCXML document: pauses, reactions, and the end of the mission.

The region is written from the executor's own table of interruptions. The parts of a row that the
mission determines, such as the ranks of reactions, are evaluated here; the others become guards.

A reaction is *pending* while its `since` is above 0: it is active, so its state is entered, or it
waits. `over` is 1 if the event that ends its hold has occurred in the meantime.
"""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager

from argo_compiler.base.number_text import number_text
from argo_compiler.export.scxml_data import (
    NEVER,
    ChartIds,
    assign,
    task_attributes,
    write_group_timer_start,
    write_timer_cancel,
    write_timer_start,
)
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Hfsm, Outcome
from argo_compiler.hfsm.interrupt_state import evaluate_static_guard, reaction_outcome
from argo_compiler.hfsm.interrupts import ROWS, Effect, InterruptGuard, InterruptRow, Stage, Trigger
from argo_compiler.hfsm.model import DONE, ReactionState, RepeatRule
from argo_compiler.il import EventKind, Reaction, Response

OUTCOMES = tuple(Outcome)
"""Final states; `outcome` in the data is the position of one of them, from 1."""

Assignments = Sequence[tuple[str, str | int]]


def outcome_code(outcome: Outcome) -> int:
    """Return the number that stands for an outcome in the chart's data."""
    return OUTCOMES.index(outcome) + 1


def final_id(outcome: Outcome) -> str:
    """Return the id of the final state for an outcome."""
    return outcome.replace(" ", "_")


def write_outcome_states(xml: XmlWriter) -> None:
    """Write the final states, one for each outcome."""
    for outcome in OUTCOMES:
        xml.add("final", {"id": final_id(outcome)})


_STATES = {
    Stage.GOING: "going",
    Stage.CHOOSING: "choose",
    Stage.STOPPED: "stopped",
    Stage.ENDING: "ending",
}
_REACTION_STATES = {
    Stage.BEGINNING: "begin",
    Stage.DRIVING: "drive",
    Stage.ARRIVED: "arrive",
    Stage.HOLDING: "hold",
    Stage.LETTING_GO: "over",
}
_EVENTS = {
    Trigger.PAUSE: "pause",
    Trigger.RESUME: "resume",
    Trigger.CANCEL: "cancel",
    Trigger.DRIVEN: "action.succeeded",
    Trigger.STUCK: "action.failed",
    Trigger.LIMIT: "timeout.hold",
}
_SPONTANEOUS = {
    Trigger.ALWAYS: "",
    Trigger.DONE: f"(ends == {outcome_code(Outcome.COMPLETED)} || "
    f"ends == {outcome_code(Outcome.COMPLETED_WITH_FAILURES)})",
    Trigger.ENDED: f"ends > {outcome_code(Outcome.COMPLETED_WITH_FAILURES)}",
}
"""Guards of the triggers that are no events of the chart."""

_TRIGGER_GUARDS = {
    Trigger.DRIVEN: ["running == drive"],
    # In `stopping`, the cancellation may be the cause of the failure.
    Trigger.STUCK: ["running == drive", "In('busy')"],
}
_END_OUTCOMES = {
    Effect.END_ABORTED: Outcome.ABORTED,
    Effect.END_CANCELLED: Outcome.CANCELLED,
    Effect.END_FAILED: Outcome.FAILED,
}


class ControlRegion:
    """Writer of the region `control`, which a document contains once."""

    def __init__(self, xml: XmlWriter, hfsm: Hfsm, ids: ChartIds, timers: bool) -> None:
        self.xml = xml
        self.timers = timers
        self.timed = {
            ids.groups[c.id]: c.repeat.count_interruptions
            for c in hfsm.composites
            if timers and c.timeout and c.repeat
        }
        self.deadlines = [kind for kind in ids.deadlines if kind != "action"]
        """kinds whose timers stop during interruptions; an action's timer starts with the action"""
        self.rounds = [
            (ids.groups[c.id], c.repeat)
            for c in hfsm.composites
            if c.repeat is not None and c.repeat.every
        ]
        self.supervised = hfsm.supervised and hfsm.mission.initial != DONE
        # In the order of `hfsm.reactions`: the highest rank comes first.
        self.states = [s for s in hfsm.reactions if s.reaction.response is not Response.REPORT]
        self.reactions = {state.reaction.event: state.reaction for state in self.states}
        hold_ends = [s.reaction.until for s in self.states if s.reaction.until is not None]
        self.kinds = sorted({*self.reactions, *hold_ends})

    def write(self) -> None:
        """Write the region `control` with its states and transitions."""
        xml = self.xml
        initial = "stopped" if self.supervised else "going"
        with xml.nest_in("state", {"id": "control", "initial": initial}):
            self._going_state()
            with self._state("choose"):
                self._enter([("mode", 2)])
                self._row_transitions(Stage.CHOOSING)
            with self._state("stopped"):
                # `paused` is set for a supervised mission's start; otherwise it is 1 already.
                self._enter([("mode", 2), ("paused", 1)])
                self._row_transitions(Stage.STOPPED)
            for state in self.states:
                if state.reaction.response is not Response.ABORT:
                    self._reaction_state(state)
            with self._state("ending"):
                self._enter([("mode", 3)])
                for outcome in OUTCOMES:
                    cond = f"running == 0 && outcome == {outcome_code(outcome)}"
                    self._eventless_transition(cond, final_id(outcome))
            self._event_transition("action timeout event reading tick pause resume cancel")

    def _going_state(self) -> None:
        with self._state("going"):
            with self.xml.nest_in("onentry"):
                self._assign([("mode", 0), ("lost", "now - clock"), ("look", 1)])
                for n, repeat in self.rounds:
                    with self.xml.nest_in("if", {"cond": f"awaits == {n}"}):
                        self._assign([("due_round", round_due_expression(n, repeat))])
                for n, counted in self.timed.items():
                    with self.xml.nest_in("if", {"cond": f"In('g{n}') && until_{n} < {NEVER}"}):
                        write_group_timer_start(self.xml, n, counted)
                if self.timers:
                    for kind in self.deadlines:
                        write_timer_start(self.xml, kind)
            with self.xml.nest_in("onexit"):
                # An interrupted action is started again later, with its full time limit.
                self._assign([("due_action", 0)])
                for n in self.timed:
                    self.xml.add("cancel", {"sendid": f"timer_{n}"})
                if self.timers:
                    for kind in self.deadlines:
                        write_timer_cancel(self.xml, kind)
            self._row_transitions(Stage.GOING)
            clock = [("clock", "now - lost")]
            self._event_transition("action timeout event reading tick pause resume", None, clock)

    def _reaction_state(self, state: ReactionState) -> None:
        reaction = state.reaction
        id = f"react_{reaction.event}"
        with self._state(id, {"initial": f"{id}_begin"}):
            with self._state(f"{id}_begin"):
                self._row_transitions(Stage.BEGINNING, reaction)
            if state.task is not None:
                with self._state(f"{id}_drive", task_attributes(state.task)):
                    self._enter(
                        [
                            ("count", "count + 1"),
                            ("drive", "count"),
                            ("drive_place", f"'{id}_drive'"),
                            ("mode", 1),
                        ]
                    )
                    self._row_transitions(Stage.DRIVING, reaction)
            with self._state(f"{id}_arrive"):
                self._enter([("mode", 2)])
                self._row_transitions(Stage.ARRIVED, reaction)
            if evaluate_static_guard(InterruptGuard.HOLDS, None, reaction, None):
                self._hold_state(f"{id}_hold", reaction)
            with self._state(f"{id}_over"):
                self._row_transitions(Stage.LETTING_GO, reaction)

    def _hold_state(self, id: str, reaction: Reaction) -> None:
        with self._state(id):
            if reaction.hold_limit is not None:
                with self.xml.nest_in("onentry"):
                    self._assign([("due_hold", f"now + {number_text(reaction.hold_limit)}")])
                    if self.timers:
                        write_timer_start(self.xml, "hold")
                with self.xml.nest_in("onexit"):
                    self._assign([("due_hold", 0)])
                    if self.timers:
                        write_timer_cancel(self.xml, "hold")
            self._row_transitions(Stage.HOLDING, reaction)

    # Rows

    def _row_transitions(self, stage: Stage, active: Reaction | None = None) -> None:
        """Write transitions from the table's rows for a stage into the XML element that is open.

        The element is that of the state to leave. The table is that of interruptions
        (`argo_compiler.hfsm.interrupts`). `active` is the reaction that the state belongs to; None
        outside of reactions.
        """
        for trigger, guard in _SPONTANEOUS.items():
            for row, conds, _ in self._possible_rows(stage, trigger, active, None):
                self._write_row(row, stage, None, _conjunction([guard, *conds]), active, None)
        for kind in self.kinds:
            for row, conds, own in self._possible_rows(stage, Trigger.EVENT, active, kind):
                self._write_row(row, stage, f"event.{kind}", _conjunction(conds), active, own, kind)
        for trigger, event in _EVENTS.items():
            for row, conds, _ in self._possible_rows(stage, trigger, active, None):
                cond = _conjunction([*_TRIGGER_GUARDS.get(trigger, []), *conds])
                self._write_row(row, stage, event, cond, active, None)

    def _possible_rows(
        self, stage: Stage, trigger: Trigger, active: Reaction | None, kind: EventKind | None
    ) -> Iterator[tuple[InterruptRow, list[str], Reaction | None]]:
        """Yield the rows of the table that may be taken at a stage and trigger.

        Each row comes with its guards that only the run decides, and with the reaction to the event
        `kind`, or None. `active` is the active reaction. Rows after one that is always taken are
        left out.
        """
        own = None if kind is None else self.reactions.get(kind)
        for row in ROWS.get((stage, trigger), ()):
            static = [g for g in (*row.when, *row.unless) if g not in _DYNAMIC]
            values = {g: evaluate_static_guard(g, own, active, kind) for g in static}
            if not all(values.get(g, True) for g in row.when):
                continue
            if any(values.get(g, False) for g in row.unless):
                continue
            conds = [
                _DYNAMIC[g][0].format(**_events(own, active)) for g in row.when if g in _DYNAMIC
            ]
            conds += [
                _DYNAMIC[g][1].format(**_events(own, active)) for g in row.unless if g in _DYNAMIC
            ]
            # A row that changes nothing needs no transition: the region's last one stores the time.
            if conds or row.target is not None or row.effects:
                yield row, conds, own
            if not conds:
                return

    def _write_row(
        self,
        row: InterruptRow,
        stage: Stage,
        event: str | None,
        cond: str | None,
        active: Reaction | None,
        own: Reaction | None,
        kind: EventKind | None = None,
    ) -> None:
        if InterruptGuard.HIGHER_WAITS in row.when:
            assert active is not None
            for higher in self.reactions.values():
                if higher.urgency_score > active.urgency_score:
                    waits = _conjunction([cond or "", f"since_{higher.event} != 0"])
                    target = self._target(row.target, None)
                    self._transition(row, stage, event, waits, target, active, own, kind)
        elif Effect.ACTIVATE in row.effects:
            for state in self.states:
                if state.reaction.response is not Response.ABORT:
                    turn = self._turn_guard(state.reaction)
                    target = f"react_{state.reaction.event}"
                    self._transition(row, stage, event, turn, target, active, own, kind)
        else:
            target = self._target(row.target, active)
            self._transition(row, stage, event, cond, target, active, own, kind)

    def _turn_guard(self, reaction: Reaction) -> str:
        """Return the guard that the reaction waits, and no other of equal rank has waited longer.

        The guard does not name reactions of higher ranks, as their transitions come first.
        """
        guards = [f"since_{reaction.event} != 0"]
        guards += (
            f"(since_{r.event} == 0 || since_{reaction.event} < since_{r.event})"
            for r in self.reactions.values()
            if r.urgency_score == reaction.urgency_score and r is not reaction
        )
        return " && ".join(guards)

    def _target(self, stage: Stage | None, active: Reaction | None) -> str | None:
        if stage is None:
            return None
        if stage in _STATES:
            return _STATES[stage]
        assert active is not None
        return f"react_{active.event}_{_REACTION_STATES[stage]}"

    def _transition(
        self,
        row: InterruptRow,
        stage: Stage,
        event: str | None,
        cond: str | None,
        target: str | None,
        active: Reaction | None,
        own: Reaction | None,
        kind: EventKind | None,
    ) -> None:
        with self.xml.nest_in("transition", {"event": event, "cond": cond, "target": target}):
            if event is not None:
                self._assign([("now", "_event.data.time")])
                if stage is Stage.GOING:
                    self._assign([("clock", "now - lost")])
            for effect in row.effects:
                self._effect(effect, active, own, kind)
            if stage is Stage.DRIVING and target is None:
                if Effect.PAUSE in row.effects:
                    self._assign([("mode", 2)])
                elif Effect.UNPAUSE in row.effects:
                    self._assign([("mode", 1)])

    def _effect(
        self,
        effect: Effect,
        active: Reaction | None,
        own: Reaction | None,
        kind: EventKind | None,
    ) -> None:
        match effect:
            case Effect.MARK:
                assert kind is not None
                self._mark(kind)
            case Effect.ENQUEUE:
                assert own is not None
                since = [("events", "events + 1"), (f"since_{own.event}", "events")]
                self._assign([*since, (f"over_{own.event}", 0)])
            case Effect.DROP:
                assert active is not None
                self._assign([(f"since_{active.event}", 0)])
            case Effect.PAUSE:
                self._assign([("paused", 1)])
            case Effect.UNPAUSE:
                self._assign([("paused", 0)])
            case Effect.END_OF_PLAN:
                self._assign([("outcome", "ends")])
            case Effect.END_THERE:
                assert active is not None
                self._assign([("outcome", outcome_code(reaction_outcome(active)))])
            case Effect.END_ABORTED | Effect.END_CANCELLED | Effect.END_FAILED:
                self._assign([("outcome", outcome_code(_END_OUTCOMES[effect]))])
            case Effect.SET_ASIDE | Effect.ACTIVATE:
                pass  # the entered state shows the active reaction; a waiting one has its `since`

    def _mark(self, kind: EventKind) -> None:
        for reaction in self.reactions.values():
            ends_hold = reaction.until is kind
            if ends_hold or reaction.event is kind:
                with self.xml.nest_in("if", {"cond": f"since_{reaction.event} != 0"}):
                    self._assign([(f"over_{reaction.event}", int(ends_hold))])

    # Elements of the states

    def _state(self, id: str, attributes: Attributes | None = None) -> AbstractContextManager[None]:
        return self.xml.nest_in("state", {"id": id, **(attributes or {})})

    def _enter(self, assignments: Assignments) -> None:
        with self.xml.nest_in("onentry"):
            self._assign(assignments)

    def _eventless_transition(self, cond: str, target: str) -> None:
        self.xml.add("transition", {"cond": cond, "target": target})

    def _event_transition(
        self, event: str, target: str | None = None, more: Assignments = ()
    ) -> None:
        with self.xml.nest_in("transition", {"event": event, "target": target}):
            self._assign([("now", "_event.data.time"), *more])

    def _assign(self, assignments: Assignments) -> None:
        for location, expr in assignments:
            assign(self.xml, location, str(expr))


_DYNAMIC = {
    InterruptGuard.PAUSED: ("paused == 1", "paused == 0"),
    InterruptGuard.NEW: ("since_{own} == 0", "since_{own} != 0"),
    InterruptGuard.OVER: ("over_{active} == 1", "over_{active} == 0"),
    # `_write_row` writes a row with one of these once for each reaction that may wait.
    InterruptGuard.SOME_WAITS: ("", ""),
    InterruptGuard.HIGHER_WAITS: ("", ""),
}
"""Guards for conditions that are known only during the run: first for true, then for false."""


def _conjunction(conds: Sequence[str]) -> str | None:
    """Return one guard that requires all of the conditions, or None if there are none."""
    return " && ".join(filter(None, conds)) or None


def _events(own: Reaction | None, active: Reaction | None) -> dict[str, str]:
    return {
        "own": "" if own is None else own.event,
        "active": "" if active is None else active.event,
    }


def round_due_expression(n: int, repeat: RepeatRule) -> str:
    """Return the expression for the time at which the present round of group `n` is due to begin.

    The time is in s since the mission's start.
    """
    due = f"entered_{n} + (round_{n} - 1) * {number_text(repeat.every)}"
    return due if repeat.count_interruptions else f"{due} + lost"
