"""A reference that counts what happens to it."""

from collections import Counter

from tests.argo_compiler.hfsm.reference import Reference


class Counted(Reference):
    def __init__(self, mission):
        super().__init__(mission)
        self.happened = Counter()

    def counted(self, what, happens):
        self.happened[what] += bool(happens)
        return happens

    def start(self, now):
        commands = super().start(now)
        self.counted("begins paused", self.paused)
        return commands

    def wait_over(self):
        wait, occurred = self.wait(), self.occurred
        if wait is None:
            return False
        why = "duration" if wait.duration is not None else "event" if occurred else "conditions"
        return self.counted(f"a wait ends by {why}", super().wait_over())

    def limit_over(self):
        what = "a wait's limit" if self.wait() else "an action's limit"
        return self.counted(what, super().limit_over())

    def hold_limit_over(self):
        return self.counted("a hold's limit", super().hold_limit_over())

    def window_over(self):
        return self.counted("a hard window is missed", super().window_over())

    def round_begins(self):
        return self.counted("a round that waited begins", super().round_begins())

    def group_over(self):
        return self.counted("a group's time is up", super().group_over())

    def done_by_hand(self):
        return self.counted("done by hand", super().done_by_hand())

    def time_over(self):
        return self.counted("TIME_UP", super().time_over())

    def failed_for_good(self, kind="failed", missed=None):
        self.counted("missed_target", missed is not None)
        self.counted("a failure branches", self.tasks[self.current].on_failure == "branch")
        super().failed_for_good(kind, missed)

    def action_succeeded(self, run, event):
        self.counted("late success", run.dropped)
        super().action_succeeded(run, event)

    def measured(self, object_id, reading):
        self.counted("unreadable", reading.kind == "unreadable")
        super().measured(object_id, reading)

    def over(self, outcome):
        self.counted(outcome, True)
        super().over(outcome)
