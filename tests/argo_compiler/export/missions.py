"""Random missions, and a driver that takes any machine through one on a virtual clock."""

from dataclasses import dataclass, field
from itertools import cycle

from hypothesis import strategies as st

from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Stop,
    Task,
    Transition,
)
from argo_compiler.model import Pose

OBJECTS = ("1", "2", "3")
HERE = Pose(x=0, y=0, z=0)


@st.composite
def conditions(draw):
    low = draw(st.integers(0, 4))
    return Condition(
        type=draw(st.sampled_from(ConditionType)),
        object_id=draw(st.sampled_from(OBJECTS)),
        param1=low,
        param2=draw(st.integers(low + 1, 6)),
        inclusive=draw(st.booleans()),
        max_age=draw(st.one_of(st.none(), st.integers(1, 6))),
    )


@st.composite
def missions(draw, failures=True):
    """Up to nine tasks with ways in all directions and groups in groups.

    With `failures`, tasks have retries and policies.
    """
    size = draw(st.integers(1, 9))
    kinds = draw(st.lists(st.booleans(), min_size=size, max_size=size))
    names = [f"{'M' if measures else 'W'}{i}" for i, measures in enumerate(kinds)]
    tasks = [draw(_tasks_named(name, names, i, failures)) for i, name in enumerate(names)]
    if draw(st.booleans()):
        ways = draw(st.lists(st.sampled_from(names), max_size=1))
        start = tuple(Transition(target=way) for way in ways)
        tasks.insert(0, Task(name="S", action=Action.START, transitions=start))
    return Mission(tasks=tuple(tasks), groups=tuple(draw(_groups_over(names))), dock=HERE)


@st.composite
def _tasks_named(draw, name, names, index, failures):
    ways = [
        Transition(target=draw(st.sampled_from(names)), conditions=tuple(held))
        for held in draw(st.lists(st.lists(conditions(), min_size=1, max_size=2), max_size=2))
    ]
    onward = draw(st.sampled_from(["next", "next", "next", "any", "end"]))
    if onward != "end":
        following = names[index + 1] if index + 1 < len(names) else None
        target = draw(st.sampled_from(names)) if onward == "any" else following
        if target is not None:
            ways.insert(draw(st.integers(0, len(ways))), Transition(target=target))
    measures = name.startswith("M")
    policies = [OnFailure.CONTINUE, OnFailure.CONTINUE, *OnFailure]
    return Task(
        name=name,
        action=Action.MEASURE if measures else Action.WAYPOINT,
        object_id=draw(st.sampled_from(OBJECTS)) if measures else None,
        pose=None if measures else HERE,
        retries=draw(st.sampled_from([0, 0, 1, 2])) if failures else 0,
        on_failure=draw(st.sampled_from(policies)) if failures else OnFailure.CONTINUE,
        transitions=tuple(ways),
    )


@st.composite
def _groups_over(draw, names):
    """Ranges that lie in each other or apart, named by their nesting."""
    ends = st.integers(0, len(names) - 1)
    kept = []
    for a, b in draw(st.lists(st.tuples(ends, ends), max_size=5)):
        first, last = min(a, b), max(a, b)
        if not any(f < first <= e < last or first < f <= last < e for f, e in kept):
            kept.append((first, last))
    around, groups = [], []
    for i, (first, last) in enumerate(sorted(kept, key=lambda r: (r[0], -r[1]))):
        while around and around[-1][1] < first:
            around.pop()
        name = f"{around[-1][0]}/{i}" if around else str(i)
        around.append((name, last))
        groups.append(
            Group(
                name=name,
                start=names[first],
                end=names[last],
                max_repeat_count=draw(st.integers(0, 3)),
                max_repeat_duration=draw(st.sampled_from([0, 0, 1, 2, 3, 5, 8, 13])),
                count_interruptions=draw(st.booleans()),
                stop=draw(st.sampled_from(Stop)),
            )
        )
    return draw(st.permutations(groups))


@st.composite
def reactions(draw):
    """Reactions to some of four events; `until` may be an event that has a reaction itself."""
    events = (EventKind.GAS_LEAK, EventKind.LOW_BATTERY, EventKind.HOT_SPOT, EventKind.TIME_UP)
    untils = st.sampled_from([None, EventKind.ALL_CLEAR, EventKind.BATTERY_CHARGED, *events[:2]])
    made = []
    for event in draw(st.lists(st.sampled_from(events), max_size=3, unique=True)):
        response = draw(st.sampled_from(Response))
        interrupts = response not in (Response.REPORT, Response.ABORT)
        drives = response in (Response.RETURN, Response.SAFE_AREA)
        made.append(
            Reaction(
                event=event,
                response=response,
                pose=HERE if response is Response.SAFE_AREA else None,
                until=draw(untils) if interrupts else None,
                afterwards=draw(st.sampled_from(Afterwards)) if drives else Afterwards.END,
                priority=draw(st.integers(0, 2)),
            )
        )
    return tuple(made)


# How long an action takes (s), what it reads, and whether it fails.
outcome_lists = st.lists(
    st.tuples(st.integers(0, 4), st.one_of(st.none(), st.integers(0, 6)), st.booleans()),
    min_size=1,
    max_size=8,
)

# How long the clean-up of a cancelled action takes (s), and how it ends.
cleanup_lists = st.lists(
    st.tuples(st.integers(0, 3), st.sampled_from(["stopped", "stopped", "succeeded", "failed"])),
    min_size=1,
    max_size=4,
)

# When (s after the one before) a person or an event comes between.
intervention_lists = st.lists(
    st.tuples(
        st.integers(0, 6),
        st.sampled_from(
            ["pause", "resume", "resume", "cancel"]
            + [f"event.{kind}" for kind in ("gas_leak", "low_battery", "hot_spot")]
            + [f"event.{kind}" for kind in ("all_clear", "battery_charged")]
        ),
    ),
    max_size=8,
)


@dataclass
class Drive:
    """Drives a machine on a virtual clock, and writes down what it can see of it.

    A machine has `start()`, `handle(event, now, value)`, `deadline`, `finished`, `running` (the
    number of actions started and the task, or None), `stopping` and `seen()`.
    """

    machine: object
    outcomes: list
    cleanups: list = field(default_factory=lambda: [(0, "stopped")])
    interventions: list = field(default_factory=list)
    steps: int = 60

    def run(self):
        outcomes, cleanups = cycle(self.outcomes), cycle(self.cleanups)
        pending, at = [], 0
        for delay, event in self.interventions:
            at += delay
            pending.append((at, event))
        machine, now, ends, stops, token = self.machine, 0, None, False, None
        machine.start()
        seen = [(now, *machine.seen())]
        while not machine.finished and len(seen) < self.steps:
            if machine.running is None:
                ends = None
            elif machine.running != token:
                duration, value, failed = next(outcomes)
                token, stops = machine.running, False
                ends = (now + duration, "failed" if failed else "succeeded", value)
            if machine.running is not None and machine.stopping and not stops:
                duration, how = next(cleanups)
                stops, ends = True, (now + duration, how, ends[2])
            due = []
            if ends is not None:
                due.append((ends[0], 0, f"action.{ends[1]}"))
            if pending:
                due.append((pending[0][0], 1, pending[0][1]))
            if machine.deadline is not None:
                due.append((machine.deadline, 2, "tick"))
            if not due:
                break
            now, rank, event = min(due)
            if rank == 1:
                pending.pop(0)
            value = ends[2] if rank == 0 and token[1].startswith("M") else None
            machine.handle(event, now, value)
            seen.append((now, *machine.seen()))
        return seen


@st.composite
def structured_missions(draw, timeouts=True):
    """Missions that go forward: conditional ways ahead, rounds by groups only.

    Without `timeouts`, no group is left by the clock in the middle of an action.
    """
    size = draw(st.integers(1, 9))
    kinds = draw(st.lists(st.booleans(), min_size=size, max_size=size))
    names = [f"{'M' if measures else 'W'}{i}" for i, measures in enumerate(kinds)]
    tasks = []
    for i, name in enumerate(names):
        made = draw(_tasks_named(name, names, i, True))
        ahead = tuple(t for t in made.transitions if names.index(t.target) > i)
        tasks.append(made.model_copy(update={"transitions": ahead}))
    groups = [
        group if timeouts else group.model_copy(update={"stop": Stop.SOFT})
        for group in draw(_groups_over(names))
    ]
    start = Task(
        name="S",
        action=Action.START,
        transitions=(Transition(target=draw(st.sampled_from(names))),),
    )
    first = [start] if draw(st.booleans()) else []
    return Mission(tasks=(*first, *tasks), groups=tuple(groups), dock=HERE)
