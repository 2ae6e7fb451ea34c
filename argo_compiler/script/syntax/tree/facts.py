"""Facts: what a sentence says of the mission as a whole."""

from dataclasses import dataclass

from argo_compiler.script.syntax.tree.node import Node
from argo_compiler.script.syntax.tree.nouns import Nouns
from argo_compiler.script.syntax.tree.places import Location, Steps


@dataclass(frozen=True, slots=True, kw_only=True)
class Fact(Node):
    """Something that holds for the whole mission."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxDuration(Fact):
    """`The mission may take 20 minutes at most`."""

    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class BackWithin(Fact):
    """`It has to be back in its dock in starting area 1 within 35 minutes`."""

    where: Location
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True)
class ReadBefore(Fact):
    """`Checkpoint 7 has to be read before checkpoint 18`."""

    first: Nouns
    second: Nouns


@dataclass(frozen=True, slots=True, kw_only=True)
class OrderFree(Fact):
    """`The order does not matter`."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StepsOrdered(Fact):
    """`Always do step 2 before step 5`."""

    first: Steps
    second: Steps


@dataclass(frozen=True, slots=True, kw_only=True)
class LeaveOut(Fact):
    """`Leave out what does not fit`: each task may be."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundsDriven(Fact):
    """`Steps 2 and 3 are a round that is driven three times`."""

    steps: Steps
    count: int
