"""The tasks of a program with their ways, while it is not known yet which task a way leads to."""

from dataclasses import dataclass, field

from argo_compiler.il import Condition
from argo_compiler.script.resolve.program import Do, Leave, ProgramRound


@dataclass(eq=False, slots=True)
class Point:
    """Where a way leads to; neither set: the mission ends."""

    item: "Item | None" = None
    same: "Point | None" = None
    """it is this one"""

    def circles(self) -> bool:
        """Whether it leads to itself, and to no task."""
        point, seen = self, set()
        while point.same is not None and id(point) not in seen:
            seen.add(id(point))
            point = point.same
        return point.same is not None

    def reached(self) -> "Item | None":
        """The task that is come to here."""
        point = self
        while point.same is not None:
            point = point.same
        return point.item


@dataclass(eq=False, slots=True)
class Item:
    """A task with its ways on."""

    do: Do
    ways: list[tuple[tuple[Condition, ...], Point]] = field(default_factory=list)
    """in order; one without conditions is taken if no other is"""
    next: Point | None = None
    """where it leads if no way is taken"""
    failure: Point | None = None
    missed: Point | None = None


@dataclass(frozen=True, slots=True)
class Range:
    """A round, and the places of its first and last task."""

    round: ProgramRound
    first: int
    last: int


@dataclass(frozen=True, slots=True)
class Lowered:
    """The tasks in order with their ways, and the rounds over them, the outer ones first."""

    items: list[Item]
    ranges: list[Range]
    circling: list[Leave]
    """those that only lead to themselves"""
