"""A checker of witnesses, independent of how they were found.

It reads a mission by the rules of `docs/language.md` alone and uses nothing of the analysis but the
form of its witnesses. Each step of the mission is looked at once.
"""

from bisect import bisect_left
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

from argo_compiler.analysis.facts import (
    Analysis,
    GroupFacts,
    TaskFacts,
    TransitionFacts,
    Verdict,
)
from argo_compiler.analysis.witness import Invariant, KeptReading, Trap
from argo_compiler.catalog import Catalog
from argo_compiler.il import Action, Condition, ConditionType, Mission, OnFailure, Stop, Task

Place = tuple[str, int]
"""`task`, `round` or `cut` with a position in the mission's list, or `END`"""
END: Place = ("end", 0)

Step = tuple[Place, int, int]
"""where to, the readings that may be there, and those that may still come there"""

Ranges = tuple[float, float, float, float]
"""of a checkpoint: between what its values lie, and its nominal ones"""

_AGED = (ConditionType.STALE, ConditionType.ABNORMAL)


@dataclass
class Proved:
    """What a witness leaves possible, by positions in the mission's lists; all else never is."""

    tasks: set[int] = field(default_factory=set)
    transitions: set[tuple[int, int]] = field(default_factory=set)
    """task and transition"""
    certain: set[tuple[int, int]] = field(default_factory=set)
    """transitions that are taken whenever they are looked at"""
    repeats: set[int] = field(default_factory=set)
    """groups that may begin another round"""
    ends: set[int] = field(default_factory=set)
    """groups that may end by themselves"""
    ended: bool = False


class Verifier:
    """Checks witnesses about one mission."""

    def __init__(self, mission: Mission, catalog: Catalog | None) -> None:
        self._mission = mission
        self._layout = GroupLayout(mission)
        checkpoints = () if catalog is None else catalog.checkpoints
        self._ranges = {
            str(c.id): (c.range.low, c.range.high, c.nominal.low, c.nominal.high)
            for c in checkpoints
        }

    def invariant(self, witness: Invariant) -> Proved | None:
        """What an invariant proves; None: some step leads out of it, or its form is wrong."""
        states = self._states(witness)
        if states is None:
            return None
        proved = Proved(ended=witness.ended)
        proved.tasks = {at for kind, at in states.places if kind == "task"}
        walk = _Walk(self._mission, self._layout, states, witness.failures, proved, self._ranges)
        if not states.holds(*walk.first()):
            return None
        for here in list(states.places):
            if not all(states.holds(*step) for step in walk.steps(here)):
                return None
        return proved

    def trap(self, witness: Trap, invariant: Invariant) -> bool:
        """Whether no step leads out of a trap, if what is there is as an invariant says, which has
        been checked."""
        states = self._states(invariant)
        places = self._places_of(witness)
        if states is None or places is None or not places or invariant.failures:
            return False
        if witness.kept is not None:
            kept = states.with_kept(witness.kept, self._ranges)
            if kept is None:
                return False
            states = kept
        walk = _Walk(self._mission, self._layout, states, False, Proved(), self._ranges)
        for here in places:
            if here not in states.places:
                continue
            for place, state, _ in walk.steps(here):
                if place not in places or not states.keeps(place, state, witness.kept):
                    return False
        return any(here in states.places for here in places)

    def _places_of(self, witness: Trap) -> set[Place] | None:
        task, group = self._layout.position, self._layout.group_position
        if not (set(witness.tasks) <= task.keys() and witness.tasks):
            return None
        if not {*witness.rounds, *witness.cuts} <= group.keys():
            return None
        return {
            *(("task", task[name]) for name in witness.tasks),
            *(("round", group[name]) for name in witness.rounds),
            *(("cut", group[name]) for name in witness.cuts),
        }

    def _states(self, witness: Invariant) -> "_States | None":
        columns = (
            ("task", witness.tasks, witness.late_tasks, len(self._mission.tasks)),
            ("round", witness.rounds, witness.late_rounds, len(self._mission.groups)),
            ("cut", witness.cuts, witness.late_cuts, len(self._mission.groups)),
        )
        states = _States({}, {}, {}, 0)
        for scale in witness.scales:
            if not states.add_scale(scale.object_id, scale.bounds, scale.shift, self._ranges):
                return None
        for kind, known, late, size in columns:
            if len(known) != size or len(late) != size:
                return None
            for at, state in enumerate(known):
                if state is not None:
                    states.places[kind, at] = state
                if late[at]:
                    states.late[kind, at] = late[at]
        if witness.ended:
            states.places[END] = states.late[END] = -1
        return states


@dataclass(frozen=True, slots=True)
class _Scale:
    """The readings of one checkpoint, and where its bits lie among those of all."""

    bounds: tuple[float, ...]
    shift: int
    values: int
    """the bits of the values that it may show"""
    abnormal: int
    """and of those that may be called abnormal"""

    @property
    def missing(self) -> int:
        return 1 << (2 * len(self.bounds) + 1)

    @property
    def unreadable(self) -> int:
        return self.missing << 1

    @property
    def failed(self) -> int:
        return self.missing << 2

    @property
    def width(self) -> int:
        return 2 * len(self.bounds) + 4

    @property
    def full(self) -> int:
        return (1 << self.width) - 1

    def reaching(self, low: float, high: float) -> int:
        """The values from `low` to `high`, both included, and those of the same regions."""
        first, last = bisect_left(self.bounds, low), bisect_left(self.bounds, high)
        first_bit = 2 * first + (low in self.bounds[first : first + 1])
        last_bit = 2 * last + (high in self.bounds[last : last + 1])
        return (1 << (last_bit + 1)) - (1 << first_bit)

    def at_most(self, bound: float, inclusive: bool) -> int | None:
        """The values below a bound; None if it is not one of the bounds."""
        k = bisect_left(self.bounds, bound)
        if k == len(self.bounds) or self.bounds[k] != bound:
            return None
        return (1 << (2 * k + 1 + inclusive)) - 1

    def satisfying(self, condition: Condition) -> int:
        """The readings with which a condition may hold, its age apart."""
        all_values = self.missing - 1
        match condition.type:
            case ConditionType.UNREADABLE:
                return self.unreadable
            case ConditionType.FAILED:
                return self.unreadable | self.failed
            case ConditionType.STALE:
                return all_values
            case ConditionType.ABNORMAL:
                return self.abnormal
        low, high = condition.param1, condition.param2
        if low is None:
            return 0
        if condition.type is ConditionType.LESS:
            below = self.at_most(low, condition.inclusive)
            return all_values if below is None else below
        above = self.at_most(low, not condition.inclusive)
        held = all_values if above is None else all_values & ~above
        if condition.type is ConditionType.WITHIN and high is not None:
            below = self.at_most(high, condition.inclusive)
            held &= all_values if below is None else below
        return held

    def decides(self, condition: Condition) -> bool:
        """Whether a condition is true of all or none of the values of each bit."""
        return not condition.type.compares or all(
            self.at_most(bound, False) is not None for bound in _bounds_of(condition)
        )


def _bounds_of(condition: Condition) -> list[float]:
    return [bound for bound in (condition.param1, condition.param2) if bound is not None]


@dataclass
class _States:
    """The readings at each place, all checkpoints beside each other in one number."""

    places: dict[Place, int]
    late: dict[Place, int]
    """what may still come there from an action that is being cancelled (I3)"""
    scales: dict[str, _Scale]
    width: int
    """bits in all"""

    def add_scale(
        self, object_id: str, bounds: tuple[float, ...], shift: int, ranges: Mapping[str, Ranges]
    ) -> bool:
        """Whether the scale may lie there: above those before."""
        if object_id in self.scales or shift < self.width:
            return False
        if any(not a < b for a, b in pairwise(bounds)):
            return False
        scale = _Scale(bounds, shift, 0, 0)
        values = abnormal = scale.missing - 1
        if object_id in ranges:
            low, high, normal_low, normal_high = ranges[object_id]
            values = scale.reaching(low, high)
            # A region belongs to the nominal values for sure only if it lies among them.
            first, last = bisect_left(bounds, normal_low), bisect_left(bounds, normal_high)
            if normal_low in bounds[first : first + 1] and normal_high in bounds[last : last + 1]:
                abnormal &= ~scale.reaching(normal_low, normal_high)
        self.scales[object_id] = _Scale(bounds, shift, values, abnormal)
        self.width = shift + scale.width
        return True

    def late_readings(self, object_id: str, failures: bool) -> int:
        """What may come late: a value, or a success without one."""
        scale = self.scales[object_id]
        return (scale.values | (scale.unreadable if failures else 0)) << scale.shift

    def holds(self, place: Place, state: int, late: int) -> bool:
        known = self.places.get(place)
        if known is None or late & ~self.late.get(place, 0):
            return False
        return not (state | late) & ~known

    def keeps(self, place: Place, state: int, kept: KeptReading | None) -> bool:
        if place == END or kept is None:
            return place != END
        return not self.get(state, kept.object_id) & ~kept.readings

    def get(self, state: int, object_id: str) -> int:
        scale = self.scales[object_id]
        return state >> scale.shift & scale.full

    def set(self, state: int, object_id: str, readings: int) -> int:
        scale = self.scales[object_id]
        return state & ~(scale.full << scale.shift) | readings << scale.shift

    def with_kept(self, kept: KeptReading, ranges: Mapping[str, Ranges]) -> "_States | None":
        """The same with one checkpoint's readings as they are kept."""
        states = _States({}, dict(self.late), dict(self.scales), self.width)
        old = states.scales.pop(kept.object_id, None)
        if not states.add_scale(kept.object_id, kept.bounds, states.width, ranges):
            return None
        scale = states.scales[kept.object_id]
        if not 0 < kept.readings <= scale.full:
            return None
        hole = 0 if old is None else old.full << old.shift
        for place, state in self.places.items():
            states.places[place] = state & ~hole | kept.readings << scale.shift
        return states


class _Walk:
    """The steps of a mission from each of its places."""

    def __init__(
        self,
        mission: Mission,
        layout: "GroupLayout",
        states: _States,
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
        self._told = 0
        waited = {
            condition.object_id
            for task in mission.tasks
            for condition in (() if task.wait is None else task.wait.conditions)
        }
        measured = {task.object_id for task in mission.tasks if task.action is Action.MEASURE}
        for object_id, scale in states.scales.items():
            # What a mission waits for or never measures may be told at any time (C8).
            if object_id in waited or object_id not in measured:
                self._told |= scale.values << scale.shift

    def first(self) -> Step:
        """M1: where the mission begins. Nothing has been measured."""
        state = self._told
        for scale in self.states.scales.values():
            state |= scale.missing << scale.shift
        return self.layout.begin, state, 0

    def steps(self, here: Place) -> Iterator[Step]:
        """Where the mission may go on from a place, with which readings."""
        kind, at = here
        late = self.states.late.get(here, 0)
        state = self.states.places[here]
        if kind == "task":
            yield from self._leave_task(at, state, late)
        elif kind == "round":
            yield from self._end_round(at, state, late)
        elif kind == "cut":
            around = self.layout.parent[at]
            if around is not None and self.layout.timed[around]:
                yield ("cut", around), state, late
            if self.layout.hard[at]:
                self.proved.ends.add(at)
                yield from self._after_last(at, state, late)

    def _leave_task(self, at: int, state: int, late: int) -> Iterator[Step]:
        task = self.mission.tasks[at]
        own = self._late(task)
        ended = self._after(task, state)
        # A WAIT runs no action, so what is late may still come when it has ended. Other tasks begin
        # when the action before has ended, but may have failed by time before they begin.
        passing = late if task.wait is not None or self._by_time(task) else 0
        if self._may_fail(task):
            failed = self._after_failure(task, state)
            lost = passing | (own if self._by_time(task) else 0)
            if self._may_go_on(task):
                ended |= failed
                passing = lost
            for place in self._failure_places(task):
                yield place, failed | lost, lost
        inside = self.layout.innermost[at]
        if inside is not None and self.layout.timed[inside]:
            yield ("cut", inside), state | late | own, late | own
        yield from self._ways(at, task, ended | passing | self._told, passing)

    def _late(self, task: Task) -> int:
        """What may come from the task's action while it is cancelled."""
        if task.action is not Action.MEASURE or task.object_id not in self.states.scales:
            return 0
        return self.states.late_readings(task.object_id, self.failures)

    def _after(self, task: Task, state: int) -> int:
        """The readings when a task has ended (C3), by the robot or by hand (H3)."""
        o = task.object_id
        if task.action is not Action.MEASURE or o not in self.states.scales:
            return state
        scale = self.states.scales[o]
        # A success without a number is unreadable; by hand there may be no value.
        others = scale.unreadable | scale.missing if self.failures else 0
        return self.states.set(state, o, scale.values | others) | self._told

    def _after_failure(self, task: Task, state: int) -> int:
        o = task.object_id
        if task.action is not Action.MEASURE or o not in self.states.scales:
            return state
        scale = self.states.scales[o]
        others = scale.unreadable if self.failures else 0
        return self.states.set(state, o, scale.failed | others) | self._told

    def _may_fail(self, task: Task) -> bool:
        """Whether a task may fail for good; without failures, by time alone (W3, W5)."""
        waits = task.wait is not None and task.wait.limit is not None
        return self._missable(task) or waits or (self.failures and task.action is not Action.WAIT)

    def _missable(self, task: Task) -> bool:
        window = task.window
        return window is not None and window.hard and window.latest is not None

    def _by_time(self, task: Task) -> bool:
        """Whether a task may fail while its action, or one before, is being cancelled."""
        return self._missable(task) or (self.failures and task.time_limit is not None)

    def _by_itself(self, task: Task) -> bool:
        """Whether it may fail otherwise than by a missed window."""
        waits = task.wait is not None and task.wait.limit is not None
        return waits or (self.failures and task.action is not Action.WAIT)

    def _to_missed(self, task: Task) -> str | None:
        return None if task.window is None else task.window.missed_target

    def _may_go_on(self, task: Task) -> bool:
        """Whether some failure for good counts as any other end (T8)."""
        goes_on = task.on_failure is OnFailure.CONTINUE or (
            task.on_failure is OnFailure.BRANCH and task.failure_target is None
        )
        return goes_on and (self._by_itself(task) or self._to_missed(task) is None)

    def _failure_places(self, task: Task) -> Iterator[Place]:
        """Where a task leads that has failed for good, if not where any end leads (T8, W5)."""
        missed = self._to_missed(task)
        if self._missable(task) and missed is not None:
            yield self.layout.place(missed)
            if not self._by_itself(task):
                return
        if task.on_failure is OnFailure.BRANCH and task.failure_target is not None:
            yield self.layout.place(task.failure_target)
        elif task.on_failure in (OnFailure.RETURN, OnFailure.ABORT):
            yield END

    def _ways(self, at: int, task: Task, state: int, late: int) -> Iterator[Step]:
        """T2 and T3: the transitions in order, then the unconditional one."""
        changing = late | self._told
        fresh = None
        unmeasured = self.failures or (self._may_fail(task) and self._may_go_on(task))
        if task.action is Action.MEASURE and not unmeasured:
            fresh = task.object_id
        for k, transition in enumerate(task.transitions):
            if not transition.conditions:
                continue
            taken, rest, certain = self._test(transition.conditions, state, fresh)
            if taken is not None:
                self.proved.transitions.add((at, k))
                yield self.layout.place(transition.target), taken | changing, late
                if certain:
                    self.proved.certain.add((at, k))
                    return
            state = rest | changing
        ending = self.layout.ending[at]
        if ending is not None:
            yield ("round", ending), state, late
        else:
            yield from self._unconditional(at, state, late)

    def _test(
        self, conditions: tuple[Condition, ...], state: int, fresh: str | None
    ) -> tuple[int | None, int, bool]:
        """The readings if all conditions hold (None: they can't), and if not; whether they do."""
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
            holding = self._holding(condition)
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
            left = states.get(state, condition.object_id) & ~self._holding(condition)
            rest = states.set(state, condition.object_id, left)
        return taken if possible else None, rest, possible and not unsure

    def _in_range(self, condition: Condition) -> tuple[bool, bool]:
        """Whether a condition on a checkpoint without a scale may hold, and whether it does for
        every value in range."""
        known = self.ranges.get(condition.object_id)
        if known is None or not condition.type.compares:
            return True, False
        scale = _Scale(tuple(sorted({*known[:2], *_bounds_of(condition)})), 0, 0, 0)
        values, holding = scale.reaching(*known[:2]), scale.satisfying(condition)
        return values & holding != 0, not values & ~holding

    def _exact(self, condition: Condition, fresh: str | None) -> bool:
        """Whether each set of readings says for sure if a condition holds."""
        scale = self.states.scales.get(condition.object_id)
        timely = condition.max_age is None or condition.object_id == fresh
        exact = timely and condition.type not in _AGED
        return exact and scale is not None and scale.decides(condition)

    def _holding(self, condition: Condition) -> int:
        # The mission is kept as long as this, so ids stay what they are; hashing takes long.
        found = self._satisfying.get(id(condition))
        if found is None:
            found = self.states.scales[condition.object_id].satisfying(condition)
            self._satisfying[id(condition)] = found
        return found

    def _unconditional(self, at: int, state: int, late: int) -> Iterator[Step]:
        for k, transition in enumerate(self.mission.tasks[at].transitions):
            if not transition.conditions:
                self.proved.transitions.add((at, k))
                yield self.layout.place(transition.target), state, late
                return
        yield END, 0, 0

    def _end_round(self, number: int, state: int, late: int) -> Iterator[Step]:
        """G5 to G8."""
        group = self.mission.groups[number]
        changing = late | self._told
        held, left, certain = self._test(group.until, state, None)
        if group.max_repeat_count != 1 and not (group.until and certain):
            self.proved.repeats.add(number)
            start = "task", self.layout.position[group.start]
            yield start, (left | changing if group.until else state), late
        limited = group.max_repeat_count > 0 or group.max_repeat_duration > 0
        if limited or (group.until and held is not None):
            if not self.layout.hard[number]:
                self.proved.ends.add(number)
            after = state if limited or held is None else held | changing
            yield from self._after_last(number, after, late)

    def _after_last(self, number: int, state: int, late: int) -> Iterator[Step]:
        """G6, G7: the next group outward decides, or the unconditional transition is taken."""
        around = self.layout.ending_around[number]
        if around is not None:
            yield ("round", around), state, late
        else:
            yield from self._unconditional(self.layout.last[number], state, late)


class GroupLayout:
    """Which tasks lie in which groups (G1), by position."""

    def __init__(self, mission: Mission) -> None:
        self.position = {task.name: i for i, task in enumerate(mission.tasks)}
        self.group_position = {group.name: g for g, group in enumerate(mission.groups)}
        groups = mission.groups
        first = [self.position[group.start] for group in groups]
        self.last = [self.position[group.end] for group in groups]
        self.parent = [self.group_position.get(g.name.rpartition("/")[0]) for g in groups]
        self.innermost: list[int | None] = [None] * len(mission.tasks)
        self.ending: list[int | None] = [None] * len(mission.tasks)
        """for each task the innermost group that ends with it"""
        self.hard = [g.max_repeat_duration > 0 and g.stop is Stop.HARD for g in groups]
        self.timed = [False] * len(groups)
        self.ending_around: list[int | None] = [None] * len(groups)
        """for each group the one around it, if that ends with the same task"""
        depth = [group.name.count("/") for group in groups]
        opened: dict[int, list[int]] = {}
        for g in sorted(range(len(groups)), key=lambda g: depth[g]):
            around = self.parent[g]
            self.timed[g] = self.hard[g] or (around is not None and self.timed[around])
            if around is not None and self.last[around] == self.last[g]:
                self.ending_around[g] = around
            self.ending[self.last[g]] = g
            opened.setdefault(first[g], []).append(g)
        inside: list[int] = []
        for i in range(len(mission.tasks)):
            inside += opened.get(i, ())
            if inside:
                self.innermost[i] = inside[-1]
            while inside and self.last[inside[-1]] == i:
                inside.pop()
        self.begin = self._begin(mission)

    def place(self, name: str) -> Place:
        return "task", self.position[name]

    def _begin(self, mission: Mission) -> Place:
        start = next((t for t in mission.tasks if t.action is Action.START), None)
        if start is not None:
            for transition in start.transitions:
                if not transition.conditions:
                    return self.place(transition.target)
        for i, task in enumerate(mission.tasks):
            if task.action is not Action.START:
                return "task", i
        return END


def unproved(mission: Mission, catalog: Catalog | None, analysis: Analysis) -> tuple[str, ...]:
    """The claims of an analysis that its witnesses do not show, in words; none: all are right."""
    witnesses = analysis.witnesses
    if witnesses is None:
        return ("there are no witnesses",)
    verifier = Verifier(mission, catalog)
    nominal, whatever = verifier.invariant(witnesses.nominal), verifier.invariant(witnesses.all)
    if nominal is None or whatever is None or not witnesses.all.failures:
        return ("what can't happen",)
    if witnesses.nominal.failures:
        return ("what happens only after failures",)
    claims = _Claims(mission, nominal, whatever)
    wrong = [claims.of_task(facts) for facts in analysis.tasks]
    wrong += [claims.of_group(facts) for facts in analysis.groups]
    if not _excluded(analysis.ends, whatever.ended, nominal.ended):
        wrong.append(["how the mission ends"])
    traps = ["endless loops" for t in witnesses.traps if not verifier.trap(t, witnesses.nominal)]
    return tuple(dict.fromkeys([*(one for many in wrong for one in many), *traps]))


def _excluded(verdict: Verdict, whatever: bool, nominal: bool) -> bool:
    """Whether what a verdict excludes is excluded, by what may be with failures and without."""
    if verdict is Verdict.NEVER:
        return not whatever
    return not (verdict is Verdict.AFTER_FAILURE and nominal)


class _Claims:
    """The verdicts of an analysis beside what is proved."""

    def __init__(self, mission: Mission, nominal: Proved, whatever: Proved) -> None:
        self.mission = mission
        self.tasks = {task.name: i for i, task in enumerate(mission.tasks)}
        self.groups = {group.name: i for i, group in enumerate(mission.groups)}
        self.nominal = nominal
        self.whatever = whatever

    def of_task(self, facts: TaskFacts) -> list[str]:
        at = self.tasks.get(facts.task)
        if at is None:
            return [f"task '{facts.task}'"]
        right = _excluded(facts.verdict, at in self.whatever.tasks, at in self.nominal.tasks)
        wrong = [] if right else [f"task '{facts.task}'"]
        for one in facts.transitions:
            if not self._right(at, one):
                wrong.append(f"transition {one.index} of task '{facts.task}'")
        return wrong

    def _right(self, at: int, facts: TransitionFacts) -> bool:
        key = (at, facts.index)
        if facts.verdict is not Verdict.ALWAYS:
            may = key in self.whatever.transitions, key in self.nominal.transitions
            return _excluded(facts.verdict, *may)
        transitions = self.mission.tasks[at].transitions
        if transitions[facts.index].conditions:
            return key in self.nominal.certain or key not in self.nominal.transitions
        return not any(
            transition.conditions and (at, k) in self.nominal.transitions
            for k, transition in enumerate(transitions)
        )

    def of_group(self, facts: GroupFacts) -> list[str]:
        at = self.groups.get(facts.group)
        if at is None:
            return [f"group '{facts.group}'"]
        whatever, nominal = self.whatever, self.nominal
        right = _excluded(facts.repeats, at in whatever.repeats, at in nominal.repeats)
        right = right and _excluded(facts.ends, at in whatever.ends, at in nominal.ends)
        return [] if right else [f"group '{facts.group}'"]
