"""Random missions through the machine and through a reference interpreter of the IL."""

from dataclasses import replace
from itertools import cycle, tee

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from argo_compiler.checks import check
from argo_compiler.diagnostics import Severity
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Cause,
    Executor,
    Hfsm,
    Pause,
    Progress,
    Resume,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.hfsm.model import RETURN
from argo_compiler.il import Action
from tests.argo_compiler.hfsm.random_missions import (
    busy_missions,
    busy_scripts,
    missions,
    outcome_lists,
    scripts,
)
from tests.argo_compiler.hfsm.reference import Reference
from tests.conftest import examples

STEPS = 60
MOVES = {Cause.START, Cause.CONDITION, Cause.REPEAT, Cause.DEFAULT, Cause.TIMEOUT}


class World:
    """Carries out what an executor asks for; `seen` is what it was asked, and when."""

    def __init__(self, executor, outcomes, script, poll=False, now=0):
        self.executor = executor
        self.outcomes = cycle(outcomes)
        self.script = []
        for wait, happening in script:
            self.script.append(((self.script[-1][0] if self.script else 0) + wait, happening))
        self.poll = poll
        self.now = now
        self.running = None
        self.ends_at = None
        self.ending = None
        self.seen = []

    def start(self):
        self.note(self.executor.start(self.now))

    def note(self, commands):
        for command in commands:
            kind, name = read(command)
            self.seen.append((self.now, kind, name))
            if kind is StartAction:
                assert self.running is None
                self.running, self.outcome = name, next(self.outcomes)
                duration, value, failed, _, _ = self.outcome
                self.ends_at = self.now + duration
                self.ending = result(name, value, failed)
            else:
                assert self.running == name
                _, value, failed, clean_up, late = self.outcome
                self.ends_at = self.now + clean_up
                self.ending = result(name, value, failed) if late else ActionStopped(name)

    def step(self):
        """The next thing that happens; False: nothing will."""
        due = self.executor.next_deadline
        happening = self.script[0][0] if self.script else None
        times = [t for t in (self.ends_at, happening, due) if t is not None]
        if not times:
            return False
        if self.poll and self.now + 1 < min(times):
            self.now += 1
            self.note(self.executor.handle(Tick(), self.now))
            return True
        self.now = min(times)
        if self.now == self.ends_at:
            ending, self.running, self.ends_at = self.ending, None, None
            self.note(self.executor.handle(ending, self.now))
        elif self.now == happening:
            self.note(self.executor.handle(self.script.pop(0)[1], self.now))
        else:
            self.note(self.executor.handle(Tick(), self.now))
        return True


def read(command):
    if isinstance(command, StartAction):
        return StartAction, command.task.name
    return CancelAction, command.task


def result(name, value, failed):
    if failed:
        return ActionFailed(name, "failed")
    return ActionSucceeded(name, value if name.startswith("M") else None)


def machine(mission):
    assume(all(d.severity is not Severity.ERROR for d in check(mission)))
    return lower(mission)


def steps(executor):
    """The ways of the mission from task to task."""
    return [
        (e.time, e.target)
        for e in executor.trace
        if e.cause in MOVES or (e.cause is Cause.FAILURE and e.target is not None)
    ]


def reports(executor):
    return [(e.time, e.event) for e in executor.trace if e.cause is Cause.REPORT]


def where(executor):
    progress = executor.progress()
    return {
        "outcome": str(executor.outcome) if executor.outcome else None,
        "paused": executor.paused,
        "reaction": executor.reaction,
        "task": executor.active,
        "rounds": dict(executor.rounds),
        "values": {v.object_id: (v.value, v.age) for v in progress.values},
        "ended": [(e.task, e.failure) for e in progress.ended],
        "elapsed": progress.elapsed,
        "clocks": {g.group: g.elapsed for g in progress.groups},
    }


def where_reference(reference):
    active = reference.active
    return {
        "outcome": reference.outcome,
        "paused": reference.paused,
        "reaction": active.reaction.event if active else None,
        "task": reference.current,
        "rounds": reference.round,
        "values": {id: (value, reference.age[id]) for id, value in reference.values.items()},
        "ended": reference.done,
        "elapsed": reference.elapsed,
        "clocks": reference.clock,
    }


class Pair:
    """A machine and the reference, which are to do the same at all times."""

    def __init__(self, mission):
        self.executor = Executor(machine(mission))
        self.reference = Reference(mission)

    @property
    def next_deadline(self):
        return self.executor.next_deadline

    def start(self, now):
        return self.agree(self.executor.start(now), self.reference.start(now))

    def handle(self, event, now):
        return self.agree(self.executor.handle(event, now), self.reference.handle(event, now))

    def agree(self, commands, expected):
        assert [read(command) for command in commands] == expected
        assert where(self.executor) == where_reference(self.reference)
        return commands


@settings(max_examples=examples(100), deadline=None)
@given(missions(), outcome_lists, scripts, st.booleans())
def test_machine_does_what_the_rules_say(mission, outcomes, script, poll):
    run(mission, outcomes, script, poll)


@settings(max_examples=examples(100), deadline=None)
@given(busy_missions(), outcome_lists, busy_scripts)
def test_interruptions_are_what_the_rules_say(mission, outcomes, script):
    run(mission, outcomes, script, poll=False)


def run(mission, outcomes, script, poll):
    pair = Pair(mission)
    world = World(pair, outcomes, script, poll)
    world.start()
    for _ in range(STEPS):
        if not world.step():
            break
    assert steps(pair.executor) == pair.reference.steps
    assert reports(pair.executor) == pair.reference.events


@settings(max_examples=examples(40), deadline=None)
@given(missions(), outcome_lists, scripts)
def test_more_ticks_change_nothing(mission, outcomes, script):
    hfsm = machine(mission)
    worlds = [World(Executor(hfsm), outcomes, script, poll) for poll in (False, True)]
    for world in worlds:
        world.start()
        for _ in range(STEPS):
            if not world.step():
                break
    until = min(world.now for world in worlds)
    seen = [[one for one in world.seen if one[0] < until] for world in worlds]
    assert seen[0] == seen[1]


@pytest.mark.rule("H1", "H2")
@settings(max_examples=examples(60), deadline=None)
@given(missions(), outcome_lists, scripts, st.integers(0, 30), st.sampled_from([0, 0, 7]))
def test_restored_machine_goes_on_alike(mission, outcomes, script, count, away):
    """Against a machine that a person pauses for as long as the other one is away."""
    hfsm = machine(mission)
    world = World(Executor(hfsm), outcomes, script)
    world.start()
    for _ in range(count):
        if not world.step():
            break
    executor = world.executor
    if not executor.paused:
        world.note(executor.handle(Pause(), world.now))
    while world.running:
        world.ends_at = world.now
        world.ending = ActionStopped(world.running)
        world.step()
    text = executor.progress().model_dump_json()
    world.now += away
    executor.handle(Tick(), world.now)
    later = 1000
    other = Executor.restore(
        Hfsm.model_validate_json(hfsm.model_dump_json()),
        Progress.model_validate_json(text),
        later,
        away,
    )
    other.start(later)
    assert Progress.model_validate_json(other.progress().model_dump_json()) == executor.progress()
    rest = World(other, outcomes, script, now=later)
    rest.outcomes, world.outcomes = tee(world.outcomes)
    shift = later - world.now
    world.script = [(at + away, happening) for at, happening in world.script]
    rest.script = [(at + shift, happening) for at, happening in world.script]
    world.script.insert(0, (world.now, Resume()))
    rest.script.insert(0, (later, Resume()))
    before = len(executor.trace), len(other.trace)
    world.seen = []
    for _ in range(STEPS):
        going = world.step()
        assert rest.step() == going
        if not going:
            break
        assert rest.seen == [(at + shift, *what) for at, *what in world.seen]
        assert other.progress() == executor.progress()
    expected = [replace(entry, time=entry.time + shift) for entry in executor.trace[before[0] :]]
    assert list(other.trace[before[1] :]) == expected


@settings(max_examples=60, deadline=None)
@given(missions())
def test_every_state_carries_what_it_came_from(mission):
    hfsm = machine(mission)
    tasks = [task for task in mission.tasks if task.action is not Action.START]
    assert [leaf.task for leaf in hfsm.leaves if leaf.id != RETURN] == tasks
    assert {c.name for c in hfsm.composites[1:]} == {group.name for group in mission.groups}
    for composite in hfsm.composites[1:]:
        assert composite.id in next(
            parent.children for parent in hfsm.composites if parent.id == composite.parent
        )
