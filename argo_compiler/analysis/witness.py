"""Witnesses: evidence for the claims of the analysis, as data that can be checked in one pass.

A set of readings of a checkpoint is an integer with one bit for each of them. The checkpoint's
bounds divide the number line: bit 2k stands for the values between bound k - 1 and bound k, bit
2k + 1 for bound k itself, and bit 2n, with n bounds, for the values above the last one. Four more
bits follow: no reading, unreadable, unreachable, failed. The sets of all checkpoints are packed
into one long integer.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ReadingScale:
    """Position and meaning of the bits of a checkpoint's readings in the long integers."""

    object_id: str
    bounds: tuple[float, ...]
    """ascending"""
    shift: int
    """number of the first bit"""


@dataclass(frozen=True, slots=True)
class Invariant:
    """Inductive invariant of a mission: states so large that no step of the mission leaves them.

    Whatever lies outside of them can't happen. The readings are those that are possible at a task,
    before its action, or at a group; a checkpoint without a scale may have any reading anywhere.
    """

    failures: bool
    """whether any action may fail, and a person may do or skip any task"""
    scales: tuple[ReadingScale, ...]
    tasks: tuple[int | None, ...]
    """for each task, in the mission's order, the readings; None if it is not reached"""
    rounds: tuple[int | None, ...]
    """for each group, in the mission's order, the readings when a round of it has ended"""
    cuts: tuple[int | None, ...]
    """for each group, the readings when its time or that of an enclosing group is up"""
    ended: bool
    """whether the mission can end"""
    late_tasks: tuple[int, ...]
    """for each task, the readings that an action being cancelled may still report there"""
    late_rounds: tuple[int, ...]
    """the same for each element of `rounds`"""
    late_cuts: tuple[int, ...]
    """the same for each element of `cuts`"""


@dataclass(frozen=True, slots=True)
class KeptReading:
    """Readings of a checkpoint that do not change in a loop, as no task in it measures them."""

    object_id: str
    bounds: tuple[float, ...]
    """ascending"""
    readings: int
    """set of readings, as bits"""


@dataclass(frozen=True, slots=True)
class Trap:
    """Tasks and groups that follow each other for ever if no action fails: no step leaves them."""

    tasks: tuple[str, ...]
    """names of the tasks"""
    rounds: tuple[str, ...] = ()
    """names of the groups whose rounds end in the loop"""
    cuts: tuple[str, ...] = ()
    """names of the groups that a time-out leaves in the loop"""
    kept: KeptReading | None = None
    """readings with which the loop is entered; None if it goes on with any possible reading"""


@dataclass(frozen=True, slots=True)
class LeastSpent:
    """Lower bounds of the time (s) or energy (Wh) spent from the mission's start to each point.

    The values hold for the first round of each enclosing group. Round n adds n - 1 times the
    group's period. A value is None if the point is not reached.
    """

    tasks: tuple[float | None, ...]
    """for each task, in the mission's order, until it has ended"""
    missed: tuple[float | None, ...]
    """for each task, until its hard window has closed"""
    rounds: tuple[float | None, ...]
    """for each group, in the mission's order, until a round of it has ended"""
    left: tuple[float | None, ...]
    """for each group, until its last round has ended or its time is up"""
    entered: tuple[float | None, ...]
    """for each group, until it is entered"""
    periods: tuple[float, ...]
    """for each group, lower bound from one round to the next"""
    end: float | None
    """until the mission has ended"""


@dataclass(frozen=True, slots=True)
class LeastWitness:
    """Witness of the least time and the least energy of a mission."""

    time: LeastSpent
    """s"""
    energy: LeastSpent
    """Wh"""


@dataclass(frozen=True, slots=True)
class Witnesses:
    """All witnesses of an analysis."""

    nominal: Invariant
    """invariant if no action fails"""
    all: Invariant
    """invariant whatever fails"""
    traps: tuple[Trap, ...] = ()
    least: LeastWitness | None = None
    """lower bounds; None if no diagnostic claims one"""
