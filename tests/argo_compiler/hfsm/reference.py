"""Reference interpreter of missions, written straight from the rules of docs/language.md.

It interprets the IL and shares no code with the machine: it steps through whole seconds, counts
them on each clock that runs, and stores everything by name. The docstring of a method names its
rules.
"""

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    CancelAction,
    GiveBack,
    Occurred,
    Pause,
    Resume,
    StartAction,
    TakeOver,
)
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import (
    DEFAULT_PRIORITIES,
    Action,
    Afterwards,
    ConditionType,
    EventKind,
    Mode,
    OnFailure,
    Response,
    Stop,
)

DOCK = "return to dock"
ENDS = (ActionSucceeded, ActionFailed, ActionStopped)


class Reading:
    """Result of the last measurement at a checkpoint (C3).

    It is "value", "unreadable", "unreachable" or "failed".
    """

    def __init__(self, kind, value=None, abnormal=False, age=0):
        self.kind = kind
        self.value = value
        self.abnormal = abnormal
        self.age = age


class Alarm:
    """Reaction that is active or waits."""

    def __init__(self, reaction):
        self.reaction = reaction
        self.until_occurred = False
        self.visit = None
        self.there = False
        """whether the robot holds"""
        self.held = 0


class Run:
    """Action that has been started."""

    def __init__(self, id, task, visit, drives):
        self.id = id
        self.task = task
        self.visit = visit
        self.drives = drives
        self.seconds = 0
        """elapsed of its time limit"""
        self.dropped = False
        """whether it is no longer needed, and has to be cancelled"""
        self.cancelled = False


class TaskByHand:
    """Task that a person did and the machine has not reached; `age` is the time since then (s)."""

    def __init__(self, what):
        self.what = what
        self.age = what.age or 0


def rank(reaction):
    """R7."""
    given = reaction.priority
    return (
        reaction.response is Response.ABORT,
        reaction.event is EventKind.EMERGENCY_STOP,
        DEFAULT_PRIORITIES[reaction.event] if given is None else given,
    )


class Reference:
    def __init__(self, mission):
        self.mission = mission
        self.tasks = {task.name: task for task in mission.tasks}
        self.groups = {group.name: group for group in mission.groups}
        order = [task.name for task in mission.tasks]
        self.members = {
            g.name: set(order[order.index(g.start) : order.index(g.end) + 1])
            for g in mission.groups
        }
        self.reactions = {reaction.event: reaction for reaction in mission.reactions}
        self.now = self.elapsed = 0
        # The groups that it is in.
        self.clock = {}
        self.round = {}
        # What it knows.
        self.readings = {}
        self.by_hand = []
        self.tallies = {}
        self.failed = False
        # Where it stands.
        self.current = None
        self.visit = self.visits = 0
        self.since = 0
        self.failures = 0
        self.occurred = False
        self.look = False
        self.round_of = None
        # What interrupts it.
        self.alarms = []
        self.active = None
        self.paused = False
        self.time_up = False
        self.was_going = False
        self.outcome = None
        # What runs, and what has happened.
        self.run = None
        self.runs = 0
        self.steps = []
        self.events = []

    # The protocol of an executor

    def start(self, now):
        self.now = now
        self.go(self.first_task())
        self.paused = self.mission.mode is Mode.SUPERVISORY and self.current is not None
        self.due()
        return self.command()

    def handle(self, event, now):
        while self.now < now:
            self.second()
            if self.now < now:
                self.due()
        if isinstance(event, ENDS):
            self.action_ended(event)
        elif isinstance(event, ReadingGiven):
            self.measured(event.object_id, Reading("value", event.value, event.abnormal))
        elif self.outcome is None:
            if isinstance(event, Occurred):
                self.occurs(event.event)
            elif isinstance(event, Pause | TakeOver):
                self.paused = True
            elif isinstance(event, Resume):
                self.resumed()
            elif isinstance(event, GiveBack):
                self.by_hand += [TaskByHand(what) for what in event.by_hand]
                self.resumed()
            elif isinstance(event, Cancel):
                self.over("cancelled")
        self.due()
        return self.command()

    def wanted(self):
        """The visit whose action has to run."""
        if self.outcome is not None or self.paused:
            return None
        if self.active is not None:
            return None if self.active.there else self.active.visit
        if self.current is None or self.wait() or self.round_of is not None:
            return None
        return self.visit

    def command(self):
        """The present command; a start has the seconds until its work may begin (I3, I4, W4)."""
        if self.run is not None:
            if self.run.cancelled or not self.run.dropped:
                return []
            self.run.cancelled = True
            return [(CancelAction, self.run.task, self.run.id)]
        wanted = self.wanted()
        if wanted is None:
            return []
        self.runs += 1
        if self.active is not None:
            self.run = Run(self.runs, f"react to {self.active.reaction.event}", wanted, True)
        else:
            self.run = Run(self.runs, self.current, wanted, False)
        waits = 0 if self.run.drives else max(self.earliest() - self.elapsed, 0)
        return [(StartAction, self.run.task, self.run.id, waits)]

    # Time

    def going(self):
        return self.outcome is None and not self.paused and self.active is None

    def second(self):
        going = self.going()
        waits_for = self.inside(self.round_of) - {self.round_of} if self.round_of else ()
        for g in self.clock:
            if (going or self.groups[g].count_interruptions) and g not in waits_for:
                self.clock[g] += 1
        self.now += 1
        self.elapsed += 1
        self.since += 1
        for one in (*self.readings.values(), *self.by_hand):
            one.age += 1
        if self.active is not None and self.active.there:
            self.active.held += 1
        if self.run is not None and self.elapsed > self.earliest():
            self.run.seconds += 1

    def due(self):
        """I5: all that time brings about, one after the other."""
        while self.outcome is None:
            going = self.going()
            if going and not self.was_going:
                self.look = True
            self.was_going = going
            mission = going and (
                self.completed()
                or self.wait_over()
                or self.time_over()
                or self.group_over()
                or self.done_by_hand()
                or self.window_over()
                or self.limit_over()
                or self.round_begins()
            )
            if not mission and not self.time_over() and not self.hold_limit_over():
                break
        if self.run is not None and self.run.visit != self.wanted():
            self.run.dropped = True

    def completed(self):
        """M3."""
        if self.current is not None:
            return False
        self.over("completed with failures" if self.failed else "completed")
        return True

    def time_over(self):
        """M4."""
        limit = self.mission.max_duration
        if limit is None or self.elapsed < limit or self.time_up:
            return False
        self.time_up = True
        self.occurs(EventKind.TIME_UP)
        return True

    def group_over(self):
        """G10 to G12."""
        up = [
            g
            for g, elapsed in self.clock.items()
            if self.groups[g].stop is Stop.HARD
            and 0 < self.groups[g].max_repeat_duration <= elapsed
        ]
        if up:
            self.round_over(min(up, key=len))
        return bool(up)

    def round_begins(self):
        """G13."""
        if self.round_of is None or self.clock[self.round_of] < self.plan(self.round_of):
            return False
        self.visit_begins()
        return True

    # Tasks

    def first_task(self):
        """M1, M2."""
        for task in self.mission.tasks:
            if task.action is Action.START:
                for transition in task.transitions:
                    if not transition.conditions:
                        return transition.target
        others = [task.name for task in self.mission.tasks if task.action is not Action.START]
        return others[0] if others else None

    def go(self, target, left=()):
        """G2 to G4."""
        stays = {g for g in self.clock if g not in left and target in self.members[g]}
        self.clock = {g: self.clock[g] for g in stays}
        self.round = {g: self.round[g] for g in stays}
        for g in self.groups:
            if target in self.members[g] and g not in stays:
                self.clock[g], self.round[g] = 0, 1
        self.current = target
        self.visits += 1
        self.visit = self.visits
        self.failures = 0
        self.visit_begins()
        self.steps.append((self.now, target))

    def visit_begins(self):
        self.round_of = None
        self.since = 0
        self.occurred = False
        self.look = True

    def unconditionally(self, task, left=()):
        """T3, T4."""
        targets = [t.target for t in task.transitions if not t.conditions]
        self.go(targets[0] if targets else None, left)

    def task_over(self):
        """T2, G5."""
        task = self.tasks[self.current]
        for transition in task.transitions:
            if transition.conditions and self.hold(transition.conditions):
                self.go(transition.target)
                return
        ending = [g for g in self.groups if self.groups[g].end == task.name]
        if ending:
            self.round_over(max(ending, key=len))
        else:
            self.unconditionally(task)

    def tally(self, task, what):
        counts = self.tallies.setdefault(task, {"done": 0, "failed": 0, "by_hand": 0})
        counts[what] += 1

    def failed_for_good(self, kind="failed", missed=None):
        """M3, T8, W5; `missed` is the target of a missed window."""
        task = self.tasks[self.current]
        self.tally(task.name, "failed")
        self.failed = self.failed or not task.optional
        if task.action is Action.MEASURE:
            self.measured(task.object_id, Reading(kind))
        if missed is not None:
            self.go(missed)
        elif task.on_failure is OnFailure.CONTINUE:
            self.task_over()
        elif task.on_failure is OnFailure.BRANCH:
            self.go(task.failure_target)
        elif task.on_failure is OnFailure.RETURN:
            self.go(DOCK)
        else:
            self.over("aborted")

    def attempt_failed(self, kind="failed"):
        """T7."""
        self.failures += 1
        if self.failures > self.tasks[self.current].retries:
            self.failed_for_good(kind)

    def limit_over(self):
        """T9, W3."""
        if self.current == DOCK or self.round_of is not None:
            return False
        task = self.tasks[self.current]
        if task.wait is not None:
            if task.wait.limit is None or self.since < task.wait.limit:
                return False
            self.failed_for_good()
            return True
        run = self.run
        if run is None or run.dropped or run.visit != self.visit:
            return False
        if task.time_limit is None or run.seconds < task.time_limit:
            return False
        run.dropped = True
        self.attempt_failed()
        return True

    def done_by_hand(self):
        """H3."""
        work = next((w for w in self.by_hand if w.what.task == self.current), None)
        if work is None:
            return False
        self.by_hand.remove(work)
        task, what = self.tasks[self.current], work.what
        for g in self.clock:
            if not self.groups[g].count_interruptions:
                self.clock[g] += what.duration
        self.tally(task.name, "by_hand")
        if task.action is Action.MEASURE:
            if what.skipped or what.value is None:
                self.readings.pop(task.object_id, None)
                self.look = True
            else:
                reading = Reading("value", what.value, what.abnormal, work.age)
                self.measured(task.object_id, reading)
        self.task_over()
        return True

    # Waiting and windows

    def wait(self):
        task = self.tasks.get(self.current)
        return task.wait if task is not None and task.action is Action.WAIT else None

    def earliest(self):
        task = self.tasks.get(self.current)
        return task.window.earliest if task is not None and task.window else 0

    def hard_latest(self):
        task = self.tasks.get(self.current)
        window = task.window if task is not None else None
        return window.latest if window and window.hard else None

    def wait_over(self):
        """W1, W2, W4, W5."""
        wait, latest = self.wait(), self.hard_latest()
        if wait is None or self.round_of is not None or self.elapsed < self.earliest():
            return False
        if latest is not None and self.elapsed > latest:
            return False
        if any(work.what.task == self.current for work in self.by_hand):
            return False  # H3
        if wait.duration is not None:
            over = self.since >= wait.duration
        else:
            looked, self.look = self.look, False
            over = self.occurred or bool(looked and wait.conditions and self.hold(wait.conditions))
        if over:
            self.tally(self.current, "done")
            self.task_over()
        return over

    def window_over(self):
        """W5, W6."""
        latest = self.hard_latest()
        if latest is None or self.elapsed < latest or self.round_of is not None:
            return False
        self.failed_for_good(missed=self.tasks[self.current].window.missed_target)
        return True

    # Readings

    def measured(self, object_id, reading):
        self.readings[object_id] = reading
        self.look = True

    def hold(self, conditions):
        return all(self.holds(condition) for condition in conditions)

    def holds(self, c):
        """C1, C2, C4, C5, C7."""
        reading = self.readings.get(c.object_id)
        if reading is None:
            return False
        if c.type is ConditionType.UNREADABLE:
            return reading.kind == "unreadable"
        if c.type is ConditionType.FAILED:
            return reading.kind in ("unreadable", "unreachable", "failed")
        if c.type is ConditionType.UNREACHABLE:
            return reading.kind == "unreachable"
        if reading.kind != "value":
            return False
        old = c.max_age is not None and reading.age > c.max_age
        if c.type is ConditionType.STALE:
            return old
        if old:
            return False
        if c.type is ConditionType.ABNORMAL:
            return reading.abnormal
        value = reading.value
        if value == c.param1 or (c.type is ConditionType.WITHIN and value == c.param2):
            return c.inclusive
        if c.type is ConditionType.WITHIN:
            return c.param1 < value < c.param2
        return value < c.param1 if c.type is ConditionType.LESS else value > c.param1

    # Groups

    def inside(self, name):
        return {g for g in self.groups if g == name or g.startswith(name + "/")}

    def plan(self, g):
        """The time on its clock at which its present round is due (G13)."""
        return (self.round[g] - 1) * self.groups[g].every

    def wants(self, g):
        """G8."""
        group = self.groups[g]
        if group.max_repeat_count and self.round[g] >= group.max_repeat_count:
            return False
        if group.until and self.hold(group.until):
            return False
        begins = max(self.clock[g], self.round[g] * group.every)
        return group.max_repeat_duration == 0 or begins < group.max_repeat_duration

    def round_over(self, g):
        """A round of the group has ended; it and those around it decide what follows (G5 to G7)."""
        group = self.groups[g]
        if self.wants(g):
            self.round[g] += 1
            self.go(group.start, left=self.inside(g) - {g})
            if self.clock[g] < self.plan(g):
                self.round_of = g
            return
        around = g.rpartition("/")[0]
        if around and self.groups[around].end == group.end:
            self.round_over(around)
        else:
            self.unconditionally(self.tasks[group.end], left=self.inside(g))

    # Actions that have ended

    def action_ended(self, event):
        run = self.run
        if run is None or event.id not in (None, run.id):
            return
        self.run = None
        failed = isinstance(event, ActionFailed) and not run.dropped
        if run.drives:
            if self.active is not None and self.active.visit == run.visit:
                if isinstance(event, ActionSucceeded):
                    self.arrived()
                elif failed:
                    self.drive_failed()
        elif isinstance(event, ActionSucceeded):
            self.action_succeeded(run, event)
        elif failed and run.task == DOCK:
            self.over("failed")
        elif failed:
            kind = "unreachable" if event.unreachable else "failed"
            self.attempt_failed("unreadable" if event.unreadable else kind)

    def action_succeeded(self, run, event):
        """C3, I3, T9."""
        stands = run.visit == self.visit and self.outcome is None
        if run.task == DOCK:
            if stands:
                self.over("returned")
            return
        task = self.tasks[run.task]
        if task.action is Action.MEASURE:
            found = (
                Reading("unreadable")
                if event.value is None
                else Reading("value", event.value, event.abnormal)
            )
            self.measured(task.object_id, found)
        self.tally(run.task, "done")
        if stands:
            self.task_over()

    def over(self, outcome):
        self.outcome = outcome
        self.current = self.active = self.round_of = None
        self.alarms = []
        self.paused = False
        self.clock = {}
        self.round = {}

    # Reactions

    def occurs(self, event):
        """R1, R6, R7, R10, W2."""
        self.events.append((self.now, event))
        wait = self.wait()
        if wait is not None and wait.event is event and self.round_of is None:
            self.occurred = True
        for alarm in self.alarms:
            if alarm.reaction.until is event:
                alarm.until_occurred = True
            elif alarm.reaction.event is event:
                alarm.until_occurred = False
        reaction = self.reactions.get(event)
        pending = event in [alarm.reaction.event for alarm in self.alarms]
        if reaction and reaction.response is not Response.REPORT and not pending:
            if reaction.response is Response.ABORT:
                self.over("aborted")
                return
            active = self.active
            higher = active is None or rank(reaction) > rank(active.reaction)
            if higher or active.reaction.until is not event:
                self.alarms.append(Alarm(reaction))
        self.arrange()

    def arrange(self):
        """Activates the reaction of the highest rank (R7, R9)."""
        while self.outcome is None and not self.paused and self.alarms:
            # Of equal ones, max takes the one that occurred first.
            top = max(self.alarms, key=lambda alarm: rank(alarm.reaction))
            active = self.active
            if active is None or rank(top.reaction) > rank(active.reaction):
                self.begin(top)
            elif active.there and active.until_occurred:
                self.hold_over()
            else:
                break

    def begin(self, alarm):
        """R2."""
        self.active = alarm
        self.visits += 1
        alarm.visit = self.visits
        alarm.there = False
        if alarm.reaction.response is Response.PAUSE:
            self.arrived()

    def arrived(self):
        """R3."""
        alarm = self.active
        alarm.there = True
        alarm.held = 0
        holds = alarm.reaction.until is not None or alarm.reaction.response is Response.PAUSE
        if not holds or alarm.until_occurred:
            self.hold_over()

    def hold_over(self):
        """R4."""
        reaction = self.reaction_over()
        if reaction.response is not Response.PAUSE:
            if reaction.afterwards is Afterwards.WAIT:
                self.paused = True
            elif reaction.afterwards is Afterwards.END:
                self.reaction_ends_it(reaction)
        self.arrange()

    def hold_limit_over(self):
        """R3."""
        active = self.active
        if active is None or not active.there or self.paused:
            return False
        if active.reaction.hold_limit is None or active.held < active.reaction.hold_limit:
            return False
        if active.reaction.on_limit is Afterwards.RESUME:
            self.hold_over()
        else:
            reaction = self.reaction_over()
            if reaction.on_limit is Afterwards.END:
                self.reaction_ends_it(reaction)
            else:
                self.paused = True
        return True

    def reaction_over(self):
        over = self.active
        self.alarms.remove(over)
        self.active = None
        return over.reaction

    def reaction_ends_it(self, reaction):
        """R3, R4."""
        outcomes = {Response.RETURN: "returned", Response.SAFE_AREA: "sheltered"}
        self.over(outcomes.get(reaction.response, "aborted"))

    def drive_failed(self):
        """R8."""
        if self.reaction_over().afterwards is Afterwards.END:
            self.over("failed")
        else:
            self.paused = True

    def resumed(self):
        """I1, R3, R9."""
        if self.paused:
            self.paused = False
            self.arrange()
        elif self.active is not None and self.active.there:
            self.hold_over()
