"""The reactions of a mission under way: the active one and those that wait for their turn."""

from dataclasses import dataclass

from argo_compiler.hfsm.progress import Phase
from argo_compiler.hfsm.tables import ReactionNode
from argo_compiler.il import EventKind, Reaction, Response


@dataclass(slots=True, eq=False)
class Pending:
    """A reaction from the moment when its event occurs until it lets the mission go on."""

    node: ReactionNode
    order: int
    """when its event occurred, among all of them"""
    over: bool = False
    """whether the event that it would hold for has occurred"""

    @property
    def reaction(self) -> Reaction:
        return self.node.state.reaction


class Reactions:
    """At most one reaction is active, the others wait. It changes with each event."""

    __slots__ = ("_order", "active", "phase", "visit", "waiting")

    def __init__(self) -> None:
        self.active: Pending | None = None
        self.phase = Phase.HOLDING
        self.visit = 0
        """the number of the active one's drive"""
        self.waiting: list[Pending] = []
        """in the order in which their events occurred, but for those that were interrupted"""
        self._order = 0

    def occur(self, kind: EventKind, own: ReactionNode | None, paused: bool) -> Pending | None:
        """Takes note of an event; returns the reaction that begins now, if one does.

        `own` is the reaction to the event, if the mission has one. Where the event is what the
        active reaction holds for, that is marked as over.
        """
        known = False
        for pending in self.pending():
            reaction = pending.reaction
            if reaction.until is kind:
                pending.over = True
            elif reaction.event is kind:
                pending.over = False
            known = known or reaction.event is kind
        if known or own is None or own.state.reaction.response is Response.REPORT:
            return None
        active = self.active
        if active is not None and own.rank <= active.reaction.rank:
            if active.reaction.until is not kind:
                self.wait(own)
            return None
        if paused and own.state.reaction.response is not Response.ABORT:
            self.wait(own)
            return None
        return self._new(own)

    def begin(self, pending: Pending) -> None:
        """Makes a reaction the active one; one that it interrupts waits and begins anew."""
        if self.active is not None:
            self.waiting.append(self.active)
        self.active = pending

    def next(self) -> Pending | None:
        """Takes the reaction whose turn it is off the waiting ones: it may interrupt the active."""
        first = min(
            self.waiting,
            key=lambda p: (*(-part for part in p.reaction.rank), p.order),
            default=None,
        )
        if first is None:
            return None
        if self.active is not None and first.reaction.rank <= self.active.reaction.rank:
            return None
        self.waiting.remove(first)
        return first

    def clear(self) -> None:
        self.active = None
        self.waiting.clear()

    def pending(self) -> list[Pending]:
        """All of them, in the order in which their events occurred."""
        active = [] if self.active is None else [self.active]
        return sorted([*active, *self.waiting], key=lambda p: p.order)

    def wait(self, node: ReactionNode, over: bool = False) -> Pending:
        pending = self._new(node, over)
        self.waiting.append(pending)
        return pending

    def _new(self, node: ReactionNode, over: bool = False) -> Pending:
        self._order += 1
        return Pending(node, self._order, over)
