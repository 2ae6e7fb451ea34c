"""Table of all interruptions of a mission: by events, persons, and drives and holds of reactions.

It is data: the executor looks up its rows (`argo_compiler.hfsm.interrupt_state`), and the state
chart of `argo export` is written from the same rows. The rules are those of `docs/language.md`.

The rows of a stage and a trigger are tried in order. The first row is taken all of whose `when`
guards are true and none of whose `unless` guards is. After each row, the rows of `Trigger.ALWAYS`
are tried until none can be taken. Guards are evaluated on the state before the row; effects are
executed in order.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Stage(StrEnum):
    """Phase of the control of the robot by the mission, a reaction or a person."""

    GOING = "going"
    """the mission goes on"""
    CHOOSING = "choosing"
    """takes no time: selects the reaction or the mission that continues"""
    STOPPED = "stopped"
    """paused, with no reaction active"""
    BEGINNING = "beginning"
    """takes no time: the active reaction gets the robot"""
    DRIVING = "driving"
    """the active reaction drives, or is paused during its drive"""
    ARRIVED = "arrived"
    """takes no time: the active reaction has no drive, or its drive has ended"""
    HOLDING = "holding"
    """the active reaction holds: the robot stands still and waits"""
    LETTING_GO = "letting_go"
    """takes no time: the hold of the active reaction is over"""
    ENDING = "ending"
    """the mission has an outcome; an action may still have to end"""


class Trigger(StrEnum):
    """Kind of occurrence that may change who controls the robot."""

    ALWAYS = "always"
    """nothing: tried after each row"""
    EVENT = "event"
    """an event occurs that the mission may react to"""
    PAUSE = "pause"
    """a person pauses, or takes over"""
    RESUME = "resume"
    """a person resumes, or gives back"""
    CANCEL = "cancel"
    """a person ends the mission"""
    DRIVEN = "driven"
    """the drive of the active reaction has succeeded"""
    STUCK = "stuck"
    """the drive of the active reaction has failed"""
    LIMIT = "limit"
    """the hold's limit is over"""
    DONE = "done"
    """the mission's last task has ended; tried again until it has an effect"""
    ENDED = "ended"
    """the mission itself has ended in another way: docked or aborted after a failure"""


class InterruptGuard(StrEnum):
    """Guard of a row. `own` is the reaction to the event that occurs."""

    PAUSED = "paused"
    """the mission waits for a person to resume it"""
    ABORTS = "aborts"
    """own is ABORT"""
    REACTS = "reacts"
    """own interrupts the mission"""
    NEW = "new"
    """own is neither active nor waiting"""
    HIGHER = "higher"
    """own ranks above the active reaction"""
    AWAITED = "awaited"
    """the event is the `until` of the active reaction"""
    SOME_WAITS = "some_waits"
    """a reaction is waiting; the one of the highest rank is next, among equal ranks the earliest
    one"""
    HIGHER_WAITS = "higher_waits"
    """a reaction is waiting that ranks above the active one"""
    DRIVES = "drives"
    """the active reaction has a drive"""
    HOLDS = "holds"
    """the active reaction holds: it has an `until`, or is a PAUSE"""
    OVER = "over"
    """the `until` of the active reaction has occurred"""
    FAILS_HARD = "fails_hard"
    """`afterwards` of the active reaction is END: the mission fails if its drive fails"""
    THEN_RESUME = "then_resume"
    """the mission resumes after the active reaction"""
    THEN_WAIT = "then_wait"
    """the mission waits for a person after the active reaction"""
    LIMIT_RESUME = "limit_resume"
    """`on_limit` of the active reaction is RESUME"""
    LIMIT_WAIT = "limit_wait"
    """`on_limit` of the active reaction is WAIT"""


class Effect(StrEnum):
    """Effect of a row."""

    MARK = "mark"
    """reactions whose `until` is the event are marked: their hold is over; the mark of the reaction
    to the event itself is removed"""
    ENQUEUE = "enqueue"
    """own is added to the waiting reactions, as the last one"""
    SET_ASIDE = "set_aside"
    """the active reaction becomes a waiting one, and starts again from its beginning later"""
    ACTIVATE = "activate"
    """the waiting reaction that is next becomes the active one"""
    DROP = "drop"
    """the active reaction is over"""
    PAUSE = "pause"
    UNPAUSE = "unpause"
    END_ABORTED = "end_aborted"
    END_CANCELLED = "end_cancelled"
    END_FAILED = "end_failed"
    END_THERE = "end_there"
    """outcome by the active reaction's target: returned, sheltered or, after a PAUSE, aborted"""
    END_OF_PLAN = "end_of_plan"
    """outcome of the mission itself"""


@dataclass(frozen=True, slots=True)
class InterruptRow:
    """Row of the table: its effects and target in any of `stages` at a trigger."""

    rule: str
    """ids of the rules in `docs/language.md` that it implements"""
    stages: tuple[Stage, ...]
    trigger: Trigger
    target: Stage | None = None
    """next stage; None if the stage does not change"""
    when: tuple[InterruptGuard, ...] = ()
    unless: tuple[InterruptGuard, ...] = ()
    effects: tuple[Effect, ...] = ()


_REACTING = (Stage.DRIVING, Stage.HOLDING)
_LIVE = (Stage.GOING, Stage.STOPPED, *_REACTING)
_STABLE = (*_LIVE, Stage.ENDING)

_NEW = (InterruptGuard.REACTS, InterruptGuard.NEW)


def _rows() -> Iterable[InterruptRow]:
    row, on, to, g, do = InterruptRow, Trigger, Stage, InterruptGuard, Effect

    # Persons and ABORT come first.
    yield row("I2", _LIVE, on.CANCEL, to.ENDING, effects=(do.END_CANCELLED,))
    yield row("R6 R7 R9", _LIVE, on.EVENT, to.ENDING, (g.ABORTS,), effects=(do.END_ABORTED,))
    yield row("T8", _LIVE, on.ENDED, to.ENDING, effects=(do.END_OF_PLAN,))
    yield row("M3", (to.GOING,), on.DONE, to.ENDING, effects=(do.END_OF_PLAN,))

    # Events.
    queues = (do.MARK, do.ENQUEUE)
    yield row("R2", (to.GOING,), on.EVENT, to.CHOOSING, (g.REACTS,), effects=(do.ENQUEUE,))
    yield row("R9", (to.STOPPED,), on.EVENT, None, _NEW, effects=queues)
    higher = (*_NEW, g.HIGHER)
    yield row("R9", _REACTING, on.EVENT, None, (*higher, g.PAUSED), effects=queues)
    preempts = (do.SET_ASIDE, *queues)
    yield row("R7", _REACTING, on.EVENT, to.CHOOSING, higher, effects=preempts)
    yield row("R10", _REACTING, on.EVENT, None, (*_NEW, g.AWAITED), effects=(do.MARK,))
    yield row("R7", _REACTING, on.EVENT, None, _NEW, effects=queues)
    yield row("R3 R7", (to.STOPPED, *_REACTING), on.EVENT, effects=(do.MARK,))

    # Selection of the next reaction.
    yield row(
        "R7", (to.CHOOSING,), on.ALWAYS, to.BEGINNING, (g.SOME_WAITS,), effects=(do.ACTIVATE,)
    )
    yield row("R5", (to.CHOOSING,), on.ALWAYS, to.GOING)

    # A reaction from its start to its end.
    yield row("R2", (to.BEGINNING,), on.ALWAYS, to.DRIVING, (g.DRIVES,))
    yield row("R3", (to.BEGINNING,), on.ALWAYS, to.ARRIVED)
    yield row("R3", (to.DRIVING,), on.DRIVEN, to.ARRIVED)
    yield row("R8", (to.DRIVING,), on.STUCK, to.ENDING, (g.FAILS_HARD,), effects=(do.END_FAILED,))
    wait_for_person = (do.DROP, do.PAUSE)
    yield row("R8", (to.DRIVING,), on.STUCK, to.STOPPED, effects=wait_for_person)
    yield row("R3", (to.ARRIVED,), on.ALWAYS, to.HOLDING, (g.HOLDS,), (g.OVER,))
    yield row("R3", (to.ARRIVED,), on.ALWAYS, to.LETTING_GO)
    yield row("R3", (to.HOLDING,), on.ALWAYS, to.LETTING_GO, (g.OVER,), (g.PAUSED,))
    limit, paused = on.LIMIT, (g.PAUSED,)
    yield row("R3", (to.HOLDING,), limit, to.LETTING_GO, (g.LIMIT_RESUME,), paused)
    yield row("R3", (to.HOLDING,), limit, to.STOPPED, (g.LIMIT_WAIT,), paused, wait_for_person)
    yield row("R3", (to.HOLDING,), limit, to.ENDING, (), paused, (do.END_THERE,))
    letting_go = (to.LETTING_GO,)
    yield row(
        "R4 I1", letting_go, on.ALWAYS, to.STOPPED, (g.THEN_RESUME, g.PAUSED), effects=(do.DROP,)
    )
    yield row("R4", letting_go, on.ALWAYS, to.CHOOSING, (g.THEN_RESUME,), effects=(do.DROP,))
    yield row("R4", letting_go, on.ALWAYS, to.STOPPED, (g.THEN_WAIT,), effects=wait_for_person)
    yield row("R4", letting_go, on.ALWAYS, to.ENDING, effects=(do.END_THERE,))

    # Pause and resume by persons.
    yield row("I1", (to.GOING,), on.PAUSE, to.STOPPED, effects=(do.PAUSE,))
    yield row("I1", _REACTING, on.PAUSE, None, (), (g.PAUSED,), (do.PAUSE,))
    yield row("I1 R9", (to.STOPPED,), on.RESUME, to.CHOOSING, effects=(do.UNPAUSE,))
    unpause_and_requeue = (do.UNPAUSE, do.SET_ASIDE)
    yield row(
        "R9",
        _REACTING,
        on.RESUME,
        to.CHOOSING,
        (g.PAUSED, g.HIGHER_WAITS),
        effects=unpause_and_requeue,
    )
    yield row("I1", _REACTING, on.RESUME, None, (g.PAUSED,), effects=(do.UNPAUSE,))
    yield row("R3", (to.HOLDING,), on.RESUME, to.LETTING_GO)

    # Triggers without an effect.
    yield row("R1", (to.GOING, to.ENDING), on.EVENT)
    yield row("I1", (to.STOPPED, *_REACTING, to.ENDING), on.PAUSE)
    yield row("I1", (to.GOING, to.DRIVING, to.ENDING), on.RESUME)
    yield row("R5", (to.STOPPED, *_REACTING, to.ENDING), on.DONE)
    yield row("I3", (to.GOING, to.STOPPED, to.HOLDING, to.ENDING), on.DRIVEN)
    yield row("I3", (to.GOING, to.STOPPED, to.HOLDING, to.ENDING), on.STUCK)
    yield row("R3", _STABLE, on.LIMIT)
    yield row("M3", (to.ENDING,), on.CANCEL)
    yield row("M3", (to.ENDING,), on.ENDED)


TABLE: tuple[InterruptRow, ...] = tuple(_rows())

ROWS: dict[tuple[Stage, Trigger], tuple[InterruptRow, ...]] = {
    (stage, trigger): rows
    for stage in Stage
    for trigger in Trigger
    if (rows := tuple(r for r in TABLE if r.trigger is trigger and stage in r.stages))
}
"""rows of the table by stage and trigger, in the order in which they are tried"""
