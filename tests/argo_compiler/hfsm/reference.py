"""What a mission does, straight from the rules of docs/language.md.

An interpreter of the IL that shares nothing with the machine: it steps through whole seconds,
counts them on the clock of each group that it is in, and keeps all by name.
"""

from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    Cancel,
    CancelAction,
    Occurred,
    Pause,
    Resume,
    StartAction,
)
from argo_compiler.il import Action, Afterwards, ConditionType, EventKind, OnFailure, Response, Stop

DOCK = "return to dock"
ENDS = (ActionSucceeded, ActionFailed, ActionStopped)


class Alarm:
    """A reaction that is active or waits."""

    def __init__(self, reaction):
        self.reaction = reaction
        self.until_occurred = False
        self.visit = None
        self.there = False


class Run:
    """An action that has been started."""

    def __init__(self, task, visit, drives):
        self.task = task
        self.visit = visit
        self.drives = drives
        self.cancelled = False


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
        self.clock = {}
        self.round = {}
        self.values = {}
        self.age = {}
        self.current = None
        self.visit = self.visits = 0
        self.failures = 0
        self.run = None
        self.alarms = []
        self.active = None
        self.paused = False
        self.time_up = False
        self.outcome = None
        self.steps = []
        self.events = []
        self.done = []

    # The protocol of an executor

    def start(self, now):
        self.now = now
        self.go(self.first_task())
        self.due()
        return self.command()

    def handle(self, event, now):
        while self.now < now:
            self.second()
            if self.now < now:
                self.due()
        if isinstance(event, ENDS):
            self.action_ended(event)
        elif self.outcome is None:
            if isinstance(event, Occurred):
                self.occurs(event.event)
            elif isinstance(event, Pause):
                self.paused = True
            elif isinstance(event, Resume):
                self.resumed()
            elif isinstance(event, Cancel):
                self.over("cancelled")
        self.due()
        return self.command()

    def wanted(self):
        if self.outcome is not None or self.paused:
            return None
        if self.active is not None:
            return None if self.active.there else self.active.visit
        return None if self.current is None else self.visit

    def command(self):
        wanted = self.wanted()
        if self.run is not None:
            if self.run.cancelled or self.run.visit == wanted:
                return []
            self.run.cancelled = True
            return [(CancelAction, self.run.task)]
        if wanted is None:
            return []
        drives = self.active is not None
        task = f"react to {self.active.reaction.event}" if drives else self.current
        self.run = Run(task, wanted, drives)
        return [(StartAction, task)]

    # Time

    def going(self):
        return self.outcome is None and not self.paused and self.active is None

    def second(self):
        self.now += 1
        self.elapsed += 1
        for object_id in self.age:
            self.age[object_id] += 1
        for g in self.clock:
            if self.going() or self.groups[g].count_interruptions:
                self.clock[g] += 1

    def due(self):
        self.completed()
        limit = self.mission.max_duration
        if self.outcome is None and limit and self.elapsed >= limit and not self.time_up:
            self.occurs(EventKind.TIME_UP)
        while self.going():
            up = [
                g
                for g, elapsed in self.clock.items()
                if self.groups[g].stop is Stop.HARD
                and 0 < self.groups[g].max_repeat_duration <= elapsed
            ]
            if not up:
                break
            self.round_over(min(up, key=len))
            self.completed()

    def completed(self):
        if self.going() and self.current is None:
            self.over("completed")

    # Tasks and groups

    def first_task(self):
        for task in self.mission.tasks:
            if task.action is Action.START:
                for transition in task.transitions:
                    if not transition.conditions:
                        return transition.target
        return next(task.name for task in self.mission.tasks if task.action is not Action.START)

    def go(self, target, left=()):
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
        self.steps.append((self.now, target))

    def inside(self, name):
        return {g for g in self.groups if g == name or g.startswith(name + "/")}

    def wants(self, g):
        group = self.groups[g]
        more = group.max_repeat_count == 0 or self.round[g] < group.max_repeat_count
        limit = group.max_repeat_duration
        return more and (limit == 0 or self.clock[g] < limit)

    def round_over(self, g):
        """Group `g` has come to the end of a round; it and those around it decide."""
        group = self.groups[g]
        if self.wants(g):
            self.round[g] += 1
            self.go(group.start, left=self.inside(g) - {g})
            return
        around = g.rpartition("/")[0]
        if around and self.groups[around].end == group.end:
            self.round_over(around)
        else:
            self.unconditionally(self.tasks[group.end], left=self.inside(g))

    def unconditionally(self, task, left=()):
        targets = [t.target for t in task.transitions if not t.conditions]
        self.go(targets[0] if targets else None, left)

    def task_over(self):
        task = self.tasks[self.current]
        for transition in task.transitions:
            if transition.conditions and all(self.holds(c) for c in transition.conditions):
                self.go(transition.target)
                return
        ending = [g for g in self.groups if self.groups[g].end == task.name]
        if ending:
            self.round_over(max(ending, key=len))
        else:
            self.unconditionally(task)

    def holds(self, c):
        if c.object_id not in self.values:
            return False
        if c.max_age is not None and self.age[c.object_id] > c.max_age:
            return False
        value = self.values[c.object_id]
        on_bound = value == c.param1 or (c.type is ConditionType.WITHIN and value == c.param2)
        if on_bound:
            return c.inclusive
        if c.type is ConditionType.WITHIN:
            return c.param1 < value < c.param2
        return value < c.param1 if c.type is ConditionType.LESS else value > c.param1

    def action_ended(self, event):
        run = self.run
        unwanted = run.cancelled or self.wanted() != run.visit
        self.run = None
        failed = isinstance(event, ActionFailed) and not unwanted
        if run.drives:
            if self.active is not None and self.active.visit == run.visit:
                if isinstance(event, ActionSucceeded):
                    self.arrived()
                elif failed:
                    self.drive_failed()
        elif isinstance(event, ActionSucceeded):
            if event.value is not None:
                object_id = self.tasks[run.task].object_id
                self.values[object_id], self.age[object_id] = event.value, 0
            if run.task != DOCK:
                self.done.append((run.task, None))
            if run.visit == self.visit and self.outcome is None:
                if run.task == DOCK:
                    self.over("returned")
                else:
                    self.task_over()
        elif failed:
            self.action_failed(event.reason)

    def action_failed(self, reason):
        if self.current == DOCK:
            self.over("failed")
            return
        task = self.tasks[self.current]
        self.failures += 1
        if self.failures <= task.retries:
            return
        self.done.append((task.name, reason))
        if task.on_failure is OnFailure.CONTINUE:
            self.task_over()
        elif task.on_failure is OnFailure.RETURN:
            self.go(DOCK)
        else:
            self.over("aborted")

    def over(self, outcome):
        self.outcome = outcome
        self.current = self.active = None
        self.alarms = []
        self.paused = False
        self.clock = {}
        self.round = {}

    # Reactions

    def occurs(self, event):
        self.events.append((self.now, event))
        if event is EventKind.TIME_UP:
            self.time_up = True
        for alarm in self.alarms:
            if alarm.reaction.until is event:
                alarm.until_occurred = True
            elif alarm.reaction.event is event:
                alarm.until_occurred = False
        reaction = self.reactions.get(event)
        pending = event in [alarm.reaction.event for alarm in self.alarms]
        if reaction and reaction.response is not Response.REPORT and not pending:
            active = self.active
            first = active is None or reaction.priority > active.reaction.priority
            if first and reaction.response is Response.ABORT:
                self.over("aborted")
                return
            if first or active.reaction.until is not event:
                self.alarms.append(Alarm(reaction))
        self.arrange()

    def arrange(self):
        """Whose turn it is now."""
        while self.outcome is None and not self.paused and self.alarms:
            # Of equal ones, max takes the one that occurred first.
            top = max(self.alarms, key=lambda alarm: alarm.reaction.priority)
            active = self.active
            if active is None or top.reaction.priority > active.reaction.priority:
                self.begin(top)
            elif active.there and active.until_occurred:
                self.hold_over()
            else:
                break

    def begin(self, alarm):
        if alarm.reaction.response is Response.ABORT:
            self.over("aborted")
            return
        self.active = alarm
        self.visits += 1
        alarm.visit = self.visits
        alarm.there = False
        if alarm.reaction.response is Response.PAUSE:
            self.arrived()

    def arrived(self):
        alarm = self.active
        alarm.there = True
        holds = alarm.reaction.until is not None or alarm.reaction.response is Response.PAUSE
        if not holds or alarm.until_occurred:
            self.hold_over()

    def hold_over(self):
        reaction = self.active.reaction
        self.alarms.remove(self.active)
        self.active = None
        if reaction.response is not Response.PAUSE:
            if reaction.afterwards is Afterwards.WAIT:
                self.paused = True
            elif reaction.afterwards is Afterwards.END:
                returned = reaction.response is Response.RETURN
                self.over("returned" if returned else "sheltered")
        self.arrange()

    def drive_failed(self):
        if self.active.reaction.afterwards is Afterwards.END:
            self.over("failed")
            return
        self.alarms.remove(self.active)
        self.active = None
        self.paused = True

    def resumed(self):
        if self.paused:
            self.paused = False
            self.arrange()
        elif self.active is not None and self.active.there:
            self.hold_over()
