"""Small random missions with bounded values, travel times made up for them, and runs of both."""

from dataclasses import dataclass
from random import Random

from hypothesis import strategies as st

from argo_compiler.analysis import Leg, NoPath
from argo_compiler.analysis.flow import Flow
from argo_compiler.analysis.reachability import reported_by_others
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
HORIZON = 60  # s in which things happen from outside


@st.composite
def conditions(draw, objects=OBJECTS):
    """Comparisons."""
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
    """Of three in ten it is not the value that is looked at."""
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
    # Conditions on what was just measured are what plans are made of.
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
    """Often one to TIME_UP, sometimes others."""
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
    """Travel times and energies between places, drawn once. Places are objects and poses."""

    def __init__(self, seed, clean_up=0.0, blocked=(), standing_power=0.0):
        self.seed = seed
        self.clean_up = clean_up
        self.battery = 5.0
        self.standing_power = standing_power
        self.blocked = blocked

    def start(self, mission):  # noqa: ARG002
        return "start"

    def leg(self, origin, task, velocity):
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
    """What happened in a run."""

    executor: Executor
    now: float = 0.0
    energy: float = 0.0
    finished: bool = False
    nominal: bool = True
    """whether no action failed, be it by its time limit"""
    astray: bool = False
    """whether actions that were cancelled in a row left the robot between any places"""
    in_time: bool = True
    """whether no reaction began"""


@dataclass(frozen=True)
class _At:
    """The robot stands at a standing."""

    standing: object


@dataclass(frozen=True)
class _Near:
    """It was on its way from another place to a task."""

    before: object
    task: Task
    arrival: object


@dataclass
class _Way:
    """An action under way, and what its cancellation leaves to be done."""

    task: Task
    started: float
    ends: float
    energy: float
    arrival: object


class _World:
    """A robot at the travel's times. Values lie in the catalogue's ranges, bounds included."""

    def __init__(self, mission, hfsm, catalog, travel, seed, mode):
        self.travel = travel
        self.mode = mode
        self.fails = mode in ("failing", "wild")
        self.pauses = {"wild": 0.05, "eventful": 0.1}.get(mode, 0.0)
        self.rng = Random(seed)
        self.checkpoints = {str(c.id): c for c in catalog.checkpoints}
        self.done = Run(Executor(hfsm))
        self.place = _At(travel.start(mission))
        self.way = None
        self.stop_at = None
        self.outside = []
        """what may also occur or be told at any moment: events, and objects by their names"""
        self.coming = self._from_outside(mission, hfsm)

    def _from_outside(self, mission, hfsm):
        """What occurs and is told, and when. Nobody reacts to it unless things may go wrong."""
        waits = [t.wait for t in mission.tasks if t.wait is not None]
        awaited = {w.event for w in waits if w.event is not None}
        reacting = {r.event for r in mission.reactions} - {EventKind.TIME_UP}
        if self.mode in ("nominal", "eventful"):
            awaited -= reacting
        else:
            awaited |= reacting | {r.until for r in mission.reactions if r.until is not None}
        told = reported_by_others(Flow.from_machine(hfsm, mission)) & self.checkpoints.keys()
        if self.mode == "eventful":
            self.outside = [*sorted(awaited), *sorted(told)]
        rng, coming = self.rng, []
        for event in sorted(awaited):
            coming += [
                (rng.randint(0, HORIZON) / 2, Occurred(event)) for _ in range(rng.randint(0, 4))
            ]
        for o in sorted(told):
            for _ in range(rng.randint(0, 5)):
                value, abnormal = self._value(o)
                coming.append((rng.randint(0, HORIZON) / 2, ReadingGiven(o, value, abnormal)))
        return sorted(coming, key=lambda c: c[0], reverse=True)

    def run(self, steps):
        done, executor = self.done, self.done.executor
        self._note(executor.start(0.0))
        while not executor.finished and len(executor.trace) < steps:
            if executor.reaction is not None:
                done.in_time = False
            times = [executor.next_deadline]
            ends = None
            if self.way is not None:
                ends = self.way.ends if self.stop_at is None else self.stop_at
            times += [ends, self.coming[-1][0] if self.coming else None]
            known = [t for t in times if t is not None]
            if executor.paused and self.way is None:
                if self.mode == "eventful":
                    done.now += self.rng.choice([0, 1, 3, 7])
                self._note(executor.handle(Resume(), done.now))
                continue
            if not known:
                break
            self._pass(max(done.now, min(known)))
            if self.outside and self.rng.random() < 0.3:
                self._note(executor.handle(self._anything(), done.now))
            elif self.pauses and self.stop_at is None and self.rng.random() < self.pauses:
                self._note(executor.handle(Pause(), done.now))
            elif self.coming and self.coming[-1][0] <= done.now:
                self._note(executor.handle(self.coming.pop()[1], done.now))
            elif ends is not None and ends <= done.now:
                self._end()
            else:
                self._note(executor.handle(Tick(), done.now))
        done.finished = executor.finished
        done.nominal = done.nominal and not any(e.failure for e in executor.trace)
        return done

    def _anything(self):
        """Something from outside that may happen at any moment."""
        what = self.rng.choice(self.outside)
        if isinstance(what, EventKind):
            return Occurred(what)
        return ReadingGiven(what, *self._value(what))

    def _pass(self, now):
        """Time passes; the robot may draw power while nothing is under way."""
        if self.way is None:
            share = self.rng.choice([0, 1])
            waited = now - self.done.now
            self.done.energy += share * waited * self.travel.standing_power / 3600
        self.done.now = now

    def _note(self, commands):
        for command in commands:
            if isinstance(command, CancelAction):
                self.stop_at = self.done.now + self.rng.choice([0, 1]) * self.travel.clean_up
            else:
                assert isinstance(command, StartAction)
                self._begin(command)

    def _begin(self, command):
        task, now, rng = command.task, self.done.now, self.rng
        leg = self.travel.leg("start", task, task.velocity)
        work, arrival = leg.work, leg.arrival
        time, energy = self._longest(self.place, task, task.velocity)
        if isinstance(self.place, _Near):
            # An action that is begun anew takes its whole time again.
            time = max(work, rng.choice([0, 0.5, 1]) * max(time, work))
            energy *= rng.choice([0, 0.5, 1])
        if task.time_limit is not None and time > task.time_limit:
            self.done.nominal = False
        if self.mode == "wild":
            time = rng.choice([time, 0, 2 * time + 1])
            work = min(work, time)
        there = now + time - work
        begins = there if command.not_before is None else max(there, command.not_before)
        waiting = rng.choice([0, 1]) * (begins - there) * self.travel.standing_power / 3600
        self.way = _Way(task, now, begins + work, energy + waiting, arrival)

    def _longest(self, place, task, velocity):
        if isinstance(place, _At):
            leg = self.travel.leg(place.standing, task, velocity)
            return leg.duration, leg.energy
        time, energy = self._longest(place.before, place.task, velocity)
        if task.name != place.task.name:
            leg = self.travel.leg(place.arrival, task, velocity)
            time, energy = time + leg.duration, energy + leg.energy
        return time, energy

    def _on_the_way(self, way):
        before = self.place
        if isinstance(before, _Near):
            if self.mode == "failing":
                # What is left after several failures is assumed, see `docs/analysis.md`.
                before = _At(before.arrival)
            else:
                self.done.astray = True
        return _Near(before, way.task, way.arrival)

    def _end(self):
        done, rng, way = self.done, self.rng, self.way
        task, now = way.task, done.now
        value, abnormal = None, False
        if task.action is Action.MEASURE:
            value, abnormal = self._value(task.object_id)
            if self.fails and rng.random() < 0.2:
                value, abnormal = None, False
        self.way = None
        if self.stop_at is not None:
            self.stop_at = None
            share = 1.0 if way.ends <= now else rng.choice([0, 0.5, 1])
            done.energy += share * way.energy
            late = rng.random() < 0.3 and now > way.started
            self.place = _At(way.arrival) if late else self._on_the_way(way)
            event = (
                ActionSucceeded(task.name, value, abnormal) if late else ActionStopped(task.name)
            )
        else:
            done.energy += way.energy
            failed = self.fails and rng.random() < 0.25
            self.place = self._on_the_way(way) if failed else _At(way.arrival)
            event = ActionSucceeded(task.name, value, abnormal)
            if failed:
                event = ActionFailed(task.name, "failed", unreadable=rng.random() < 0.5)
        self._note(done.executor.handle(event, now))

    def _value(self, object_id):
        """Bounds, whole numbers and what lies between them, and whether the robot finds it odd."""
        checkpoint, rng = self.checkpoints[object_id], self.rng
        low, high = checkpoint.range.low, checkpoint.range.high
        between = rng.randint(int(low), int(high))
        value = float(min(rng.choice([low, high, between, between + 0.5]), high))
        return value, not checkpoint.nominal.contains(value) and rng.random() < 0.8


def run(mission: Mission, hfsm: Hfsm, catalog, travel, seed, mode="nominal", steps=STEPS) -> Run:
    """One run at the travel's times.

    `mode` *eventful*: no action fails, but a person pauses, and what others tell and what is waited
    for comes at any moment. *failing*: actions fail, measurements have no value, events occur.
    *wild*: besides, times are any, and a person pauses.
    """
    return _World(mission, hfsm, catalog, travel, seed, mode).run(steps)
