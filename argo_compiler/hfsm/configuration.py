"""State of a mission under way: its task, its groups with rounds and clocks, and its readings."""

import math
from dataclasses import dataclass

from argo_compiler.hfsm.conditions import CheckpointReading
from argo_compiler.hfsm.tables import CompiledTransition, GroupNode, Guard, LeafNode, Tables
from argo_compiler.hfsm.trace import TracedRound, new_tuple
from argo_compiler.hfsm.visits import TaskVisit

_NEVER = math.inf


@dataclass(slots=True, eq=False)
class Frame:
    """Active group: its current round, from 1, and the group's clock (s) when it was entered."""

    group: GroupNode
    round: int
    entered: float


class Configuration:
    """Active states of a mission and their clocks. Each step changes them in place.

    Visits and readings use the executor's clock. The clock of a group stops while the mission is
    interrupted, and advances by the duration of tasks done by hand; groups that count interruptions
    ignore both.
    """

    __slots__ = (
        "_has_hard_groups",
        "awaited_round",
        "by_hand_s",
        "due_group",
        "frames",
        "group_due",
        "interrupted_at",
        "interrupted_s",
        "last_number",
        "readings",
        "started_at",
        "visit",
        "visit_due",
    )

    def __init__(self, tables: Tables) -> None:
        self._has_hard_groups = tables.has_hard_groups
        self.started_at = 0.0
        """time (s) at which the mission was started"""
        self.last_number = 0
        """how many numbers have been assigned: each visit, each turn of an action and each drive of
        a reaction gets the next one"""
        self.visit = TaskVisit(None, 0, 0, 0.0)
        self.frames: list[Frame] = []
        """active groups, outermost first"""
        self.awaited_round: Frame | None = None
        """the group whose next round starts with the present visit but is not due yet; None if none
        is awaited"""
        self.readings: dict[str, CheckpointReading] = {}
        """by object_id of the checkpoint"""
        self.by_hand_s = 0.0
        """total duration (s) of tasks done by hand"""
        self.interrupted_s = 0.0
        """total duration (s) of the interruptions that have ended"""
        self.interrupted_at: float | None = None
        """time (s) at which the present interruption began; None if the mission is not
        interrupted"""
        self.group_due = math.inf
        """next time (s) at which a group with a hard stop times out; infinite while interrupted"""
        self.due_group: GroupNode | None = None
        """the group that times out at `group_due`; of several at the same time the outermost one,
        as leaving it leaves the others"""
        self.visit_due = math.inf
        """next time (s) at which the present visit's own times (round, wait, window, time limit)
        take effect; infinite while interrupted"""

    @property
    def leaf(self) -> LeafNode | None:
        """The active task; None before the start and at the end of the mission."""
        return self.visit.leaf

    def new_visit_or_turn_number(self) -> int:
        self.last_number += 1
        return self.last_number

    def clock_time_at(self, now: float, group: GroupNode) -> float:
        """Return the time (s) on a group's clock at `now`; it is not 0 when the group starts."""
        return self._clock_time(now, group) + self._clock_offset(group)

    def take_first_possible_transition(
        self, transitions: tuple[CompiledTransition, ...], now: float
    ) -> CompiledTransition:
        """Take the first of these transitions that is possible at `now`, and return it.

        If none before it is possible, the last one is taken. If the transition completes the round
        of a group, one of the group's own transitions, to its next round or out of it, is taken and
        returned instead.
        """
        if self.awaited_round is not None:
            self.start_awaited_round(now)
        while True:
            for transition in transitions:
                if transition.always_possible or self._is_possible(transition, now):
                    break
            if transition.completes is None:
                break
            transitions = transition.completes.transitions
        repeated = transition.repeats
        if repeated is not None:
            self.frames[repeated.depth].round += 1
        self._enter(transition.target, transition.kept_groups, transition.domain, now)
        if repeated is not None and repeated.every:
            self._await_round(self.frames[repeated.depth], now)
        return transition

    def enter_first_task_or_end(self, first_leaf: LeafNode | None, now: float) -> None:
        """Enter the mission's first task, or go to the mission's end if `first_leaf` is None."""
        self._enter(first_leaf, 0, None, now)

    def interrupt(self, now: float) -> None:
        if self.interrupted_at is None:
            self.interrupted_at = now
            # A new turn: the action is cancelled and started again, even if the interruption is
            # over before the driver calls the executor again.
            self.visit.turn = self.new_visit_or_turn_number()
            self.group_due = self.visit_due = self.visit.action_due = math.inf

    def resume(self, now: float) -> None:
        """End the interruption, if there is one: the clocks of the groups run again.

        Time-outs whose time has passed meanwhile are due at `now`.
        """
        if self.interrupted_at is not None:
            self.interrupted_s += now - self.interrupted_at
            self.interrupted_at = None
        self.schedule_wait_check_now(now)
        self._update_group_due(now)

    def advance_stopped_group_clocks(self, by_hand_seconds: float, now: float) -> None:
        """Advance the clocks of groups by the duration (s) of a task done by hand.

        Groups that count interruptions are not affected: their clocks have run meanwhile.
        """
        if by_hand_seconds:
            self.by_hand_s += by_hand_seconds
            self._update_group_due(now)

    def set_reading(self, object_id: str, reading: CheckpointReading | None, now: float) -> None:
        """Set or (None) remove a checkpoint's reading, and let a WAIT check its conditions."""
        if reading is None:
            self.readings.pop(object_id, None)
        else:
            self.readings[object_id] = reading
        self.schedule_check_if_waiting(now)

    def schedule_check_if_waiting(self, now: float) -> None:
        """Let the active task, if it is a WAIT, check its conditions, as a reading has changed."""
        if self.visit.leaf is not None and self.visit.leaf.wait is not None:
            self.schedule_wait_check_now(now)

    def schedule_wait_check_now(self, now: float) -> None:
        """Schedule a check of the active WAIT's conditions at `now`, or after the interruption."""
        self.visit.check_at = now
        self.update_visit_due()

    def are_satisfied(self, guards: tuple[Guard, ...], now: float) -> bool:
        """Return True if the present readings satisfy all of the compiled conditions at `now`."""
        readings = self.readings
        for object_id, test in guards:
            reading = readings.get(object_id)
            if reading is None or not test(reading, now):
                return False
        return True

    def start_awaited_round(self, now: float) -> None:
        """Start the awaited round of a group at `now`, and with it the present visit."""
        frame = self.awaited_round
        assert frame is not None
        self.awaited_round = None
        self.visit.since = self.visit.check_at = now
        for inner in self.frames[frame.group.depth + 1 :]:
            inner.entered = self.clock_time_at(now, inner.group)
        self._update_group_due(now)
        self.update_visit_due()

    @property
    def awaited_round_due(self) -> float:
        """Time (s) at which the awaited round is due if no clock stops; infinite if none is."""
        frame = self.awaited_round
        return math.inf if frame is None else self._round_due(frame)

    def rounds_from(self, depth: int, now: float) -> tuple[TracedRound, ...]:
        """Return the present rounds of the active groups at this depth and deeper, for the trace.

        Without those of the groups inside an awaited round, which have not begun either. A round
        of a group whose clock has stopped is due as if the clock went on from `now`.
        """
        awaited = self.awaited_round
        end = None if awaited is None else awaited.group.depth + 1
        return tuple(
            [
                new_tuple(
                    TracedRound,
                    (
                        frame.group.name,
                        frame.round,
                        self._expected_due(frame, now) if frame.group.every else None,
                        frame is awaited,
                    ),
                )
                for frame in self.frames[depth:end]
            ]
        )

    def update_visit_due(self) -> None:
        """Compute `visit_due` anew, after a change of the visit's times."""
        visit, leaf = self.visit, self.visit.leaf
        self.visit_due = math.inf
        if leaf is None or self.interrupted_at is not None:
            return
        if self.awaited_round is not None:
            self.visit_due = (
                self.awaited_round_due
            )  # a window is not missed before the round starts
        elif leaf.is_timed or visit.action_due < math.inf:
            self.visit_due = visit.next_due(self.started_at)

    def leave_all_states(self) -> None:
        """Leave all states, as the mission has ended."""
        number = self.new_visit_or_turn_number()
        self.visit = TaskVisit(None, number, number, 0.0)
        self.frames.clear()
        self.awaited_round = None
        self.group_due = self.visit_due = math.inf

    def _is_possible(self, transition: CompiledTransition, now: float) -> bool:
        group = transition.repeats
        if group is not None:
            frame = self.frames[group.depth]
            if group.count and frame.round >= group.count:
                return False
            if group.duration and (
                self._clock_time(now, group) >= self._duration_end(frame)
                or frame.round * group.every >= group.duration
            ):
                return False
            return not group.until or not self.are_satisfied(group.until, now)
        return not transition.guards or self.are_satisfied(transition.guards, now)

    def _enter(
        self, leaf: LeafNode | None, kept_groups: int, domain: GroupNode | None, now: float
    ) -> None:
        """Leave all active groups but the outermost `kept_groups`, and enter the leaf.

        `domain` is the innermost of the kept groups; None if none is kept. The groups between it
        and the leaf are entered with their first round. Without a leaf the mission's end is
        entered.
        """
        self.last_number = number = self.last_number + 1
        visit = self.visit  # reused, which is faster than a new object
        visit.leaf = leaf
        visit.number = visit.turn = number
        visit.since = visit.check_at = now
        visit.attempt = 0
        visit.occurred = False
        visit.action_due = _NEVER
        frames = self.frames
        changed = len(frames) > kept_groups
        if changed:
            del frames[kept_groups:]
        if leaf is not None and leaf.parent is not domain:
            changed = True
            group = leaf.parent
            entered = []
            while group is not None and group is not domain:
                entered.append(Frame(group, 1, self.clock_time_at(now, group)))
                group = group.parent
            frames.extend(reversed(entered))
        if changed and self._has_hard_groups:
            self._update_group_due(now)
        self.visit_due = _NEVER
        if leaf is not None and leaf.is_timed:
            self.update_visit_due()

    def _await_round(self, frame: Frame, now: float) -> None:
        if self._round_due(frame) > self._clock_time(now, frame.group):
            self.awaited_round = frame
            self._update_group_due(now)
            self.update_visit_due()

    def _round_due(self, frame: Frame) -> float:
        group = frame.group
        return frame.entered + (frame.round - 1) * group.every - self._clock_offset(group)

    def _expected_due(self, frame: Frame, now: float) -> float:
        """Return the time (s) at which a round is due if its group's clock goes on from `now`."""
        return self._round_due(frame) + (now - self._clock_time(now, frame.group))

    def _update_group_due(self, now: float) -> None:
        self.group_due = math.inf
        if self.interrupted_at is not None:
            return
        started = self.frames
        if self.awaited_round is not None:
            started = started[: self.awaited_round.group.depth + 1]
        for frame in started:
            if frame.group.has_hard_stop:
                at = max(self._duration_end(frame), now)
                if at < self.group_due:
                    self.group_due, self.due_group = at, frame.group

    def _clock_time(self, now: float, group: GroupNode) -> float:
        """Return the executor's time (s) that a group's clock shows at `now`, without its offset.

        This is the start of the interruption if the group's clock has stopped, and `now` otherwise.
        """
        if self.interrupted_at is None or group.counts_interruptions:
            return now
        return self.interrupted_at

    def _clock_offset(self, group: GroupNode) -> float:
        """Return how far a group's clock is ahead of the executor's clock (s); may be negative."""
        return 0.0 if group.counts_interruptions else self.by_hand_s - self.interrupted_s

    def _duration_end(self, frame: Frame) -> float:
        """Return the executor's time (s) at which a group's duration ends if its clock goes on."""
        return frame.entered + frame.group.duration - self._clock_offset(frame.group)
