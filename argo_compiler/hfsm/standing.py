"""Where a mission's interruptions stand, and the step that the table of them says."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from argo_compiler.hfsm.interrupts import ROWS, Effect, Given, InterruptRow, Stage, Trigger
from argo_compiler.hfsm.kinds import Outcome
from argo_compiler.il import Afterwards, EventKind, Reaction, Response

Reactions = Mapping[EventKind, Reaction]
"""Those of a mission, by event."""


@dataclass(frozen=True, slots=True)
class Pending:
    """A reaction from the moment when its event occurs until it is over."""

    event: EventKind
    over: bool = False
    """whether the event that it would hold for has occurred"""


@dataclass(frozen=True, slots=True)
class InterruptState:
    """Who has the robot: the mission, a reaction, or a person."""

    stage: Stage = Stage.GOING
    paused: bool = False
    """whether a person has to resume"""
    active: EventKind | None = None
    """the event of the active reaction"""
    pending: tuple[Pending, ...] = ()
    """the active reaction and those that wait, in the order in which their events occurred"""
    outcome: Outcome | None = None

    @property
    def waiting(self) -> tuple[Pending, ...]:
        return tuple(p for p in self.pending if p.event is not self.active)

    @property
    def over(self) -> bool:
        """Whether what the active reaction would hold for has occurred."""
        return any(p.over for p in self.pending if p.event is self.active)


class TakenRow(NamedTuple):
    """A row that was taken, what was so before it, and what is so after it."""

    row: InterruptRow
    before: InterruptState
    after: InterruptState


def advance(
    standing: InterruptState,
    reactions: Reactions,
    trigger: Trigger,
    event: EventKind | None = None,
    outcome: Outcome | None = None,
) -> tuple[TakenRow, ...]:
    """The rows that are taken when that happens, until nothing more follows.

    `event` is what occurs, for EVENT; `outcome` is the plan's, for DONE and ENDED.
    """
    steps: list[TakenRow] = []
    while True:
        row = _row(standing, reactions, trigger, event)
        if row is None:
            return tuple(steps)
        before = standing
        for effect in row.effects:
            standing = _after(standing, effect, reactions, event, outcome)
        if row.target is not None:
            standing = replace(standing, stage=row.target)
        steps.append(TakenRow(row, before, standing))
        trigger = Trigger.ALWAYS


def interrupts(reaction: Reaction) -> bool:
    """Whether it does more than report."""
    return reaction.response is not Response.REPORT


def lets_go_on(reaction: Reaction) -> bool:
    """Whether the mission goes on after it."""
    return reaction.response is Response.PAUSE or reaction.afterwards is Afterwards.RESUME


def _row(
    standing: InterruptState, reactions: Reactions, trigger: Trigger, event: EventKind | None
) -> InterruptRow | None:
    for row in ROWS.get((standing.stage, trigger), ()):
        if all(_so(standing, reactions, given, event) for given in row.when) and not any(
            _so(standing, reactions, given, event) for given in row.unless
        ):
            return row
    return None


def _so(
    standing: InterruptState, reactions: Reactions, given: Given, event: EventKind | None
) -> bool:
    """Whether that is so."""
    own = None if event is None else reactions.get(event)
    active = None if standing.active is None else reactions[standing.active]
    match given:
        case Given.PAUSED:
            return standing.paused
        case Given.OVER:
            return standing.over
        case Given.NEW:
            return all(pending.event is not event for pending in standing.pending)
        case Given.SOME_WAITS:
            return bool(standing.waiting)
        case Given.HIGHER_WAITS:
            assert active is not None
            return any(reactions[p.event].rank > active.rank for p in standing.waiting)
        case _:
            return fixed(given, own, active, event)


def fixed(
    given: Given, own: Reaction | None, active: Reaction | None, event: EventKind | None
) -> bool:
    """Whether that is so, for what is known of reactions and events beforehand."""
    match given:
        case Given.ABORTS:
            return own is not None and own.response is Response.ABORT
        case Given.REACTS:
            return own is not None and interrupts(own)
    assert active is not None
    match given:
        case Given.HIGHER:
            return own is not None and own.rank > active.rank
        case Given.AWAITED:
            return active.until is event
        case Given.DRIVES:
            return active.response.drives
        case Given.HOLDS:
            return active.holds
        case Given.FAILS_HARD:
            return active.afterwards is Afterwards.END
        case Given.THEN_RESUME:
            return lets_go_on(active)
        case Given.THEN_WAIT:
            return active.afterwards is Afterwards.WAIT
        case Given.LIMIT_RESUME:
            return active.on_limit is Afterwards.RESUME
        case Given.LIMIT_WAIT:
            return active.on_limit is Afterwards.WAIT
    raise AssertionError(given)


def _after(
    standing: InterruptState,
    effect: Effect,
    reactions: Reactions,
    event: EventKind | None,
    outcome: Outcome | None,
) -> InterruptState:
    match effect:
        case Effect.MARK:
            return replace(standing, pending=tuple(_marked(standing, reactions, event)))
        case Effect.ENQUEUE:
            assert event is not None
            return replace(standing, pending=(*standing.pending, Pending(event)))
        case Effect.SET_ASIDE:
            return replace(standing, active=None)
        case Effect.ACTIVATE:
            # Of equal ranks, max takes the one that occurred first.
            turn = max(standing.pending, key=lambda pending: reactions[pending.event].rank)
            return replace(standing, active=turn.event)
        case Effect.DROP:
            return replace(standing, active=None, pending=standing.waiting)
        case Effect.PAUSE:
            return replace(standing, paused=True)
        case Effect.UNPAUSE:
            return replace(standing, paused=False)
    if effect is Effect.END_THERE:
        assert standing.active is not None
        outcome = there(reactions[standing.active])
    elif effect is not Effect.END_OF_PLAN:
        outcome = _OUTCOMES[effect]
    return InterruptState(Stage.ENDING, outcome=outcome)


_OUTCOMES = {
    Effect.END_ABORTED: Outcome.ABORTED,
    Effect.END_CANCELLED: Outcome.CANCELLED,
    Effect.END_FAILED: Outcome.FAILED,
}


def there(reaction: Reaction) -> Outcome:
    """How a mission ends that ends where a reaction has led it."""
    return {
        Response.RETURN: Outcome.RETURNED,
        Response.SAFE_AREA: Outcome.SHELTERED,
    }.get(reaction.response, Outcome.ABORTED)


def _marked(
    standing: InterruptState, reactions: Reactions, event: EventKind | None
) -> list[Pending]:
    marked = []
    for pending in standing.pending:
        if reactions[pending.event].until is event:
            marked.append(Pending(pending.event, over=True))
        elif pending.event is event:
            marked.append(Pending(pending.event))
        else:
            marked.append(pending)
    return marked
