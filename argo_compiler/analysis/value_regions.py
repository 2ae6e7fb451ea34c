"""Sets of values as bits: which stretches of a checkpoint's scale its last value may lie in.

The bounds that a mission compares an object with cut the line of values into finitely many regions:
the bounds themselves, the open intervals between them, and the two rays outside. A set of regions
is a number with one bit each, from the lowest region up. Three more bits, the topmost, say that
there may be no reading, an unreadable one, or a failed one. The sets of all objects lie beside each
other in one long number, so that joining what is known on two paths is a single `|`.
"""

from bisect import bisect_left
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from argo_compiler.base.catalog import Interval
from argo_compiler.base.listing import listed
from argo_compiler.il import Condition, ConditionType


@dataclass(frozen=True)
class Scale:
    """The regions of one object."""

    bounds: tuple[float, ...]
    """ascending; region 2k + 1 is bound k itself, region 2k lies below it"""
    possible: int
    """the regions that a measured value can lie in"""
    abnormal: int = -1
    """the regions of values that the robot may call abnormal; -1: all of them"""

    @cached_property
    def missing(self) -> int:
        """The bit for: there may be no reading."""
        return 1 << (2 * len(self.bounds) + 1)

    @cached_property
    def unreadable(self) -> int:
        """The bit for: the reading may be unreadable."""
        return self.missing << 1

    @cached_property
    def failed(self) -> int:
        """The bit for: the reading may have failed otherwise."""
        return self.missing << 2

    @cached_property
    def without_value(self) -> int:
        return self.missing | self.unreadable | self.failed

    @cached_property
    def width(self) -> int:
        """How many bits a set takes."""
        return 2 * len(self.bounds) + 4

    @cached_property
    def full(self) -> int:
        """All bits of a set."""
        return (1 << self.width) - 1

    def satisfying(self, condition: Condition) -> int:
        """What a reading may be that satisfies a condition on this object, its age apart."""
        match condition.type:
            case ConditionType.UNREADABLE:
                return self.unreadable
            case ConditionType.FAILED:
                return self.unreadable | self.failed
            case ConditionType.STALE:
                return self.missing - 1
            case ConditionType.ABNORMAL:
                return (self.missing - 1) & self.abnormal
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

    def words(self, regions: int) -> str:
        """A set of regions for people: `below 2, 5 or 7 to 9`."""
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
        return listed(pieces, "or") or "nothing"

    def _stretch(self, first: int, last: int) -> str:
        low = None if first == 0 else self.bounds[(first - 1) // 2]
        high = None if last == 2 * len(self.bounds) else self.bounds[last // 2]
        if low is None and high is None:
            return "any value"
        if low is None:
            return f"{'at most' if last % 2 else 'below'} {high:g}"
        if high is None:
            return f"{'at least' if first % 2 else 'above'} {low:g}"
        if low == high:
            return f"{low:g}"
        open_ends = [
            *([] if first % 2 else [f"{low:g}"]),
            *([] if last % 2 else [f"{high:g}"]),
        ]
        return f"{low:g} to {high:g}" + (
            f" (without {' and '.join(open_ends)})" if open_ends else ""
        )

    def _below(self, bound: float, inclusive: bool) -> int:
        at = bisect_left(self.bounds, bound)
        return (1 << (2 * at + 1 + inclusive)) - 1

    def _above(self, bound: float, inclusive: bool) -> int:
        everything = self.missing - 1
        return everything & ~self._below(bound, not inclusive)


def make_scale(
    conditions: Iterable[Condition], range_: Interval | None, nominal: Interval | None = None
) -> Scale:
    """The regions for the conditions on one object, measured values lying in `range_`, and those
    that are called abnormal outside `nominal`."""
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
    # -0.0 and 0.0 are one bound: a set keeps one of two equal floats.
    ordered = tuple(sorted(bounds))
    scale = Scale(ordered, 0)
    possible = scale.missing - 1
    if range_ is not None:
        possible &= scale._above(range_.low, True) & scale._below(range_.high, True)
    if not abnormal or nominal is None:
        return Scale(ordered, possible)
    normal = scale._above(nominal.low, True) & scale._below(nominal.high, True)
    return Scale(ordered, possible, (scale.missing - 1) & ~normal)


@dataclass(frozen=True)
class Fields:
    """Where the set of each object lies in the long number."""

    scales: Mapping[str, Scale]
    """of every object that a condition looks at"""
    shift: Mapping[str, int]
    """of those that are kept track of along the paths"""
    width: int
    """bits in all"""

    @property
    def unmeasured(self) -> int:
        """At the mission's start: no object has a value."""
        return sum_bits(self.scales[o].missing << shift for o, shift in self.shift.items())

    @property
    def anything(self) -> int:
        return (1 << self.width) - 1

    def get(self, state: int, object_id: str) -> int:
        scale = self.scales[object_id]
        shift = self.shift.get(object_id)
        if shift is None:
            return scale.possible | scale.without_value
        return (state >> shift) & scale.full

    def set(self, state: int, object_id: str, regions: int) -> int:
        shift = self.shift.get(object_id)
        if shift is None:
            return state
        old = (state >> shift) & self.scales[object_id].full
        return state ^ ((old ^ regions) << shift)


def sum_bits(parts: Iterable[int]) -> int:
    """The union of sets that don't overlap, without a long number for each intermediate one."""
    pending = list(parts)
    while len(pending) > 1:
        pending = [
            pending[i] | (pending[i + 1] if i + 1 < len(pending) else 0)
            for i in range(0, len(pending), 2)
        ]
    return pending[0] if pending else 0
