"""Random missions of the whole language, and what happens to them."""

from hypothesis import strategies as st

from argo_compiler.hfsm import Cancel, Occurred, Pause, Resume
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
EVENTS = (
    EventKind.GAS_LEAK,
    EventKind.LOW_BATTERY,
    EventKind.PLATFORM_ALARM,
    EventKind.ALL_CLEAR,
)


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
def missions(draw, events=True):
    """Missions of up to nine tasks; without `events` nothing interrupts them but a person."""
    size = draw(st.integers(1, 9))
    kinds = draw(st.lists(st.booleans(), min_size=size, max_size=size))
    names = [f"{'M' if measures else 'W'}{i}" for i, measures in enumerate(kinds)]
    tasks = [draw(tasks_named(name, names, i)) for i, name in enumerate(names)]
    if draw(st.booleans()):
        ways = draw(st.lists(st.sampled_from(names), max_size=1))
        start = Task(
            name="S",
            action=Action.START,
            transitions=tuple(Transition(target=way) for way in ways),
        )
        tasks.insert(0, start)
    return Mission(
        tasks=tuple(tasks),
        groups=tuple(draw(groups_over(names, interruptions=events))),
        reactions=tuple(draw(reactions())) if events else (),
        max_duration=draw(st.sampled_from([None, None, 3, 10, 30])) if events else None,
        dock=HERE,
    )


@st.composite
def tasks_named(draw, name, names, index):
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
    return Task(
        name=name,
        action=Action.MEASURE if name.startswith("M") else Action.WAYPOINT,
        object_id=draw(st.sampled_from(OBJECTS)) if name.startswith("M") else None,
        pose=None if name.startswith("M") else HERE,
        retries=draw(st.sampled_from([0, 0, 1, 2])),
        on_failure=draw(st.sampled_from([OnFailure.CONTINUE, OnFailure.CONTINUE, *OnFailure])),
        transitions=tuple(ways),
    )


@st.composite
def groups_over(draw, names, interruptions=True):
    """Ranges that lie in each other or apart, named by their nesting."""
    ends = st.integers(0, len(names) - 1)
    kept = []
    for a, b in draw(st.lists(st.tuples(ends, ends), max_size=5)):
        first, last = min(a, b), max(a, b)
        crosses = any(f < first <= e < last or first < f <= last < e for f, e in kept)
        if not crosses:
            kept.append((first, last))
    paths = []
    groups = []
    for i, (first, last) in enumerate(sorted(kept, key=lambda r: (r[0], -r[1]))):
        while paths and paths[-1][1] < first:
            paths.pop()
        name = f"{paths[-1][0]}/{i}" if paths else str(i)
        paths.append((name, last))
        groups.append(
            Group(
                name=name,
                start=names[first],
                end=names[last],
                max_repeat_count=draw(st.integers(0, 3)),
                max_repeat_duration=draw(st.sampled_from([0, 0, 1, 2, 3, 5, 8, 13])),
                count_interruptions=interruptions and draw(st.booleans()),
                stop=draw(st.sampled_from(Stop)),
            )
        )
    return draw(st.permutations(groups))


@st.composite
def reactions(draw, events=(*EVENTS, EventKind.TIME_UP), least=0):
    kinds = draw(st.lists(st.sampled_from(events), unique=True, min_size=least, max_size=4))
    found = []
    for event in kinds:
        response = draw(st.sampled_from(Response))
        others = [other for other in EVENTS if other in events and other is not event]
        until = draw(st.sampled_from([None, *others]))
        found.append(
            Reaction(
                event=event,
                response=response,
                pose=HERE if response is Response.SAFE_AREA else None,
                until=until,
                afterwards=draw(st.sampled_from(Afterwards)),
                priority=draw(st.integers(0, 2)),
            )
        )
    return found


happenings = st.one_of(
    st.sampled_from(EVENTS).map(Occurred),
    st.sampled_from(EVENTS).map(Occurred),
    st.sampled_from([Pause(), Resume(), Resume()]),
    st.sampled_from([Pause(), Resume(), Cancel()]),
)

# What happens besides, and how many seconds after the happening before.
scripts = st.lists(st.tuples(st.integers(0, 6), happenings), max_size=8)

# How long an action takes (s), what it reads, whether it fails; if it is cancelled, how long its
# clean-up takes, and whether it reports its result after all.
outcome_lists = st.lists(
    st.tuples(
        st.integers(0, 4),
        st.one_of(st.none(), st.integers(0, 6)),
        st.booleans(),
        st.integers(0, 2),
        st.booleans(),
    ),
    min_size=1,
    max_size=8,
)


@st.composite
def busy_missions(draw):
    """Missions that go on and on, and are interrupted all the time."""
    two = (
        draw(tasks_named("M0", ["M0", "W1"], 0)).model_copy(update={"object_id": "1"}),
        draw(tasks_named("W1", ["M0", "W1"], 1)).model_copy(update={"transitions": ()}),
    )
    limit = draw(st.sampled_from([0, 0, 5, 9]))
    group = Group(
        name="G",
        start="M0",
        end="W1",
        max_repeat_count=50,
        max_repeat_duration=limit,
        count_interruptions=draw(st.booleans()),
    )
    return Mission(
        tasks=two,
        groups=(group,),
        reactions=tuple(draw(reactions(BUSY, least=2))),
        dock=HERE,
    )


BUSY = (EventKind.GAS_LEAK, EventKind.LOW_BATTERY, EventKind.ALL_CLEAR)

busy_scripts = st.lists(
    st.tuples(
        st.integers(0, 4),
        st.one_of(
            st.sampled_from(BUSY).map(Occurred),
            st.sampled_from(BUSY).map(Occurred),
            st.sampled_from([Pause(), Resume()]),
        ),
    ),
    min_size=4,
    max_size=12,
)
