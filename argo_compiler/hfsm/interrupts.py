"""The one table of what interrupts a mission: events, persons, the drives and holds of reactions.

It is data: the executor looks its rows up (`argo_compiler.hfsm.standing`), and the state chart of
`argo export` is written from the same rows. Rules are those of `docs/language.md`.

Rows of a state and a trigger are tried in order, and the first whose `when` all hold and of whose
`unless` none does is taken. After each row, those of `Trigger.ALWAYS` are tried until none can be
taken. Guards look at what was so before the row, effects are carried out in order.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Stage(StrEnum):
    """Who has the robot, and how far that has come."""

    GOING = "going"
    """the mission goes on"""
    CHOOSING = "choosing"
    """for no time: whose turn is it?"""
    STOPPED = "stopped"
    """paused, with no reaction active"""
    BEGINNING = "beginning"
    """for no time: the active reaction has the robot"""
    DRIVING = "driving"
    """the active reaction drives, or is paused on the way"""
    ARRIVED = "arrived"
    """for no time: the active reaction is where it wants to be"""
    HOLDING = "holding"
    """the active reaction stands still and waits"""
    LETTING_GO = "letting_go"
    """for no time: nothing is waited for any more"""
    ENDING = "ending"
    """the mission has an outcome; an action may still have to end"""


class Trigger(StrEnum):
    """What may happen."""

    ALWAYS = "always"
    """nothing: looked at after each row"""
    EVENT = "event"
    """something that the mission may react to occurs"""
    PAUSE = "pause"
    """a person pauses, or takes over"""
    RESUME = "resume"
    """a person resumes, or gives back"""
    CANCEL = "cancel"
    """a person ends the mission"""
    DRIVEN = "driven"
    """the drive of the active reaction has succeeded"""
    STUCK = "stuck"
    """that drive has failed"""
    LIMIT = "limit"
    """the hold's limit is over"""
    DONE = "done"
    """the mission's last task has ended; looked at until it has an effect"""
    ENDED = "ended"
    """the plan itself has ended otherwise: docked or aborted after a failure"""


class Given(StrEnum):
    """What a row may ask for. `own` is the reaction to the event that occurs."""

    PAUSED = "paused"
    """a person has to resume"""
    ABORTS = "aborts"
    """own is ABORT"""
    REACTS = "reacts"
    """own interrupts the mission"""
    NEW = "new"
    """own is neither active nor waits"""
    HIGHER = "higher"
    """own ranks above the active reaction"""
    AWAITED = "awaited"
    """the event is what the active reaction holds for"""
    SOME_WAITS = "some_waits"
    """a reaction waits; the turn is that of the highest rank, of equal ones the earliest's"""
    HIGHER_WAITS = "higher_waits"
    """a reaction waits that ranks above the active one"""
    DRIVES = "drives"
    """the active reaction has a drive"""
    HOLDS = "holds"
    """it holds: it has an `until`, or is a PAUSE"""
    OVER = "over"
    """what it holds for has occurred"""
    FAILS_HARD = "fails_hard"
    """its `afterwards` is END, so that the mission fails with its drive"""
    THEN_RESUME = "then_resume"
    """it lets the mission go on afterwards"""
    THEN_WAIT = "then_wait"
    """it waits for a person afterwards"""
    LIMIT_RESUME = "limit_resume"
    """its `on_limit` is RESUME"""
    LIMIT_WAIT = "limit_wait"
    """its `on_limit` is WAIT"""


class Effect(StrEnum):
    """What a row does."""

    MARK = "mark"
    """the reactions that would hold for the event need not, those to it have to again"""
    ENQUEUE = "enqueue"
    """own waits, as the last of all"""
    SET_ASIDE = "set_aside"
    """the active reaction waits, and will begin anew"""
    ACTIVATE = "activate"
    """the reaction whose turn it is becomes the active one"""
    DROP = "drop"
    """the active reaction is over"""
    PAUSE = "pause"
    UNPAUSE = "unpause"
    END_ABORTED = "end_aborted"
    END_CANCELLED = "end_cancelled"
    END_FAILED = "end_failed"
    END_THERE = "end_there"
    """as the active reaction's place says: returned, sheltered or, after a PAUSE, aborted"""
    END_OF_PLAN = "end_of_plan"
    """as the plan says"""


@dataclass(frozen=True, slots=True)
class InterruptRow:
    """What happens in any of `stages` at a trigger."""

    rule: str
    """what it is for"""
    stages: tuple[Stage, ...]
    trigger: Trigger
    target: Stage | None = None
    """None: it stays where it is"""
    when: tuple[Given, ...] = ()
    unless: tuple[Given, ...] = ()
    effects: tuple[Effect, ...] = ()


_REACTING = (Stage.DRIVING, Stage.HOLDING)
_LIVE = (Stage.GOING, Stage.STOPPED, *_REACTING)
_STABLE = (*_LIVE, Stage.ENDING)

_NEW = (Given.REACTS, Given.NEW)


def _rows() -> Iterable[InterruptRow]:
    row, on, to, g, do = InterruptRow, Trigger, Stage, Given, Effect

    # Persons and ABORT come before all else.
    yield row("I2", _LIVE, on.CANCEL, to.ENDING, effects=(do.END_CANCELLED,))
    yield row("R6 R7 R9", _LIVE, on.EVENT, to.ENDING, (g.ABORTS,), effects=(do.END_ABORTED,))
    yield row("T8", _LIVE, on.ENDED, to.ENDING, effects=(do.END_OF_PLAN,))
    yield row("M3", (to.GOING,), on.DONE, to.ENDING, effects=(do.END_OF_PLAN,))

    # Events.
    waits = (do.MARK, do.ENQUEUE)
    yield row("R2", (to.GOING,), on.EVENT, to.CHOOSING, (g.REACTS,), effects=(do.ENQUEUE,))
    yield row("R9", (to.STOPPED,), on.EVENT, None, _NEW, effects=waits)
    higher = (*_NEW, g.HIGHER)
    yield row("R9", _REACTING, on.EVENT, None, (*higher, g.PAUSED), effects=waits)
    interrupts = (do.SET_ASIDE, *waits)
    yield row("R7", _REACTING, on.EVENT, to.CHOOSING, higher, effects=interrupts)
    yield row("R10", _REACTING, on.EVENT, None, (*_NEW, g.AWAITED), effects=(do.MARK,))
    yield row("R7", _REACTING, on.EVENT, None, _NEW, effects=waits)
    yield row("R3 R7", (to.STOPPED, *_REACTING), on.EVENT, effects=(do.MARK,))

    # Whose turn it is.
    yield row(
        "R7", (to.CHOOSING,), on.ALWAYS, to.BEGINNING, (g.SOME_WAITS,), effects=(do.ACTIVATE,)
    )
    yield row("R5", (to.CHOOSING,), on.ALWAYS, to.GOING)

    # A reaction from its beginning to its end.
    yield row("R2", (to.BEGINNING,), on.ALWAYS, to.DRIVING, (g.DRIVES,))
    yield row("R3", (to.BEGINNING,), on.ALWAYS, to.ARRIVED)
    yield row("R3", (to.DRIVING,), on.DRIVEN, to.ARRIVED)
    yield row("R8", (to.DRIVING,), on.STUCK, to.ENDING, (g.FAILS_HARD,), effects=(do.END_FAILED,))
    lets_a_person = (do.DROP, do.PAUSE)
    yield row("R8", (to.DRIVING,), on.STUCK, to.STOPPED, effects=lets_a_person)
    yield row("R3", (to.ARRIVED,), on.ALWAYS, to.HOLDING, (g.HOLDS,), (g.OVER,))
    yield row("R3", (to.ARRIVED,), on.ALWAYS, to.LETTING_GO)
    yield row("R3", (to.HOLDING,), on.ALWAYS, to.LETTING_GO, (g.OVER,), (g.PAUSED,))
    limit, running = on.LIMIT, (g.PAUSED,)
    yield row("R3", (to.HOLDING,), limit, to.LETTING_GO, (g.LIMIT_RESUME,), running)
    yield row("R3", (to.HOLDING,), limit, to.STOPPED, (g.LIMIT_WAIT,), running, lets_a_person)
    yield row("R3", (to.HOLDING,), limit, to.ENDING, (), running, (do.END_THERE,))
    over = (to.LETTING_GO,)
    yield row("R4 I1", over, on.ALWAYS, to.STOPPED, (g.THEN_RESUME, g.PAUSED), effects=(do.DROP,))
    yield row("R4", over, on.ALWAYS, to.CHOOSING, (g.THEN_RESUME,), effects=(do.DROP,))
    yield row("R4", over, on.ALWAYS, to.STOPPED, (g.THEN_WAIT,), effects=lets_a_person)
    yield row("R4", over, on.ALWAYS, to.ENDING, effects=(do.END_THERE,))

    # Persons who pause and resume.
    yield row("I1", (to.GOING,), on.PAUSE, to.STOPPED, effects=(do.PAUSE,))
    yield row("I1", _REACTING, on.PAUSE, None, (), (g.PAUSED,), (do.PAUSE,))
    yield row("I1 R9", (to.STOPPED,), on.RESUME, to.CHOOSING, effects=(do.UNPAUSE,))
    aside = (do.UNPAUSE, do.SET_ASIDE)
    yield row("R9", _REACTING, on.RESUME, to.CHOOSING, (g.PAUSED, g.HIGHER_WAITS), effects=aside)
    yield row("I1", _REACTING, on.RESUME, None, (g.PAUSED,), effects=(do.UNPAUSE,))
    yield row("R3", (to.HOLDING,), on.RESUME, to.LETTING_GO)

    # What changes nothing.
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
"""The table by stage and trigger, in the order in which rows are tried."""
