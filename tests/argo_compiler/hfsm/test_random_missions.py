"""Whether random missions come to all that the language has."""

from collections import Counter

import pytest
from hypothesis import Phase, given, settings

from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.hfsm import Executor, lower
from tests.argo_compiler.hfsm.random_missions import cases
from tests.argo_compiler.hfsm.reference import Reference
from tests.argo_compiler.hfsm.test_differential import Pair, World

HAPPENS = {
    "a wait ends by duration": 10,
    "a wait ends by event": 5,
    "a wait ends by conditions": 5,
    "a wait's limit": 10,
    "an action's limit": 10,
    "a hold's limit": 3,
    "a hard window is missed": 5,
    "missed_target": 2,
    "a failure branches": 5,
    "a round that waited begins": 5,
    "a group's time is up": 5,
    "done by hand": 10,
    "TIME_UP": 10,
    "late success": 10,
    "unreadable": 10,
    "completed with failures": 5,
    "begins paused": 5,
}
"""At least so often in 500 missions."""


class Counted(Reference):
    """The reference, which counts what happens to it."""

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


@pytest.mark.long
def test_random_missions_come_to_all_there_is():
    happened = Counter()

    @settings(max_examples=600, deadline=None, phases=[Phase.generate])
    @given(cases())
    def run(case):
        if has_errors(check(case.mission)):
            happened["refused"] += 1
            return
        pair = Pair(Executor(lower(case.mission)), Counted(case.mission))
        World(pair, case).run()
        happened.update(pair.reference.happened)

    run()
    assert happened["refused"] < 200
    rare = {what: happened[what] for what, least in HAPPENS.items() if happened[what] < least}
    assert not rare
