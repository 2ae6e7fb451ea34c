"""A machine played by hand, and short ways to write what it is told."""

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Executor,
    lower,
)


class Play:
    """A machine, and what it asks for in short: `+A` is a start, `-A` a cancellation."""

    def __init__(self, mission, now=0):
        self.executor = Executor(lower(mission))
        self.asked = self.short(self.executor.start(now))

    def short(self, commands):
        return [
            f"-{c.task}" if isinstance(c, CancelAction) else f"+{c.task.name}" for c in commands
        ]

    def at(self, now, event):
        return self.short(self.executor.handle(event, now))

    def __getattr__(self, name):
        return getattr(self.executor, name)


def stopped(name):
    return ActionStopped(name)


def well(name, value=None):
    return ActionSucceeded(name, value)


def badly(name):
    return ActionFailed(name, "stuck")
