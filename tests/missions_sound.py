"""Missions without errors of `check`, with every field of the language.

Plain values (the ones a person would write) are as likely as odd ones, for what is left unsaid in a
script has to be tried as often as what is said.
"""

from hypothesis import strategies as st

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Mode,
    OnFailure,
    Order,
    Reaction,
    Response,
    Stop,
    Task,
    Transition,
)
from argo_compiler.il.reserved import RESERVED_NAMES
from tests.mission_parts import nested

# Signs that text recognition, JSON, the script language or a terminal could trip over.
ODD = "\"'\\*`\t\n\r\0\x1b#:;.,/()[]-+ äßİﬁ’“–\u00ad\u200b\u2028\ufeff²٣😀and"
texts = st.one_of(
    st.sampled_from(
        ["", "Mission #1", "As per the rules", "and", "10. then", "- a", "a  b", " a "]
    ),
    st.text(st.sampled_from(ODD) | st.characters(exclude_categories=["Cs"]), max_size=12),
    st.text('ab "*', min_size=60, max_size=200),
)
floats = st.one_of(
    st.integers(-5, 20).map(float),
    st.floats(-1e3, 1e3).map(lambda x: round(x, 2)),
    st.floats(-1e300, 1e300, allow_nan=False),
)
lengths = st.one_of(
    st.sampled_from([1.0, 60.0, 90.5, 600.0, 3600.0]), st.floats(1e-3, 1e12, allow_nan=False)
)
yaws = st.one_of(st.sampled_from([0.0, 1.5707963267948966, -3.141592653589793]), floats)


def poses(catalog: Catalog) -> st.SearchStrategy[Pose]:
    """Draw a pose of the site, or any other."""
    named = [*(p.pose for p in catalog.places), *(a.dock for a in catalog.areas)]
    return st.sampled_from(named) | st.builds(Pose, x=floats, y=floats, z=floats, yaw=yaws)


@st.composite
def conditions(draw: st.DrawFn, catalog: Catalog) -> Condition:
    kind = draw(st.sampled_from([t for t in ConditionType if t.compares]))
    inclusive = draw(st.booleans())
    low = draw(floats)
    high = draw(st.none() | floats)
    if kind is ConditionType.WITHIN:
        high = low + draw(st.sampled_from([1.0, 0.5])) * (abs(low) + 1)
    return Condition(
        type=kind,
        id=draw(st.just("") | texts),
        object_id=str(draw(st.sampled_from(catalog.checkpoints)).id),
        param1=low,
        param2=high,
        inclusive=inclusive,
        max_age=draw(st.none() | lengths),
    )


@st.composite
def sound_missions(draw: st.DrawFn, catalog: Catalog, most: int = 7) -> Mission:
    """Draw a mission of up to `most` tasks and START, on the catalogue's site."""
    drafts = draw(st.lists(_drafts(catalog), min_size=1, max_size=most))
    if draw(st.booleans()):
        floor = draw(st.sampled_from(catalog.floors))
        at = draw(st.integers(0, len(drafts)))
        drafts[at:at] = [Task(name="?", action=Action.WAYPOINT, pose=pose) for pose in floor.patrol]
    names = _names(draw, drafts)
    groups = draw(_groups(names, drafts, catalog))
    tasks = [
        draft.model_copy(
            update={
                "name": name,
                "transitions": draw(_ways(names, i, catalog)),
                "group": draw(st.sampled_from([_inner(names, i, groups)] * 5 + ["", "shown"])),
            }
        )
        for i, (name, draft) in enumerate(zip(names, drafts, strict=True))
    ]
    if draw(st.booleans()):
        start = draw(_starts(catalog, [t.name for t in tasks]))
        places = [0] * 4 + [i for i in range(len(tasks)) if not _covered(names, i, groups)]
        tasks.insert(draw(st.sampled_from(places)), start)
    dock = draw(poses(catalog))
    areas = st.none() | st.sampled_from([a.number for a in catalog.areas])
    events = draw(st.lists(st.sampled_from(EventKind), unique=True, max_size=3))
    return Mission(
        designation=draw(texts),
        site=catalog.site,
        mode=draw(st.sampled_from(Mode)),
        max_duration=draw(st.none() | lengths),
        start_area=draw(areas),
        end_area=draw(areas),
        dock=dock,
        order=draw(st.sampled_from(Order)),
        anomaly_specification=draw(texts),
        real_time_reporting=draw(texts),
        after_mission_report=draw(texts),
        tasks=tuple(tasks),
        groups=tuple(draw(st.permutations(groups))),
        reactions=tuple(draw(_reactions(event, catalog)) for event in events),
        current=draw(st.none() | st.sampled_from([t.name for t in tasks]) | texts),
        left_out=tuple(draw(st.lists(texts, max_size=3))),
    )


@st.composite
def _drafts(draw: st.DrawFn, catalog: Catalog) -> Task:
    """Draw a task without its name and transitions."""
    measures = draw(st.booleans())
    plain = draw(st.booleans())
    checkpoint = draw(st.sampled_from(catalog.checkpoints))
    task = Task(
        name="?",
        action=Action.MEASURE if measures else Action.WAYPOINT,
        object_id=str(checkpoint.id) if measures else None,
        pose=None if measures else draw(poses(catalog)),
    )
    if plain:
        return task
    joints = draw(st.lists(texts, unique=True, max_size=3))
    return task.model_copy(
        update={
            "object_id": task.object_id if measures else draw(st.none() | texts),
            "pose": draw(st.none() | poses(catalog)) if measures else task.pose,
            "velocity": draw(st.none() | lengths),
            "joint_states": draw(
                st.none()
                | st.just(
                    JointState(names=tuple(joints), positions=tuple(map(float, range(len(joints)))))
                )
            ),
            "retries": draw(st.sampled_from([0, 0, 1, 2, 7])),
            "on_failure": draw(
                st.sampled_from([p for p in OnFailure if p is not OnFailure.BRANCH])
            ),
        }
    )


def _names(draw: st.DrawFn, drafts: list[Task]) -> list[str]:
    """Draw distinct names, as scripts make them or any others."""
    own = texts.filter(lambda name: name and name not in RESERVED_NAMES)
    names: list[str] = []
    for draft in drafts:
        base = f"MEASURE {draft.object_id}" if draft.action is Action.MEASURE else "WAYPOINT"
        usual = [
            name
            for k in range(1, len(drafts) + 2)
            if (name := f"WAYPOINT {k}" if base == "WAYPOINT" else base + f" ({k})" * (k > 1))
            not in names
        ]
        likely = st.sampled_from(usual[:1] * 5 + usual[1:2] + ["DOCK", "START 2", "4"])
        names.append(
            draw((likely | own).filter(lambda name: name not in names and name != "START"))
        )
    return names


@st.composite
def _ways(draw: st.DrawFn, names: list[str], i: int, catalog: Catalog) -> tuple[Transition, ...]:
    following = names[i + 1] if i + 1 < len(names) else None
    usual = () if following is None else (Transition(target=following),)
    if draw(st.booleans()):
        return usual
    held = st.lists(conditions(catalog), min_size=1, max_size=3).map(tuple)
    ways = draw(
        st.lists(st.builds(Transition, target=st.sampled_from(names), conditions=held), max_size=2)
    )
    onward = draw(st.sampled_from([following, following, None, *names]))
    if onward is not None:
        ways.insert(draw(st.integers(0, len(ways))), Transition(target=onward))
    return tuple(ways)


@st.composite
def _starts(draw: st.DrawFn, catalog: Catalog, names: list[str]) -> Task:
    target = draw(st.sampled_from([names[0]] * 3 + names))
    plain = draw(st.booleans())
    return Task(
        name="START"
        if plain
        else draw(st.sampled_from(["START", "Start", "here"]).filter(lambda n: n not in names)),
        action=Action.START,
        pose=draw(st.none() | poses(catalog)) if not plain else draw(poses(catalog)),
        object_id=None if plain else draw(st.none() | texts),
        velocity=None if plain else draw(st.none() | lengths),
        transitions=(Transition(target=target),) if plain or draw(st.booleans()) else (),
    )


@st.composite
def _groups(draw: st.DrawFn, names: list[str], drafts: list[Task], catalog: Catalog) -> list[Group]:
    """Draw groups over nested or disjoint ranges, named by their nesting."""
    ends = st.integers(0, len(names) - 1)
    patrols = {floor.patrol: floor.number for floor in catalog.floors}
    length = len(catalog.floors[0].patrol)
    found = {
        i: patrols[poses]
        for i in range(len(drafts) - length + 1)
        if (poses := tuple(d.pose for d in drafts[i : i + length])) in patrols
    }

    def own(i: int, first: int, last: int) -> str:
        is_patrol = first in found and last == first + length - 1
        usual = f"Patrol floor {found[first]}" if is_patrol else f"Repeat {first + 1} to {last + 1}"
        return draw(st.sampled_from([usual, usual, f"Alpha {i}", f'{i}*"\\']))

    ranges = draw(st.lists(st.tuples(ends, ends), max_size=4))
    return [
        Group(
            name=path,
            start=names[first],
            end=names[last],
            max_repeat_count=draw(st.integers(0, 4) | st.just(10**6 + 1)),
            max_repeat_duration=draw(st.just(0.0) | lengths),
            count_interruptions=draw(st.booleans()),
            stop=draw(st.sampled_from(Stop)),
        )
        for path, first, last in nested([*((i, i + length - 1) for i in found), *ranges], own)
    ]


def _inner(names: list[str], i: int, groups: list[Group]) -> str:
    """Return the name of the innermost group around the task."""
    return max(
        (g.name for g in groups if names.index(g.start) <= i <= names.index(g.end)),
        key=lambda name: name.count("/"),
        default="",
    )


def _covered(names: list[str], i: int, groups: list[Group]) -> bool:
    """Return True if the position before the task is inside a group."""
    return any(names.index(g.start) < i <= names.index(g.end) for g in groups)


@st.composite
def _reactions(draw: st.DrawFn, event: EventKind, catalog: Catalog) -> Reaction:
    response = draw(st.sampled_from(Response))
    where = poses(catalog)
    others = [kind for kind in EventKind if kind is not event]
    return Reaction(
        event=event,
        response=response,
        pose=draw(where if response is Response.SAFE_AREA else st.none() | where),
        until=draw(st.none() | st.sampled_from(others)),
        afterwards=draw(st.sampled_from(Afterwards)),
        priority=draw(st.sampled_from([0, 0, 1, -3, 10**9])),
    )
