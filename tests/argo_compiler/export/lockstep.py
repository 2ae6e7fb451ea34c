"""Argo's executor and an exported state chart, run in lockstep on one virtual clock."""

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


class Lockstep:
    """Executor and state chart of one mission, which must agree after each event."""

    def __init__(self, mission):
        hfsm = lower(mission)
        self.executor = Executor(hfsm)
        self.chart = Chart(to_scxml(mission, hfsm))
        self.stopping = False
        self.now = 0
        self.first_commands = self.executor.start(0)
        self.record(self.first_commands)
        self.chart.start()
        self.assert_agreement("start")

    def start(self, now):
        """Return the commands with which both started in the constructor."""
        assert now == 0
        return self.first_commands

    def record(self, commands):
        for command in commands:
            self.stopping = isinstance(command, CancelAction)

    def handle(self, event, now):
        was_finished = self.executor.finished
        commands = self.executor.handle(event, now)
        if was_finished:  # a chart that has ended receives no events
            return commands
        self.now = now
        if isinstance(event, (ActionFailed, ActionStopped, ActionSucceeded)):
            self.stopping = False
        self.record(commands)
        name, data = chart_event(event, self.chart)
        self.chart.handle(name, now, **data)
        self.assert_agreement(event)
        return commands

    def handle_at(self, now, event):
        self.handle(event, now)

    def assert_agreement(self, event):
        assert self.chart.observation() == self.observation(), (self.now, event)
        assert self.chart.readings() == self.readings(), (self.now, event)

    def observation(self):
        executor = self.executor
        if executor.finished:
            return None, None, False, {}, str(executor.outcome)
        name = executor.running and executor.running.name
        if executor.outcome is not None:
            return None, name, self.stopping, {}, None
        return executor.active_task, name, self.stopping, dict(executor.rounds), None

    def readings(self):
        readings = self.executor.readings.items()
        return {
            object_id: (str(r.kind), r.value, r.time, r.abnormal)
            for object_id, r in readings
            if object_id in self.chart.objects
        }

    @property
    def paused(self):
        return self.executor.paused

    @property
    def next_deadline(self):
        due = [self.executor.next_deadline, self.chart.deadline]
        return min((at for at in due if at is not None), default=None)


def chart_event(event, chart):
    """Return the name and the data of the chart's event for an event of the executor."""
    match event:
        case Occurred(kind):
            return f"event.{kind}", {}
        case ReadingGiven(object_id, value, abnormal):
            if object_id not in chart.objects:
                return "tick", {}
            data = {"value": value, "abnormal": int(abnormal)}
            return f"reading.{chart.objects[object_id]}", data
        case ActionSucceeded(_, value, abnormal):
            return "action.succeeded", {"value": value, "abnormal": int(abnormal)}
        case ActionFailed():
            kinds = {"unreadable": event.unreadable, "unreachable": event.unreachable}
            return "action.failed", {kind: int(is_so) for kind, is_so in kinds.items()}
        case ActionStopped():
            return "action.stopped", {}
    return PLAIN[type(event)], {}
