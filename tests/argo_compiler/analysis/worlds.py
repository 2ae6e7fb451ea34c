"""Small random missions with bounded values, random travel times, and runs of them."""

from dataclasses import dataclass
from random import Random

from hypothesis import strategies as st

from argo_compiler.analysis import Leg, NoPath
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.reachability import objects_that_others_may_report
from argo_compiler.base.catalog import Area, Catalog
from argo_compiler.base.model import Pose
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Executor,
    Hfsm,
    Occurred,
    Pause,
    Resume,
    StartAction,
    Tick,
)
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Task,
    Transition,
)
from tests.mission_parts import HERE, OBJECTS, groups_over, transitions, wait_rules, windows
from tests.mission_writing import checkpoint

STEPS = 80
SHELTER = Pose(x=-1, y=0, z=0)
HORIZON = 60  # half seconds in which external events occur


@st.composite
def conditions(draw, objects=OBJECTS):
    """Draw comparisons of a value."""
    low = draw(st.integers(-1, 6))
    return Condition(
        type=draw(st.sampled_from([t for t in ConditionType if t.compares])),
        object_id=draw(st.sampled_from(objects)),
        param1=low,
        param2=draw(st.integers(low + 1, 7)),
        inclusive=draw(st.booleans()),
        max_age=draw(st.sampled_from([None, None, None, 2, 6])),
    )


@st.composite
def conditions_of_all_kinds(draw, objects=OBJECTS):
    """Draw conditions of all kinds; about three in ten do not compare the value."""
    kind = draw(st.sampled_from([None] * 7 + [t for t in ConditionType if not t.compares]))
    if kind is None:
        return draw(conditions(objects))
    ages = {ConditionType.STALE: [1, 3, 6], ConditionType.ABNORMAL: [None, None, 4]}
    return Condition(
        type=kind,
        object_id=draw(st.sampled_from(objects)),
        max_age=draw(st.sampled_from(ages.get(kind, [None]))),
    )


@st.composite
def tasks_named(draw, name, names, index, object_id):
    # Most missions compare the value that was just measured.
    objects = OBJECTS if object_id is None else (object_id, object_id, *OBJECTS)
    policy = draw(st.sampled_from([OnFailure.CONTINUE, OnFailure.CONTINUE, *OnFailure]))
    fields = {
        "on_failure": policy,
        "failure_target": draw(st.sampled_from(names)) if policy is OnFailure.BRANCH else None,
        "transitions": draw(transitions(names, index, lambda: conditions_of_all_kinds(objects))),
        "window": draw(windows(names)) if draw(st.integers(0, 4)) == 0 else None,
        "optional": draw(st.booleans()),
    }
    if name.startswith("T"):
        return Task(name=name, action=Action.WAIT, wait=draw(wait_rules()), **fields)
    return Task(
        name=name,
        action=Action.WAYPOINT if object_id is None else Action.MEASURE,
        object_id=object_id,
        pose=Pose(x=index + 1, y=0, z=0) if object_id is None else None,
        velocity=draw(st.sampled_from([None, None, 2])),
        retries=draw(st.sampled_from([0, 0, 1])),
        time_limit=draw(st.sampled_from([None, None, None, None, 3, 6])),
        **fields,
    )


@st.composite
def reactions(draw):
    """Draw reactions, often one to TIME_UP, sometimes others."""
    events = [EventKind.TIME_UP] if draw(st.booleans()) else []
    others = (EventKind.GAS_LEAK, EventKind.LOW_BATTERY)
    events += draw(st.sampled_from([(), (), others[:1], others]))
    found = []
    for event in events:
        response = draw(st.sampled_from([*Response, Response.RETURN]))
        drives = response in (Response.RETURN, Response.SAFE_AREA)
        until = EventKind.BATTERY_CHARGED if draw(st.integers(0, 3)) == 0 else None
        holds = response is Response.PAUSE or (drives and until is not None)
        limit = draw(st.sampled_from([None, 1, 4])) if holds else None
        afterwards = draw(st.sampled_from([Afterwards.END, Afterwards.END, *Afterwards]))
        found.append(
            Reaction(
                event=event,
                response=response,
                pose=SHELTER if response is Response.SAFE_AREA else None,
                until=until if holds else None,
                afterwards=afterwards if drives else Afterwards.END,
                hold_limit=limit,
                on_limit=draw(st.sampled_from(Afterwards)) if limit else Afterwards.WAIT,
                priority=draw(st.sampled_from([None, None, 40])),
            )
        )
    return tuple(found)


@st.composite
def missions(draw, least=1, most=8):
    size = draw(st.integers(least, most))
    kinds = [draw(st.sampled_from(["W", "T", *OBJECTS, *OBJECTS])) for _ in range(size)]
    names = [f"{k if k in 'WT' else f'M{k}x'}{i}" for i, k in enumerate(kinds)]
    tasks = [
        draw(tasks_named(name, names, i, None if kinds[i] in "WT" else kinds[i]))
        for i, name in enumerate(names)
    ]
    if draw(st.booleans()):
        way = draw(st.lists(st.sampled_from(names), max_size=1))
        ways = tuple(Transition(target=w) for w in way)
        tasks.insert(0, Task(name="S", action=Action.START, transitions=ways))
    until = conditions_of_all_kinds() if draw(st.booleans()) else None
    return Mission(
        tasks=tuple(tasks),
        groups=draw(groups_over(names, interruptions=False, plans=True, until=until)),
        dock=HERE,
        reactions=draw(reactions()),
        max_duration=draw(st.sampled_from([None, 7, 15, 30])),
    )


@st.composite
def catalogs(draw):
    return Catalog(
        site="made up",
        checkpoints=tuple(checkpoint(int(o), *draw(ranges()), *draw(ranges())) for o in OBJECTS),
        areas=(Area(number=1, dock=HERE),),
        floors=(),
    )


@st.composite
def ranges(draw):
    low = draw(st.integers(0, 4))
    return low, draw(st.integers(low, 6))


class MadeUpTravel:
    """Random travel times and energies, always the same for two poses of the robot.

    A pose is the object that the robot measures there, or the coordinate of a waypoint.
    """

    def __init__(self, seed, clean_up=0.0, blocked=(), standing_power=0.0):
        self.seed = seed
        self.longest_cancellation_time = clean_up
        self.battery = 5.0
        self.standing_power = standing_power
        self.charging_power = None
        self.blocked = blocked

    def start_pose(self, mission):  # noqa: ARG002
        return "start"

    def leg_with_action(self, origin, task, velocity):
        place = task.object_id or f"{task.pose.x:g}"
        if place in self.blocked:
            return NoPath("a wall stands in the way")
        rng = Random(f"{self.seed} {origin} {place}")
        distance = 0 if origin == place else rng.choice([0, 1, 1, 2, 3, 4])
        action = Random(f"{self.seed} {place}").choice([0, 1]) if task.object_id else 0
        energy = rng.choice([0.5, 1.0, 3.0])
        return Leg(distance / (velocity or 1) + action, energy, place, action)


@dataclass
class Run:
    """State and outcome of a run."""

    executor: Executor
    now: float = 0.0
    energy: float = 0.0
    finished: bool = False
    nominal: bool = True
    """whether no action failed, by its time limit or otherwise"""
    astray: bool = False
    """whether several cancelled actions in a row left the robot between arbitrary poses"""
    in_time: bool = True
    """whether no reaction started"""


@dataclass(frozen=True)
class _AtPose:
    """Position of a robot that stands at a pose."""

    pose: object


@dataclass(frozen=True)
class _Interrupted:
    """Position of a robot that was interrupted on its way from another position to a task."""

    before: object
    task: Task
    arrival: object


@dataclass
class _Action:
    """Action that the robot is executing, with the energy it needs and the pose after it."""

    task: Task
    started: float
    ends: float
    energy: float
    arrival: object


class _World:
    """Simulation of a robot with the times of a travel.

    Values lie in the catalogue's ranges, bounds included.
    """

    def __init__(self, mission, hfsm, catalog, travel, seed, mode):
        self.travel = travel
        self.mode = mode
        self.fails = mode in ("failing", "wild")
        self.pauses = {"wild": 0.05, "eventful": 0.1}.get(mode, 0.0)
        self.rng = Random(seed)
        self.checkpoints = {str(c.id): c for c in catalog.checkpoints}
        self.result = Run(Executor(hfsm))
        self.position = _AtPose(travel.start_pose(mission))
        self.action = None
        self.stop_at = None
        self.external = []
        """events that may occur, and objects whose values may be reported, at any moment"""
        self.upcoming = self._external_events(mission, hfsm)

    def _external_events(self, mission, hfsm):
        """Return the external events and readings with their times, the latest first.

        In the modes `nominal` and `eventful`, no event starts a reaction.
        """
        waits = [t.wait for t in mission.tasks if t.wait is not None]
        awaited = {w.event for w in waits if w.event is not None}
        reacting = {r.event for r in mission.reactions} - {EventKind.TIME_UP}
        if self.mode in ("nominal", "eventful"):
            awaited -= reacting
        else:
            awaited |= reacting | {r.until for r in mission.reactions if r.until is not None}
        reported = (
            objects_that_others_may_report(Flow.from_machine(hfsm, mission))
            & self.checkpoints.keys()
        )
        if self.mode == "eventful":
            self.external = [*sorted(awaited), *sorted(reported)]
        rng, upcoming = self.rng, []
        for event in sorted(awaited):
            upcoming += [
                (rng.randint(0, HORIZON) / 2, Occurred(event)) for _ in range(rng.randint(0, 4))
            ]
        for o in sorted(reported):
            for _ in range(rng.randint(0, 5)):
                value, abnormal = self._value(o)
                upcoming.append((rng.randint(0, HORIZON) / 2, ReadingGiven(o, value, abnormal)))
        return sorted(upcoming, key=lambda c: c[0], reverse=True)

    def run(self, steps):
        result, executor = self.result, self.result.executor
        self._execute(executor.start(0.0))
        while not executor.finished and len(executor.trace) < steps:
            if executor.reaction is not None:
                result.in_time = False
            times = [executor.next_deadline]
            ends = None
            if self.action is not None:
                ends = self.action.ends if self.stop_at is None else self.stop_at
            times += [ends, self.upcoming[-1][0] if self.upcoming else None]
            known = [t for t in times if t is not None]
            if executor.paused and self.action is None:
                if self.mode == "eventful":
                    result.now += self.rng.choice([0, 1, 3, 7])
                self._execute(executor.handle(Resume(), result.now))
                continue
            if not known:
                break
            self._advance(max(result.now, min(known)))
            if self.external and self.rng.random() < 0.3:
                self._execute(executor.handle(self._external_event(), result.now))
            elif self.pauses and self.stop_at is None and self.rng.random() < self.pauses:
                self._execute(executor.handle(Pause(), result.now))
            elif self.upcoming and self.upcoming[-1][0] <= result.now:
                self._execute(executor.handle(self.upcoming.pop()[1], result.now))
            elif ends is not None and ends <= result.now:
                self._end_action()
            else:
                self._execute(executor.handle(Tick(), result.now))
        result.finished = executor.finished
        result.nominal = result.nominal and not any(e.failure for e in executor.trace)
        return result

    def _external_event(self):
        """Return a random external event or reading."""
        what = self.rng.choice(self.external)
        if isinstance(what, EventKind):
            return Occurred(what)
        return ReadingGiven(what, *self._value(what))

    def _advance(self, now):
        """Let time pass; without an action, the robot may draw the power of standing."""
        if self.action is None:
            share = self.rng.choice([0, 1])
            waited = now - self.result.now
            self.result.energy += share * waited * self.travel.standing_power / 3600
        self.result.now = now

    def _execute(self, commands):
        for command in commands:
            if isinstance(command, CancelAction):
                longest = self.travel.longest_cancellation_time
                self.stop_at = self.result.now + self.rng.choice([0, 1]) * longest
            else:
                assert isinstance(command, StartAction)
                self._start_action(command)

    def _start_action(self, command):
        task, now, rng = command.task, self.result.now, self.rng
        leg = self.travel.leg_with_action("start", task, task.velocity)
        work, arrival = leg.work, leg.arrival
        time, energy = self._longest(self.position, task, task.velocity)
        if isinstance(self.position, _Interrupted):
            # An action that is started again may take its full time again.
            time = max(work, rng.choice([0, 0.5, 1]) * max(time, work))
            energy *= rng.choice([0, 0.5, 1])
        if task.time_limit is not None and time > task.time_limit:
            self.result.nominal = False
        if self.mode == "wild":
            time = rng.choice([time, 0, 2 * time + 1])
            work = min(work, time)
        arrived = now + time - work
        begins = arrived if command.not_before is None else max(arrived, command.not_before)
        waiting = rng.choice([0, 1]) * (begins - arrived) * self.travel.standing_power / 3600
        self.action = _Action(task, now, begins + work, energy + waiting, arrival)

    def _longest(self, position, task, velocity):
        if isinstance(position, _AtPose):
            leg = self.travel.leg_with_action(position.pose, task, velocity)
            return leg.duration, leg.energy
        time, energy = self._longest(position.before, position.task, velocity)
        if task.name != position.task.name:
            leg = self.travel.leg_with_action(position.arrival, task, velocity)
            time, energy = time + leg.duration, energy + leg.energy
        return time, energy

    def _interrupted_position(self, action):
        before = self.position
        if isinstance(before, _Interrupted):
            if self.mode == "failing":
                # The position after several failures is an assumption, see `docs/analysis.md`.
                before = _AtPose(before.arrival)
            else:
                self.result.astray = True
        return _Interrupted(before, action.task, action.arrival)

    def _end_action(self):
        result, rng, action = self.result, self.rng, self.action
        task, now = action.task, result.now
        value, abnormal = None, False
        if task.action is Action.MEASURE:
            value, abnormal = self._value(task.object_id)
            if self.fails and rng.random() < 0.2:
                value, abnormal = None, False
        self.action = None
        if self.stop_at is not None:
            self.stop_at = None
            share = 1.0 if action.ends <= now else rng.choice([0, 0.5, 1])
            result.energy += share * action.energy
            late = rng.random() < 0.3 and now > action.started
            self.position = _AtPose(action.arrival) if late else self._interrupted_position(action)
            event = (
                ActionSucceeded(task.name, value, abnormal) if late else ActionStopped(task.name)
            )
        else:
            result.energy += action.energy
            failed = self.fails and rng.random() < 0.25
            self.position = (
                self._interrupted_position(action) if failed else _AtPose(action.arrival)
            )
            event = ActionSucceeded(task.name, value, abnormal)
            if failed:
                kind = rng.choice(["unreadable", "unreadable", "failed", "unreachable"])
                event = ActionFailed(
                    task.name,
                    "failed",
                    unreadable=kind == "unreadable",
                    unreachable=kind == "unreachable",
                )
        self._execute(result.executor.handle(event, now))

    def _value(self, object_id):
        """Return a random value, often a bound or a whole number, and whether it is abnormal."""
        checkpoint, rng = self.checkpoints[object_id], self.rng
        low, high = checkpoint.range.low, checkpoint.range.high
        between = rng.randint(int(low), int(high))
        value = float(min(rng.choice([low, high, between, between + 0.5]), high))
        return value, not checkpoint.nominal.contains(value) and rng.random() < 0.8


def run(mission: Mission, hfsm: Hfsm, catalog, travel, seed, mode="nominal", steps=STEPS) -> Run:
    """Simulate one run with the times of the travel.

    The `mode` is one of: *nominal*: no action fails, and only awaited events occur. *eventful*: no
    action fails, but a person pauses, and awaited events and reported values come at any moment.
    *failing*: actions fail, measurements have no value, events occur. *wild*: as *failing*, but
    actions take arbitrary times, and a person pauses.
    """
    return _World(mission, hfsm, catalog, travel, seed, mode).run(steps)
