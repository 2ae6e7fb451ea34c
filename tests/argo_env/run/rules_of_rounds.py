"""Rounds, visits, waits and windows as the rules of docs/language.md have them.

They share no code with the record: one recomputation is part of the reference interpreter, the
other reads the sources, targets and causes of a trace.
"""

from argo_compiler.hfsm import Cause
from argo_compiler.il import Action
from tests.argo_compiler.hfsm.reference import Reference


def is_junction(task):
    return task.wait is not None and task.wait.duration == 0 and task.window is None


class RoundsReference(Reference):
    """Reference interpreter that writes down its rounds and visits."""

    def __init__(self, mission):
        super().__init__(mission)
        self.rounds = []
        self.present = {}
        self.visits_made = []
        self.visit_now = None
        self.how = "left"

    def begin_round(self, g, began):
        due = self.now + self.plan(g) - self.clock[g] if self.groups[g].every else None
        if g in self.present:
            self.present[g].update(due=due, began=began)
            return
        self.present[g] = {
            "group": g, "number": self.round[g], "since": self.now, "due": due, "began": began,
            "ended": None,
        }  # fmt: skip
        self.rounds.append(self.present[g])

    def end_round(self, g):
        if g in self.present:
            self.present.pop(g)["ended"] = self.now

    def begin_rounds_inside(self, g):
        for inner in sorted(self.clock, key=len):
            if inner in self.inside(g):
                self.begin_round(inner, self.now)

    def end_visit(self):
        if self.visit_now is not None:
            self.visit_now.update(end=self.now, how=self.how)
        self.visit_now, self.how = None, "left"

    def begin_visit(self):
        if self.current is not None:
            self.visit_now = {"task": self.current, "start": self.now, "end": None, "how": "open"}
            self.visits_made.append(self.visit_now)

    def go(self, target, left=()):
        self.end_visit()
        for g in list(self.present):
            repeats = g in self.round and self.round[g] != self.present[g]["number"]
            if g in left or repeats or target not in self.members[g]:
                self.end_round(g)
        super().go(target, left)
        self.begin_visit()
        for g in sorted(self.clock, key=len):
            if g not in self.present:
                self.begin_round(g, self.now)

    def round_over(self, g):
        super().round_over(g)
        if self.round_of != g or self.present[g]["began"] is None:
            return
        # Neither this round nor those inside nor the visit have begun.
        self.begin_round(g, None)
        self.visits_made.remove(self.visit_now)
        self.visit_now = None
        for inner in self.inside(g) - {g}:
            if inner in self.present:
                self.rounds.remove(self.present.pop(inner))

    def awaited_round_begins(self, g):
        if g is not None:
            self.begin_rounds_inside(g)
            self.begin_visit()

    def round_begins(self):
        awaited = self.round_of
        begins = super().round_begins()
        if begins:
            self.awaited_round_begins(awaited)
        return begins

    def done_by_hand(self):
        if any(work.what.task == self.current for work in self.by_hand):
            self.awaited_round_begins(self.round_of)
            self.how = "done"
        return super().done_by_hand()

    def wait_over(self):
        self.how = "done"
        over = super().wait_over()
        if not over:
            self.how = "left"
        return over

    def action_succeeded(self, run, event):
        if run.visit == self.visit and self.outcome is None:
            self.how = "done"
        super().action_succeeded(run, event)
        self.how = "left"

    def failed_for_good(self, kind="failed", missed=None):
        self.how = "failed"
        super().failed_for_good(kind, missed)

    def over(self, outcome):
        self.end_visit()
        for g in list(self.present):
            self.end_round(g)
        super().over(outcome)

    def waits(self):
        return [
            (v["task"], v["start"], self.now if v["end"] is None else v["end"], v["how"])
            for v in self.visits_made
            if v["task"] in self.tasks
            and self.tasks[v["task"]].action is Action.WAIT
            and not is_junction(self.tasks[v["task"]])
        ]

    def windows(self):
        found = []
        for v in self.visits_made:
            window = self.tasks[v["task"]].window if v["task"] in self.tasks else None
            if window is None:
                continue
            kept = v["how"]
            over = v["end"] is not None and window.latest is not None and v["end"] >= window.latest
            if kept == "done":
                late = window.latest is not None and v["end"] > window.latest
                kept = "late" if late else "kept"
            elif kept == "failed" and window.hard and over:
                kept = "missed"
            found.append((v["task"], v["start"], v["end"], kept))
        visited = {task for task, *_ in found}
        found += [
            (task.name, None, None, "not visited")
            for task in self.mission.tasks
            if task.window is not None and task.name not in visited
        ]
        return found


MOVES = (
    Cause.CONDITION, Cause.REPEAT, Cause.DEFAULT, Cause.TIMEOUT, Cause.FAILURE, Cause.MISSED,
    Cause.CANCEL, Cause.END,
)  # fmt: skip


def recompute(mission, trace):
    """Return rounds and visits from a trace, by the rules for its causes and tasks.

    Of the rounds in the trace it reads only whether one is awaited. A round is (group, number,
    since, began, ended), a visit (task, start, end).
    """
    groups = {group.name: group for group in mission.groups}
    order = [task.name for task in mission.tasks]
    members = {
        g.name: set(order[order.index(g.start) : order.index(g.end) + 1]) for g in mission.groups
    }
    rounds, present, visits = [], {}, []
    at, since, awaited = None, 0.0, None

    def enter(target, now):
        for g in sorted(groups, key=len):
            if target in members[g] and g not in present:
                present[g] = [g, 1, now, now, None]
                rounds.append(present[g])

    moves = [e for e in trace if e.cause in (*MOVES, Cause.START, Cause.RESTORE, Cause.ROUND)]
    for e in moves:
        if e.cause is Cause.ROUND:
            present[awaited][3] = since = e.time
            enter(at, e.time)
            awaited = None
            continue
        if at is not None and awaited is None:
            visits.append((at, since, e.time))
        again, left = e.repeated, set()
        if again is not None:
            left = {g for g in groups if g.startswith(again + "/")}
        elif e.timed_out is not None:
            end = groups[e.timed_out].end
            around = [g for g in groups if e.timed_out.startswith(g + "/") and groups[g].end == end]
            over = [f"{g}/" for g in (*around, e.timed_out)]
            left = {g for g in groups if f"{g}/".startswith(tuple(over))}
        elif e.cause is Cause.DEFAULT:
            left = {g for g in groups if groups[g].end == e.source}
        for g in list(present):
            if g in left or g == again or e.target not in members[g]:
                number, present.pop(g)[4] = present[g][1], e.time
                if g == again:
                    renewed = [g, number + 1, e.time, e.time, None]
        at, since, awaited = e.target, e.time, None
        if again is not None:
            present[again] = renewed
            rounds.append(renewed)
            if any(begun.awaited for begun in e.rounds):
                awaited, renewed[3] = again, None
                continue
        if e.target is not None:
            enter(e.target, e.time)
    if at is not None and awaited is None:
        visits.append((at, since, None))
    return [tuple(one) for one in rounds], visits
