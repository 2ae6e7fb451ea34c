"""Where a mission stands: its task, its groups with their rounds and clocks, and its readings."""

import math
from dataclasses import dataclass

from argo_compiler.hfsm.conditions import CheckpointReading
from argo_compiler.hfsm.tables import CompiledTransition, GroupNode, Guard, LeafNode, Tables
from argo_compiler.hfsm.visits import TaskVisit

_NEVER = math.inf


@dataclass(slots=True, eq=False)
class Frame:
    """A group that is active: the round it is in, from 1, and its clock (s) when it was entered."""

    group: GroupNode
    round: int
    entered: float


class Configuration:
    """The one place of a mission. It changes with each step.

    Visits and readings go by the executor's clock. That of the groups stands while the mission is
    interrupted, and what was done by hand advances it, except for groups that count interruptions.
    """

    __slots__ = (
        "_has_hard_groups",
        "began",
        "by_hand_s",
        "due",
        "frames",
        "interrupted_at",
        "interrupted_s",
        "numbers",
        "own_due",
        "readings",
        "round_of",
        "timed_out",
        "visit",
    )

    def __init__(self, tables: Tables) -> None:
        self._has_hard_groups = tables.has_hard_groups
        self.began = 0.0
        """s, when the mission was started"""
        self.numbers = 0
        """how many visits and turns there have been; a drive of a reaction is a turn"""
        self.visit = TaskVisit(None, 0, 0, 0.0)
        self.frames: list[Frame] = []
        """the active groups, outermost first"""
        self.round_of: Frame | None = None
        """the one whose round begins with this visit and has not begun yet"""
        self.readings: dict[str, CheckpointReading] = {}
        """by checkpoint"""
        self.by_hand_s = 0.0
        """s that were done by hand"""
        self.interrupted_s = 0.0
        """s of interruptions that are over"""
        self.interrupted_at: float | None = None
        """since when the mission has been interrupted (s)"""
        self.due = math.inf
        """when the time of a group with a hard stop is up next (s); never while interrupted"""
        self.timed_out: GroupNode | None = None
        """that group; of several at the same time the outermost, as leaving it leaves them all"""
        self.own_due = math.inf
        """when the present visit's own times bring something about (s); never while interrupted"""

    @property
    def leaf(self) -> LeafNode | None:
        """The task that the mission stands at."""
        return self.visit.leaf

    def new_number(self) -> int:
        self.numbers += 1
        return self.numbers

    def clock(self, now: float, group: GroupNode) -> float:
        """The clock that a group goes by (s)."""
        return self._at(now, group) + self._ahead(group)

    def take(self, ways: tuple[CompiledTransition, ...], now: float) -> CompiledTransition:
        """Goes the first way that can be taken, and returns it."""
        if self.round_of is not None:
            self.begin_round(now)
        while True:
            for way in ways:
                if way.free or self._possible(way, now):
                    break
            if way.completes is None:
                break
            ways = way.completes.ways
        repeated = way.repeats
        if repeated is not None:
            self.frames[repeated.depth].round += 1
        self._enter(way.target, way.keep, way.domain, now)
        if repeated is not None and repeated.every:
            self._await_round(self.frames[repeated.depth], now)
        return way

    def enter(self, leaf: LeafNode | None, now: float) -> None:
        """Begins the mission."""
        self._enter(leaf, 0, None, now)

    def interrupt(self, now: float) -> None:
        if self.interrupted_at is None:
            self.interrupted_at = now
            # An action is started anew afterwards, even if the driver hears of it when it is over.
            self.visit.turn = self.new_number()
            self.due = self.own_due = self.visit.action_due = math.inf

    def go_on(self, now: float) -> None:
        """The groups' clocks run again; what is due by now is due now."""
        if self.interrupted_at is not None:
            self.interrupted_s += now - self.interrupted_at
            self.interrupted_at = None
        self.look(now)
        self._find_due(now)

    def advance_clocks(self, seconds: float, now: float) -> None:
        """Adds the time that a task done by hand took."""
        if seconds:
            self.by_hand_s += seconds
            self._find_due(now)

    def read(self, object_id: str, reading: CheckpointReading | None, now: float) -> None:
        """Takes note of a reading, or that there is none any more."""
        if reading is None:
            self.readings.pop(object_id, None)
        else:
            self.readings[object_id] = reading
        self.reading_changed(now)

    def reading_changed(self, now: float) -> None:
        """A WAIT that the mission stands at looks at it."""
        if self.visit.leaf is not None and self.visit.leaf.wait is not None:
            self.look(now)

    def look(self, now: float) -> None:
        """The conditions of a WAIT are looked at now, or as soon as the mission goes on."""
        self.visit.look_at = now
        self.find_own_due()

    def hold(self, guards: tuple[Guard, ...], now: float) -> bool:
        """Whether all of the conditions hold."""
        readings = self.readings
        for object_id, test in guards:
            reading = readings.get(object_id)
            if reading is None or not test(reading, now):
                return False
        return True

    def begin_round(self, now: float) -> None:
        """The round that was waited for begins, and with it this visit."""
        frame = self.round_of
        assert frame is not None
        self.round_of = None
        self.visit.since = self.visit.look_at = now
        for inner in self.frames[frame.group.depth + 1 :]:
            inner.entered = self.clock(now, inner.group)
        self._find_due(now)
        self.find_own_due()

    @property
    def round_at(self) -> float:
        """When the round that is waited for is due (s), if no clock stands."""
        frame = self.round_of
        return math.inf if frame is None else self._round_at(frame)

    def find_own_due(self) -> None:
        """What the present visit waits for may have changed."""
        visit, leaf = self.visit, self.visit.leaf
        self.own_due = math.inf
        if leaf is None or self.interrupted_at is not None:
            return
        if self.round_of is not None:
            self.own_due = self.round_at  # no window is missed before it
        elif leaf.timed or visit.action_due < math.inf:
            self.own_due = visit.due(self.began)

    def leave(self) -> None:
        """The mission has ended, whatever it was doing."""
        number = self.new_number()
        self.visit = TaskVisit(None, number, number, 0.0)
        self.frames.clear()
        self.round_of = None
        self.due = self.own_due = math.inf

    def _possible(self, way: CompiledTransition, now: float) -> bool:
        group = way.repeats
        if group is not None:
            frame = self.frames[group.depth]
            if group.count and frame.round >= group.count:
                return False
            if group.duration and (
                self._at(now, group) >= self._time_up(frame)
                or frame.round * group.every >= group.duration
            ):
                return False
            return not group.until or not self.hold(group.until, now)
        return not way.guards or self.hold(way.guards, now)

    def _enter(
        self, leaf: LeafNode | None, keep: int, domain: GroupNode | None, now: float
    ) -> None:
        """Leaves all below `domain`, which is the last of `keep` groups, and enters the leaf."""
        self.numbers = number = self.numbers + 1
        visit = self.visit  # used again, which takes less time than a new one
        visit.leaf = leaf
        visit.number = visit.turn = number
        visit.since = visit.look_at = now
        visit.attempt = 0
        visit.occurred = False
        visit.action_due = _NEVER
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
        self.own_due = _NEVER
        if leaf is not None and leaf.timed:
            self.find_own_due()

    def _await_round(self, frame: Frame, now: float) -> None:
        if self._round_at(frame) > self._at(now, frame.group):
            self.round_of = frame
            self._find_due(now)
            self.find_own_due()

    def _round_at(self, frame: Frame) -> float:
        group = frame.group
        return frame.entered + (frame.round - 1) * group.every - self._ahead(group)

    def _find_due(self, now: float) -> None:
        self.due = math.inf
        if self.interrupted_at is not None:
            return
        begun = self.frames
        if self.round_of is not None:
            begun = begun[: self.round_of.group.depth + 1]
        for frame in begun:
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
        return 0.0 if group.counts_interruptions else self.by_hand_s - self.interrupted_s

    def _time_up(self, frame: Frame) -> float:
        """When the duration of a group is over (s), if its clock stood no more."""
        return frame.entered + frame.group.duration - self._ahead(frame.group)
