"""Random parts of missions: conditions, tasks with transitions to any task, nested groups."""

from hypothesis import assume
from hypothesis import strategies as st

from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import has_errors
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    OnFailure,
    Reaction,
    Response,
    Stop,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)

OBJECTS = ("1", "2", "3")
HERE = Pose(x=0, y=0, z=0)


def assume_sound(mission):
    """Return the mission, or reject the example if the mission has errors."""
    assume(not has_errors(check(mission)))
    return mission


@st.composite
def task_names(draw, least=1, most=9):
    """Draw names of tasks: M and a number to measure, W and a number for a waypoint."""
    kinds = draw(st.lists(st.booleans(), min_size=least, max_size=most))
    return [f"{'M' if measures else 'W'}{i}" for i, measures in enumerate(kinds)]


@st.composite
def conditions(draw):
    low = draw(st.integers(0, 4))
    return Condition(
        type=draw(st.sampled_from([t for t in ConditionType if t.compares])),
        object_id=draw(st.sampled_from(OBJECTS)),
        param1=low,
        param2=draw(st.integers(low + 1, 6)),
        inclusive=draw(st.booleans()),
        max_age=draw(st.one_of(st.none(), st.integers(1, 6))),
    )


@st.composite
def conditions_of_readings(draw, ages=True):
    """Draw a condition of any type; without `ages`, one that ignores the age of the reading."""
    types = [t for t in ConditionType if ages or t is not ConditionType.STALE]
    type = draw(st.sampled_from([*types, ConditionType.LESS, ConditionType.GREATER]))
    if type.compares:
        found = draw(conditions()).model_copy(update={"type": type})
        return found if ages else found.model_copy(update={"max_age": None})
    oldest = {
        ConditionType.STALE: st.integers(1, 6),
        ConditionType.ABNORMAL: st.one_of(st.none(), st.integers(1, 6)),
    }
    return Condition(
        type=type,
        object_id=draw(st.sampled_from(OBJECTS)),
        max_age=draw(oldest.get(type, st.none())) if ages else None,
    )


@st.composite
def wait_rules(draw, events=(EventKind.ALL_CLEAR,)):
    """Draw the rule of a WAIT: for a time, perhaps 0, or until something occurs, mostly limited."""
    until = draw(st.sampled_from(["time", "event", "conditions", "either"]))
    if until == "time":
        return WaitRule(duration=draw(st.sampled_from([0, 0, 1, 2, 3, 5])))
    held = conditions_of_readings()
    return WaitRule(
        event=None if until == "conditions" else draw(st.sampled_from(events)),
        conditions=() if until == "event" else (draw(held), *draw(st.lists(held, max_size=1))),
        limit=draw(st.sampled_from([None, 1, 4, 8, 12])),
    )


@st.composite
def windows(draw, names, late=12):
    """Draw a hard window, perhaps with a `missed_target`, or a soft one, up to about 2 `late` s."""
    earliest = draw(st.one_of(st.just(0), st.integers(0, late)))
    latest = draw(st.sampled_from([None, *(earliest + s for s in (1, 2, 4, late))]))
    hard = latest is not None and draw(st.sampled_from([True, True, False]))
    target = st.one_of(st.none(), st.sampled_from(names))
    return TimeWindow(
        earliest=earliest, latest=latest, hard=hard, missed_target=draw(target) if hard else None
    )


@st.composite
def transitions(draw, names, index, held=conditions, most=3):
    """Draw transitions from the task with this index to any others, with conditions from `held`.

    In most cases there is also an unconditional transition to the next task.
    """
    ways = [
        Transition(target=draw(st.sampled_from(names)), conditions=tuple(both))
        for both in draw(st.lists(st.lists(held(), min_size=1, max_size=2), max_size=most))
    ]
    onward = draw(st.sampled_from(["next", "next", "next", "any", "end"]))
    if onward != "end":
        following = names[index + 1] if index + 1 < len(names) else None
        target = draw(st.sampled_from(names)) if onward == "any" else following
        if target is not None:
            ways.insert(draw(st.integers(0, len(ways))), Transition(target=target))
    return tuple(ways)


@st.composite
def tasks_named(draw, name, names, index, failures=True):
    """Draw a task of this name; with `failures`, it may have retries and a failure policy."""
    measures = name.startswith("M")
    policies = [OnFailure.CONTINUE, OnFailure.CONTINUE, *OnFailure]
    return Task(
        name=name,
        action=Action.MEASURE if measures else Action.WAYPOINT,
        object_id=draw(st.sampled_from(OBJECTS)) if measures else None,
        pose=None if measures else HERE,
        retries=draw(st.sampled_from([0, 0, 1, 2])) if failures else 0,
        on_failure=draw(st.sampled_from(policies)) if failures else OnFailure.CONTINUE,
        transitions=draw(transitions(names, index)),
    )


@st.composite
def starts(draw, names):
    """Draw a list of no or one START, perhaps with a transition to any task."""
    if not draw(st.booleans()):
        return []
    ways = tuple(Transition(target=w) for w in draw(st.lists(st.sampled_from(names), max_size=1)))
    return [Task(name="S", action=Action.START, transitions=ways)]


@st.composite
def reactions_to(draw, event, responses, untils, limits, priorities, afterwards, shelter=HERE):
    """Draw reactions; each field that has an effect is drawn from the arguments."""
    response = draw(st.sampled_from(responses))
    until = draw(st.sampled_from(untils))
    drives = response in (Response.RETURN, Response.SAFE_AREA)
    holds = response is Response.PAUSE or (drives and until is not None)
    limit = draw(st.sampled_from(limits)) if holds else None
    return Reaction(
        event=event,
        response=response,
        pose=shelter if response is Response.SAFE_AREA else None,
        until=until if holds else None,
        afterwards=draw(st.sampled_from(afterwards)),
        hold_limit=limit,
        on_limit=draw(st.sampled_from(Afterwards)) if limit else Afterwards.WAIT,
        priority=draw(st.sampled_from(priorities)),
    )


def nested(ranges, own):
    """Yield the nested or disjoint ranges, outer ones first, each after the path of its name.

    `own` returns the last part of the path, from the range and its index.
    """
    kept, around, paths = [], [], set()
    for first, last in map(sorted, ranges):
        if not any(f < first <= e < last or first < f <= last < e for f, e in kept):
            kept.append((first, last))
    for i, (first, last) in enumerate(sorted(kept, key=lambda r: (r[0], -r[1]))):
        while around and around[-1][1] < first:
            around.pop()
        name = own(i, first, last)
        path = f"{around[-1][0]}/{name}" if around else name
        path += f" {i}" if path in paths else ""
        around.append((path, last))
        paths.add(path)
        yield path, first, last


@st.composite
def groups_over(draw, names, interruptions=True, plans=False, until=None):
    """Draw nested or disjoint groups over some of the tasks.

    With `plans`, rounds may be due at times; `until` draws the conditions that end the rounds.
    """
    ends = st.integers(0, len(names) - 1)
    ranges = draw(st.lists(st.tuples(ends, ends), max_size=5))
    groups = [
        Group(
            name=name,
            start=names[first],
            end=names[last],
            max_repeat_count=draw(st.integers(0, 3)),
            max_repeat_duration=draw(st.sampled_from([0, 0, 1, 2, 3, 5, 8, 13])),
            count_interruptions=interruptions and draw(st.booleans()),
            stop=draw(st.sampled_from(Stop)),
            every=draw(st.sampled_from([0, 0, 2, 4, 7])) if plans else 0,
            until=() if until is None else tuple(draw(st.lists(until, max_size=2))),
        )
        for name, first, last in nested(ranges, lambda i, *_: str(i))
    ]
    return tuple(draw(st.permutations(groups)))
