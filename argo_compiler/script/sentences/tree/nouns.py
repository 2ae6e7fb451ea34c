"""Noun phrases: which checkpoints are meant. Nothing is looked up yet."""

from enum import StrEnum

from argo_compiler.base.catalog import CheckpointKind
from argo_compiler.script.sentences.tree.node import Node, node
from argo_compiler.script.sentences.tree.places import FloorName


class Kind(StrEnum):
    """What a noun says that it is of; `gauge` may be a pressure or a level gauge."""

    CHECKPOINT = "checkpoint"
    GAUGE = "gauge"
    PRESSURE_GAUGE = CheckpointKind.PRESSURE_GAUGE
    LIQUID_LEVEL_GAUGE = CheckpointKind.LIQUID_LEVEL_GAUGE
    VALVE = CheckpointKind.VALVE


class Quantity(StrEnum):
    """What a script asks to be read."""

    VALUE = "value"
    POSITION = "position"
    LEVEL = "level"
    PRESSURE = "pressure"


@node
class Labelled(Node):
    """`valve R25`, `#8`, `pressure gauges 5 to 7`: by a number or an identifier."""

    label: int | str
    kind: Kind | None = None
    """None: as the one before it in the list, if it says one"""
    plural: bool = False
    """whether the kind is said of several"""
    hash: bool = False
    """`#8`, `no. 8`: a checkpoint's number, whatever kind it is"""
    last: int | str | None = None
    """of a range"""
    floors: tuple[FloorName, ...] = ()
    """where it is said to be"""
    quantity: Quantity | None = None
    also: "Labelled | None" = None
    """the same by its other name: `pressure gauge 5 (checkpoint #8)`"""


@node
class AllOf(Node):
    """`all valves on the second floor`."""

    kind: Kind
    floors: tuple[FloorName, ...] = ()
    """none: the whole site"""
    count: int | None = None
    """how many there are, if that is said: `both valves`"""
    whole: bool = False
    """`everything`, `the whole round`: of no kind"""


@node
class TheOne(Node):
    """`the valve on the third floor`: the only one of its kind there, or what was measured last."""

    kind: Kind
    floors: tuple[FloorName, ...] = ()
    plural: bool = False
    """`the valves on the third floor`"""


@node
class Pronoun(Node):
    """What was measured last: `it`, `the value`; or all that was: `both`, `them`."""

    every: bool = False
    either: bool = False
    """`one of them`"""
    or_one: bool = False
    """as `sie` in German, which may be one of them as well"""
    count: int | None = None
    """how many they are, if that is said: `the same four`"""
    kind: Kind | None = None
    quantity: Quantity | None = None
    """of `the value`, `the level`: what is asked for"""


Noun = Labelled | AllOf | TheOne | Pronoun


@node
class Nouns(Node):
    """A list of them."""

    nouns: tuple[Noun, ...]
    but: tuple[Noun, ...] = ()
    """what is left out of them"""
    either: bool = False
    """joined by `or`"""
    parted: bool = False
    """whether a comma stands before the second of two: `1, and 4`"""
