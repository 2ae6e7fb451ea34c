"""Abstract domain of readings: bit sets of the regions in which a checkpoint's last value may lie.

The bounds that a mission compares an object with divide the number line into finitely many regions:
the bounds themselves, the open intervals between them, and the two rays outside. A set of regions
is an integer with one bit for each region, from the lowest one up. The four topmost bits say that
there may be no reading, an unreadable one, an unreachable one, or a failed one. The sets of all
objects are packed into one long integer, so that a single `|` joins the states of two paths.
"""

from bisect import bisect_left
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.base.catalog import Interval
from argo_compiler.base.listing import listed
from argo_compiler.base.message import Listing, Message
from argo_compiler.il import Condition, ConditionType


@dataclass(frozen=True)
class Scale:
    """Regions of the values of one object."""

    bounds: tuple[float, ...]
    """ascending; region 2k + 1 is bound k itself, region 2k lies below it"""
    possible: int
    """regions in which a measured value can lie"""
    abnormal: int = -1
    """regions of the values that the robot may call abnormal; -1 for all regions"""

    @cached_property
    def missing_bit(self) -> int:
        """Mask of the bit that says: there may be no reading."""
        return 1 << (2 * len(self.bounds) + 1)

    @cached_property
    def unreadable_bit(self) -> int:
        """Mask of the bit that says: the reading may be unreadable."""
        return self.missing_bit << 1

    @cached_property
    def unreachable_bit(self) -> int:
        """Mask of the bit that says: the checkpoint may have been unreachable."""
        return self.missing_bit << 2

    @cached_property
    def otherwise_failed_bit(self) -> int:
        """Mask of the bit that says: the reading may have failed for another reason."""
        return self.missing_bit << 3

    @cached_property
    def failed_bits(self) -> int:
        """Mask of all bits of failed readings, unreadable and unreachable ones included."""
        return self.unreadable_bit | self.unreachable_bit | self.otherwise_failed_bit

    @cached_property
    def without_value_bits(self) -> int:
        return self.missing_bit | self.failed_bits

    @cached_property
    def width(self) -> int:
        """Number of bits of a set of readings."""
        return 2 * len(self.bounds) + 5

    @cached_property
    def all_bits(self) -> int:
        """Mask of all bits: of all values, of no reading, and of failed ones."""
        return (1 << self.width) - 1

    def satisfying_bits(self, condition: Condition) -> int:
        """Return the bits of the readings that satisfy a condition on this object at some age."""
        match condition.type:
            case ConditionType.UNREADABLE:
                return self.unreadable_bit
            case ConditionType.UNREACHABLE:
                return self.unreachable_bit
            case ConditionType.FAILED:
                return self.failed_bits
            case ConditionType.STALE:
                return self.missing_bit - 1
            case ConditionType.ABNORMAL:
                return (self.missing_bit - 1) & self.abnormal
        low, high = condition.param1, condition.param2
        if low is None:
            return 0
        if condition.type is ConditionType.LESS:
            return self._below(low, condition.inclusive)
        if condition.type is ConditionType.GREATER:
            return self._above(low, condition.inclusive)
        if high is None:
            return 0
        return self._above(low, condition.inclusive) & self._below(high, condition.inclusive)

    def regions_text(self, regions: int) -> str:
        """Format a set of regions for people, such as `below 2, 5 or 7 to 9`."""
        pieces = []
        k = 0
        count = 2 * len(self.bounds) + 1
        while k < count:
            if not regions >> k & 1:
                k += 1
                continue
            first = k
            while k < count and regions >> k & 1:
                k += 1
            pieces.append(self._stretch(first, k - 1))
        return listed(pieces, "or") or Message("nothing")

    def _stretch(self, first: int, last: int) -> str:
        low = None if first == 0 else self.bounds[(first - 1) // 2]
        high = None if last == 2 * len(self.bounds) else self.bounds[last // 2]
        if low is None and high is None:
            return Message("any value")
        if low is None:
            if last % 2:
                return Message("at most {high:g}", high=high)
            return Message("below {high:g}", high=high)
        if high is None:
            if first % 2:
                return Message("at least {low:g}", low=low)
            return Message("above {low:g}", low=low)
        if low == high:
            return Message("{low:g}", low=low)
        open_ends = [
            *([] if first % 2 else [Message("{low:g}", low=low)]),
            *([] if last % 2 else [Message("{high:g}", high=high)]),
        ]
        return Message("{low:g} to {high:g}", low=low, high=high) + (
            Message(" (without {open_ends:and})", open_ends=Listing(open_ends)) if open_ends else ""
        )

    def _below(self, bound: float, inclusive: bool) -> int:
        at = bisect_left(self.bounds, bound)
        return (1 << (2 * at + 1 + inclusive)) - 1

    def _above(self, bound: float, inclusive: bool) -> int:
        everything = self.missing_bit - 1
        return everything & ~self._below(bound, not inclusive)


def make_scale(
    conditions: Iterable[Condition], range_: Interval | None, nominal: Interval | None = None
) -> Scale:
    """Return the regions that the conditions on one object distinguish.

    Args:
        conditions: All conditions on the object.
        range_: Interval of the values that can be measured; None if it is unknown.
        nominal: Interval outside of which a value may be called abnormal; None if it is unknown.
    """
    bounds: set[float] = set()
    abnormal = False
    for condition in conditions:
        abnormal = abnormal or condition.type is ConditionType.ABNORMAL
        if condition.param1 is not None:
            bounds.add(condition.param1)
        if condition.param2 is not None:
            bounds.add(condition.param2)
    if range_ is not None:
        bounds |= {range_.low, range_.high}
    if abnormal and nominal is not None:
        bounds |= {nominal.low, nominal.high}
    # -0.0 and 0.0 are the same bound, as a set has only one of two equal floats.
    ordered = tuple(sorted(bounds))
    scale = Scale(ordered, 0)
    possible = scale.missing_bit - 1
    if range_ is not None:
        possible &= scale._above(range_.low, True) & scale._below(range_.high, True)
    if not abnormal or nominal is None:
        return Scale(ordered, possible)
    normal = scale._above(nominal.low, True) & scale._below(nominal.high, True)
    return Scale(ordered, possible, (scale.missing_bit - 1) & ~normal)


@dataclass(frozen=True)
class Fields:
    """Layout of the objects' sets in the long integer, which is called a state."""

    scales: Mapping[str, Scale]
    """for every object that a condition compares"""
    shift: Mapping[str, int]
    """number of the first bit of each tracked object; an object without it may have any reading"""
    width: int
    """total number of bits"""

    @property
    def unmeasured_state(self) -> int:
        """State at the mission's start: no object has a reading."""
        return union_of_bits(self.scales[o].missing_bit << shift for o, shift in self.shift.items())

    @property
    def any_readings_state(self) -> int:
        """State in which each tracked object may have any reading, or none."""
        return (1 << self.width) - 1

    def get(self, state: int, object_id: str) -> int:
        scale = self.scales[object_id]
        shift = self.shift.get(object_id)
        if shift is None:
            return scale.possible | scale.without_value_bits
        return (state >> shift) & scale.all_bits

    def set(self, state: int, object_id: str, regions: int) -> int:
        shift = self.shift.get(object_id)
        if shift is None:
            return state
        old = (state >> shift) & self.scales[object_id].all_bits
        return state ^ ((old ^ regions) << shift)


def union_of_bits(parts: Iterable[int]) -> int:
    """Return the union of bit sets.

    It is computed in pairs, so that few intermediate results are long.
    """
    pending = list(parts)
    while len(pending) > 1:
        pending = [
            pending[i] | (pending[i + 1] if i + 1 < len(pending) else 0)
            for i in range(0, len(pending), 2)
        ]
    return pending[0] if pending else 0
