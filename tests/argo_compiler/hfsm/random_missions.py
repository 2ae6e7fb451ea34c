"""Random missions of the whole language, and what happens to them."""

from hypothesis import strategies as st

from argo_compiler.hfsm import Cancel, Occurred, Pause, Resume
from argo_compiler.il import (
    Afterwards,
    EventKind,
    Group,
    Mission,
    Reaction,
    Response,
)
from tests.mission_parts import HERE, groups_over, starts, task_names, tasks_named

EVENTS = (
    EventKind.GAS_LEAK,
    EventKind.LOW_BATTERY,
    EventKind.PLATFORM_ALARM,
    EventKind.ALL_CLEAR,
)


@st.composite
def missions(draw, events=True):
    """Missions of up to nine tasks; without `events` nothing interrupts them but a person."""
    names = draw(task_names())
    tasks = [draw(tasks_named(name, names, i)) for i, name in enumerate(names)]
    return Mission(
        tasks=(*draw(starts(names)), *tasks),
        groups=draw(groups_over(names, interruptions=events)),
        reactions=tuple(draw(reactions())) if events else (),
        max_duration=draw(st.sampled_from([None, None, 3, 10, 30])) if events else None,
        dock=HERE,
    )


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
