"""A checker of what a mission takes at least, independent of how that was found.

It reads the mission by the rules of `docs/language.md` and asks the travel; of the analysis it uses
only the form of the witnesses and what `verification` has proved about the transitions. Each step
of the mission is looked at once: none may take less than the difference that a witness claims.

No action fails and no reaction begins. The robot may be anywhere on its way when a time is up.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from argo_compiler.analysis.facts import Analysis, Bounds
from argo_compiler.analysis.travel import Leg, NoWay, Standing, Travel
from argo_compiler.analysis.verification import Verifier
from argo_compiler.analysis.verification_layout import GroupLayout
from argo_compiler.analysis.verification_walk import Proved
from argo_compiler.analysis.witness import Invariant, LeastSpent, LeastWitness
from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Diagnostic
from argo_compiler.diagnostics.subject import subject_of
from argo_compiler.il import Mission, OnFailure, Task

Place = tuple[str, int]
"""`task`, `missed`, `round`, `left` or `entered` with a position in the mission's list, or:"""
BEGIN: Place = ("begin", 0)
END: Place = ("end", 0)

Spent = Mapping[Place, float]
"""at least, since the mission's start"""

_SOON = 1e-6  # s: sums of floats are not exact
_SLACK = 1e-9  # of a round, likewise
_STANDINGS = 64  # of one place that are looked at
_NESTING = 200_000  # pairs of a task or group and one around it
_COLUMNS = ("task", "missed", "round", "left", "entered")


AT_LEAST = frozenset(
    f"analysis.{code}" for code in ("too-long", "battery-exceeded", "window-late", "window-missed")
)
"""the diagnostics that say what is taken at least"""


class LeastTooLargeError(Exception):
    """There are more standings, or groups nest deeper, than is looked at."""


@dataclass(frozen=True, slots=True)
class _Robot:
    """Where the robot is: at a standing, or somewhere on a way from it or to it."""

    standing: Standing
    there: bool


@dataclass(frozen=True, slots=True)
class _Visit:
    """A way to a task, perhaps into a further round of a group."""

    task: int
    repeated: int | None = None


@dataclass(frozen=True, slots=True)
class _Way:
    """A visit, from one place."""

    visit: _Visit
    entered: tuple[int, ...]
    """the groups that are entered on the way, from the outside in"""
    time: float
    """s of the way and the action, or the wait, at least"""
    energy: float
    """Wh, likewise"""


class LeastSteps:
    """The steps of a mission if nothing fails, and what each of them takes at least.

    Raises:
        LeastTooLargeError: the robot may be at too many standings, or groups nest too deeply.
    """

    def __init__(self, mission: Mission, travel: Travel, proved: Proved) -> None:
        self.mission = mission
        self.layout = GroupLayout(mission)
        self.travel = travel
        self._proved = proved
        if self._nesting() > _NESTING:
            raise LeastTooLargeError
        self._chains = [self._groups_around(g) for g in range(len(mission.groups))]
        self._legs: dict[tuple[Standing, int], Leg] = {}
        self._robots: dict[Place, dict[_Robot, None]] = {}
        self._visits: dict[Place, tuple[_Visit, ...]] = {}
        self._onward: dict[Place, tuple[Place, ...]] = {}
        """places that are come to at the same time"""
        self._spread()
        self._work = self._least_work()
        self._ways_on = {
            place: tuple(self._way(place, visit) for visit in visits)
            for place, visits in self._visits.items()
        }

    def around(self, place: Place) -> tuple[int, ...]:
        """The groups that a place lies in, from the outside in."""
        kind, at = place
        if kind in ("task", "missed"):
            inside = self.layout.innermost[at]
            return () if inside is None else self._chains[inside]
        if kind == "round":
            return self._chains[at]
        return self._chains[at][:-1] if kind in ("left", "entered") else ()

    def late(self, place: Place, time: Spent) -> bool:
        """Whether a task never ends, as its hard window is always over before."""
        deadline = self._deadline(place[1])
        return deadline is not None and time.get(place, 0.0) > deadline + _SOON

    def late_tasks(self, time: Spent) -> frozenset[int]:
        tasks = range(len(self.mission.tasks))
        return frozenset(i for i in tasks if self.late(("task", i), time))

    def steps(
        self, place: Place, spent: Spent, periods: tuple[float, ...], *, of_time: bool
    ) -> Iterator[tuple[Place, float]]:
        """Where the mission may go on from a place, and what has been spent there at least."""
        here = spent[place]
        for other in self._onward.get(place, ()):
            yield other, here
        for way in self._ways_on.get(place, ()):
            yield from self._come(way, here, spent, periods, of_time)
        kind, at = place
        if kind == "round":
            last = self._last_round(at, here, spent, periods, of_time)
            if last is not None:
                yield ("left", at), last
        elif kind == "entered" and self.layout.hard[at]:
            # Whatever was done before the time was up.
            passed = self.mission.groups[at].max_repeat_duration if of_time else 0.0
            yield ("left", at), here + passed

    def _come(
        self,
        way: _Way,
        here: float,
        spent: Spent,
        periods: tuple[float, ...],
        of_time: bool,
    ) -> Iterator[tuple[Place, float]]:
        i, repeated = way.visit.task, way.visit.repeated
        missed = begun = here
        if repeated is not None:
            missed = begun = here - periods[repeated]
            every = self.mission.groups[repeated].every
            if of_time and every and periods[repeated] <= every:
                # Round n is not begun before it is due (G13).
                entered = spent.get(("entered", repeated), -math.inf)
                begun = max(begun, entered + (every - periods[repeated]))
        for g in way.entered:
            yield ("entered", g), begun
        ended = begun + (way.time if of_time else way.energy)
        window = self.mission.tasks[i].window
        if window is None:
            yield ("task", i), ended
            return
        # Windows count from the mission's start: in a group, all rounds share them.
        shared = self.layout.innermost[i] is not None
        if of_time and not shared:
            ended = max(ended, window.earliest + self._work.get(i, (0.0, 0.0))[0])
        yield ("task", i), ended
        deadline = self._deadline(i)
        if deadline is not None:
            yield ("missed", i), max(missed, deadline) if of_time and not shared else missed

    def _last_round(
        self, g: int, here: float, spent: Spent, periods: tuple[float, ...], of_time: bool
    ) -> float | None:
        """G8: when no other round is wanted; None: another one always is."""
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
                due = math.ceil(group.max_repeat_duration / group.every * (1 - _SLACK) - _SLACK)
                ends.append(here + max(due - 1, 0) * periods[g])
        return min(ends, default=None)

    def _way(self, source: Place, visit: _Visit) -> _Way:
        inside = self.around(("task", visit.task))
        kept = sum(a == b for a, b in zip(inside, self.around(source), strict=False))
        return _Way(visit, inside[kept:], *self._cost(source, visit.task))

    def _cost(self, source: Place, i: int) -> tuple[float, float]:
        """s and Wh of the way from a place to a task, and its action, or the wait."""
        task = self.mission.tasks[i]
        if task.wait is not None:
            return task.wait.duration or 0.0, 0.0
        time = energy = math.inf
        for robot in self._robots.get(source, ()):
            taken = self._work[i]
            if robot.there:
                leg = self._leg(robot.standing, i)
                taken = leg.duration, leg.energy
            time, energy = min(time, taken[0]), min(energy, taken[1])
        return max(time, 0.0), max(energy, 0.0)

    def _least_work(self) -> dict[int, tuple[float, float]]:
        """s and Wh of each task's action, wherever the robot comes from."""
        found: dict[int, tuple[float, float]] = {}
        for (_, i), leg in self._legs.items():
            time, energy = found.get(i, (math.inf, math.inf))
            work = min(leg.work, leg.duration), min(leg.work_energy, leg.energy)
            found[i] = max(min(time, work[0]), 0.0), max(min(energy, work[1]), 0.0)
        return found

    def _leg(self, standing: Standing, i: int) -> Leg:
        known = self._legs.get((standing, i))
        if known is None:
            task = self.mission.tasks[i]
            found = self.travel.leg(standing, task, task.velocity)
            known = Leg(0.0, 0.0, standing) if isinstance(found, NoWay) else found
            self._legs[standing, i] = known
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

    def _spread(self) -> None:
        """Where the robot may be at each place."""
        pending = [(BEGIN, _Robot(self.travel.start(self.mission), True))]
        while pending:
            place, robot = pending.pop()
            known = self._robots.setdefault(place, {})
            if robot in known:
                continue
            if len(known) >= _STANDINGS:
                raise LeastTooLargeError
            known[robot] = None
            if place not in self._visits:
                self._visits[place] = tuple(self._visits_from(place))
                self._onward[place] = tuple(self._onward_from(place))
            pending += [(other, robot) for other in self._onward[place]]
            if place[0] == "round":
                pending.append((("left", place[1]), robot))
            for visit in self._visits[place]:
                pending += self._robots_after(visit.task, robot)

    def _robots_after(self, i: int, robot: _Robot) -> Iterator[tuple[Place, _Robot]]:
        cut: tuple[_Robot, ...]
        if self.mission.tasks[i].wait is not None:
            # It stays where it is (W1).
            ended, cut = robot, (robot,)
        else:
            arrival = self._leg(robot.standing, i).arrival
            ended = _Robot(arrival, True)
            cut = _Robot(robot.standing, False), _Robot(arrival, False)
        yield ("task", i), ended
        for somewhere in cut:
            if self._deadline(i) is not None:
                yield ("missed", i), somewhere
            for g in self.around(("task", i)):
                if self.layout.hard[g]:
                    yield ("left", g), somewhere

    def _visits_from(self, place: Place) -> Iterator[_Visit]:
        kind, at = place
        if place == BEGIN and self.layout.begin[0] == "task":
            yield _Visit(self.layout.begin[1])
        elif kind == "task":
            task = self.mission.tasks[at]
            if task.wait is not None and task.wait.limit is not None:
                yield from self._after_failure(task)
            yield from self._ways(at)
        elif kind == "missed":
            task = self.mission.tasks[at]
            if task.window is not None and task.window.missed_target is not None:
                yield self._to(task.window.missed_target)
                return
            yield from self._after_failure(task)
            if self._goes_on(task):
                yield from self._ways(at)
        elif kind == "round" and at in self._proved.repeats:
            yield _Visit(self.layout.position[self.mission.groups[at].start], at)
        elif kind == "left" and self.layout.ending_around[at] is None:
            yield from self._unconditional(self.layout.last[at])

    def _onward_from(self, place: Place) -> Iterator[Place]:
        kind, at = place
        if place == BEGIN and self.layout.begin[0] != "task":
            yield END
        elif kind == "task":
            task = self.mission.tasks[at]
            if task.wait is not None and task.wait.limit is not None and self._ends_mission(task):
                yield END
            yield from self._after_ways(at)
        elif kind == "missed":
            task = self.mission.tasks[at]
            if task.window is not None and task.window.missed_target is not None:
                return
            if self._ends_mission(task):
                yield END
            if self._goes_on(task):
                yield from self._after_ways(at)
        elif kind == "left":
            around = self.layout.ending_around[at]
            if around is not None:
                yield "round", around
            elif self._last_way(self.layout.last[at]) is None:
                yield END

    def _after_failure(self, task: Task) -> Iterator[_Visit]:
        if task.on_failure is OnFailure.BRANCH and task.failure_target is not None:
            yield self._to(task.failure_target)

    def _ends_mission(self, task: Task) -> bool:
        return task.on_failure in (OnFailure.RETURN, OnFailure.ABORT)

    def _goes_on(self, task: Task) -> bool:
        """Whether a failure counts as any other end (T8)."""
        branches = task.on_failure is OnFailure.BRANCH and task.failure_target is not None
        return not branches and not self._ends_mission(task)

    def _ways(self, i: int) -> Iterator[_Visit]:
        """T2 and T3, the ends of rounds apart."""
        for k, transition in enumerate(self.mission.tasks[i].transitions):
            if transition.conditions and (i, k) in self._proved.transitions:
                yield self._to(transition.target)
        if self.layout.ending[i] is None and not self._certain(i):
            yield from self._unconditional(i)

    def _after_ways(self, i: int) -> Iterator[Place]:
        if self._certain(i):
            return
        ending = self.layout.ending[i]
        if ending is not None:
            yield "round", ending
        elif self._last_way(i) is None:
            yield END

    def _certain(self, i: int) -> bool:
        """Whether one of the transitions with conditions is always taken."""
        transitions = self.mission.tasks[i].transitions
        return any((i, k) in self._proved.certain for k in range(len(transitions)))

    def _last_way(self, i: int) -> int | None:
        transitions = enumerate(self.mission.tasks[i].transitions)
        return next((k for k, t in transitions if not t.conditions), None)

    def _unconditional(self, i: int) -> Iterator[_Visit]:
        k = self._last_way(i)
        if k is not None and (i, k) in self._proved.transitions:
            yield self._to(self.mission.tasks[i].transitions[k].target)

    def _to(self, name: str) -> _Visit:
        return _Visit(self.layout.position[name])


def spent_of(witness: LeastSpent) -> dict[Place, float]:
    """A witness by places, the mission's start included."""
    columns = witness.tasks, witness.missed, witness.rounds, witness.left, witness.entered
    spent: dict[Place, float] = {BEGIN: 0.0}
    for kind, column in zip(_COLUMNS, columns, strict=True):
        spent |= {(kind, at): value for at, value in enumerate(column) if value is not None}
    if witness.end is not None:
        spent[END] = witness.end
    return spent


def holds(steps: LeastSteps, witness: LeastWitness) -> bool:
    """Whether no step of the mission takes less than a witness says."""
    if not all(_has_form(steps.mission, one) for one in (witness.time, witness.energy)):
        return False
    late = steps.late_tasks(spent_of(witness.time))
    return _holds(steps, witness.time, late, of_time=True) and _holds(
        steps, witness.energy, late, of_time=False
    )


def _has_form(mission: Mission, witness: LeastSpent) -> bool:
    groups = len(mission.groups)
    sizes = [len(witness.tasks), len(witness.missed)]
    sizes += [len(c) for c in (witness.rounds, witness.left, witness.entered, witness.periods)]
    periods = all(math.isfinite(p) and p >= 0 for p in witness.periods)
    return periods and sizes == [*[len(mission.tasks)] * 2, *[groups] * 4]


def _holds(steps: LeastSteps, witness: LeastSpent, late: frozenset[int], *, of_time: bool) -> bool:
    spent = spent_of(witness)
    for place in spent:
        if place[0] == "task" and place[1] in late:
            continue
        for other, least in steps.steps(place, spent, witness.periods, of_time=of_time):
            # Not a number is never right.
            if other not in spent or not spent[other] <= least:
                return False
    return True


def unproved_bounds(
    mission: Mission, catalog: Catalog | None, travel: Travel, analysis: Analysis
) -> tuple[Diagnostic, ...]:
    """The diagnostics about what is taken at least that the witness does not show."""
    witnesses = analysis.witnesses
    if witnesses is None or not any(d.code in AT_LEAST for d in analysis.diagnostics):
        return unshown(None, analysis)
    return unshown(least_steps(mission, catalog, travel, witnesses.nominal), analysis)


def least_steps(
    mission: Mission, catalog: Catalog | None, travel: Travel, nominal: Invariant
) -> LeastSteps | None:
    """The steps over the transitions that an invariant leaves possible; None if it is wrong, or
    there is too much to look at."""
    proved = Verifier(mission, catalog).invariant(nominal)
    if proved is None or nominal.failures:
        return None
    try:
        return LeastSteps(mission, travel, proved)
    except LeastTooLargeError:
        return None


def unshown(steps: LeastSteps | None, analysis: Analysis) -> tuple[Diagnostic, ...]:
    """The same, with the mission's steps; None: nothing is shown."""
    claims = tuple(d for d in analysis.diagnostics if d.code in AT_LEAST)
    least = None if analysis.witnesses is None else analysis.witnesses.least
    if not claims or steps is None or least is None or not holds(steps, least):
        return claims
    shown = _Shown(steps, analysis, spent_of(least.time), spent_of(least.energy))
    return tuple(claim for claim in claims if not shown.says(claim))


@dataclass(frozen=True)
class _Shown:
    """What a witness that has been accepted shows."""

    steps: LeastSteps
    analysis: Analysis
    time: Spent
    energy: Spent

    def says(self, claim: Diagnostic) -> bool:
        mission = self.steps.mission
        if claim.code == "analysis.too-long":
            return _exceeds(self.time, self.analysis.duration, mission.max_duration)
        if claim.code == "analysis.battery-exceeded":
            return _exceeds(self.energy, self.analysis.energy, self.steps.travel.battery)
        return _too_late(mission, claim, self.time)


def _exceeds(spent: Spent, claimed: Bounds | None, limit: float | None) -> bool:
    """Whether the mission's end takes as much as is claimed, and more than a limit."""
    least = None if claimed is None else claimed.least.value
    if least is None or limit is None or END not in spent:
        return False
    return spent[END] > limit and spent[END] >= least - _SOON - _SLACK * least * 10


def _too_late(mission: Mission, claim: Diagnostic, time: Spent) -> bool:
    for i, task in enumerate(mission.tasks):
        if subject_of("tasks", task.name) == claim.subject:
            latest = None if task.window is None else task.window.latest
            return latest is not None and time.get(("task", i), math.inf) > latest
    return False
