"""State of the mission itself, without its interruptions: tasks, groups, their ends and times."""

import math
from collections import defaultdict, deque
from collections.abc import Iterable
from typing import NamedTuple

from argo_compiler.base.message import Message
from argo_compiler.hfsm.conditions import CheckpointReading, conjunction_text
from argo_compiler.hfsm.configuration import Configuration
from argo_compiler.hfsm.kinds import Cause, Outcome, ReadingKind
from argo_compiler.hfsm.progress import ByHand, Progress
from argo_compiler.hfsm.restoring import group_progress
from argo_compiler.hfsm.tables import CompiledTransition, LeafNode, Tables
from argo_compiler.hfsm.trace import RawEntry, StoredStep, TracedRound, groups_left, new_tuple
from argo_compiler.il import EventKind

_VALUE = ReadingKind.VALUE
_OVER = Message("its time window is over")


class DoneByHand(NamedTuple):
    """Task that a person did or skipped and that the machine has not reached yet."""

    number: int
    """its position in the order in which they were given back"""
    done: ByHand
    at: float
    """time (s) at which it was done"""


class MachineState:
    """Configuration of a mission with its trace, tallies and outcome. Each step changes it.

    It does not know of reactions, persons and running actions: `interrupt` and `resume` tell it of
    interruptions.
    """

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.configuration = Configuration(tables)
        self.by_hand: dict[str, deque[DoneByHand]] = {}
        """by task"""
        self._by_hand_count = 0
        self.now = -math.inf
        """time (s) of the last step"""
        self.time_up_at = math.inf
        """time (s) at which TIME_UP occurs; infinite if it has occurred or never will"""
        self.time_up = False
        self.failed = False
        """whether a task that is not optional has failed for good"""
        self.outcome: Outcome | None = None
        self.left_at: Progress | None = None
        """the active task and groups when the mission was given up; None: it was not"""
        self.tallies: defaultdict[str, list[int]] = defaultdict(lambda: [0, 0, 0])
        """by task, the numbers of ended visits: done, failed, by hand"""
        # The history has no effect on what follows, so these lists only grow.
        self.trace: list[RawEntry | StoredStep] = []
        self.ended: list[tuple[str, str | None, bool]] = []

    @property
    def active_task(self) -> str | None:
        leaf = self.configuration.leaf
        return None if leaf is None else leaf.name

    @property
    def next_due(self) -> float:
        """Earliest time (s) of a change by a group, the visit or TIME_UP; infinite without one."""
        configuration = self.configuration
        due = (
            configuration.group_due
            if configuration.group_due < configuration.visit_due
            else configuration.visit_due
        )
        return due if due < self.time_up_at else self.time_up_at

    def handle_wait_or_time_up_event(self, kind: EventKind) -> None:
        """Record an event; only TIME_UP and what the active WAIT awaits have an effect."""
        if kind is EventKind.TIME_UP:
            self.time_up = True
            self.time_up_at = math.inf
        configuration, leaf = self.configuration, self.configuration.leaf
        if (
            leaf is None
            or leaf.wait is None
            or leaf.wait.event is not kind
            or configuration.awaited_round
        ):
            return
        configuration.visit.occurred = True
        configuration.update_visit_due()

    def queue_tasks_done_by_hand(self, tasks: Iterable[ByHand], now: float) -> None:
        """Add tasks that a person did or skipped; each stands in for the next visit of its task.

        `now` is the time (s) from which their ages count back.
        """
        for task in tasks:
            self._by_hand_count += 1
            done = DoneByHand(self._by_hand_count, task, now - (task.age or 0.0))
            self.by_hand.setdefault(task.task, deque()).append(done)

    def interrupt(self) -> None:
        """Interrupt the mission, if it is not interrupted yet."""
        self.configuration.interrupt(self.now)

    def resume(self) -> None:
        """Resume the mission at its present task."""
        self.configuration.resume(self.now)

    def end_wait_if_over(self) -> bool:
        """End the active WAIT if it is over now, and return whether it was.

        The mission must not be interrupted. This does nothing for a WAIT that a person has done by
        hand: `step` ends it, but takes time-outs first.
        """
        configuration, visit = self.configuration, self.configuration.visit
        leaf = visit.leaf
        if (
            leaf is None
            or leaf.wait is None
            or configuration.awaited_round
            or leaf.name in self.by_hand
        ):
            return False
        if (
            not visit.earliest_wait_end_or_check(configuration.started_at)
            <= self.now
            <= visit.window_missed_at(configuration.started_at)
        ):
            return False
        wait = leaf.wait
        if wait.duration is not None:
            why = f"waited {wait.duration:g} s"
        elif visit.occurred:
            assert wait.event is not None
            why = f"{wait.event.replace('_', ' ')} has occurred"
        else:
            visit.check_at = math.inf
            if not wait.guards or not configuration.are_satisfied(wait.guards, self.now):
                configuration.update_visit_due()
                return False
            why = conjunction_text(wait.conditions)
        self.complete(leaf, why)
        return True

    def step(self) -> bool:
        """Make one change that is due now and needs no action of the robot, if there is one.

        The changes are: the end of the mission, a time-out, the end of a task that was done by
        hand, or one that is due by the visit's own times. The mission must not be interrupted.
        Returns True if a change was made.
        """
        configuration = self.configuration
        leaf = configuration.visit.leaf
        if leaf is None:
            failed = self.failed
            self.outcome = Outcome.COMPLETED_WITH_FAILURES if failed else Outcome.COMPLETED
            self.time_up_at = math.inf
        elif configuration.group_due <= self.now:
            self._time_out_group()
        elif self.by_hand and not leaf.is_return and leaf.name in self.by_hand:
            self._end_by_hand(leaf)
        elif configuration.visit_due <= self.now:
            return self._handle_visit_due(leaf)
        else:
            return False
        return True

    def _handle_visit_due(self, leaf: LeafNode) -> bool:
        """Make the change that is due by the visit's own times: round, window or time limits.

        `end_wait_if_over` ends a WAIT. Returns True if a change was made.
        """
        configuration, visit = self.configuration, self.configuration.visit
        if configuration.awaited_round is not None:
            self._start_awaited_round()
        elif visit.window_missed_at(configuration.started_at) <= self.now:
            self._fail_for_good(leaf, _OVER, leaf.missed or leaf.failure)
        elif visit.action_due <= self.now:
            self.retry_or_fail(leaf, Message("not done within {limit:g} s", limit=leaf.time_limit))
        elif visit.wait_limit_at <= self.now:
            assert leaf.wait is not None
            self._fail_for_good(
                leaf, Message("waited {limit:g} s in vain", limit=leaf.wait.limit), leaf.failure
            )
        else:
            return False
        return True

    def start_time_limit(self, seconds: float, not_before: float | None) -> None:
        """Start the time limit (s) of the action that the present visit has just started.

        The time counts from the time `not_before` (s), if that is later than now.
        """
        begins = self.now if not_before is None else max(self.now, not_before)
        self.configuration.visit.action_due = begins + seconds
        self.configuration.update_visit_due()

    def clear_time_limit(self) -> None:
        """Clear the time limit, as the action has ended."""
        if self.configuration.visit.action_due < math.inf:
            self.configuration.visit.action_due = math.inf
            self.configuration.update_visit_due()

    def pending_tasks_done_by_hand(self) -> tuple[ByHand, ...]:
        """Return the tasks done by hand that the machine has not reached yet, with their ages."""
        remaining = sorted(done for queue in self.by_hand.values() for done in queue)
        return tuple(
            done.model_copy(update={"age": max(0.0, self.now - at)}) for _, done, at in remaining
        )

    def record_measurement(
        self, object_id: str, leaf: LeafNode, value: float | None, abnormal: bool
    ) -> None:
        """Record the reading of a measurement that ended well; value None means unreadable.

        `leaf` is the task that measured, which the machine may have left meanwhile.
        """
        configuration, now = self.configuration, self.now
        if value is None:
            configuration.readings[object_id] = CheckpointReading(ReadingKind.UNREADABLE, now)
        else:
            configuration.readings[object_id] = new_tuple(
                CheckpointReading, (_VALUE, now, value, abnormal)
            )
        if configuration.visit.leaf is not leaf:
            configuration.schedule_check_if_waiting(now)

    def set_reading(self, object_id: str, value: float, abnormal: bool, at: float) -> None:
        """Set the reading of a checkpoint to a value that was read at the time `at` (s)."""
        self.configuration.set_reading(
            object_id, CheckpointReading(_VALUE, at, value, abnormal), self.now
        )

    def retry_or_fail(
        self, leaf: LeafNode, reason: str, kind: ReadingKind = ReadingKind.FAILED
    ) -> None:
        """Retry the active task after a failure of its action, or let the task fail for good.

        When a measurement fails for good, its reading is of this kind.
        """
        visit = self.configuration.visit
        if visit.attempt < leaf.retries:
            visit.attempt += 1
            visit.turn = self.configuration.new_visit_or_turn_number()
            visit.action_due = math.inf
            self.configuration.update_visit_due()
            self.add_entry(Cause.RETRY, failure=reason)
        elif leaf.is_return:
            self.end(Outcome.FAILED, Cause.FAILURE, failure=reason)
        else:
            self._fail_for_good(leaf, reason, leaf.failure, kind)

    def _fail_for_good(
        self,
        leaf: LeafNode,
        reason: str,
        transition: CompiledTransition | None,
        kind: ReadingKind = ReadingKind.FAILED,
    ) -> None:
        if leaf.measures is not None:
            self._set_no_value(leaf.measures, kind)
        self.failed = self.failed or not leaf.optional
        self._count_end(leaf, failure=reason)
        if transition is None:
            self._take_transition(leaf.transitions, reason)
        elif transition.target is None:
            self.end(Outcome.ABORTED, Cause.FAILURE, failure=reason)
        elif transition.target.is_return:
            self._note_where_left()
            self._take_transition((transition,), reason)
        else:
            self._take_transition((transition,), reason)

    def complete(self, leaf: LeafNode, detail: str = "") -> None:
        """End the active task with success, and take its first possible transition."""
        if leaf.is_return:
            self.end(Outcome.RETURNED, Cause.END)
            return
        # Same as `_count_end` and `_take_transition`, but faster: most events lead here.
        self.tallies[leaf.name][0] += 1
        self.ended.append(leaf.ended_visit)
        configuration, now = self.configuration, self.now
        transition = configuration.take_first_possible_transition(leaf.transitions, now)
        kept = transition.kept_rounds
        rounds = configuration.rounds_from(kept, now) if len(configuration.frames) > kept else ()
        self.trace.append((now, leaf, configuration.visit.leaf, transition, detail, rounds))

    def record_success_after_leaving(self, leaf: LeafNode) -> None:
        """Count the success of an action that came after the mission had left its task."""
        if not leaf.is_return:
            self._count_end(leaf)
            self.add_entry(Cause.LATE, detail=leaf.name)

    def end(
        self,
        outcome: Outcome,
        cause: Cause,
        event: EventKind | None = None,
        failure: str | None = None,
    ) -> None:
        """End the mission at once, whatever it was doing."""
        source = self.active_task
        left = tuple(frame.group.name for frame in reversed(self.configuration.frames))
        self._note_where_left()
        self.outcome = outcome
        self.configuration.leave_all_states()
        self.time_up_at = math.inf
        self.add_entry(cause, source, event=event, failure=failure, detail=str(outcome), left=left)

    def _note_where_left(self) -> None:
        """Note the active task and groups, as the mission is being given up."""
        if self.left_at is None:
            groups = group_progress(self.configuration, self.now)
            self.left_at = Progress(active=self.active_task, groups=groups)

    def add_entry(
        self,
        cause: Cause,
        source: str | None = "",
        event: EventKind | None = None,
        failure: str | None = None,
        detail: str = "",
        left: tuple[str, ...] = (),
        rounds: tuple[TracedRound, ...] = (),
    ) -> None:
        """Add an entry to the trace at the present time; its target is the active task.

        Its source is the active task too, unless another one or None is given.
        """
        target = self.active_task
        origin = target if source == "" else source
        self.trace.append(
            RawEntry(
                self.now,
                origin,
                target,
                cause,
                left=left,
                rounds=rounds,
                failure=failure,
                event=event,
                detail=detail,
            )
        )

    def _count_end(self, leaf: LeafNode, failure: str | None = None, by_hand: bool = False) -> None:
        """Count the end of a visit of a task: done, failed (with the reason), or done by hand."""
        self.tallies[leaf.name][2 if by_hand else 0 if failure is None else 1] += 1
        self.ended.append((leaf.name, failure, by_hand))

    def _set_no_value(self, object_id: str, kind: ReadingKind) -> None:
        """Set the reading of a checkpoint whose measurement gave no value."""
        self.configuration.set_reading(object_id, CheckpointReading(kind, self.now), self.now)

    def _take_transition(
        self,
        transitions: tuple[CompiledTransition, ...],
        failure: str | None = None,
        timed_out: str | None = None,
        by_hand: ByHand | None = None,
    ) -> None:
        configuration, now = self.configuration, self.now
        source = configuration.visit.leaf
        transition = configuration.take_first_possible_transition(transitions, now)
        target, repeated = configuration.visit.leaf, transition.repeats
        self.trace.append(
            RawEntry(
                now,
                None if source is None else source.name,
                None if target is None else target.name,
                transition.cause if timed_out is None else Cause.TIMEOUT,
                transition.conditions,
                timed_out,
                None if repeated is None else repeated.name,
                () if source is None else groups_left(source, transition),
                configuration.rounds_from(transition.kept_rounds, self.now),
                failure,
                None,
                by_hand is not None,
                by_hand is not None and by_hand.skipped,
            )
        )

    def _end_by_hand(self, leaf: LeafNode) -> None:
        """End the active task, as it was done or skipped by hand."""
        queue = self.by_hand[leaf.name]
        _, done, at = queue.popleft()
        if not queue:
            del self.by_hand[leaf.name]
        if self.configuration.awaited_round is not None:
            self._start_awaited_round()
        self.configuration.advance_stopped_group_clocks(done.duration, self.now)
        if leaf.measures is not None:
            if done.value is None or done.skipped:
                self.configuration.set_reading(leaf.measures, None, self.now)
            else:
                self.set_reading(leaf.measures, done.value, done.abnormal, at)
        self._count_end(leaf, by_hand=True)
        self._take_transition(leaf.transitions, by_hand=done)

    def _start_awaited_round(self) -> None:
        """Start the awaited round of a group, and add that to the trace."""
        configuration = self.configuration
        frame = configuration.awaited_round
        assert frame is not None
        configuration.start_awaited_round(self.now)
        self.add_entry(
            Cause.ROUND,
            detail=f"{frame.round} of '{frame.group.name}'",
            rounds=configuration.rounds_from(frame.group.depth, self.now),
        )

    def _time_out_group(self) -> None:
        """Take the time-out transition of the group whose time is up."""
        group = self.configuration.due_group
        assert group is not None
        assert group.timeout is not None
        self._take_transition((group.timeout,), timed_out=group.name)
