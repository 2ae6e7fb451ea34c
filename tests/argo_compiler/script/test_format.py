"""A mission written as a script and read again is the same mission."""

from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from argo_compiler.catalog import Catalog
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.il import (
    Action,
    Afterwards,
    Condition,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    OnFailure,
    Reaction,
    Response,
    Task,
    TimeWindow,
    Transition,
    WaitRule,
)
from argo_compiler.model import Model, Pose
from argo_compiler.script import import_script
from argo_compiler.script.write import protocol, steps, tasks
from argo_compiler.script.write.protocol import format_script
from tests.argo_compiler.hfsm.random_missions import missions as tangled_missions
from tests.conftest import examples
from tests.missions_sound import sound_missions

HERE = Pose(x=1, y=2, z=0)


def bare(mission: Mission) -> Mission:
    """The mission without the places in its script."""
    parts = {
        name: tuple(part.model_copy(update={"source": None}) for part in getattr(mission, name))
        for name in ("tasks", "groups", "reactions")
    }
    return mission.model_copy(update=parts)


def read(text: str, catalog: Catalog) -> Mission:
    result = import_script(text, catalog)
    assert result.diagnostics == ()
    return bare(result.mission)


def assert_kept(mission: Mission, catalog: Catalog) -> str:
    text = format_script(mission, catalog)
    again = read(text, catalog)
    assert again == bare(mission)
    assert format_script(again, catalog) == text
    return text


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_any_mission_is_kept(data: st.DataObject, catalog: Catalog) -> None:
    mission = data.draw(sound_missions(catalog, most=5))
    assume(all(d.severity is not Severity.ERROR for d in check(mission, catalog)))
    assert_kept(mission, catalog)


SHORT = """\
Mission Protocol
Designation: Inspection of the lower floors
Maximum duration: 90 min
Anomaly specification: "anything \\u002aodd\\u002a"

1. Set the starting point at the front of the site.
2. Patrol floor 1 for 10 min.
3. Check checkpoint #2.
4. Check checkpoint #14; retry twice; if it fails abort the mission.
5. "gate": go to (1, 2, 0) heading 90 degrees; at 0.25 m/s.
6. Check checkpoint #14; if checkpoint #14 is above 2.5, go to step 3; otherwise end the mission.
7. Return to the docking station in starting area 1.

Repeat steps 3 to 4 3 times.
"Alpha": repeat step "gate" for 754.5 s or twice, finishing the round.

On gas leak: return to the docking station.
On platform alarm: go to the front of the site, until all clear, afterwards resume, priority 2.
"""


def test_canonical_form(catalog: Catalog) -> None:
    assert format_script(read(SHORT, catalog), catalog) == SHORT


def test_names_of_ones_own_beside_the_usual_ones(catalog: Catalog) -> None:
    names = ["WAYPOINT 2", "WAYPOINT 1", "WAYPOINT 3", "DOCK"]
    tasks = tuple(
        Task(
            name=name,
            action=Action.WAYPOINT,
            pose=HERE,
            transitions=(Transition(target=following),) if following else (),
        )
        for name, following in zip(names, [*names[1:], None], strict=True)
    )
    text = assert_kept(Mission(site=catalog.site, tasks=tasks), catalog)
    assert '1. "WAYPOINT 2": go to (1, 2, 0).\n2. Go to (1, 2, 0).' in text


def test_scripts_are_kept(missions: Path, catalog: Catalog) -> None:
    for path in sorted(missions.glob("*.txt")):
        areas = {"start_area": 1, "end_area": 2} if path.name.startswith("mission") else {}
        assert_kept(import_script(path.read_text(), catalog, **areas).mission, catalog)


def test_originals_are_kept(originals: Path, catalog: Catalog) -> None:
    sheet = (originals / "mission_1.txt").read_text()
    protocol = (originals / "protocol_2.txt").read_text()
    assert_kept(import_script(sheet, catalog, start_area=1, end_area=2).mission, catalog)
    assert_kept(import_script(protocol, catalog).mission, catalog)


def test_long_texts_and_many_ways_are_broken_into_lines(catalog: Catalog) -> None:
    name = "long " * 100
    held = tuple(Condition(type=ConditionType.GREATER, object_id="1", param1=k) for k in range(120))
    ways = tuple(Transition(target=name, conditions=(c,)) for c in held)
    task = Task(
        name=name,
        action=Action.MEASURE,
        object_id="1",
        transitions=(*ways, Transition(target=name, conditions=held)),
    )
    mission = Mission(site=catalog.site, designation="x*" * 3_000, tasks=(task,))
    text = assert_kept(mission, catalog)
    assert max(map(len, text.splitlines())) <= 110


@pytest.mark.parametrize(
    ("task", "reason"),
    [
        (Task(name="a", action=Action.WAYPOINT), "without a pose"),
        (Task(name="a", action=Action.MEASURE), "measures nothing"),
        (Task(name="a", action=Action.MEASURE, object_id="x"), "`x`"),
    ],
)
def test_what_no_script_says_is_refused(task: Task, reason: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match=f"(?s)task 'a'.*{reason}") as caught:
        format_script(Mission(site=catalog.site, tasks=(task,)), catalog)
    assert [d.subject for d in caught.value.diagnostics] == ["tasks['a']"]


# ---- what no script can say yet


FAILED = Condition(type=ConditionType.FAILED, object_id="1")
UNSAID = {
    "tasks": {
        "wait": WaitRule(duration=5),
        "on_failure": OnFailure.BRANCH,
        "failure_target": "a",
        "time_limit": 60.0,
        "reading_limit": 5.0,
        "optional": True,
        "priority": 2,
        "window": TimeWindow(latest=60),
        "joint_states": JointState(names=("arm",), efforts=(1.0,)),
        "transitions": (Transition(target="a", conditions=(FAILED,)),),
    },
    "groups": {"every": 60.0, "until": (FAILED,)},
    "reactions": {"hold_limit": 60.0, "on_limit": Afterwards.END, "area": 1},
}


def whole() -> Mission:
    """A mission with a task, a group and a reaction that a script can say."""
    return Mission(
        site="umad",
        dock=HERE,
        tasks=(Task(name="a", action=Action.MEASURE, object_id="1"),),
        groups=(Group(name="G", start="a", end="a", max_repeat_count=2),),
        reactions=(Reaction(event=EventKind.GAS_LEAK, response=Response.RETURN),),
    )


@pytest.mark.parametrize(
    ("part", "field"), [(part, field) for part, fields in UNSAID.items() for field in fields]
)
def test_a_field_that_no_script_says_is_refused_by_name(
    part: str, field: str, catalog: Catalog
) -> None:
    (one,) = getattr(whole(), part)
    changed = one.model_copy(update={field: UNSAID[part][field]})
    with pytest.raises(DiagnosticError) as caught:
        format_script(whole().model_copy(update={part: (changed,)}), catalog)
    (found,) = caught.value.diagnostics
    assert found.code == "script.unwritable"
    assert found.subject is not None
    assert found.subject.startswith(f"{part}[")
    named = "READING_FAILED" if field == "transitions" else f"`{field}"
    assert named in found.message


def test_each_field_is_said_or_refused() -> None:
    """What is added to the language is refused until a script can say it."""
    known: list[tuple[type[Model], frozenset[str], str]] = [
        (Task, tasks.SAID, "tasks"),
        (Group, steps.SAID, "groups"),
        (Reaction, protocol.SAID, "reactions"),
    ]
    for model, said, part in known:
        assert said <= set(model.model_fields)
        assert set(model.model_fields) <= said | set(UNSAID[part])


@st.composite
def missions_of_the_site(draw: st.DrawFn, catalog: Catalog) -> Mission:
    """Missions of all that the language has; most have something that no script says."""
    if draw(st.booleans()):
        return draw(tangled_missions()).model_copy(update={"site": catalog.site})
    mission = draw(sound_missions(catalog, most=4))
    for part, fields in UNSAID.items():
        models = list(getattr(mission, part))
        if models and draw(st.integers(0, 3)) == 0:
            at = draw(st.integers(0, len(models) - 1))
            field = draw(st.sampled_from(sorted(fields)))
            models[at] = models[at].model_copy(update={field: fields[field]})
            mission = mission.model_copy(update={part: tuple(models)})
    return mission


def test_all_of_a_mission_is_kept_or_refused(catalog: Catalog) -> None:
    kept = refused = 0

    @settings(max_examples=examples(120), deadline=None)
    @given(missions_of_the_site(catalog))
    def write(mission: Mission) -> None:
        nonlocal kept, refused
        assume(all(d.severity is not Severity.ERROR for d in check(mission)))
        try:
            text = format_script(mission, catalog)
        except DiagnosticError as error:
            found = error.diagnostics
        else:
            kept += 1
            assert read(text, catalog) == bare(mission)
            return
        refused += 1
        assert {d.code for d in found} == {"script.unwritable"}
        assert all(d.subject for d in found)

    write()
    assert min(kept, refused) > 10


def test_places_where_ways_meet_are_kept(catalog: Catalog) -> None:
    text = (
        "Mission Protocol\n\n"
        "1. Set the starting point in starting area 1.\n"
        "2. Check checkpoint #1; if checkpoint #1 is above 5, go to step 4.\n"
        "3. Check checkpoint #2; at 0.3 m/s.\n"
        "4. Check checkpoint #3; then go to step \"end of 'G'\".\n"
        "5. \"end of 'G'\": go on here.\n\n"
        '"G": repeat steps 2 to "end of \'G\'" 3 times.\n'
    )
    text = text.replace("; then go to step \"end of 'G'\"", "")
    assert format_script(read(text, catalog), catalog) == text
