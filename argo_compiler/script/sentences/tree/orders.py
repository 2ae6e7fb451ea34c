"""Orders: what the robot is to do, and changes of the plan; facts; and sentences of both."""

from dataclasses import replace
from enum import StrEnum
from typing import Self

from argo_compiler.script.sentences.tree.conditions import SaidCondition
from argo_compiler.script.sentences.tree.manner import NOTHING_SAID, Manner
from argo_compiler.script.sentences.tree.node import Node, node
from argo_compiler.script.sentences.tree.nouns import Nouns
from argo_compiler.script.sentences.tree.places import DockLocation, FloorName, Location, Steps


@node
class ScriptOrder(Node):
    """Something to do."""

    name: str | None = None
    """of the task or the round, if the script gives one"""
    manner: Manner = NOTHING_SAID
    joint: str = ""
    """what stood before it: `, and`"""

    def joined(self, joint: str) -> Self:
        """The order with what stood before it."""
        return replace(self, joint=joint)


@node
class Measure(ScriptOrder):
    """`Check the checkpoint #14`."""

    what: Nouns
    bare: bool = False
    """only named, as in a list"""
    keep: bool = False
    """`keep reading`"""
    passive: bool = False
    """`valve R25 has to be read`"""


@node
class VisitOrder(ScriptOrder):
    """`Drive to checkpoint 5 at 0.3 m/s`: on the way to what is measured there."""

    what: Nouns


@node
class Go(ScriptOrder):
    """`Go to the front of the site`."""

    where: Location | FloorName


@node
class Home(ScriptOrder):
    """`Return to the docking station`, `go home`."""

    dock: DockLocation


@node
class Start(ScriptOrder):
    """`Set a starting point in front of the site`; with `here` it stays where the line stands."""

    where: Location | None
    here: bool = False
    ends_there: bool = False
    """`start and end in starting area 1`"""


@node
class Patrol(ScriptOrder):
    """`Patrol the first floor in circles for 10 minutes`."""

    places: tuple[FloorName | Location, ...]


@node
class WaitOrder(ScriptOrder):
    """`Wait 90 s`, `wait until #1 is below 3`, `wait for the all-clear`."""

    where: Location | FloorName | None = None
    """None: where it is"""
    stays: bool = False
    """`stay there`: in its dock it waits for nothing"""
    recharges: bool = False
    """`recharge`: it waits for the battery"""


class PlainWord(StrEnum):
    """Orders of one word."""

    PAUSE = "pause"
    END = "end the mission"
    ABORT = "abort the mission"
    GO_ON = "go on"
    RECHARGE = "recharge"
    REPORT = "report it"
    DONE = "done"
    MEET = "go on here"


@node
class Plain(ScriptOrder):
    """An order that needs nothing else."""

    word: PlainWord


@node
class Amend(ScriptOrder):
    """Manner by itself: of what stands before it, or behind it after a colon."""


@node
class Follow(ScriptOrder):
    """`Do the following twice:`, of the steps within this one."""


@node
class Retry(ScriptOrder):
    """`retry twice`."""

    again: bool = False
    """whether it may be meant as once more, too: `repeat the reading`"""
    every: bool = False
    """`retry all twice`"""


@node
class Jump(ScriptOrder):
    """`go to step 5`."""

    step: Steps


@node
class Repeat(ScriptOrder):
    """`Repeat steps 2 to 4 three times`."""

    steps: Steps | None
    """None: all"""
    last: bool = False
    """`repeat this`: what was said last"""
    again: bool = True
    """`repeat`, and not `do` or `run through`, which may be the first time"""


class Side(StrEnum):
    """Where something is put."""

    BEFORE = "before"
    AFTER = "after"


@node
class Add(ScriptOrder):
    """`Add checkpoint #2 after checkpoint #14`."""

    what: Nouns
    side: Side
    anchor: Nouns | Steps


@node
class Beside(ScriptOrder):
    """`Before you read liquid level gauge 2, check valve R12`: both, in this order."""

    order: Measure
    side: Side
    anchor: Nouns


@node
class Delete(ScriptOrder):
    """`Delete the measuring of checkpoint #2`."""

    what: Nouns | Steps


@node
class Spare(ScriptOrder):
    """`Don't check checkpoint 19`."""

    what: Nouns


@node
class Move(ScriptOrder):
    """`Move checkpoint #4 before checkpoint #1`."""

    what: Nouns | Steps
    side: Side
    anchor: Nouns | Steps


@node
class Replace(ScriptOrder):
    """`Replace checkpoint #1 by checkpoint #2`."""

    what: Nouns | Steps
    by: Nouns


class Rest(StrEnum):
    """When a case without a condition is meant."""

    OTHERWISE = "otherwise"
    """if the condition before it does not hold"""
    ALL_OTHERS = "in all other cases"
    """if no condition of its task holds, also none that follows"""
    LAST_ROUND = "after the last round"
    """likewise, where the round ends that is not repeated any more"""


@node
class Case(Node):
    """`If ..., A and B`; without a condition: `otherwise A and B`."""

    condition: SaidCondition | None
    orders: tuple[ScriptOrder, ...]
    rest: Rest = Rest.OTHERWISE
    chained: bool = False
    """`otherwise, if ...`; `otherwise` without a condition as well"""


class Placing(StrEnum):
    """Where a word says that something stands."""

    AT_END = "AT_END"
    """`at the end`, `finally`"""
    AT_BEGIN = "AT_BEGIN"
    """`first of all`; `first` at the end of a sentence"""
    THERE = "THERE"
    INSTEAD = "INSTEAD"


@node
class Placed(Node):
    """A word of an order that says where it stands: `Finally check 4`."""

    placing: Placing
    orders: int
    """how many of the sentence's orders begin before it"""


# ---- what a sentence says of the mission as a whole


@node
class Fact(Node):
    """Something that holds for the whole mission."""


@node
class MaxDuration(Fact):
    """`The mission may take 20 minutes at most`, `it has to be back in area 1 within 35 min`."""

    seconds: float
    where: Location | None = None
    """where it has to be by then"""


@node
class DoneBefore(Fact):
    """`Checkpoint 7 has to be read before checkpoint 18`, `always do step 2 before step 5`."""

    first: Nouns | Steps
    second: Nouns | Steps


@node
class OrderFree(Fact):
    """`The order does not matter`."""


@node
class LeaveOut(Fact):
    """`Leave out what does not fit`: each task may be."""


@node
class RoundsDriven(Fact):
    """`Steps 2 and 3 are a round that is driven three times`."""

    steps: Steps
    count: int


@node
class Sentence(Node):
    """Orders, then cases in the order in which they are said."""

    orders: tuple[ScriptOrder, ...] = ()
    cases: tuple[Case, ...] = ()
    facts: tuple[Fact, ...] = ()
    """what is said of the mission beside: `but checkpoint 9 before checkpoint 14`"""
    placed: tuple[Placed, ...] = ()
    """where it says that it stands"""
