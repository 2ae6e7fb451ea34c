"""Argo's executor and an exported state chart, side by side on one virtual clock."""

from itertools import cycle

from argo_compiler.export.scxml import to_scxml
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    CancelAction,
    Executor,
    GiveBack,
    Occurred,
    Pause,
    Resume,
    TakeOver,
    Tick,
    lower,
)
from argo_compiler.hfsm.events import ReadingGiven
from tests.argo_compiler.export.charts import Chart

PLAIN = {
    Tick: "tick",
    Pause: "pause",
    TakeOver: "pause",
    Resume: "resume",
    GiveBack: "resume",
    Cancel: "cancel",
}


class Both:
    """The two machines of a mission. After each event they have to agree."""

    def __init__(self, mission):
        hfsm = lower(mission)
        self.executor = Executor(hfsm)
        self.chart = Chart(to_scxml(mission, hfsm))
        self.stopping = False
        self.started = 0
        self.now = 0
        self.note(self.executor.start(0))
        self.chart.start()
        self.agree("start")

    def note(self, commands):
        for command in commands:
            self.stopping = isinstance(command, CancelAction)
            self.started = command.id

    def at(self, now, event):
        if isinstance(event, (ActionFailed, ActionStopped, ActionSucceeded)):
            self.stopping = False
        self.now = now
        self.note(self.executor.handle(event, now))
        name, data = told(event, self.chart)
        self.chart.handle(name, now, **data)
        self.agree(event)

    def agree(self, event):
        assert self.chart.seen() == self.seen(), (self.now, event)
        assert self.chart.readings() == self.readings(), (self.now, event)

    def seen(self):
        executor = self.executor
        if executor.finished:
            return None, None, False, {}, str(executor.outcome)
        name = executor.running and executor.running.name
        if executor.outcome is not None:
            return None, name, self.stopping, {}, None
        return executor.active, name, self.stopping, dict(executor.rounds), None

    def readings(self):
        known = self.executor.readings.items()
        return {
            object_id: (str(r.kind), r.value, r.time, r.abnormal)
            for object_id, r in known
            if object_id in self.chart.objects
        }

    @property
    def deadline(self):
        due = [self.executor.next_deadline, self.chart.deadline]
        return min((at for at in due if at is not None), default=None)


def told(event, chart):
    """The event as the chart is told it."""
    match event:
        case Occurred(kind):
            return f"event.{kind}", {}
        case ReadingGiven(object_id, value, abnormal):
            if object_id not in chart.objects:
                return "tick", {}
            known = {"value": value, "abnormal": int(abnormal)}
            return f"reading.{chart.objects[object_id]}", known
        case ActionSucceeded(_, value, abnormal):
            return "action.succeeded", {"value": value, "abnormal": int(abnormal)}
        case ActionFailed(_, _, unreadable):
            return "action.failed", {"unreadable": int(unreadable)}
        case ActionStopped():
            return "action.stopped", {}
    return PLAIN[type(event)], {}


def play(mission, doings, script, steps=40):
    """Drives both machines through a mission; returns them. `doings` and `script` are those of
    `random_missions`."""
    both = Both(mission)
    doings = cycle(doings)
    script = list(script)
    at, doing, ends, token, stops = 0, None, None, None, False
    upcoming = []
    for delay, event in script:
        at += delay
        upcoming.append((at, GiveBack() if isinstance(event, GiveBack) else event))
    for _ in range(steps):
        executor = both.executor
        if executor.finished:
            break
        running = executor.running
        if running is None:
            ends, token = None, None
        elif both.started != token:
            doing, token, stops = next(doings), both.started, False
            ends = both.now + doing.seconds
        if running is not None and both.stopping and not stops:
            stops, ends = True, both.now + doing.clean_up
        due = [(ends, 0)] if ends is not None else []
        if upcoming:
            due.append((upcoming[0][0], 1))
        if both.deadline is not None:
            due.append((max(both.deadline, both.now), 2))
        if not due:
            break
        now, what = min(due)
        if what == 0:
            event = end_of(running, doing, stops)
            ends = None
        else:
            event = upcoming.pop(0)[1] if what == 1 else Tick()
        both.at(now, event)
    return both


def end_of(task, doing, stopped):
    if stopped and not doing.late:
        return ActionStopped(task.name)
    if doing.failed:
        return ActionFailed(task.name, "failed", unreadable=doing.unreadable)
    measures = task.object_id is not None
    value = doing.value if measures else None
    return ActionSucceeded(task.name, value, abnormal=doing.abnormal and value is not None)
