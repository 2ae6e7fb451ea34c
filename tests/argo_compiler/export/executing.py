"""Argo's executor behind the interface that `missions.Drive` drives."""

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    CancelAction,
    Executor,
    Occurred,
    Pause,
    Resume,
    StartAction,
    Tick,
)
from argo_compiler.il import EventKind

PLAIN = {"tick": Tick(), "pause": Pause(), "resume": Resume(), "cancel": Cancel()}


class Executing:
    def __init__(self, hfsm):
        self.executor = Executor(hfsm)
        self.started = 0
        self.stopping = False

    def note(self, commands):
        for command in commands:
            self.started += isinstance(command, StartAction)
            self.stopping = isinstance(command, CancelAction)

    def start(self):
        self.note(self.executor.start(0))

    def handle(self, event, now, value):
        name = self.executor.running and self.executor.running.name
        if event.startswith("event."):
            made = Occurred(EventKind(event.removeprefix("event.")))
        elif event.startswith("action."):
            self.stopping = False
            made = {
                "action.succeeded": ActionSucceeded(name, value),
                "action.failed": ActionFailed(name, "failed"),
                "action.stopped": ActionStopped(name),
            }[event]
        else:
            made = PLAIN[event]
        self.note(self.executor.handle(made, now))

    @property
    def running(self):
        return self.executor.running and (self.started, self.executor.running.name)

    @property
    def deadline(self):
        return self.executor.next_deadline

    @property
    def finished(self):
        return self.executor.finished

    def seen(self):
        executor = self.executor
        if self.finished:
            return None, None, False, {}, self.values(), str(executor.outcome)
        ended = executor.outcome is not None
        return (
            None if ended else executor.active,
            executor.running and executor.running.name,
            self.stopping,
            {} if ended else dict(executor.rounds),
            self.values(),
            None,
        )

    def values(self):
        return {k: (v.value, v.time) for k, v in self.executor.values.items()}
