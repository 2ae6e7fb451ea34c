"""Random missions through the machine and through a reference interpreter of the IL.

The reference knows no states and no transitions of a machine. It steps through whole seconds and
keeps, by name, which groups it is in, since when and in which round.
"""

from itertools import cycle, islice

from hypothesis import assume, given, settings
from hypothesis import strategies as st

from argo_compiler.check import check
from argo_compiler.diagnostics import Severity
from argo_compiler.hfsm import (
    ActionFailed,
    ActionSucceeded,
    Executor,
    Hfsm,
    Progress,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Group,
    Mission,
    Stop,
    Task,
    Transition,
)
from argo_compiler.model import Pose

STEPS = 60
OBJECTS = ("1", "2", "3")


class Reference:
    """What a mission does, straight from the rules."""

    def __init__(self, mission, outcomes):
        self.tasks = {task.name: task for task in mission.tasks}
        self.groups = {group.name: group for group in mission.groups}
        order = [task.name for task in mission.tasks]
        self.members = {
            g.name: set(order[order.index(g.start) : order.index(g.end) + 1])
            for g in mission.groups
        }
        self.outcomes = outcomes
        self.since = {}
        self.round = {}
        self.values = {}
        self.trace = []
        self.current = None
        self.first = self.first_task(mission)

    @staticmethod
    def first_task(mission):
        for task in mission.tasks:
            if task.action is Action.START:
                for transition in task.transitions:
                    if not transition.conditions:
                        return transition.target
        return next(task.name for task in mission.tasks if task.action is not Action.START)

    def run(self):
        self.go(self.first, 0, left=())
        while self.current is not None and len(self.trace) < STEPS:
            duration, value, failed = next(self.outcomes)
            started = self.trace[-1][0]
            ends = started + duration
            if not self.cancelled(started, ends):
                self.ended(ends, None if failed else value)
                self.time_outs(ends)
        return self.trace[:STEPS]

    def cancelled(self, started, ends):
        """Lets whole seconds pass while an action runs; whether a time-out cancels it."""
        before = len(self.trace)
        for now in range(started + 1, ends):
            self.time_outs(now)
            if len(self.trace) > before:
                return True
        return False

    def go(self, target, now, left):
        stays = {g for g in self.since if g not in left and target in self.members[g]}
        self.since = {g: self.since[g] for g in stays}
        self.round = {g: self.round[g] for g in stays}
        for g in self.groups:
            if target in self.members[g] and g not in stays:
                self.since[g], self.round[g] = now, 1
        self.current = target
        self.trace.append((now, target))

    def inside(self, name):
        return {g for g in self.groups if g == name or g.startswith(name + "/")}

    def wants(self, g, now):
        group = self.groups[g]
        more = group.max_repeat_count == 0 or self.round[g] < group.max_repeat_count
        limit = group.max_repeat_duration
        return more and (limit == 0 or now - self.since[g] < limit)

    def round_over(self, g, now):
        """Group `g` has come to the end of a round; it and those around it decide."""
        group = self.groups[g]
        if self.wants(g, now):
            self.round[g] += 1
            self.go(group.start, now, left=self.inside(g) - {g})
            return
        around = g.rpartition("/")[0]
        if around and self.groups[around].end == group.end:
            self.round_over(around, now)
        else:
            self.unconditionally(self.tasks[group.end], now, left=self.inside(g))

    def unconditionally(self, task, now, left):
        targets = [t.target for t in task.transitions if not t.conditions]
        self.go(targets[0] if targets else None, now, left)

    def ended(self, now, value):
        task = self.tasks[self.current]
        if value is not None and task.action is Action.MEASURE:
            self.values[task.object_id] = value, now
        for transition in task.transitions:
            if transition.conditions and all(self.holds(c, now) for c in transition.conditions):
                self.go(transition.target, now, left=())
                return
        ending = [g for g in self.groups if self.groups[g].end == task.name]
        if ending:
            self.round_over(max(ending, key=len), now)
        else:
            self.unconditionally(task, now, left=())

    def holds(self, c, now):
        if c.object_id not in self.values:
            return False
        value, at = self.values[c.object_id]
        fresh = c.max_age is None or at + c.max_age >= now
        return (
            fresh
            and {
                ConditionType.LESS: value < c.param1,
                ConditionType.GREATER: c.param1 < value,
                ConditionType.WITHIN: c.param1 < value and value < (c.param2 or 0),
            }[c.type]
        )

    def time_outs(self, now):
        up = [
            g
            for g, since in self.since.items()
            if self.groups[g].stop is Stop.HARD
            and 0 < self.groups[g].max_repeat_duration <= now - since
        ]
        if up:
            self.round_over(min(up, key=len), now)


class Drive:
    """The machine, driven by the same outcomes; `poll` adds ticks at every second."""

    def __init__(self, executor, outcomes, poll=False, offset=0):
        self.executor = executor
        self.outcomes = outcomes
        self.poll = poll
        self.now = offset
        self.running = None

    def note(self, commands):
        if any(isinstance(command, StartAction) for command in commands):
            duration, value, failed = next(self.outcomes)
            self.running = self.now + duration, value, failed

    def start(self):
        self.note(self.executor.start(self.now))

    def step(self):
        ends_at, value, failed = self.running
        deadline = self.executor.next_deadline
        if self.poll and self.now + 1 < ends_at:
            self.now += 1
            event = Tick()
        elif deadline is not None and deadline < ends_at:
            self.now = deadline
            event = Tick()
        else:
            self.now = ends_at
            event = self.end_of_action(value, failed)
        self.note(self.executor.handle(event, self.now))

    def end_of_action(self, value, failed):
        name = self.executor.active
        if failed:
            return ActionFailed(name, "failed")
        reads = self.executor.configuration[-1].startswith("task:M")
        return ActionSucceeded(name, value if reads else None)

    def finish(self):
        while not self.executor.finished and len(self.executor.trace) < STEPS:
            self.step()
        return [(entry.time, entry.target) for entry in self.executor.trace[:STEPS]]


@st.composite
def conditions(draw):
    low = draw(st.integers(0, 4))
    return Condition(
        type=draw(st.sampled_from(ConditionType)),
        object_id=draw(st.sampled_from(OBJECTS)),
        param1=low,
        param2=draw(st.integers(low + 1, 6)),
        max_age=draw(st.one_of(st.none(), st.integers(1, 6))),
    )


@st.composite
def missions(draw):
    size = draw(st.integers(1, 9))
    kinds = draw(st.lists(st.booleans(), min_size=size, max_size=size))
    names = [f"{'M' if measures else 'W'}{i}" for i, measures in enumerate(kinds)]
    tasks = [draw(tasks_named(name, names, i)) for i, name in enumerate(names)]
    if draw(st.booleans()):
        ways = draw(st.lists(st.sampled_from(names), max_size=1))
        start = Task(
            name="S",
            action=Action.START,
            transitions=tuple(Transition(target=way) for way in ways),
        )
        tasks.insert(0, start)
    return Mission(tasks=tuple(tasks), groups=tuple(draw(groups_over(names))))


@st.composite
def tasks_named(draw, name, names, index):
    ways = [
        Transition(target=draw(st.sampled_from(names)), conditions=tuple(held))
        for held in draw(st.lists(st.lists(conditions(), min_size=1, max_size=2), max_size=2))
    ]
    onward = draw(st.sampled_from(["next", "next", "next", "any", "end"]))
    if onward != "end":
        following = names[index + 1] if index + 1 < len(names) else None
        target = draw(st.sampled_from(names)) if onward == "any" else following
        if target is not None:
            ways.insert(draw(st.integers(0, len(ways))), Transition(target=target))
    return Task(
        name=name,
        action=Action.MEASURE if name.startswith("M") else Action.WAYPOINT,
        object_id=draw(st.sampled_from(OBJECTS)) if name.startswith("M") else None,
        pose=None if name.startswith("M") else Pose(x=0, y=0, z=0),
        transitions=tuple(ways),
    )


@st.composite
def groups_over(draw, names):
    """Ranges that lie in each other or apart, named by their nesting."""
    ends = st.integers(0, len(names) - 1)
    kept = []
    for a, b in draw(st.lists(st.tuples(ends, ends), max_size=5)):
        first, last = min(a, b), max(a, b)
        crosses = any(f < first <= e < last or first < f <= last < e for f, e in kept)
        if not crosses:
            kept.append((first, last))
    paths = []
    groups = []
    for i, (first, last) in enumerate(sorted(kept, key=lambda r: (r[0], -r[1]))):
        while paths and paths[-1][1] < first:
            paths.pop()
        name = f"{paths[-1][0]}/{i}" if paths else str(i)
        paths.append((name, last))
        groups.append(
            Group(
                name=name,
                start=names[first],
                end=names[last],
                max_repeat_count=draw(st.integers(0, 3)),
                max_repeat_duration=draw(st.sampled_from([0, 0, 1, 2, 3, 5, 8, 13])),
                stop=draw(st.sampled_from(Stop)),
            )
        )
    return draw(st.permutations(groups))


# How long an action takes (s), what it reads, and whether it fails.
outcome_lists = st.lists(
    st.tuples(st.integers(0, 4), st.one_of(st.none(), st.integers(0, 6)), st.booleans()),
    min_size=1,
    max_size=8,
)


def machine(mission):
    assume(all(d.severity is not Severity.ERROR for d in check(mission)))
    return lower(mission)


@settings(max_examples=400, deadline=None)
@given(missions(), outcome_lists)
def test_machine_does_what_the_rules_say(mission, outcomes):
    drive = Drive(Executor(machine(mission)), cycle(outcomes))
    drive.start()
    assert drive.finish() == Reference(mission, cycle(outcomes)).run()


@settings(max_examples=80, deadline=None)
@given(missions(), outcome_lists)
def test_more_ticks_change_nothing(mission, outcomes):
    hfsm = machine(mission)
    drives = [Drive(Executor(hfsm), cycle(outcomes), poll) for poll in (False, True)]
    for drive in drives:
        drive.start()
    assert drives[0].finish() == drives[1].finish()


@settings(max_examples=80, deadline=None)
@given(missions(), outcome_lists, st.integers(0, 20))
def test_restored_machine_goes_on_alike(mission, outcomes, steps):
    hfsm = Hfsm.model_validate_json(machine(mission).model_dump_json())
    whole = Drive(Executor(hfsm), cycle(outcomes))
    whole.start()
    drawn = 1
    for _ in range(steps):
        if whole.executor.finished:
            break
        running = whole.running
        whole.step()
        drawn += whole.running is not running
    progress = Progress.model_validate_json(whole.executor.progress().model_dump_json())
    before = len(whole.executor.trace)
    if whole.executor.finished:
        return
    offset = 1000
    rest = Drive(
        Executor.restore(hfsm, progress, offset),
        islice(cycle(outcomes), drawn - 1, None),
        offset=offset,
    )
    rest.start()
    shift = offset - whole.now
    for _ in range(20):
        if whole.executor.finished:
            break
        whole.step()
        rest.step()
    expected = [(e.time + shift, *_what(e)) for e in whole.executor.trace[before:]]
    assert [(e.time, *_what(e)) for e in rest.executor.trace[1:]] == expected


def _what(entry):
    return entry.source, entry.target, entry.cause, entry.conditions, entry.failure


@settings(max_examples=60, deadline=None)
@given(missions())
def test_every_state_carries_what_it_came_from(mission):
    hfsm = machine(mission)
    tasks = [task for task in mission.tasks if task.action is not Action.START]
    assert [leaf.task for leaf in hfsm.leaves] == tasks
    assert {c.name for c in hfsm.composites[1:]} == {group.name for group in mission.groups}
    for composite in hfsm.composites[1:]:
        assert composite.id in next(
            parent.children for parent in hfsm.composites if parent.id == composite.parent
        )
