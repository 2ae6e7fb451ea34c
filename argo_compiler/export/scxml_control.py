"""The region `control` of an SCXML document: pauses, reactions, and the end of the mission.

A reaction is *pending* while its `since` is above 0: it is the active one, whose state is entered,
or it waits. `over` says that the event which it would hold for has occurred meanwhile.
"""

from collections.abc import Sequence
from contextlib import AbstractContextManager

from argo_compiler.export.scxml_data import (
    ActionIds,
    assign,
    send_time_out,
    task_attributes,
)
from argo_compiler.export.xml import Attributes, XmlWriter
from argo_compiler.hfsm import Hfsm
from argo_compiler.hfsm.model import ReactionState
from argo_compiler.il import Afterwards, EventKind, Reaction, Response

OUTCOMES = ("completed", "returned", "sheltered", "failed", "aborted", "cancelled")
"""The final states. `outcome` in the data is the position of one, from 1."""

Assignments = Sequence[tuple[str, str | int]]

COMPLETED, RETURNED, SHELTERED, FAILED, ABORTED, CANCELLED = range(1, 7)


def outcome_states(xml: XmlWriter) -> None:
    """Writes the final states, one for each outcome."""
    for outcome in OUTCOMES:
        xml.add("final", {"id": outcome})


class ControlRegion:
    """The region, which is written once."""

    def __init__(self, xml: XmlWriter, hfsm: Hfsm, ids: ActionIds, timers: bool) -> None:
        self.xml = xml
        self.timed = {
            ids.groups[c.id]: c.repeat.count_interruptions
            for c in hfsm.composites
            if timers and c.timeout and c.repeat
        }
        # By priority, the greatest first.
        self.states = [s for s in hfsm.reactions if s.reaction.response is not Response.REPORT]
        self.own = {state.reaction.event: state.reaction for state in self.states}
        untils = [s.reaction.until for s in self.states if s.reaction.until is not None]
        self.kinds = sorted({*self.own, *untils})

    def write(self) -> None:
        xml = self.xml
        with xml.element("state", {"id": "control", "initial": "going"}):
            # Internal, as an external transition from `control` would leave the parallel state.
            to_end: Attributes = {"target": "ending", "type": "internal"}
            xml.add("transition", {"cond": "outcome != 0 && mode != 3", **to_end})
            self._go("cancel", None, None, [("outcome", CANCELLED)], cond="outcome == 0")
            self._go("action timeout event tick pause resume")
            self._going()
            self._choose()
            self._stopped()
            for state in self.states:
                if state.reaction.response is not Response.ABORT:
                    self._reaction(state)
            self._ending()

    def _going(self) -> None:
        with self._state("going"):
            self._enter([("mode", 0), ("lost", "now - clock")])
            self._timers()
            self._then("done == 1 && outcome == 0", "choose", [("outcome", COMPLETED)])
            clock = [("clock", "now - lost")]
            for kind, own in self.own.items():
                self._go(f"event.{kind}", "choose", own, clock)
            self._go("pause", "stopped", None, [*clock, ("paused", 1)])
            self._go("action timeout event tick resume", None, None, clock)

    def _timers(self) -> None:
        """The engine's timers of the groups, which stand while the mission is interrupted."""
        if not self.timed:
            return
        with self.xml.element("onentry"):
            for n, counts in self.timed.items():
                with self.xml.element("if", {"cond": f"In('g{n}')"}):
                    send_time_out(self.xml, n, counts)
        with self.xml.element("onexit"):
            for n in self.timed:
                self.xml.add("cancel", {"sendid": f"timer_{n}"})

    def _choose(self) -> None:
        """The reaction whose turn it is, or else the mission."""
        with self._state("choose"):
            self._enter([("mode", 2)])
            for state in self.states:
                mine = state.reaction
                first = [f"since_{mine.event} != 0", "outcome == 0"]
                first += (
                    f"(since_{r.event} == 0 || since_{mine.event} < since_{r.event})"
                    for r in self.own.values()
                    if r.rank == mine.rank and r is not mine
                )
                if mine.response is Response.ABORT:
                    self._then(" && ".join(first), None, [("outcome", ABORTED)])
                else:
                    self._then(" && ".join(first), f"react_{mine.event}")
            self._then("outcome == 0", "going")

    def _stopped(self) -> None:
        """Paused, with no reaction active."""
        with self._state("stopped"):
            self._enter([("mode", 2)])
            self._go("resume", "choose", None, [("paused", 0)])
            for kind in self.kinds:
                self._occurs(kind, None)

    def _reaction(self, state: ReactionState) -> None:
        reaction = state.reaction
        id = f"react_{reaction.event}"
        drives = state.task is not None
        with self._state(id, {"initial": f"{id}_{'drive' if drives else 'arrive'}"}):
            for kind in self.kinds:
                self._occurs(kind, reaction)
            higher = [r for r in self.own.values() if r.rank > reaction.rank]
            for r in higher:
                waits = f"paused == 1 && since_{r.event} != 0"
                self._go("resume", "choose", None, [("paused", 0)], cond=waits)
            if state.task is not None:
                with self._state(f"{id}_drive", task_attributes(state.task)):
                    self._drive(f"{id}_drive", reaction)
            with self._state(f"{id}_arrive"):
                self._enter([("mode", 2)])
                if reaction.until is not None or reaction.response is Response.PAUSE:
                    self._then(f"over_{reaction.event} == 0", f"{id}_hold")
                self._after(reaction)
            if reaction.until is not None or reaction.response is Response.PAUSE:
                with self._state(f"{id}_hold"):
                    over = f"over_{reaction.event} == 1"
                    self._then(f"{over} && paused == 0", f"{id}_arrive")
                    self._go("pause", None, None, [("paused", 1)])
                    none_waits = [f"since_{r.event} == 0" for r in higher]
                    resumed = " && ".join(["paused == 1", *none_waits])
                    self._go("resume", None, None, [("paused", 0)], cond=resumed)
                    ends = [(f"over_{reaction.event}", 1)]
                    self._go("resume", f"{id}_arrive", None, ends, cond="paused == 0")

    def _drive(self, id: str, reaction: Reaction) -> None:
        self._enter(
            [
                ("count", "count + 1"),
                ("drive", "count"),
                ("drive_place", f"'{id}'"),
                ("mode", 1),
            ]
        )
        served = "running == drive"
        arrive = id.removesuffix("drive") + "arrive"
        self._go("action.succeeded", arrive, cond=served)
        failed = f"{served} && In('busy')"
        if reaction.afterwards is Afterwards.END:
            self._go("action.failed", None, None, [("outcome", FAILED)], cond=failed)
        else:
            gives_up = [(f"since_{reaction.event}", 0), ("paused", 1)]
            self._go("action.failed", "stopped", None, gives_up, cond=failed)
        self._go("pause", None, None, [("paused", 1), ("mode", 2)])
        higher = [r for r in self.own.values() if r.rank > reaction.rank]
        resumed = " && ".join(["paused == 1", *(f"since_{r.event} == 0" for r in higher)])
        self._go("resume", None, None, [("paused", 0), ("mode", 1)], cond=resumed)

    def _after(self, reaction: Reaction) -> None:
        over = [(f"since_{reaction.event}", 0)]
        goes_on = reaction.response is Response.PAUSE or reaction.afterwards is Afterwards.RESUME
        if goes_on:
            self._then("paused == 0", "choose", over)
            self._then("paused == 1", "stopped", over)
        elif reaction.afterwards is Afterwards.WAIT:
            self._then("outcome == 0", "stopped", [*over, ("paused", 1)])
        else:
            returned = reaction.response is Response.RETURN
            outcome = RETURNED if returned else SHELTERED
            self._then("outcome == 0", None, [*over, ("outcome", outcome)])

    def _occurs(self, kind: EventKind, active: Reaction | None) -> None:
        """What an event does while a reaction is active, or none and the mission is paused."""
        own = self.own.get(kind)
        if own is not None:
            aborts = own.response is Response.ABORT
            cond = f"since_{kind} == 0"
            if active is None or own.rank > active.rank:
                if aborts:
                    self._go(f"event.{kind}", None, None, [("outcome", ABORTED)], cond=cond)
                elif active is not None:
                    self._go(f"event.{kind}", "choose", own, cond=f"{cond} && paused == 0")
        waits = own if active is None or active.until is not kind else None
        self._go(f"event.{kind}", None, waits)

    def _ending(self) -> None:
        with self._state("ending"):
            self._enter([("mode", 3)])
            for n, outcome in enumerate(OUTCOMES, 1):
                self._then(f"running == 0 && outcome == {n}", outcome)

    # The parts of which the states are made

    def _state(self, id: str, attributes: Attributes | None = None) -> AbstractContextManager[None]:
        return self.xml.element("state", {"id": id, **(attributes or {})})

    def _enter(self, assignments: Assignments) -> None:
        with self.xml.element("onentry"):
            self._assign(assignments)

    def _then(self, cond: str, target: str | None, assignments: Assignments | None = None) -> None:
        """A transition that needs no event."""
        with self.xml.element("transition", {"cond": cond, "target": target}):
            self._assign(assignments or [])

    def _go(
        self,
        event: str,
        target: str | None = None,
        pending: Reaction | None = None,
        assignments: Assignments | None = None,
        cond: str | None = None,
    ) -> None:
        """A transition at an event, after which the reaction `pending` is pending."""
        attributes = {"event": event, "cond": cond, "target": target}
        with self.xml.element("transition", attributes):
            self._assign([("now", "_event.data.time"), *(assignments or [])])
            if event.startswith("event."):
                self._mark_over(EventKind(event.removeprefix("event.")))
            if pending is not None:
                kind = pending.event
                with self.xml.element("if", {"cond": f"since_{kind} == 0"}):
                    new = [("events", "events + 1"), (f"since_{kind}", "events")]
                    self._assign([*new, (f"over_{kind}", 0)])

    def _mark_over(self, kind: EventKind) -> None:
        for reaction in self.own.values():
            over = reaction.until is kind
            if over or reaction.event is kind:
                with self.xml.element("if", {"cond": f"since_{reaction.event} != 0"}):
                    self._assign([(f"over_{reaction.event}", int(over))])

    def _assign(self, assignments: Assignments) -> None:
        for location, expr in assignments:
            assign(self.xml, location, str(expr))
