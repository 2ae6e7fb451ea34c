"""Small random missions with bounded values, travel times made up for them, and runs of both."""

from dataclasses import dataclass, field
from random import Random

from hypothesis import strategies as st

from argo_compiler.analysis import Leg, NoWay
from argo_compiler.catalog import Area, Catalog, CheckpointInfo, CheckpointKind, Interval
from argo_compiler.hfsm import (
    ActionFailed,
    ActionStopped,
    ActionSucceeded,
    CancelAction,
    Executor,
    Hfsm,
    Pause,
    Resume,
    StartAction,
    Tick,
)
from argo_compiler.il import (
    Action,
    Condition,
    ConditionType,
    Mission,
    OnFailure,
    Task,
    Transition,
)
from tests.mission_parts import HERE, OBJECTS, groups_over, transitions

STEPS = 80


@st.composite
def conditions(draw, objects=OBJECTS):
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
def tasks_named(draw, name, names, index, object_id):
    # Conditions on what was just measured are what plans are made of.
    objects = OBJECTS if object_id is None else (object_id, object_id, *OBJECTS)
    return Task(
        name=name,
        action=Action.WAYPOINT if object_id is None else Action.MEASURE,
        object_id=object_id,
        pose=HERE if object_id is None else None,
        velocity=draw(st.sampled_from([None, None, 2])),
        retries=draw(st.sampled_from([0, 0, 1])),
        on_failure=draw(st.sampled_from([OnFailure.CONTINUE, OnFailure.CONTINUE, *OnFailure])),
        transitions=draw(transitions(names, index, lambda: conditions(objects))),
    )


@st.composite
def missions(draw, least=1, most=8):
    size = draw(st.integers(least, most))
    objects = [draw(st.sampled_from([None, *OBJECTS, *OBJECTS])) for _ in range(size)]
    names = [f"{'W' if o is None else f'M{o}x'}{i}" for i, o in enumerate(objects)]
    tasks = [draw(tasks_named(name, names, i, objects[i])) for i, name in enumerate(names)]
    if draw(st.booleans()):
        way = draw(st.lists(st.sampled_from(names), max_size=1))
        ways = tuple(Transition(target=w) for w in way)
        tasks.insert(0, Task(name="S", action=Action.START, velocity=2, transitions=ways))
    return Mission(
        tasks=tuple(tasks),
        groups=draw(groups_over(names, interruptions=False)),
        dock=HERE,
        max_duration=draw(st.sampled_from([None, 30])),
    )


@st.composite
def catalogs(draw):
    return Catalog(
        site="made up",
        checkpoints=tuple(checkpoint(int(o), *draw(ranges())) for o in OBJECTS),
        areas=(Area(number=1, dock=HERE),),
        floors=(),
    )


@st.composite
def ranges(draw):
    low = draw(st.integers(0, 4))
    return low, draw(st.integers(low, 6))


def checkpoint(number, low, high):
    return CheckpointInfo(
        id=number,
        kind=CheckpointKind.VALVE,
        name=f"valve R{number}",
        floor=1,
        unit="deg",
        range=Interval(low=low, high=high),
        nominal=Interval(low=low, high=high),
    )


class MadeUpTravel:
    """Travel times and energies between places, drawn once. Places are objects and tasks."""

    def __init__(self, seed, clean_up=0.0, blocked=()):
        self.seed = seed
        self.clean_up = clean_up
        self.battery = 5.0
        self.standing_power = 0.0
        self.blocked = blocked

    def start(self, mission):  # noqa: ARG002
        return "start"

    def leg(self, origin, task, velocity):
        place = task.object_id or task.name
        if place in self.blocked:
            return NoWay("a wall stands in the way")
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
    steps: list = field(default_factory=list)


@dataclass
class _Way:
    """An action under way, and what its cancellation leaves to be done."""

    task: Task
    started: float
    ends: float
    energy: float
    arrival: object


def run(mission: Mission, hfsm: Hfsm, catalog, travel, seed, failures=False, steps=STEPS) -> Run:
    """One run at the travel's times. Values lie in the catalogue's ranges, bounds included.

    With `failures`, actions fail, measurements have no value, times are any, and a person pauses.
    """
    rng = Random(seed)
    ranges = {str(c.id): c.range for c in catalog.checkpoints}
    done = Run(Executor(hfsm))
    standing = travel.start(mission)
    rest = None  # (time, energy) at most to the place the robot was on its way to, and that task
    start = next((t for t in mission.tasks if t.action is Action.START), None)
    velocity = start.velocity if start else None
    way = None
    stop_at = None

    def note(commands):
        nonlocal way, stop_at, velocity
        for command in commands:
            if isinstance(command, CancelAction):
                stop_at = done.now + rng.choice([0, 1]) * travel.clean_up
                continue
            assert isinstance(command, StartAction)
            task = command.task
            leg = travel.leg(standing, task, velocity)
            time, energy = leg.duration, leg.energy
            if rest is not None:
                same = task.name == rest[2]
                # An action that is begun anew takes its whole time again.
                most = max(rest[0] + (0 if same else time), leg.work)
                time = max(leg.work, rng.choice([0, 0.5, 1]) * most)
                energy = rng.choice([0, 0.5, 1]) * (rest[1] + (0 if same else energy))
            if failures:
                time = rng.choice([time, 0, 2 * time + 1])
            way = _Way(task, done.now, done.now + time, energy, leg.arrival)
            velocity = task.velocity

    note(done.executor.start(0.0))
    while not done.executor.finished and len(done.executor.trace) < steps:
        deadline = done.executor.next_deadline
        ends = way.ends if stop_at is None else stop_at
        if deadline is not None and deadline < ends:
            done.now = deadline
            note(done.executor.handle(Tick(), done.now))
            continue
        if failures and stop_at is None and rng.random() < 0.05:
            note(done.executor.handle(Pause(), done.now))
            continue
        done.now = max(done.now, ends)
        task = way.task
        value = None
        if task.action is Action.MEASURE:
            limits = ranges[task.object_id]
            value = _value(rng, limits.low, limits.high)
            if failures and rng.random() < 0.2:
                value = None
        kept = way
        if stop_at is not None:
            share = 1.0 if kept.ends <= stop_at else rng.choice([0, 0.5, 1])
            done.energy += share * kept.energy
            rest = (max(0.0, kept.ends - done.now), (1 - share) * kept.energy, task.name)
            standing = kept.arrival
            stop_at = None
            late = rng.random() < 0.3
            event = ActionSucceeded(task.name, value) if late else ActionStopped(task.name)
        else:
            done.energy += kept.energy
            rest, standing = None, kept.arrival
            failed = failures and rng.random() < 0.25
            event = (
                ActionFailed(task.name, "failed") if failed else ActionSucceeded(task.name, value)
            )
        note(done.executor.handle(event, done.now))
        if done.executor.paused:
            note(done.executor.handle(Resume(), done.now))
    done.finished = done.executor.finished
    return done


def _value(rng, low, high):
    """Bounds, whole numbers and what lies between them."""
    between = rng.randint(int(low), int(high))
    return float(min(rng.choice([low, high, between, between + 0.5]), high))
