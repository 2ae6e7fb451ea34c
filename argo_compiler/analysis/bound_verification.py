"""Checker of lower bounds on time and energy, independent of the code that computes them.

It reads the mission by the rules of `docs/language.md` and gets costs from the travel. From the
analysis it uses only the format of the witnesses and what `verification` has proved about the
transitions. It visits each step of the mission once: no step may cost less than the difference that
a witness claims.

No action fails and no reaction starts. The robot may be anywhere on its way when a time is up.
"""

import math
from collections.abc import Iterator, Mapping

from argo_compiler.analysis.results import Analysis, Bounds
from argo_compiler.analysis.travel import Leg, NoPath, RobotPose, Travel
from argo_compiler.analysis.verification import Verifier
from argo_compiler.analysis.verification_layout import MissionLayout
from argo_compiler.analysis.verification_walk import Proved
from argo_compiler.analysis.witness import Invariant, LeastSpent, LeastWitness
from argo_compiler.base.catalog import Catalog
from argo_compiler.base.records import dataclass
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Mission, OnFailure, Task

ProgramPoint = tuple[str, int]
"""point of a run: `task`, `missed`, `round`, `left` or `entered` with an index into the mission's
list of tasks or groups, as in `LeastSpent`; or BEGIN or END"""
BEGIN: ProgramPoint = ("begin", 0)
END: ProgramPoint = ("end", 0)

SpentByPoint = Mapping[ProgramPoint, float]
"""least time (s) or energy (Wh) from the mission's start to each point"""

_TOLERANCE = 1e-6  # s, as sums of floats are not exact
_ROUND_TOLERANCE = 1e-9  # share of a round, for the same reason
_MOST_POSES = 64  # positions of the robot at one point
_MOST_NESTING = 200_000  # pairs of a task or group and a group that encloses it
_COLUMNS = ("task", "missed", "round", "left", "entered")


AT_LEAST = frozenset(
    f"analysis.{code}" for code in ("too-long", "battery-exceeded", "window-late", "window-missed")
)
"""codes of the diagnostics that claim a lower bound"""


class LeastTooLargeError(Exception):
    """Raised when the robot may be at too many positions, or groups nest too deeply."""


@dataclass(frozen=True, slots=True)
class _RobotPosition:
    """Position of the robot: at a pose, or somewhere on a way from it or to it."""

    pose: RobotPose
    is_there: bool
    """whether the robot is exactly at the pose"""


@dataclass(frozen=True, slots=True)
class _Visit:
    """Transition to a task, perhaps into a further round of a group."""

    task: int
    repeated: int | None = None
    """group whose further round starts with the task; None if there is none"""


@dataclass(frozen=True, slots=True)
class _VisitCost:
    """Least cost of a visit from one point."""

    visit: _Visit
    entered: tuple[int, ...]
    """groups that the transition enters, the outermost first"""
    time: float
    """least s of the drive and the action, or of the wait"""
    energy: float
    """least Wh of the drive and the action, or of the wait"""


class LeastSteps:
    """Steps of a mission if nothing fails, with the least cost of each of them.

    Raises:
        LeastTooLargeError: The robot may be at too many positions, or groups nest too deeply.
    """

    def __init__(self, mission: Mission, travel: Travel, proved: Proved) -> None:
        self.mission = mission
        self.layout = MissionLayout(mission)
        self.travel = travel
        self._proved = proved
        if self._nesting() > _MOST_NESTING:
            raise LeastTooLargeError
        self._chains = [self._groups_around(g) for g in range(len(mission.groups))]
        self._legs: dict[tuple[RobotPose, int], Leg] = {}
        self._robots: dict[ProgramPoint, dict[_RobotPosition, None]] = {}
        self._visits: dict[ProgramPoint, tuple[_Visit, ...]] = {}
        self._at_once: dict[ProgramPoint, tuple[ProgramPoint, ...]] = {}
        """for each point, the points reached at the same time, without a further task"""
        self._explore()
        self._action_costs = self._least_action_costs()
        self._visit_costs = {
            point: tuple(self._visit_cost(point, visit) for visit in visits)
            for point, visits in self._visits.items()
        }

    def enclosing_groups_outermost_first(self, point: ProgramPoint) -> tuple[int, ...]:
        """Return the numbers of the groups that enclose a point of the mission, outermost first.

        The end of a group's round lies within the group; the points at which the group is entered
        or left lie outside of it.
        """
        kind, at = point
        if kind in ("task", "missed"):
            inside = self.layout.innermost[at]
            return () if inside is None else self._chains[inside]
        if kind == "round":
            return self._chains[at]
        return self._chains[at][:-1] if kind in ("left", "entered") else ()

    def always_misses_hard_window(self, task_end: ProgramPoint, least_times: SpentByPoint) -> bool:
        """Return True if a task can't end before its hard window closes, by lower bounds on time.

        `task_end` is the point of the task's end; `least_times` has the least s from the mission's
        start to each point.
        """
        deadline = self._deadline(task_end[1])
        return deadline is not None and least_times.get(task_end, 0.0) > deadline + _TOLERANCE

    def tasks_always_missing_hard_window(self, least_times: SpentByPoint) -> frozenset[int]:
        tasks = range(len(self.mission.tasks))
        return frozenset(
            i for i in tasks if self.always_misses_hard_window(("task", i), least_times)
        )

    def successors_with_least_totals(
        self, point: ProgramPoint, spent: SpentByPoint, periods: tuple[float, ...], *, of_time: bool
    ) -> Iterator[tuple[ProgramPoint, float]]:
        """Yield the points that can follow a point, with the least time or energy until each.

        All times and energies count from the mission's start.

        Args:
            point: The point.
            spent: Claimed least time or energy until each point.
            periods: Claimed least time or energy from one round of each group to the next.
            of_time: True for time in s, False for energy in Wh.
        """
        here = spent[point]
        for other in self._at_once.get(point, ()):
            yield other, here
        for cost in self._visit_costs.get(point, ()):
            yield from self._enter_task(cost, here, spent, periods, of_time)
        kind, at = point
        if kind == "round":
            last = self._earliest_end(at, here, spent, periods, of_time)
            if last is not None:
                yield ("left", at), last
        elif kind == "entered" and self.layout.hard[at]:
            # The time is up, whatever the robot is doing.
            passed = self.mission.groups[at].max_repeat_duration if of_time else 0.0
            yield ("left", at), here + passed

    def _enter_task(
        self,
        cost: _VisitCost,
        here: float,
        spent: SpentByPoint,
        periods: tuple[float, ...],
        of_time: bool,
    ) -> Iterator[tuple[ProgramPoint, float]]:
        i, repeated = cost.visit.task, cost.visit.repeated
        missed = started = here
        if repeated is not None:
            missed = started = here - periods[repeated]
            every = self.mission.groups[repeated].every
            if of_time and every and periods[repeated] <= every:
                # Round n does not start before it is due (G13).
                entered = spent.get(("entered", repeated), -math.inf)
                started = max(started, entered + (every - periods[repeated]))
        for g in cost.entered:
            yield ("entered", g), started
        ended = started + (cost.time if of_time else cost.energy)
        window = self.mission.tasks[i].window
        if window is None:
            yield ("task", i), ended
            return
        # Windows count from the mission's start; in a group, all rounds share them.
        shared = self.layout.innermost[i] is not None
        if of_time and not shared:
            ended = max(ended, window.earliest + self._action_costs.get(i, (0.0, 0.0))[0])
        yield ("task", i), ended
        deadline = self._deadline(i)
        if deadline is not None:
            yield ("missed", i), max(missed, deadline) if of_time and not shared else missed

    def _earliest_end(
        self, g: int, here: float, spent: SpentByPoint, periods: tuple[float, ...], of_time: bool
    ) -> float | None:
        """Return the least time (s) or energy (Wh) at which a group's last round can end (G8).

        It counts from the mission's start, like `here`, the value at the end of the first round of
        group `g`. Returns None if a further round always follows.
        """
        group = self.mission.groups[g]
        ends = []
        if group.until:
            ends.append(here)
        if group.max_repeat_count:
            ends.append(here + (group.max_repeat_count - 1) * periods[g])
        if group.max_repeat_duration:
            up = spent.get(("entered", g), -math.inf) + group.max_repeat_duration
            ends.append(max(here, up) if of_time else here)
            if group.every:
                due = math.ceil(
                    group.max_repeat_duration / group.every * (1 - _ROUND_TOLERANCE)
                    - _ROUND_TOLERANCE
                )
                ends.append(here + max(due - 1, 0) * periods[g])
        return min(ends, default=None)

    def _visit_cost(self, source: ProgramPoint, visit: _Visit) -> _VisitCost:
        inside = self.enclosing_groups_outermost_first(("task", visit.task))
        shared = sum(
            a == b
            for a, b in zip(inside, self.enclosing_groups_outermost_first(source), strict=False)
        )
        return _VisitCost(visit, inside[shared:], *self._cost(source, visit.task))

    def _cost(self, source: ProgramPoint, i: int) -> tuple[float, float]:
        """Return the least time (s) and energy (Wh) of the drive to task `i` and of its action.

        It is the least over all positions that the robot may have at the point `source`. A WAIT has
        no drive and takes no energy; it takes its duration, or 0 s if it has none.
        """
        task = self.mission.tasks[i]
        if task.wait is not None:
            return task.wait.duration or 0.0, 0.0
        time = energy = math.inf
        for robot in self._robots.get(source, ()):
            taken = self._action_costs[i]
            if robot.is_there:
                leg = self._leg(robot.pose, i)
                taken = leg.duration, leg.energy
            time, energy = min(time, taken[0]), min(energy, taken[1])
        return max(time, 0.0), max(energy, 0.0)

    def _least_action_costs(self) -> dict[int, tuple[float, float]]:
        """Return the least time (s) and energy (Wh) of each task's action, without the drive."""
        costs: dict[int, tuple[float, float]] = {}
        for (_, i), leg in self._legs.items():
            time, energy = costs.get(i, (math.inf, math.inf))
            work = min(leg.work, leg.duration), min(leg.work_energy, leg.energy)
            costs[i] = max(min(time, work[0]), 0.0), max(min(energy, work[1]), 0.0)
        return costs

    def _leg(self, pose: RobotPose, i: int) -> Leg:
        known = self._legs.get((pose, i))
        if known is None:
            task = self.mission.tasks[i]
            leg = self.travel.leg_with_action(pose, task, task.velocity)
            known = Leg(0.0, 0.0, pose) if isinstance(leg, NoPath) else leg
            self._legs[pose, i] = known
        return known

    def _nesting(self) -> int:
        depth = [group.name.count("/") + 1 for group in self.mission.groups]
        return sum(depth) + sum(depth[g] for g in self.layout.innermost if g is not None)

    def _groups_around(self, g: int) -> tuple[int, ...]:
        chain: list[int] = []
        at: int | None = g
        while at is not None:
            chain.append(at)
            at = self.layout.parent[at]
        return tuple(reversed(chain))

    def _deadline(self, i: int) -> float | None:
        window = self.mission.tasks[i].window
        return None if window is None or not window.hard else window.latest

    def _explore(self) -> None:
        """Compute for each point the robot's possible positions, and what can follow the point."""
        pending = [(BEGIN, _RobotPosition(self.travel.start_pose(self.mission), True))]
        while pending:
            point, robot = pending.pop()
            known = self._robots.setdefault(point, {})
            if robot in known:
                continue
            if len(known) >= _MOST_POSES:
                raise LeastTooLargeError
            known[robot] = None
            if point not in self._visits:
                self._visits[point] = tuple(self._visits_from(point))
                self._at_once[point] = tuple(self._at_once_from(point))
            pending += [(other, robot) for other in self._at_once[point]]
            if point[0] == "round":
                pending.append((("left", point[1]), robot))
            for visit in self._visits[point]:
                pending += self._robots_after(visit.task, robot)

    def _robots_after(
        self, i: int, robot: _RobotPosition
    ) -> Iterator[tuple[ProgramPoint, _RobotPosition]]:
        cut: tuple[_RobotPosition, ...]
        if self.mission.tasks[i].wait is not None:
            # The robot stays where it is (W1).
            ended, cut = robot, (robot,)
        else:
            arrival = self._leg(robot.pose, i).arrival
            ended = _RobotPosition(arrival, True)
            cut = _RobotPosition(robot.pose, False), _RobotPosition(arrival, False)
        yield ("task", i), ended
        for position in cut:
            if self._deadline(i) is not None:
                yield ("missed", i), position
            for g in self.enclosing_groups_outermost_first(("task", i)):
                if self.layout.hard[g]:
                    yield ("left", g), position

    def _visits_from(self, point: ProgramPoint) -> Iterator[_Visit]:
        kind, at = point
        if point == BEGIN and self.layout.begin[0] == "task":
            yield _Visit(self.layout.begin[1])
        elif kind == "task":
            task = self.mission.tasks[at]
            if task.wait is not None and task.wait.limit is not None:
                yield from self._after_failure(task)
            yield from self._visits_by_transition(at)
        elif kind == "missed":
            task = self.mission.tasks[at]
            if task.window is not None and task.window.missed_target is not None:
                yield self._visit_of(task.window.missed_target)
                return
            yield from self._after_failure(task)
            if self._continues(task):
                yield from self._visits_by_transition(at)
        elif kind == "round" and at in self._proved.repeats:
            yield _Visit(self.layout.position[self.mission.groups[at].start], at)
        elif kind == "left" and self.layout.ending_around[at] is None:
            yield from self._unconditional(self.layout.last[at])

    def _at_once_from(self, point: ProgramPoint) -> Iterator[ProgramPoint]:
        kind, at = point
        if point == BEGIN and self.layout.begin[0] != "task":
            yield END
        elif kind == "task":
            task = self.mission.tasks[at]
            if task.wait is not None and task.wait.limit is not None and self._ends_mission(task):
                yield END
            yield from self._successors_at_once(at)
        elif kind == "missed":
            task = self.mission.tasks[at]
            if task.window is not None and task.window.missed_target is not None:
                return
            if self._ends_mission(task):
                yield END
            if self._continues(task):
                yield from self._successors_at_once(at)
        elif kind == "left":
            around = self.layout.ending_around[at]
            if around is not None:
                yield "round", around
            elif self._unconditional_index(self.layout.last[at]) is None:
                yield END

    def _after_failure(self, task: Task) -> Iterator[_Visit]:
        if task.on_failure is OnFailure.BRANCH and task.failure_target is not None:
            yield self._visit_of(task.failure_target)

    def _ends_mission(self, task: Task) -> bool:
        return task.on_failure in (OnFailure.RETURN, OnFailure.ABORT)

    def _continues(self, task: Task) -> bool:
        """Return True if a task's failure is followed by the transitions of its success (T8)."""
        branches = task.on_failure is OnFailure.BRANCH and task.failure_target is not None
        return not branches and not self._ends_mission(task)

    def _visits_by_transition(self, i: int) -> Iterator[_Visit]:
        """Yield the visits that the transitions of task `i` can lead to (T2, T3).

        If a group's round ends with the task, its unconditional transition is left out.
        """
        for k, transition in enumerate(self.mission.tasks[i].transitions):
            if transition.conditions and (i, k) in self._proved.transitions:
                yield self._visit_of(transition.target)
        if self.layout.ending[i] is None and not self._certain(i):
            yield from self._unconditional(i)

    def _successors_at_once(self, i: int) -> Iterator[ProgramPoint]:
        if self._certain(i):
            return
        ending = self.layout.ending[i]
        if ending is not None:
            yield "round", ending
        elif self._unconditional_index(i) is None:
            yield END

    def _certain(self, i: int) -> bool:
        """Return True if one of a task's conditional transitions is proved to be always taken."""
        transitions = self.mission.tasks[i].transitions
        return any((i, k) in self._proved.certain for k in range(len(transitions)))

    def _unconditional_index(self, i: int) -> int | None:
        transitions = enumerate(self.mission.tasks[i].transitions)
        return next((k for k, t in transitions if not t.conditions), None)

    def _unconditional(self, i: int) -> Iterator[_Visit]:
        k = self._unconditional_index(i)
        if k is not None and (i, k) in self._proved.transitions:
            yield self._visit_of(self.mission.tasks[i].transitions[k].target)

    def _visit_of(self, name: str) -> _Visit:
        return _Visit(self.layout.position[name])


def spent_by_point(witness: LeastSpent) -> dict[ProgramPoint, float]:
    """Return a witness's lower bounds on time (s) or energy (Wh), by point of the mission.

    They count from the mission's start, which has 0, and hold for the first round of each enclosing
    group. Points that are not reached are left out.
    """
    columns = witness.tasks, witness.missed, witness.rounds, witness.left, witness.entered
    spent: dict[ProgramPoint, float] = {BEGIN: 0.0}
    for kind, column in zip(_COLUMNS, columns, strict=True):
        spent |= {(kind, at): value for at, value in enumerate(column) if value is not None}
    if witness.end is not None:
        spent[END] = witness.end
    return spent


def is_valid(steps: LeastSteps, witness: LeastWitness) -> bool:
    """Return True if no step of the mission costs less than a witness claims.

    It claims the difference between the values of the step's two points, both for time and for
    energy.
    """
    if not all(_has_form(steps.mission, spent) for spent in (witness.time, witness.energy)):
        return False
    late = steps.tasks_always_missing_hard_window(spent_by_point(witness.time))
    return _is_consistent(steps, witness.time, late, of_time=True) and _is_consistent(
        steps, witness.energy, late, of_time=False
    )


def _has_form(mission: Mission, witness: LeastSpent) -> bool:
    groups = len(mission.groups)
    sizes = [len(witness.tasks), len(witness.missed)]
    sizes += [len(c) for c in (witness.rounds, witness.left, witness.entered, witness.periods)]
    periods = all(math.isfinite(p) and p >= 0 for p in witness.periods)
    return periods and sizes == [*[len(mission.tasks)] * 2, *[groups] * 4]


def _is_consistent(
    steps: LeastSteps, witness: LeastSpent, late: frozenset[int], *, of_time: bool
) -> bool:
    spent = spent_by_point(witness)
    for point in spent:
        if point[0] == "task" and point[1] in late:
            continue
        for other, least in steps.successors_with_least_totals(
            point, spent, witness.periods, of_time=of_time
        ):
            # This also rejects NaN.
            if other not in spent or not spent[other] <= least:
                return False
    return True


def unproved_bounds(
    mission: Mission, catalog: Catalog | None, travel: Travel, analysis: Analysis
) -> tuple[Diagnostic, ...]:
    """Return the diagnostics on lower bounds that the analysis's witness does not prove."""
    witnesses = analysis.witnesses
    if witnesses is None or not any(d.code in AT_LEAST for d in analysis.diagnostics):
        return bounds_unproved_by_steps(None, analysis)
    return bounds_unproved_by_steps(
        least_steps_if_computable(mission, catalog, travel, witnesses.nominal), analysis
    )


def least_steps_if_computable(
    mission: Mission, catalog: Catalog | None, travel: Travel, nominal: Invariant
) -> LeastSteps | None:
    """Return the steps that an invariant of the mission allows, with their least costs; or None.

    Returns None if the invariant `nominal` is wrong or includes failures, or if there are too many
    positions of the robot or nested groups.
    """
    proved = Verifier(mission, catalog).check_invariant(nominal)
    if proved is None or nominal.failures:
        return None
    try:
        return LeastSteps(mission, travel, proved)
    except LeastTooLargeError:
        return None


def bounds_unproved_by_steps(
    steps: LeastSteps | None, analysis: Analysis
) -> tuple[Diagnostic, ...]:
    """Return the diagnostics on lower bounds that the analysis's witness does not prove.

    Without `steps`, nothing is proved.
    """
    claims = tuple(d for d in analysis.diagnostics if d.code in AT_LEAST)
    least = None if analysis.witnesses is None else analysis.witnesses.least
    if not claims or steps is None or least is None or not is_valid(steps, least):
        return claims
    proved = _ProvedBounds(
        steps, analysis, spent_by_point(least.time), spent_by_point(least.energy)
    )
    return tuple(claim for claim in claims if not proved.proves(claim))


@dataclass(frozen=True)
class _ProvedBounds:
    """Lower bounds that an accepted witness proves."""

    steps: LeastSteps
    analysis: Analysis
    time: SpentByPoint
    energy: SpentByPoint

    def proves(self, claim: Diagnostic) -> bool:
        mission = self.steps.mission
        if claim.code == "analysis.too-long":
            return _exceeds(self.time, self.analysis.duration, mission.max_duration)
        if claim.code == "analysis.battery-exceeded":
            return _exceeds(self.energy, self.analysis.energy, self.steps.travel.battery)
        return _too_late(mission, claim, self.time)


def _exceeds(spent: SpentByPoint, claimed: Bounds | None, limit: float | None) -> bool:
    """Return True if the mission's proved least cost is the claimed one or more, and above a limit.

    False if there is no claim, limit or proof. `spent` has the proved lower bounds; all are times
    in s or energies in Wh.
    """
    least = None if claimed is None else claimed.least.value
    if least is None or limit is None or END not in spent:
        return False
    return spent[END] > limit and spent[END] >= least - _TOLERANCE - _ROUND_TOLERANCE * least * 10


def _too_late(mission: Mission, claim: Diagnostic, time: SpentByPoint) -> bool:
    for i, task in enumerate(mission.tasks):
        if subject_of("tasks", task.name) == claim.subject:
            latest = None if task.window is None else task.window.latest
            return latest is not None and time.get(("task", i), math.inf) > latest
    return False
