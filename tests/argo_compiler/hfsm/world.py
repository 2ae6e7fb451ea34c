"""What carries out an executor's commands, and compares it with the reference."""

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


class Hears(StrEnum):
    """When a driver tells its executor the time."""

    DEADLINES = "at its deadlines"
    SECONDS = "every second"
    EVENTS = "when something happens"


class World:
    """Carries out what an executor asks for; `seen` is what it was asked, and when."""

    def __init__(self, executor, case, hears=Hears.DEADLINES, now=0):
        self.executor = executor
        self.doings = cycle(case.doings)
        self.script = []
        for wait, happening in case.script:
            self.script.append(((self.script[-1][0] if self.script else now) + wait, happening))
        self.hears = hears
        self.now = now
        self.running = None
        self.ends_at = None
        self.ending = None
        self.seen = []

    def start(self):
        self.note(self.executor.start(self.now))

    def run(self):
        self.start()
        for _ in range(STEPS):
            if not self.step():
                break

    def note(self, commands):
        for command in commands:
            self.seen.append((self.now, *read(command, self.now)))
            if isinstance(command, StartAction):
                assert self.running is None
                self.running, self.doing = command, next(self.doings)
                begins = self.now if self.doing.failed else max(self.now, command.not_before or 0)
                self.ends_at = begins + self.doing.seconds
                self.ending = result(command, self.doing)
            else:
                assert self.running.id == command.id
                self.ends_at = self.now + self.doing.clean_up
                if not self.doing.late:
                    self.ending = ActionStopped(command.task, id=command.id)

    def step(self):
        """The next thing that happens; False: nothing will."""
        happening = self.script[0][0] if self.script else None
        times = [t for t in (self.ends_at, happening) if t is not None]
        due = self.executor.next_deadline
        if due is not None and not (times and self.hears is Hears.EVENTS):
            times.append(due)
        if not times:
            return False
        if self.hears is Hears.SECONDS and self.now + 1 < min(times):
            self.tell(Tick(), self.now + 1)
        elif min(times) == self.ends_at:
            ending, now = self.ending, self.ends_at
            self.running = self.ends_at = None
            self.tell(ending, now)
            if now % 2:  # a driver that delivers it twice
                with pytest.raises(ValueError, match=r"no action|does not run|another action"):
                    self.tell(ending, now)
        elif min(times) == happening:
            self.happens(self.script.pop(0)[1], happening)
        else:
            self.tell(Tick(), due)
        return True

    def happens(self, happening, now):
        """A person gives back what they have taken, and when it stands still."""
        if isinstance(happening, GiveBack):
            if self.running is not None:
                self.script.insert(0, (self.ends_at, happening))
                return
            if not self.executor.paused:
                happening = Tick()
        self.tell(happening, max(now, self.now))

    def tell(self, event, now):
        self.now = now
        self.note(self.executor.handle(event, now))


def read(command, now):
    """A command in the reference's words."""
    if isinstance(command, CancelAction):
        return CancelAction, command.task, command.id
    return StartAction, command.task.name, command.id, max((command.not_before or now) - now, 0)


def result(command, doing):
    name = command.task.name
    if doing.failed:
        return ActionFailed(name, "failed", doing.unreadable, id=command.id)
    if command.task.action is not Action.MEASURE:
        return ActionSucceeded(name, id=command.id)
    return ActionSucceeded(name, doing.value, doing.abnormal, id=command.id)


def steps(executor):
    """The ways of the mission from task to task."""
    return [
        (e.time, e.target)
        for e in executor.trace
        if e.cause in MOVES or (e.cause in FAILURES and e.target is not None)
    ]


def reports(executor):
    return [(e.time, e.event) for e in executor.trace if e.cause is Cause.REPORT]


def where(executor):
    progress = executor.progress()
    task = progress.active
    begun = task is not None and progress.round_of is None
    reaction = progress.reaction
    return {
        "outcome": progress.outcome,
        "paused": progress.paused,
        "reaction": (reaction.event, reaction.over) if reaction else None,
        "held": reaction.held if reaction and reaction.phase is Phase.HOLDING else None,
        "waiting": [(w.event, w.over) for w in progress.waiting],
        "task": task,
        "attempt": progress.attempt if task else None,
        "since": progress.since if begun else None,
        "round_of": progress.round_of,
        "groups": {g.group: (g.round, g.elapsed) for g in progress.groups},
        "readings": {r.object_id: (r.kind, r.value, r.abnormal, r.age) for r in progress.readings},
        "tallies": {t.task: (t.done, t.failed, t.by_hand) for t in progress.tallies},
        "failed": progress.failed,
        "elapsed": progress.elapsed,
        "by_hand": [(done.task, done.age or 0) for done in progress.by_hand],
    }


def where_reference(reference):
    active, task = reference.active, reference.current
    begun = task is not None and reference.round_of is None
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
        "since": reference.since if begun else None,
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
    """A machine and the reference, which are to do the same at all times."""

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
        assert [read(command, now) for command in commands] == expected
        assert where(self.executor) == where_reference(self.reference)
        return commands


def compare(case, hears, reference=Reference):
    """Nothing differs at any time; returns the reference."""
    pair = Pair(Executor(lower(case.mission)), reference(case.mission))
    World(pair, case, hears).run()
    assert steps(pair.executor) == pair.reference.steps
    assert reports(pair.executor) == pair.reference.events
    return pair.reference
