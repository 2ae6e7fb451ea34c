"""Simulated world that executes an executor's commands, and its comparison with the reference."""

from enum import StrEnum
from itertools import cycle

import pytest

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Cause,
    Executor,
    GiveBack,
    StartAction,
    Tick,
    lower,
)
from argo_compiler.hfsm.progress import Phase
from argo_compiler.il import Action
from tests.argo_compiler.hfsm.reference import Reference

STEPS = 60
MOVES = {Cause.START, Cause.CONDITION, Cause.REPEAT, Cause.DEFAULT, Cause.TIMEOUT}
FAILURES = {Cause.FAILURE, Cause.MISSED}


class Ticks(StrEnum):
    """When the world calls its executor."""

    DEADLINES = "at its deadlines"
    SECONDS = "every second"
    EVENTS = "when something happens"


class World:
    """World that executes the commands of an executor; `seen` lists them with their times."""

    def __init__(self, executor, case, ticks=Ticks.DEADLINES, now=0):
        self.executor = executor
        self.results = cycle(case.results)
        self.script = []
        for wait, scripted in case.script:
            self.script.append(((self.script[-1][0] if self.script else now) + wait, scripted))
        self.ticks = ticks
        self.now = now
        self.running = None
        self.ends_at = None
        self.end_event = None
        self.seen = []

    def start(self):
        self.execute(self.executor.start(self.now))

    def run(self):
        self.start()
        for _ in range(STEPS):
            if not self.step():
                break

    def execute(self, commands):
        for command in commands:
            self.seen.append((self.now, *in_reference_terms(command, self.now)))
            if isinstance(command, StartAction):
                assert self.running is None
                self.running, self.result = command, next(self.results)
                begins = self.now if self.result.failed else max(self.now, command.not_before or 0)
                self.ends_at = begins + self.result.seconds
                self.end_event = make_end_event(command, self.result)
            else:
                assert self.running.id == command.id
                self.ends_at = self.now + self.result.clean_up
                if not self.result.late:
                    self.end_event = ActionStopped(command.task, id=command.id)

    def step(self):
        """Simulate the next event; return False if there will be none."""
        scripted = self.script[0][0] if self.script else None
        times = [t for t in (self.ends_at, scripted) if t is not None]
        due = self.executor.next_deadline
        if due is not None and not (times and self.ticks is Ticks.EVENTS):
            times.append(due)
        if not times:
            return False
        if self.ticks is Ticks.SECONDS and self.now + 1 < min(times):
            self.handle(Tick(), self.now + 1)
        elif min(times) == self.ends_at:
            end_event, now = self.end_event, self.ends_at
            self.running = self.ends_at = None
            self.handle(end_event, now)
            if now % 2:  # a driver that delivers it twice
                with pytest.raises(ValueError, match=r"no action|does not run|another action"):
                    self.handle(end_event, now)
        elif min(times) == scripted:
            self.handle_scripted(self.script.pop(0)[1], scripted)
        else:
            self.handle(Tick(), due)
        return True

    def handle_scripted(self, scripted, now):
        """Pass a scripted event to the executor.

        A `GiveBack` waits until no action runs, and is replaced by a `Tick` if the mission is not
        paused.
        """
        if isinstance(scripted, GiveBack):
            if self.running is not None:
                self.script.insert(0, (self.ends_at, scripted))
                return
            if not self.executor.paused:
                scripted = Tick()
        self.handle(scripted, max(now, self.now))

    def handle(self, event, now):
        self.now = now
        self.execute(self.executor.handle(event, now))


def in_reference_terms(command, now):
    """Return a command in the form of the reference."""
    if isinstance(command, CancelAction):
        return CancelAction, command.task, command.id
    return StartAction, command.task.name, command.id, max((command.not_before or now) - now, 0)


def make_end_event(command, result):
    name = command.task.name
    if result.failed:
        return ActionFailed(
            name, "failed", result.unreadable, command.id, unreachable=result.unreachable
        )
    if command.task.action is not Action.MEASURE:
        return ActionSucceeded(name, id=command.id)
    return ActionSucceeded(name, result.value, result.abnormal, id=command.id)


def steps(executor):
    """Return the transitions of the mission from task to task."""
    return [
        (e.time, e.target)
        for e in executor.trace
        if e.cause in MOVES or (e.cause in FAILURES and e.target is not None)
    ]


def reports(executor):
    return [(e.time, e.event) for e in executor.trace if e.cause is Cause.REPORT]


def executor_state(executor):
    progress = executor.progress()
    task = progress.active
    started = task is not None and progress.round_of is None
    reaction = progress.reaction
    return {
        "outcome": progress.outcome,
        "paused": progress.paused,
        "reaction": (reaction.event, reaction.over) if reaction else None,
        "held": reaction.held if reaction and reaction.phase is Phase.HOLDING else None,
        "waiting": [(w.event, w.over) for w in progress.waiting],
        "task": task,
        "attempt": progress.attempt if task else None,
        "since": progress.since if started else None,
        "round_of": progress.round_of,
        "groups": {g.group: (g.round, g.elapsed) for g in progress.groups},
        "readings": {r.object_id: (r.kind, r.value, r.abnormal, r.age) for r in progress.readings},
        "tallies": {t.task: (t.done, t.failed, t.by_hand) for t in progress.tallies},
        "failed": progress.failed,
        "elapsed": progress.elapsed,
        "by_hand": [(done.task, done.age or 0) for done in progress.by_hand],
    }


def reference_state(reference):
    active, task = reference.active, reference.current
    started = task is not None and reference.round_of is None
    return {
        "outcome": reference.outcome,
        "paused": reference.paused,
        "reaction": (active.reaction.event, active.until_occurred) if active else None,
        "held": active.held if active and active.there else None,
        "waiting": [
            (a.reaction.event, a.until_occurred) for a in reference.alarms if a is not active
        ],
        "task": task,
        "attempt": reference.failures if task else None,
        "since": reference.since if started else None,
        "round_of": reference.round_of,
        "groups": {g: (reference.round[g], clock) for g, clock in reference.clock.items()},
        "readings": {
            id: (r.kind, r.value, r.abnormal, r.age) for id, r in reference.readings.items()
        },
        "tallies": {
            task: (t["done"], t["failed"], t["by_hand"]) for task, t in reference.tallies.items()
        },
        "failed": reference.failed,
        "elapsed": reference.elapsed,
        "by_hand": [(work.what.task, work.age) for work in reference.by_hand],
    }


class Pair:
    """Executor and reference that run side by side; both must do the same at all times."""

    def __init__(self, executor, reference):
        self.executor = executor
        self.reference = reference

    @property
    def next_deadline(self):
        return self.executor.next_deadline

    @property
    def paused(self):
        return self.executor.paused

    def start(self, now):
        return self.agree(self.executor.start(now), self.reference.start(now), now)

    def handle(self, event, now):
        return self.agree(self.executor.handle(event, now), self.reference.handle(event, now), now)

    def agree(self, commands, expected, now):
        assert [in_reference_terms(command, now) for command in commands] == expected
        assert executor_state(self.executor) == reference_state(self.reference)
        return commands


def compare(case, ticks, reference=Reference):
    """Assert that executor and reference never differ; return the reference."""
    pair = Pair(Executor(lower(case.mission)), reference(case.mission))
    World(pair, case, ticks).run()
    assert steps(pair.executor) == pair.reference.steps
    assert reports(pair.executor) == pair.reference.events
    return pair.reference
