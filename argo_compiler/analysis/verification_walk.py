"""Steps of a mission by the rules of `docs/language.md`, and what they prove possible.

Rules are cited by their names there, such as T2. A step leads from one point of a run to the next:
to a task, to the end of a round, to the end of a group whose time is up, or to the mission's end.
Parameters `at` and `number` are indices in the mission's lists of tasks or groups. Parameters
`state` and `late` are sets of readings, as bits: those that are possible at the point, and those of
cancelled actions that may still arrive.
"""

from collections.abc import Iterator, Mapping
from dataclasses import field

from argo_compiler.analysis.verification_layout import END, MissionLayout, ProgramPoint
from argo_compiler.analysis.verification_states import (
    ClaimedScale,
    ClaimedStates,
    Ranges,
    compared_bounds,
)
from argo_compiler.base.records import dataclass
from argo_compiler.il import Action, Condition, ConditionType, Mission, OnFailure, Task

Step = tuple[ProgramPoint, int, int]
"""next point, the readings that are possible there, and those that may still arrive late"""

# Access to an enumeration's members is slow, and each task needs these.
_MEASURE, _WAIT = Action.MEASURE, Action.WAIT
_CONTINUE, _BRANCH = OnFailure.CONTINUE, OnFailure.BRANCH
_ENDING = (OnFailure.RETURN, OnFailure.ABORT)
_AGED = (ConditionType.STALE, ConditionType.ABNORMAL)


@dataclass
class Proved:
    """Possibilities that a witness leaves, by indices in the mission's lists; a walk adds to them.

    Everything else is proved impossible.
    """

    tasks: set[int] = field(default_factory=set)
    """tasks that can be reached"""
    transitions: set[tuple[int, int]] = field(default_factory=set)
    """task and transition, for each transition that can be taken"""
    certain: set[tuple[int, int]] = field(default_factory=set)
    """transitions that are taken whenever they are evaluated"""
    repeats: set[int] = field(default_factory=set)
    """groups that can start another round"""
    ends: set[int] = field(default_factory=set)
    """groups that can end by themselves"""
    ended: bool = False
    """whether the mission can end"""


class MissionWalk:
    """Steps of a mission from each of its points; adds what is possible to `proved`."""

    def __init__(
        self,
        mission: Mission,
        layout: MissionLayout,
        states: ClaimedStates,
        failures: bool,
        proved: Proved,
        ranges: Mapping[str, Ranges],
    ) -> None:
        self.ranges = ranges
        self.mission = mission
        self.layout = layout
        self.states = states
        self.failures = failures
        self.proved = proved
        self._satisfying: dict[int, int] = {}
        self._reported = 0
        waited = {
            condition.object_id
            for task in mission.tasks
            for condition in (() if task.wait is None else task.wait.conditions)
        }
        measured = {task.object_id for task in mission.tasks if task.action is _MEASURE}
        for object_id, scale in states.scales.items():
            # Others may report what a mission waits for or never measures at any time (C8).
            if object_id in waited or object_id not in measured:
                self._reported |= scale.values << scale.shift

    def step_to_mission_start(self) -> Step:
        """Return the step to the mission's start (M1), where nothing has been measured."""
        state = self._reported
        for scale in self.states.scales.values():
            state |= scale.missing_bit << scale.shift
        return self.layout.begin, state, 0

    def steps(self, here: ProgramPoint) -> list[Step]:
        """Return the steps that can follow a point."""
        kind, at = here
        late = self.states.late.get(here, 0)
        state = self.states.readings[here]
        if kind == "task":
            return self._leave_task(at, state, late)
        if kind == "round":
            return self._end_round(at, state, late)
        steps: list[Step] = []
        if kind == "cut":
            around = self.layout.parent[at]
            if around is not None and self.layout.timed[around]:
                steps.append((("cut", around), state, late))
            if self.layout.hard[at]:
                self.proved.ends.add(at)
                steps.append(self._after_last(at, state, late))
        return steps

    def _leave_task(self, at: int, state: int, late: int) -> list[Step]:
        steps: list[Step] = []
        task = self.mission.tasks[at]
        own = self._late_readings(task)
        ended = self._after_success(task, state)
        # A WAIT runs no action, so late readings may still arrive when it has ended. Other tasks
        # start when the previous action has ended, but time may let them fail before they start.
        by_time = self._may_fail_by_time(task)
        passing = late if task.wait is not None or by_time else 0
        continues = False
        if self._may_fail(task):
            continues = self._failure_may_continue(task)
            failed = self._after_failure(task, state)
            still_late = passing | (own if by_time else 0)
            if continues:
                ended |= failed
                passing = still_late
            steps += [
                (point, failed | still_late, still_late) for point in self._failure_points(task)
            ]
        inside = self.layout.innermost[at]
        if inside is not None and self.layout.timed[inside]:
            steps.append((("cut", inside), state | late | own, late | own))
        fresh = None
        if task.action is _MEASURE and not (self.failures or continues):
            fresh = task.object_id
        return steps + self._transition_steps(
            at, task, ended | passing | self._reported, passing, fresh
        )

    def _late_readings(self, task: Task) -> int:
        """Return the readings that the task's action may still report while it is cancelled."""
        if task.action is not _MEASURE or task.object_id not in self.states.scales:
            return 0
        return self.states.cancelled_measurement_readings(task.object_id, self.failures)

    def _after_success(self, task: Task, state: int) -> int:
        """Return the readings when the robot (C3) or a person (H3) has done a task."""
        o = task.object_id
        if task.action is not _MEASURE or o not in self.states.scales:
            return state
        scale = self.states.scales[o]
        # A success without a number is unreadable; a person may do a task without a value.
        others = scale.unreadable_bit | scale.missing_bit if self.failures else 0
        return self.states.set(state, o, scale.values | others) | self._reported

    def _after_failure(self, task: Task, state: int) -> int:
        o = task.object_id
        if task.action is not _MEASURE or o not in self.states.scales:
            return state
        scale = self.states.scales[o]
        others = scale.unreadable_bit | scale.unreachable_bit if self.failures else 0
        return self.states.set(state, o, scale.otherwise_failed_bit | others) | self._reported

    def _may_fail(self, task: Task) -> bool:
        """Return True if a task may finally fail.

        Without failures of actions, a WAIT fails when its limit has elapsed (W3), and a task fails
        when its hard window has closed (W5).
        """
        waits = task.wait is not None and task.wait.limit is not None
        return self._can_miss_window(task) or waits or (self.failures and task.action is not _WAIT)

    def _can_miss_window(self, task: Task) -> bool:
        window = task.window
        return window is not None and window.hard and window.latest is not None

    def _may_fail_by_time(self, task: Task) -> bool:
        """Return True if a task may fail as its hard window closes or its own time limit ends.

        Its action, or an earlier one, may then still be being cancelled.
        """
        return self._can_miss_window(task) or (self.failures and task.time_limit is not None)

    def _may_fail_otherwise(self, task: Task) -> bool:
        """Return True if a task may fail for another reason than a missed window."""
        waits = task.wait is not None and task.wait.limit is not None
        return waits or (self.failures and task.action is not _WAIT)

    def _missed_target(self, task: Task) -> str | None:
        return None if task.window is None else task.window.missed_target

    def _failure_may_continue(self, task: Task) -> bool:
        """Return True if the mission may go on after a task's failure as after its success (T8)."""
        continues = task.on_failure is _CONTINUE or (
            task.on_failure is _BRANCH and task.failure_target is None
        )
        return continues and (self._may_fail_otherwise(task) or self._missed_target(task) is None)

    def _failure_points(self, task: Task) -> Iterator[ProgramPoint]:
        """Yield where a final failure leads, except onwards as after a success (T8, W5)."""
        missed = self._missed_target(task)
        if self._can_miss_window(task) and missed is not None:
            yield self.layout.task_point(missed)
            if not self._may_fail_otherwise(task):
                return
        if task.on_failure is _BRANCH and task.failure_target is not None:
            yield self.layout.task_point(task.failure_target)
        elif task.on_failure in _ENDING:
            yield END

    def _transition_steps(
        self, at: int, task: Task, state: int, late: int, fresh: str | None
    ) -> list[Step]:
        """Return the steps by a task's transitions, the unconditional one last (T2, T3).

        Transitions that can't be taken have no step; neither have those after one that is always
        taken. If a group ends with the task, the last step leads to the end of the group's round.

        `fresh` is a checkpoint that has certainly just been measured, so that its reading is recent
        enough for every condition; None if there is none.
        """
        steps: list[Step] = []
        changing = late | self._reported
        for k, transition in enumerate(task.transitions):
            if not transition.conditions:
                continue
            taken, rest, certain = self._evaluate(transition.conditions, state, fresh)
            if taken is not None:
                self.proved.transitions.add((at, k))
                steps.append((self.layout.task_point(transition.target), taken | changing, late))
                if certain:
                    self.proved.certain.add((at, k))
                    return steps
            state = rest | changing
        ending = self.layout.ending[at]
        if ending is not None:
            steps.append((("round", ending), state, late))
        else:
            steps.append(self._unconditional(at, state, late))
        return steps

    def _evaluate(
        self, conditions: tuple[Condition, ...], state: int, fresh: str | None
    ) -> tuple[int | None, int, bool]:
        """Return the readings if all conditions hold, those if not, and if `state` makes them hold.

        The first result is None if the conditions can't hold.
        """
        states = self.states
        taken, possible = state, True
        unsure: list[tuple[Condition, bool]] = []
        for condition in conditions:
            o = condition.object_id
            if o not in states.scales:
                may, must = self._in_range(condition)
                possible = possible and may
                if not must or o != fresh:
                    unsure.append((condition, False))
                continue
            holding = self._satisfying_readings(condition)
            held = states.get(taken, o) & holding
            possible = possible and held != 0
            possible = possible and not (o == fresh and condition.type is ConditionType.STALE)
            taken = states.set(taken, o, held)
            exact = self._exact(condition, fresh)
            if not exact or states.get(state, o) & ~holding:
                unsure.append((condition, exact))
        rest = state
        if len(unsure) == 1 and unsure[0][1]:
            condition = unsure[0][0]
            excluded = states.get(state, condition.object_id) & ~self._satisfying_readings(
                condition
            )
            rest = states.set(state, condition.object_id, excluded)
        return taken if possible else None, rest, possible and not unsure

    def _in_range(self, condition: Condition) -> tuple[bool, bool]:
        """Return whether a condition can hold for a value in the checkpoint's range, and for all.

        For checkpoints without a scale. Without a known range, a condition may hold or not.
        """
        known = self.ranges.get(condition.object_id)
        if known is None or not condition.type.compares:
            return True, False
        scale = ClaimedScale(tuple(sorted({*known[:2], *compared_bounds(condition)})), 0, 0, 0)
        values, holding = (
            scale.region_bits_overlapping(*known[:2]),
            scale.satisfying_bits(condition),
        )
        return values & holding != 0, not values & ~holding

    def _exact(self, condition: Condition, fresh: str | None) -> bool:
        """Return True if a reading alone decides whether a condition holds, whatever its age."""
        scale = self.states.scales.get(condition.object_id)
        timely = condition.max_age is None or condition.object_id == fresh
        exact = timely and condition.type not in _AGED
        return exact and scale is not None and scale.is_exact_for(condition)

    def _satisfying_readings(self, condition: Condition) -> int:
        # Hashing conditions is slow. Ids stay valid, as the mission lives as long as this object.
        satisfying = self._satisfying.get(id(condition))
        if satisfying is None:
            satisfying = self.states.scales[condition.object_id].satisfying_bits(condition)
            self._satisfying[id(condition)] = satisfying
        return satisfying

    def _unconditional(self, at: int, state: int, late: int) -> Step:
        for k, transition in enumerate(self.mission.tasks[at].transitions):
            if not transition.conditions:
                self.proved.transitions.add((at, k))
                return self.layout.task_point(transition.target), state, late
        return END, 0, 0

    def _end_round(self, number: int, state: int, late: int) -> list[Step]:
        """Return the steps at the end of a round (G5 to G8)."""
        steps: list[Step] = []
        group = self.mission.groups[number]
        changing = late | self._reported
        ended, repeated, certain = self._evaluate(group.until, state, None)
        if group.max_repeat_count != 1 and not (group.until and certain):
            self.proved.repeats.add(number)
            start = "task", self.layout.position[group.start]
            steps.append((start, repeated | changing if group.until else state, late))
        limited = group.max_repeat_count > 0 or group.max_repeat_duration > 0
        if limited or (group.until and ended is not None):
            if not self.layout.hard[number]:
                self.proved.ends.add(number)
            after = state if limited or ended is None else ended | changing
            steps.append(self._after_last(number, after, late))
        return steps

    def _after_last(self, number: int, state: int, late: int) -> Step:
        """Return the step after a group's last round (G6, G7).

        The enclosing group decides if it ends with the same task; otherwise the unconditional
        transition is taken.
        """
        around = self.layout.ending_around[number]
        if around is not None:
            return ("round", around), state, late
        return self._unconditional(self.layout.last[number], state, late)
