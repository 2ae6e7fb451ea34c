"""Witnesses: what each claim of the analysis rests on, as data that can be checked in one pass.

A set of readings of a checkpoint is a number with one bit each. Its bounds cut the line of values:
bit 2k is what lies below bound k and above the one before, bit 2k + 1 the bound itself, and bit 2n,
with n bounds, what lies above the last one. Then come three bits: no reading, unreadable, failed.
The sets of all checkpoints lie beside each other in one long number.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ReadingScale:
    """Where the readings of a checkpoint lie in the long numbers, and what they mean."""

    object_id: str
    bounds: tuple[float, ...]
    """ascending"""
    shift: int
    """the number of its first bit"""


@dataclass(frozen=True, slots=True)
class Invariant:
    """What may be on a mission, large enough that no step leads out of it.

    What lies outside can't happen. The readings are those that may be there before anything is
    done at a place; a checkpoint without a scale may have any reading anywhere.
    """

    failures: bool
    """whether any action may fail, and any task be done by hand or skipped"""
    scales: tuple[ReadingScale, ...]
    tasks: tuple[int | None, ...]
    """of each task, in the mission's order: the readings; None: it is not come to"""
    rounds: tuple[int | None, ...]
    """of each group, in the mission's order, likewise, when a round of it has ended"""
    cuts: tuple[int | None, ...]
    """of each group, likewise, when its time or that of a group around it is up"""
    ended: bool
    """whether the mission ends"""
    late_tasks: tuple[int, ...]
    """of each task: the readings that may still come there, from an action that is cancelled"""
    late_rounds: tuple[int, ...]
    late_cuts: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class KeptReading:
    """Readings of a checkpoint that a loop keeps, as nothing in it measures it."""

    object_id: str
    bounds: tuple[float, ...]
    """ascending"""
    readings: int


@dataclass(frozen=True, slots=True)
class Trap:
    """Places that follow each other for ever, if no action fails: no step leads out of them."""

    tasks: tuple[str, ...]
    rounds: tuple[str, ...] = ()
    """the groups of which a round ends there"""
    cuts: tuple[str, ...] = ()
    """the groups that a time-out leaves there"""
    kept: KeptReading | None = None
    """with what readings it is entered; None: with any that may be there"""


@dataclass(frozen=True, slots=True)
class LeastSpent:
    """What has been spent at least since the mission's start, in s or Wh, place by place.

    In the round n of each group around a place it is (n - 1) times that group's period more. None:
    the place is not come to.
    """

    tasks: tuple[float | None, ...]
    """of each task, in the mission's order: when it has ended"""
    missed: tuple[float | None, ...]
    """likewise, when its hard window is over"""
    rounds: tuple[float | None, ...]
    """of each group, in the mission's order: when a round of it has ended"""
    left: tuple[float | None, ...]
    """likewise, when it has had its last round, or its time is up"""
    entered: tuple[float | None, ...]
    """likewise, when it is entered"""
    periods: tuple[float, ...]
    """likewise, from one round to the next"""
    end: float | None
    """when the mission has ended"""


@dataclass(frozen=True, slots=True)
class LeastWitness:
    """What shows that a mission takes at least so much."""

    time: LeastSpent
    """s"""
    energy: LeastSpent
    """Wh"""


@dataclass(frozen=True, slots=True)
class Witnesses:
    """All that an analysis can show for its claims."""

    nominal: Invariant
    """if no action fails"""
    all: Invariant
    """whatever fails"""
    traps: tuple[Trap, ...] = ()
    least: LeastWitness | None = None
    """of what is taken at least, where something is said of that"""
