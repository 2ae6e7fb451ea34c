"""Campaign: random machines behave like the reference interpreter.

    python -m tests.campaigns.machines --count 40000
    python -m tests.campaigns.machines --first 17 --count 1

Each machine is drawn from its number. The last line lists what happened, and how often.
"""

import argparse
import json
import sys
import traceback
from collections import Counter

import hypothesis

from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from tests import plain_strategies
from tests.argo_compiler.hfsm.reference import Reference
from tests.argo_compiler.hfsm.world import Ticks, compare


def count_when_true(name, method):
    """Wrap a method of the reference so that it counts how often its result is true."""

    def counting(self):
        return self.count(name, method(self))

    return counting


class CountingReference(Reference):
    """Reference interpreter that counts what happens."""

    def __init__(self, mission):
        super().__init__(mission)
        self.happened = Counter()

    def count(self, name, happens):
        self.happened[name] += bool(happens)
        return happens

    hold_limit_over = count_when_true("a hold's limit", Reference.hold_limit_over)
    window_over = count_when_true("a hard window is missed", Reference.window_over)
    round_begins = count_when_true("a round that waited begins", Reference.round_begins)
    group_over = count_when_true("a group's time is up", Reference.group_over)
    done_by_hand = count_when_true("done by hand", Reference.done_by_hand)
    time_over = count_when_true("TIME_UP", Reference.time_over)

    def start(self, now):
        commands = super().start(now)
        self.count("begins paused", self.paused)
        return commands

    def wait_over(self):
        wait, occurred = self.wait(), self.occurred
        if wait is None:
            return False
        why = "duration" if wait.duration is not None else "event" if occurred else "conditions"
        return self.count(f"a wait ends by {why}", super().wait_over())

    def limit_over(self):
        name = "a wait's limit" if self.wait() else "an action's limit"
        return self.count(name, super().limit_over())

    def failed_for_good(self, kind="failed", missed=None):
        self.count("missed_target", missed is not None)
        self.count("a failure branches", self.tasks[self.current].on_failure == "branch")
        super().failed_for_good(kind, missed)

    def action_succeeded(self, run, event):
        self.count("late success", run.dropped)
        super().action_succeeded(run, event)

    def measured(self, object_id, reading):
        for kind in ("unreadable", "unreachable"):
            self.count(kind, reading.kind == kind)
        super().measured(object_id, reading)

    def over(self, outcome):
        self.count(outcome, True)
        super().over(outcome)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=1000, help="number of machines without errors")
    parser.add_argument("--first", type=int, default=0, help="number of the first machine")
    options = parser.parse_args()
    hypothesis.strategies = sys.modules["hypothesis.strategies"] = plain_strategies
    from tests.argo_compiler.hfsm.random_missions import busy_cases, cases

    kinds = (cases(), cases(), cases(), busy_cases())
    seen = Counter()
    number = options.first
    while seen["run"] < options.count:
        case = plain_strategies.example(kinds[number % len(kinds)], number)
        if has_errors(check(case.mission)):
            seen["refused by check"] += 1
        else:
            seen["run"] += 1
            try:
                reference = compare(case, list(Ticks)[number % 3], CountingReference)
                seen.update(reference.happened)
            except Exception:
                seen["differ"] += 1
                print(f"machine {number} differs:\n{traceback.format_exc()}", flush=True)
        number += 1
    print(f"machines {options.first} to {number - 1}")
    print(json.dumps(seen))
    sys.exit(bool(seen["differ"]))


if __name__ == "__main__":
    main()
