"""Where a mission stands: its task, its groups with their rounds and clocks, and its values."""

import math
from dataclasses import dataclass

from argo_compiler.hfsm.tables import CompiledTransition, GroupNode, LeafNode, Tables


@dataclass(slots=True, eq=False)
class Frame:
    """A group that is active: the round it is in, from 1, and its clock (s) when it was entered."""

    group: GroupNode
    round: int
    entered: float


class Configuration:
    """The one place of a mission. It changes with each step.

    There are two clocks. That of the values is `now` and the durations of what was done by hand.
    That of the groups stands besides while the mission is interrupted, except for groups that
    count interruptions.
    """

    __slots__ = (
        "_has_hard_groups",
        "attempt",
        "due",
        "frames",
        "interrupted_at",
        "leaf",
        "shift",
        "stood",
        "timed_out",
        "values",
        "visit",
        "visits",
    )

    def __init__(self, tables: Tables) -> None:
        self._has_hard_groups = tables.has_hard_groups
        self.leaf: LeafNode | None = None
        self.visits = 0
        """how many visits there have been; the drives of reactions count as well"""
        self.visit = 0
        """the number of the present one: tells two visits of a task apart"""
        self.attempt = 0
        """failures of the action in this visit"""
        self.frames: list[Frame] = []
        """the active groups, outermost first"""
        self.values: dict[str, tuple[float, float]] = {}
        """the last value by checkpoint, and the clock when it was measured"""
        self.shift = 0.0
        """s that were done by hand"""
        self.stood = 0.0
        """s of interruptions that are over"""
        self.interrupted_at: float | None = None
        """since when the mission has been interrupted (s)"""
        self.due = math.inf
        """when the time of a group with a hard stop is up next (s); never while interrupted"""
        self.timed_out: GroupNode | None = None
        """that group; of several at the same time the outermost, as leaving it leaves them all"""

    def new_visit(self) -> int:
        self.visits += 1
        return self.visits

    def clock(self, now: float, group: GroupNode) -> float:
        """The clock that a group goes by (s)."""
        return self._at(now, group) + self._ahead(group)

    def take(
        self, ways: tuple[CompiledTransition, ...], now: float
    ) -> tuple[CompiledTransition, GroupNode | None]:
        """Goes the first way that can be taken; returns it and the group that is repeated."""
        while True:
            for way in ways:
                if self._possible(way, now):
                    break
            if way.completes is None:
                break
            ways = way.completes.ways
        repeated = way.repeats
        if repeated is not None:
            self.frames[repeated.depth].round += 1
        self._enter(way.target, way.keep, way.domain, now)
        return way, repeated

    def enter(self, leaf: LeafNode | None, now: float) -> None:
        """Begins the mission."""
        self._enter(leaf, 0, None, now)

    def interrupt(self, now: float) -> None:
        if self.interrupted_at is None:
            self.interrupted_at = now
            self.due = math.inf

    def go_on(self, now: float) -> None:
        """The groups' clocks run again; what is due by now is due now."""
        if self.interrupted_at is not None:
            self.stood += now - self.interrupted_at
            self.interrupted_at = None
        self._find_due(now)

    def advance_clocks(self, seconds: float, now: float) -> None:
        """Adds the time that a task done by hand took."""
        self.shift += seconds
        self._find_due(now)

    def set_aside(self, seconds: float, now: float) -> None:
        """So much of the present interruption went into what was done by hand: its time is added
        when the machine comes to that, and is no part of the interruption."""
        if self.interrupted_at is not None:
            part = min(seconds, now - self.interrupted_at)
            self.shift -= part
            self.stood -= part

    def leave(self) -> None:
        """The mission has ended, whatever it was doing."""
        self.leaf = None
        self.visit = self.new_visit()
        self.frames.clear()
        self.due = math.inf

    def _possible(self, way: CompiledTransition, now: float) -> bool:
        group = way.repeats
        if group is not None:
            frame = self.frames[group.depth]
            if group.count and frame.round >= group.count:
                return False
            return not group.duration or self._at(now, group) < self._time_up(frame)
        for object_id, test, max_age in way.guards:
            measured = self.values.get(object_id)
            if measured is None or not test(measured[0]):
                return False
            if max_age is not None and now + self.shift - measured[1] > max_age:
                return False
        return True

    def _enter(
        self, leaf: LeafNode | None, keep: int, domain: GroupNode | None, now: float
    ) -> None:
        """Leaves all below `domain`, which is the last of `keep` groups, and enters the leaf."""
        self.leaf = leaf
        self.visits = self.visit = self.visits + 1
        self.attempt = 0
        frames = self.frames
        changed = len(frames) > keep
        if changed:
            del frames[keep:]
        if leaf is not None and leaf.parent is not domain:
            changed = True
            group = leaf.parent
            entered = []
            while group is not None and group is not domain:
                entered.append(Frame(group, 1, self.clock(now, group)))
                group = group.parent
            frames.extend(reversed(entered))
        if changed and self._has_hard_groups:
            self._find_due(now)

    def _find_due(self, now: float) -> None:
        self.due = math.inf
        if self.interrupted_at is not None:
            return
        for frame in self.frames:
            if frame.group.hard:
                at = max(self._time_up(frame), now)
                if at < self.due:
                    self.due, self.timed_out = at, frame.group

    def _at(self, now: float, group: GroupNode) -> float:
        """The time at which a group's clock has been read: the past one while it stands."""
        if self.interrupted_at is None or group.counts_interruptions:
            return now
        return self.interrupted_at

    def _ahead(self, group: GroupNode) -> float:
        """How far a group's clock is ahead of time (s), or behind it."""
        return self.shift if group.counts_interruptions else self.shift - self.stood

    def _time_up(self, frame: Frame) -> float:
        """When the duration of a group is over (s), if its clock stood no more."""
        return frame.entered + frame.group.duration - self._ahead(frame.group)
