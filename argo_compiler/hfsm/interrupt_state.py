"""State of a mission's interruptions, and its steps by the table of interruptions."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import NamedTuple

from argo_compiler.hfsm.interrupts import ROWS, Effect, InterruptGuard, InterruptRow, Stage, Trigger
from argo_compiler.hfsm.kinds import Outcome
from argo_compiler.il import Afterwards, EventKind, Reaction, Response

Reactions = Mapping[EventKind, Reaction]
"""reactions of a mission, by event"""


@dataclass(frozen=True, slots=True)
class Pending:
    """Reaction whose event has occurred and which is not over."""

    event: EventKind
    until_occurred: bool = False
    """whether the event `until`, for which it would hold, has occurred"""


@dataclass(frozen=True, slots=True)
class InterruptState:
    """State of control: whether the mission, a reaction or a person controls the robot."""

    stage: Stage = Stage.GOING
    paused: bool = False
    """whether the mission waits for a person to resume it"""
    active: EventKind | None = None
    """event of the active reaction"""
    pending: tuple[Pending, ...] = ()
    """the active reaction and the waiting ones, in the order in which their events occurred"""
    outcome: Outcome | None = None

    @property
    def waiting(self) -> tuple[Pending, ...]:
        return tuple(p for p in self.pending if p.event is not self.active)

    @property
    def active_until_occurred(self) -> bool:
        """True if the event that ends the active reaction's hold occurred, even before the hold."""
        return any(p.until_occurred for p in self.pending if p.event is self.active)


class AppliedRow(NamedTuple):
    """Row that was taken, with the states before and after it."""

    row: InterruptRow
    before: InterruptState
    after: InterruptState


def rows_taken_at(
    state: InterruptState,
    reactions: Reactions,
    trigger: Trigger,
    event: EventKind | None = None,
    outcome: Outcome | None = None,
) -> tuple[AppliedRow, ...]:
    """Return the rows of the table of interruptions that a trigger takes, in order; none may fit.

    The first one is taken at the trigger, the others follow from it (`Trigger.ALWAYS`). `event` is
    the event that occurs, for EVENT; `outcome` is that of the mission itself, for DONE and ENDED.
    """
    steps: list[AppliedRow] = []
    while True:
        row = _find_row(state, reactions, trigger, event)
        if row is None:
            return tuple(steps)
        before = state
        for effect in row.effects:
            state = _apply_effect(state, effect, reactions, event, outcome)
        if row.target is not None:
            state = replace(state, stage=row.target)
        steps.append(AppliedRow(row, before, state))
        trigger = Trigger.ALWAYS


def is_interrupting(reaction: Reaction) -> bool:
    """Return True if the reaction interrupts or ends the mission: all responses but REPORT."""
    return reaction.response is not Response.REPORT


def resumes_mission(reaction: Reaction) -> bool:
    """Return True if the mission resumes after the reaction."""
    return reaction.response is Response.PAUSE or reaction.afterwards is Afterwards.RESUME


def _find_row(
    state: InterruptState, reactions: Reactions, trigger: Trigger, event: EventKind | None
) -> InterruptRow | None:
    for row in ROWS.get((state.stage, trigger), ()):
        if all(_evaluate_guard(state, reactions, guard, event) for guard in row.when) and not any(
            _evaluate_guard(state, reactions, guard, event) for guard in row.unless
        ):
            return row
    return None


def _evaluate_guard(
    state: InterruptState, reactions: Reactions, guard: InterruptGuard, event: EventKind | None
) -> bool:
    own = None if event is None else reactions.get(event)
    active = None if state.active is None else reactions[state.active]
    match guard:
        case InterruptGuard.PAUSED:
            return state.paused
        case InterruptGuard.OVER:
            return state.active_until_occurred
        case InterruptGuard.NEW:
            return all(pending.event is not event for pending in state.pending)
        case InterruptGuard.SOME_WAITS:
            return bool(state.waiting)
        case InterruptGuard.HIGHER_WAITS:
            assert active is not None
            return any(
                reactions[p.event].urgency_score > active.urgency_score for p in state.waiting
            )
        case _:
            return evaluate_static_guard(guard, own, active, event)


def evaluate_static_guard(
    guard: InterruptGuard, own: Reaction | None, active: Reaction | None, event: EventKind | None
) -> bool:
    """Return the value of a guard that depends on nothing but the reactions and the event.

    `own` is the reaction to `event`, `active` the active reaction; each is None without one.
    """
    match guard:
        case InterruptGuard.ABORTS:
            return own is not None and own.response is Response.ABORT
        case InterruptGuard.REACTS:
            return own is not None and is_interrupting(own)
    assert active is not None
    match guard:
        case InterruptGuard.HIGHER:
            return own is not None and own.urgency_score > active.urgency_score
        case InterruptGuard.AWAITED:
            return active.until is event
        case InterruptGuard.DRIVES:
            return active.response.drives
        case InterruptGuard.HOLDS:
            return active.holds
        case InterruptGuard.FAILS_HARD:
            return active.afterwards is Afterwards.END
        case InterruptGuard.THEN_RESUME:
            return resumes_mission(active)
        case InterruptGuard.THEN_WAIT:
            return active.afterwards is Afterwards.WAIT
        case InterruptGuard.LIMIT_RESUME:
            return active.on_limit is Afterwards.RESUME
        case InterruptGuard.LIMIT_WAIT:
            return active.on_limit is Afterwards.WAIT
    raise AssertionError(guard)


def _apply_effect(
    state: InterruptState,
    effect: Effect,
    reactions: Reactions,
    event: EventKind | None,
    outcome: Outcome | None,
) -> InterruptState:
    match effect:
        case Effect.MARK:
            return replace(state, pending=tuple(_mark(state, reactions, event)))
        case Effect.ENQUEUE:
            assert event is not None
            return replace(state, pending=(*state.pending, Pending(event)))
        case Effect.SET_ASIDE:
            return replace(state, active=None)
        case Effect.ACTIVATE:
            # Among equal ranks, max returns the one that occurred first.
            highest = max(state.pending, key=lambda pending: reactions[pending.event].urgency_score)
            return replace(state, active=highest.event)
        case Effect.DROP:
            return replace(state, active=None, pending=state.waiting)
        case Effect.PAUSE:
            return replace(state, paused=True)
        case Effect.UNPAUSE:
            return replace(state, paused=False)
    if effect is Effect.END_THERE:
        assert state.active is not None
        outcome = reaction_outcome(reactions[state.active])
    elif effect is not Effect.END_OF_PLAN:
        outcome = _OUTCOMES[effect]
    return InterruptState(Stage.ENDING, outcome=outcome)


_OUTCOMES = {
    Effect.END_ABORTED: Outcome.ABORTED,
    Effect.END_CANCELLED: Outcome.CANCELLED,
    Effect.END_FAILED: Outcome.FAILED,
}


def reaction_outcome(reaction: Reaction) -> Outcome:
    """Return the outcome after a mission's last reaction: by its destination, or ABORTED."""
    return {
        Response.RETURN: Outcome.RETURNED,
        Response.SAFE_AREA: Outcome.SHELTERED,
    }.get(reaction.response, Outcome.ABORTED)


def _mark(state: InterruptState, reactions: Reactions, event: EventKind | None) -> list[Pending]:
    marked = []
    for pending in state.pending:
        if reactions[pending.event].until is event:
            marked.append(Pending(pending.event, until_occurred=True))
        elif pending.event is event:
            marked.append(Pending(pending.event))
        else:
            marked.append(pending)
    return marked
