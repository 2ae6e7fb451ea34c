"""The region `control` of an SCXML document: pauses, reactions, and the end of the mission.

It is written from the table of interruptions that the executor goes by. What of a row is known
beforehand, such as which reaction ranks above which, is decided here; the rest is a guard.

A reaction is *pending* while its `since` is above 0: it is the active one, whose state is entered,
or it waits. `over` says that the event which it would hold for has occurred meanwhile.
"""

from collections.abc import Iterator, Sequence
from contextlib import AbstractContextManager

from argo_compiler.base.number_text import number
from argo_compiler.export.scxml_data import (
    NEVER,
    ActionIds,
    assign,
    cancel_due,
    send_due,
    send_time_out,
    task_attributes,
)
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Hfsm, Outcome
from argo_compiler.hfsm.interrupts import ROWS, Effect, Given, InterruptRow, Stage, Trigger
from argo_compiler.hfsm.model import DONE, ReactionState, RepeatRule
from argo_compiler.hfsm.standing import fixed, there
from argo_compiler.il import EventKind, Reaction, Response

OUTCOMES = tuple(Outcome)
"""The final states. `outcome` in the data is the position of one, from 1."""

Assignments = Sequence[tuple[str, str | int]]


def code(outcome: Outcome) -> int:
    """What stands for an outcome in the data."""
    return OUTCOMES.index(outcome) + 1


def final_id(outcome: Outcome) -> str:
    """The id of the state in which a mission has ended."""
    return outcome.replace(" ", "_")


def outcome_states(xml: XmlWriter) -> None:
    """Writes the final states, one for each outcome."""
    for outcome in OUTCOMES:
        xml.add("final", {"id": final_id(outcome)})


_STATES = {
    Stage.GOING: "going",
    Stage.CHOOSING: "choose",
    Stage.STOPPED: "stopped",
    Stage.ENDING: "ending",
}
_OF_REACTION = {
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
_ARISING = {
    Trigger.ALWAYS: "",
    Trigger.DONE: f"(ends == {code(Outcome.COMPLETED)} || "
    f"ends == {code(Outcome.COMPLETED_WITH_FAILURES)})",
    Trigger.ENDED: f"ends > {code(Outcome.COMPLETED_WITH_FAILURES)}",
}
"""What needs no event, and what is so then."""

_CONDITIONS = {
    Trigger.DRIVEN: ["running == drive"],
    # The failure of a drive that is being cancelled may be the work of the cancellation.
    Trigger.STUCK: ["running == drive", "In('busy')"],
}
_ENDS = {
    Effect.END_ABORTED: Outcome.ABORTED,
    Effect.END_CANCELLED: Outcome.CANCELLED,
    Effect.END_FAILED: Outcome.FAILED,
}


class ControlRegion:
    """The region, which is written once."""

    def __init__(self, xml: XmlWriter, hfsm: Hfsm, ids: ActionIds, timers: bool) -> None:
        self.xml = xml
        self.timers = timers
        self.timed = {
            ids.groups[c.id]: c.repeat.count_interruptions
            for c in hfsm.composites
            if timers and c.timeout and c.repeat
        }
        self.dues = [due for due in ids.dues if due != "action"]
        """what is due only while the mission goes on; an action's limit is known when it starts"""
        self.rounds = [
            (ids.groups[c.id], c.repeat)
            for c in hfsm.composites
            if c.repeat is not None and c.repeat.every
        ]
        self.supervised = hfsm.supervised and hfsm.mission.initial != DONE
        # By rank, the greatest first.
        self.states = [s for s in hfsm.reactions if s.reaction.response is not Response.REPORT]
        self.own = {state.reaction.event: state.reaction for state in self.states}
        untils = [s.reaction.until for s in self.states if s.reaction.until is not None]
        self.kinds = sorted({*self.own, *untils})

    def write(self) -> None:
        xml = self.xml
        initial = "stopped" if self.supervised else "going"
        with xml.element("state", {"id": "control", "initial": initial}):
            self._going()
            with self._state("choose"):
                self._enter([("mode", 2)])
                self._rows(Stage.CHOOSING)
            with self._state("stopped"):
                # Paused when a supervised mission begins, and already so in any other case.
                self._enter([("mode", 2), ("paused", 1)])
                self._rows(Stage.STOPPED)
            for state in self.states:
                if state.reaction.response is not Response.ABORT:
                    self._reaction(state)
            with self._state("ending"):
                self._enter([("mode", 3)])
                for outcome in OUTCOMES:
                    cond = f"running == 0 && outcome == {code(outcome)}"
                    self._then(cond, final_id(outcome))
            self._go("action timeout event reading tick pause resume cancel")

    def _going(self) -> None:
        with self._state("going"):
            with self.xml.element("onentry"):
                self._assign([("mode", 0), ("lost", "now - clock"), ("look", 1)])
                for n, repeat in self.rounds:
                    with self.xml.element("if", {"cond": f"awaits == {n}"}):
                        self._assign([("due_round", due_round(n, repeat))])
                for n, counted in self.timed.items():
                    with self.xml.element("if", {"cond": f"In('g{n}') && until_{n} < {NEVER}"}):
                        send_time_out(self.xml, n, counted)
                if self.timers:
                    for due in self.dues:
                        send_due(self.xml, due)
            with self.xml.element("onexit"):
                # An action that is interrupted is started anew, with its whole limit.
                self._assign([("due_action", 0)])
                for n in self.timed:
                    self.xml.add("cancel", {"sendid": f"timer_{n}"})
                if self.timers:
                    for due in self.dues:
                        cancel_due(self.xml, due)
            self._rows(Stage.GOING)
            clock = [("clock", "now - lost")]
            self._go("action timeout event reading tick pause resume", None, clock)

    def _reaction(self, state: ReactionState) -> None:
        reaction = state.reaction
        id = f"react_{reaction.event}"
        with self._state(id, {"initial": f"{id}_begin"}):
            with self._state(f"{id}_begin"):
                self._rows(Stage.BEGINNING, reaction)
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
                    self._rows(Stage.DRIVING, reaction)
            with self._state(f"{id}_arrive"):
                self._enter([("mode", 2)])
                self._rows(Stage.ARRIVED, reaction)
            if fixed(Given.HOLDS, None, reaction, None):
                self._hold(f"{id}_hold", reaction)
            with self._state(f"{id}_over"):
                self._rows(Stage.LETTING_GO, reaction)

    def _hold(self, id: str, reaction: Reaction) -> None:
        with self._state(id):
            if reaction.hold_limit is not None:
                with self.xml.element("onentry"):
                    self._assign([("due_hold", f"now + {number(reaction.hold_limit)}")])
                    if self.timers:
                        send_due(self.xml, "hold")
                with self.xml.element("onexit"):
                    self._assign([("due_hold", 0)])
                    if self.timers:
                        cancel_due(self.xml, "hold")
            self._rows(Stage.HOLDING, reaction)

    # Rows

    def _rows(self, stage: Stage, active: Reaction | None = None) -> None:
        """The transitions of a state, from the rows of its stage."""
        for trigger, arises in _ARISING.items():
            for row, conds, _ in self._chosen(stage, trigger, active, None):
                self._write(row, stage, None, _all([arises, *conds]), active, None)
        for kind in self.kinds:
            for row, conds, own in self._chosen(stage, Trigger.EVENT, active, kind):
                self._write(row, stage, f"event.{kind}", _all(conds), active, own, kind)
        for trigger, event in _EVENTS.items():
            for row, conds, _ in self._chosen(stage, trigger, active, None):
                cond = _all([*_CONDITIONS.get(trigger, []), *conds])
                self._write(row, stage, event, cond, active, None)

    def _chosen(
        self, stage: Stage, trigger: Trigger, active: Reaction | None, kind: EventKind | None
    ) -> Iterator[tuple[InterruptRow, list[str], Reaction | None]]:
        """The rows that may be taken, each with what has to be so then."""
        own = None if kind is None else self.own.get(kind)
        for row in ROWS.get((stage, trigger), ()):
            known = [g for g in (*row.when, *row.unless) if g not in _OPEN]
            said = {g: fixed(g, own, active, kind) for g in known}
            if not all(said.get(g, True) for g in row.when):
                continue
            if any(said.get(g, False) for g in row.unless):
                continue
            conds = [_OPEN[g][0].format(**_names(own, active)) for g in row.when if g in _OPEN]
            conds += [_OPEN[g][1].format(**_names(own, active)) for g in row.unless if g in _OPEN]
            # Where nothing changes, the region's last transition notes the time.
            if conds or row.target is not None or row.effects:
                yield row, conds, own
            if not conds:
                return

    def _write(
        self,
        row: InterruptRow,
        stage: Stage,
        event: str | None,
        cond: str | None,
        active: Reaction | None,
        own: Reaction | None,
        kind: EventKind | None = None,
    ) -> None:
        if Given.HIGHER_WAITS in row.when:
            assert active is not None
            for higher in self.own.values():
                if higher.rank > active.rank:
                    waits = _all([cond or "", f"since_{higher.event} != 0"])
                    target = self._target(row.target, None)
                    self._transition(row, stage, event, waits, target, active, own, kind)
        elif Effect.ACTIVATE in row.effects:
            for state in self.states:
                if state.reaction.response is not Response.ABORT:
                    turn = self._turn(state.reaction)
                    target = f"react_{state.reaction.event}"
                    self._transition(row, stage, event, turn, target, active, own, kind)
        else:
            target = self._target(row.target, active)
            self._transition(row, stage, event, cond, target, active, own, kind)

    def _turn(self, mine: Reaction) -> str:
        """Whether it waits, and none of equal rank has waited longer. Higher ones come first."""
        first = [f"since_{mine.event} != 0"]
        first += (
            f"(since_{r.event} == 0 || since_{mine.event} < since_{r.event})"
            for r in self.own.values()
            if r.rank == mine.rank and r is not mine
        )
        return " && ".join(first)

    def _target(self, stage: Stage | None, active: Reaction | None) -> str | None:
        if stage is None:
            return None
        if stage in _STATES:
            return _STATES[stage]
        assert active is not None
        return f"react_{active.event}_{_OF_REACTION[stage]}"

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
        with self.xml.element("transition", {"event": event, "cond": cond, "target": target}):
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
                self._assign([("outcome", code(there(active)))])
            case Effect.END_ABORTED | Effect.END_CANCELLED | Effect.END_FAILED:
                self._assign([("outcome", code(_ENDS[effect]))])
            case Effect.SET_ASIDE | Effect.ACTIVATE:
                pass  # what is active is the state that is entered, and what waits has its `since`

    def _mark(self, kind: EventKind) -> None:
        for reaction in self.own.values():
            over = reaction.until is kind
            if over or reaction.event is kind:
                with self.xml.element("if", {"cond": f"since_{reaction.event} != 0"}):
                    self._assign([(f"over_{reaction.event}", int(over))])

    # The parts of which the states are made

    def _state(self, id: str, attributes: Attributes | None = None) -> AbstractContextManager[None]:
        return self.xml.element("state", {"id": id, **(attributes or {})})

    def _enter(self, assignments: Assignments) -> None:
        with self.xml.element("onentry"):
            self._assign(assignments)

    def _then(self, cond: str, target: str) -> None:
        """A transition that needs no event."""
        self.xml.add("transition", {"cond": cond, "target": target})

    def _go(self, event: str, target: str | None = None, more: Assignments = ()) -> None:
        with self.xml.element("transition", {"event": event, "target": target}):
            self._assign([("now", "_event.data.time"), *more])

    def _assign(self, assignments: Assignments) -> None:
        for location, expr in assignments:
            assign(self.xml, location, str(expr))


_OPEN = {
    Given.PAUSED: ("paused == 1", "paused == 0"),
    Given.NEW: ("since_{own} == 0", "since_{own} != 0"),
    Given.OVER: ("over_{active} == 1", "over_{active} == 0"),
    # These are written once for each reaction that may be meant.
    Given.SOME_WAITS: ("", ""),
    Given.HIGHER_WAITS: ("", ""),
}
"""What is not known beforehand: how a guard asks for it, and for the opposite."""


def _all(conds: Sequence[str]) -> str | None:
    """All of them, as one guard."""
    return " && ".join(filter(None, conds)) or None


def _names(own: Reaction | None, active: Reaction | None) -> dict[str, str]:
    return {
        "own": "" if own is None else own.event,
        "active": "" if active is None else active.event,
    }


def due_round(n: int, repeat: RepeatRule) -> str:
    """When the present round of a group is due (s since the mission's start)."""
    due = f"entered_{n} + (round_{n} - 1) * {number(repeat.every)}"
    return due if repeat.count_interruptions else f"{due} + lost"
