"""Readings that a witness claims to be possible at each point of a mission, as bits.

The code shares nothing with the bit sets of the analysis but the format of the witnesses.
"""

from bisect import bisect_left
from collections.abc import Mapping
from functools import cached_property
from itertools import pairwise

from argo_compiler.analysis.verification_layout import END, ProgramPoint
from argo_compiler.analysis.witness import KeptReading
from argo_compiler.base.records import dataclass
from argo_compiler.il import Condition, ConditionType

Ranges = tuple[float, float, float, float]
"""of a checkpoint: low and high end of its values, low and high end of its nominal values"""


@dataclass(frozen=True)
class ClaimedScale:
    """Readings of one checkpoint, and the position of their bits in the states."""

    bounds: tuple[float, ...]
    shift: int
    values: int
    """bits of the values that the checkpoint may show"""
    abnormal: int
    """bits of the values that may be called abnormal"""

    @cached_property
    def missing_bit(self) -> int:
        return 1 << (2 * len(self.bounds) + 1)

    @cached_property
    def unreadable_bit(self) -> int:
        return self.missing_bit << 1

    @cached_property
    def unreachable_bit(self) -> int:
        return self.missing_bit << 2

    @cached_property
    def otherwise_failed_bit(self) -> int:
        return self.missing_bit << 3

    @cached_property
    def width(self) -> int:
        return 2 * len(self.bounds) + 5

    @cached_property
    def all_bits(self) -> int:
        return (1 << self.width) - 1

    def region_bits_overlapping(self, low: float, high: float) -> int:
        """Return the bits of the regions with a value from `low` to `high`, both included."""
        first, last = bisect_left(self.bounds, low), bisect_left(self.bounds, high)
        first_bit = 2 * first + (low in self.bounds[first : first + 1])
        last_bit = 2 * last + (high in self.bounds[last : last + 1])
        return (1 << (last_bit + 1)) - (1 << first_bit)

    def region_bits_up_to(self, bound: float, inclusive: bool) -> int | None:
        """Return the bits of the values below a bound, and of the bound itself if `inclusive`.

        Returns None if the bound is not one of the scale's bounds.
        """
        k = bisect_left(self.bounds, bound)
        if k == len(self.bounds) or self.bounds[k] != bound:
            return None
        return (1 << (2 * k + 1 + inclusive)) - 1

    def satisfying_bits(self, condition: Condition) -> int:
        """Return the bits of the readings that may satisfy a condition at some age."""
        all_values = self.missing_bit - 1
        match condition.type:
            case ConditionType.UNREADABLE:
                return self.unreadable_bit
            case ConditionType.UNREACHABLE:
                return self.unreachable_bit
            case ConditionType.FAILED:
                return self.unreadable_bit | self.unreachable_bit | self.otherwise_failed_bit
            case ConditionType.STALE:
                return all_values
            case ConditionType.ABNORMAL:
                return self.abnormal
        low, high = condition.param1, condition.param2
        if low is None:
            return 0
        if condition.type is ConditionType.LESS:
            below = self.region_bits_up_to(low, condition.inclusive)
            return all_values if below is None else below
        above = self.region_bits_up_to(low, not condition.inclusive)
        held = all_values if above is None else all_values & ~above
        if condition.type is ConditionType.WITHIN and high is not None:
            below = self.region_bits_up_to(high, condition.inclusive)
            held &= all_values if below is None else below
        return held

    def is_exact_for(self, condition: Condition) -> bool:
        """Return True if a condition is true for all or for none of the values of each bit."""
        return not condition.type.compares or all(
            self.region_bits_up_to(bound, False) is not None for bound in compared_bounds(condition)
        )


def compared_bounds(condition: Condition) -> list[float]:
    """Return the bounds with which a condition compares values."""
    return [bound for bound in (condition.param1, condition.param2) if bound is not None]


@dataclass
class ClaimedStates:
    """Claimed readings at each point, those of all checkpoints packed into one integer."""

    readings: dict[ProgramPoint, int]
    late: dict[ProgramPoint, int]
    """for each point, the readings that an action being cancelled may still report there (I3)"""
    scales: dict[str, ClaimedScale]
    width: int
    """total number of bits"""

    def add_scale(
        self, object_id: str, bounds: tuple[float, ...], shift: int, ranges: Mapping[str, Ranges]
    ) -> bool:
        """Add the scale of a checkpoint, with its bits from `shift` on; return True if added.

        Returns False, without a change, if the checkpoint has a scale already, if its bits do not
        lie above those of the others, or if the bounds do not ascend.
        """
        if object_id in self.scales or shift < self.width:
            return False
        if any(not a < b for a, b in pairwise(bounds)):
            return False
        scale = ClaimedScale(bounds, shift, 0, 0)
        values = abnormal = scale.missing_bit - 1
        if object_id in ranges:
            low, high, normal_low, normal_high = ranges[object_id]
            values = scale.region_bits_overlapping(low, high)
            # A region has only nominal values if it lies within their bounds.
            first, last = bisect_left(bounds, normal_low), bisect_left(bounds, normal_high)
            if normal_low in bounds[first : first + 1] and normal_high in bounds[last : last + 1]:
                abnormal &= ~scale.region_bits_overlapping(normal_low, normal_high)
        self.scales[object_id] = ClaimedScale(bounds, shift, values, abnormal)
        self.width = shift + scale.width
        return True

    def cancelled_measurement_readings(self, object_id: str, failures: bool) -> int:
        """Return the bits of the readings that a cancelled measurement may still report.

        It may succeed before it is cancelled; with failures, also without a value.
        """
        scale = self.scales[object_id]
        return (scale.values | (scale.unreadable_bit if failures else 0)) << scale.shift

    def contains(self, point: ProgramPoint, state: int, late_readings: int) -> bool:
        """Return True if the readings after a step to a point are among those claimed for it.

        `state` has the possible readings, `late_readings` those that a cancelled action may still
        report there.
        """
        known = self.readings.get(point)
        if known is None or late_readings & ~self.late.get(point, 0):
            return False
        return not (state | late_readings) & ~known

    def continues_with_kept_readings(
        self, point: ProgramPoint, state: int, kept: KeptReading | None
    ) -> bool:
        """Return True if a step to a point does not end the mission and keeps a trap's readings.

        With `kept` None, the readings may be any. Whether the point is one of the trap's is not
        checked.
        """
        if point == END or kept is None:
            return point != END
        return not self.get(state, kept.object_id) & ~kept.readings

    def get(self, state: int, object_id: str) -> int:
        scale = self.scales[object_id]
        return state >> scale.shift & scale.all_bits

    def set(self, state: int, object_id: str, readings: int) -> int:
        scale = self.scales[object_id]
        return state & ~(scale.all_bits << scale.shift) | readings << scale.shift

    def restricted_to(
        self, kept: KeptReading, ranges: Mapping[str, Ranges]
    ) -> "ClaimedStates | None":
        """Return the states with one checkpoint restricted to the readings that a loop keeps.

        Returns None if the bounds or the readings are not valid.
        """
        states = ClaimedStates({}, dict(self.late), dict(self.scales), self.width)
        old = states.scales.pop(kept.object_id, None)
        if not states.add_scale(kept.object_id, kept.bounds, states.width, ranges):
            return None
        scale = states.scales[kept.object_id]
        if not 0 < kept.readings <= scale.all_bits:
            return None
        hole = 0 if old is None else old.all_bits << old.shift
        for point, state in self.readings.items():
            states.readings[point] = state & ~hole | kept.readings << scale.shift
        return states
