"""Random missions, and a driver that takes any machine through one on a virtual clock."""

from dataclasses import dataclass, field
from itertools import cycle

from hypothesis import strategies as st

from argo_compiler.il import (
    Action,
    Afterwards,
    EventKind,
    Mission,
    Reaction,
    Response,
    Stop,
    Task,
    Transition,
)
from tests.mission_parts import HERE, groups_over, starts, task_names, tasks_named


@st.composite
def missions(draw, failures=True):
    """Up to nine tasks with ways in all directions and groups in groups.

    With `failures`, tasks have retries and policies.
    """
    names = draw(task_names())
    tasks = [draw(tasks_named(name, names, i, failures)) for i, name in enumerate(names)]
    groups = draw(groups_over(names))
    return Mission(tasks=(*draw(starts(names)), *tasks), groups=groups, dock=HERE)


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
    names = draw(task_names())
    tasks = []
    for i, name in enumerate(names):
        made = draw(tasks_named(name, names, i))
        ahead = tuple(t for t in made.transitions if names.index(t.target) > i)
        tasks.append(made.model_copy(update={"transitions": ahead}))
    groups = [
        group if timeouts else group.model_copy(update={"stop": Stop.SOFT})
        for group in draw(groups_over(names))
    ]
    start = Task(
        name="S",
        action=Action.START,
        transitions=(Transition(target=draw(st.sampled_from(names))),),
    )
    first = [start] if draw(st.booleans()) else []
    return Mission(tasks=(*first, *tasks), groups=tuple(groups), dock=HERE)
