"""Random missions with all features of the language, and random events during them."""

from dataclasses import dataclass
from functools import partial

from hypothesis import strategies as st

from argo_compiler.hfsm import (
    ByHand,
    Cancel,
    GiveBack,
    Occurred,
    Pause,
    Resume,
    TakeOver,
)
from argo_compiler.hfsm.events import ReadingGiven
from argo_compiler.il import (
    Action,
    Afterwards,
    ConditionType,
    EventKind,
    Group,
    Mission,
    Mode,
    OnFailure,
    Response,
    Task,
    WaitRule,
)
from tests.mission_parts import (
    HERE,
    OBJECTS,
    conditions_of_readings,
    groups_over,
    reactions_to,
    starts,
    tasks_named,
    transitions,
    wait_rules,
    windows,
)

EVENTS = (
    EventKind.GAS_LEAK,
    EventKind.LOW_BATTERY,
    EventKind.EMERGENCY_STOP,
    EventKind.ALL_CLEAR,
)


@dataclass(frozen=True)
class ActionResult:
    """Duration (s) and result of an action.

    If the action is cancelled: the duration of its clean-up (s), and whether it reports its result
    after all (`late`).
    """

    seconds: int
    value: int | None = None
    abnormal: bool = False
    failed: bool = False
    unreadable: bool = False
    unreachable: bool = False
    clean_up: int = 0
    late: bool = False


action_results = st.builds(
    ActionResult,
    seconds=st.integers(0, 4),
    value=st.one_of(st.integers(0, 6), st.integers(0, 6), st.none()),
    abnormal=st.booleans(),
    failed=st.sampled_from([False, False, True]),
    unreadable=st.booleans(),
    unreachable=st.booleans(),
    clean_up=st.integers(0, 2),
    late=st.booleans(),
)
result_lists = st.lists(action_results, min_size=1, max_size=8)


@st.composite
def task_names(draw, least=1, most=9):
    """M and a number for tasks that measure, W for waypoints, T for waits."""
    kinds = draw(st.lists(st.sampled_from("MMWT"), min_size=least, max_size=most))
    return [f"{kind}{i}" for i, kind in enumerate(kinds)]


@st.composite
def tasks_of_all_kinds(draw, name, names, index, timed=True):
    """Actions with limits and windows, and waits.

    Without `timed`, only the clocks of groups depend on time.
    """
    most = 1 if name.startswith("T") else 3  # or most would go round in circles that take no time
    ways = transitions(names, index, partial(conditions_of_readings, ages=timed), most)
    if name.startswith("T"):
        policy = draw(st.sampled_from(OnFailure)) if timed else OnFailure.CONTINUE
        rule = draw(wait_rules(EVENTS)) if timed else WaitRule(duration=0)
        task = Task(name=name, action=Action.WAIT, wait=rule, on_failure=policy)
    else:
        task = draw(tasks_named(name, names, index))
    fields = {"transitions": draw(ways), "optional": draw(st.booleans())}
    if task.on_failure is OnFailure.BRANCH:
        fields["failure_target"] = draw(st.sampled_from(names))
    if timed and task.action is not Action.WAIT:
        fields["time_limit"] = draw(st.sampled_from([None, None, None, 1, 2, 3]))
    if timed and draw(st.sampled_from([False, False, True])):
        fields["window"] = draw(windows(names))
    return task.model_copy(update=fields)


@st.composite
def missions(draw, events=True):
    """Missions of up to nine tasks.

    Without `events`, only a person interrupts them, and only the clocks of groups depend on time.
    """
    names = draw(task_names())
    tasks = [draw(tasks_of_all_kinds(name, names, i, events)) for i, name in enumerate(names)]
    modes = [Mode.AUTONOMOUS] * 5 + [Mode.SUPERVISORY] * events
    until = conditions_of_readings(ages=events)
    return Mission(
        mode=draw(st.sampled_from(modes)),
        tasks=(*draw(starts(names)), *tasks),
        groups=draw(groups_over(names, interruptions=events, plans=events, until=until)),
        reactions=tuple(draw(reactions())) if events else (),
        max_duration=draw(st.sampled_from([None, None, 3, 10, 30])) if events else None,
        dock=HERE,
    )


@st.composite
def reactions(draw, events=(*EVENTS, EventKind.TIME_UP), least=0):
    kinds = draw(st.lists(st.sampled_from(events), unique=True, min_size=least, max_size=4))
    return [draw(_reactions_to(event, [e for e in EVENTS if e in events])) for event in kinds]


def _reactions_to(event, awaited):
    untils = [None, *(other for other in awaited if other is not event)]
    priorities = [None, None, 0, 1, 2]
    return reactions_to(event, Response, untils, [None, 1, 2, 4], priorities, Afterwards)


@st.composite
def tasks_by_hand(draw, names):
    """A task that a person did or skipped."""
    name = draw(st.sampled_from(names))
    measured = name.startswith("M") and draw(st.booleans())
    return ByHand(
        task=name,
        value=draw(st.integers(0, 6)) if measured else None,
        abnormal=measured and draw(st.booleans()),
        duration=draw(st.integers(0, 4)),
        skipped=not measured and draw(st.booleans()),
        age=draw(st.one_of(st.none(), st.integers(0, 5))),
    )


def expected(mission):
    """Return the events that the mission waits for or reacts to, except TIME_UP."""
    events = [task.wait.event for task in mission.tasks if task.wait is not None] * 3
    for reaction in mission.reactions:
        events += [reaction.event, reaction.until]
    return [event for event in events if event not in (None, EventKind.TIME_UP)]


def reading_for(condition):
    """Return an abnormal reading, which satisfies the condition if it compares values."""
    values = {
        ConditionType.LESS: lambda c: c.param1 - 1,
        ConditionType.GREATER: lambda c: c.param1 + 1,
        ConditionType.WITHIN: lambda c: (c.param1 + c.param2) / 2,
    }
    value = values.get(condition.type, lambda _: 0)(condition)
    return ReadingGiven(condition.object_id, value, abnormal=True)


@st.composite
def scripts(draw, mission, most=8):
    """Events other than the ends of actions, each with the seconds since the previous one."""
    names = [task.name for task in mission.tasks if task.action is not Action.START]
    occurs = st.sampled_from([*EVENTS, *expected(mission)]).map(Occurred)
    given = st.builds(
        ReadingGiven, st.sampled_from(OBJECTS), st.integers(0, 6), abnormal=st.booleans()
    )
    awaited = [reading_for(c) for task in mission.tasks if task.wait for c in task.wait.conditions]
    if awaited:
        given = st.one_of(given, *[st.sampled_from(awaited)] * 3)
    alone = st.one_of(occurs, given).map(lambda one: (one,))
    scripted_events = st.one_of(
        alone,
        alone,
        st.sampled_from([(Pause(), Resume()), (Resume(),), (Pause(), Resume()), (Cancel(),)]),
        st.lists(tasks_by_hand(names), max_size=4).map(
            lambda done: (TakeOver(), GiveBack(tuple(done)))
        ),
    )
    script = []
    if mission.mode is Mode.SUPERVISORY:
        script.append((draw(st.integers(0, 3)), Resume()))
    for together in draw(
        st.lists(scripted_events, min_size=draw(st.integers(0, 3)), max_size=most)
    ):
        script += [(draw(st.integers(0, 5)), one) for one in together]
    return script


@dataclass(frozen=True)
class Case:
    """Mission, the results of its actions in turn, and the scripted events."""

    mission: Mission
    results: list[ActionResult]
    script: list[tuple[int, object]]


@st.composite
def cases(draw, of=None):
    mission = draw(missions() if of is None else of)
    return Case(mission, draw(result_lists), draw(scripts(mission)))


@st.composite
def busy_missions(draw):
    """Missions with many rounds and many interruptions."""
    two = (
        draw(tasks_named("M0", ["M0", "W1"], 0)).model_copy(
            update={"object_id": "1", "failure_target": "W1"}
        ),
        draw(tasks_named("W1", ["M0", "W1"], 1)).model_copy(
            update={"transitions": (), "failure_target": "M0"}
        ),
    )
    limit = draw(st.sampled_from([0, 0, 5, 9]))
    group = Group(
        name="G",
        start="M0",
        end="W1",
        max_repeat_count=50,
        max_repeat_duration=limit,
        count_interruptions=draw(st.booleans()),
        every=draw(st.sampled_from([0, 0, 5])),
    )
    return Mission(
        tasks=two,
        groups=(group,),
        reactions=tuple(draw(reactions(BUSY, least=2))),
        dock=HERE,
    )


BUSY = (EventKind.GAS_LEAK, EventKind.LOW_BATTERY, EventKind.ALL_CLEAR)


@st.composite
def busy_cases(draw):
    mission = draw(busy_missions())
    scripted_events = st.one_of(
        st.sampled_from(BUSY).map(Occurred),
        st.sampled_from(BUSY).map(Occurred),
        st.sampled_from([Pause(), Resume()]),
    )
    script = st.lists(st.tuples(st.integers(0, 4), scripted_events), min_size=4, max_size=12)
    return Case(mission, draw(result_lists), draw(script))
