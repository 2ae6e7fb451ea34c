"""Argo's executor and an exported state chart, side by side on one virtual clock."""

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
        self.now = 0
        self.begun = self.executor.start(0)
        self.note(self.begun)
        self.chart.start()
        self.agree("start")

    def start(self, now):
        """Return the actions that both began with when they were made."""
        assert now == 0
        return self.begun

    def note(self, commands):
        for command in commands:
            self.stopping = isinstance(command, CancelAction)

    def handle(self, event, now):
        over = self.executor.finished
        commands = self.executor.handle(event, now)
        if over:  # a chart that has ended hears nothing any more
            return commands
        self.now = now
        if isinstance(event, (ActionFailed, ActionStopped, ActionSucceeded)):
            self.stopping = False
        self.note(commands)
        name, data = told(event, self.chart)
        self.chart.handle(name, now, **data)
        self.agree(event)
        return commands

    def at(self, now, event):
        self.handle(event, now)

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
    def paused(self):
        return self.executor.paused

    @property
    def next_deadline(self):
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
