"""A mission written as a script and read again is the same mission."""

from pathlib import Path

import pytest
from hypothesis import assume, given, settings

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.model import Pose
from argo_compiler.checks import check
from argo_compiler.diagnostics import DiagnosticError, has_errors
from argo_compiler.files.mission_file import read_mission
from argo_compiler.il import (
    Action,
    Afterwards,
    ConditionType,
    EventKind,
    Group,
    JointState,
    Mission,
    Reaction,
    Response,
    Task,
    TimeWindow,
    WaitRule,
)
from argo_compiler.script import format_script
from argo_compiler.script.write.reading import read_back
from tests.argo_compiler.hfsm.random_missions import missions as tangled_missions
from tests.conftest import examples
from tests.mission_writing import above, drive, measure, unplaced, way
from tests.missions_sound import sound_missions
from tests.whole_scripts import import_whole
from tests.yard import in_order

HERE = Pose(x=1, y=2, z=0)


def read(text: str, catalog: Catalog) -> Mission:
    return unplaced(import_whole(text, catalog).mission)


def assert_kept(mission: Mission, catalog: Catalog) -> str:
    text = format_script(mission, catalog)
    again = read(text, catalog)
    assert again == unplaced(mission)
    assert format_script(again, catalog) == text
    return text


SHORT = """\
Mission Protocol
Designation: Inspection of the lower floors
Maximum duration: 90 minutes
Anomaly specification: "anything \\u002aodd\\u002a"

1. Set the starting point at the front of the site.
2. Patrol floor 1 for 10 minutes.
3. Check checkpoint #2.
4. Check checkpoint #14, retry twice. If it fails, abort the mission.
5. Repeat steps 3 to 4 3 times.
6. "gate": go to (1, 2, 0) heading 90 degrees, at 0.25 m/s.
7. "Alpha": repeat step 6 for 754.5 s or twice, finishing the round.
8. Check checkpoint #14. If checkpoint #14 is above 2.5, go to step 3. Otherwise end the mission.
9. Return to the docking station in starting area 1.

If a gas leak is detected, return to the docking station.
If the platform alarm sounds, go to the front of the site, wait until all clear is given,
   with priority 2, and resume.
"""
ALL = """\
Mission Protocol #7
Mode: supervisory
Order: any
Start area: 2, as planned
End area: 1, as planned
Dock: (1, 2, 0) heading 1.25 rad
Current: "gate"
Left out: "MEASURE 8"

1. Start here at (1, 2, 0).
2. "gate": go to (1.5, 2, 0), about object "door", at 0.125 m/s, taking at most 1 minute,
   not before 10 s and not later than 12.3450 s after the start, if there is time, with priority 3,
   retry once.
   If it fails, go to step 4.
   If it is too late, go to step 6.
3. Check checkpoint #1, standing at (1, 2, 0), with joints ["a", "b"] at [0.5, -1] velocities [1,
   2] efforts [3, 4], shown in "elsewhere", reading for at most 5 s,
   preferably not later than 10 minutes after the start.
   If checkpoint #1 is from 2 to 3 and checkpoint #4 measured within the last 30 s is at least 5,
      go to step 2.
   In all other cases go to step 6.
   If checkpoint #4 is unreadable, go to step 6.
   If it fails, return to the docking station.
4. Check checkpoint #4.
   If checkpoint #4 has failed, go to step 2.
   After the last round, go to step 7.
5. "night": repeat steps 3 to 4 every 10 minutes, for 1 minute or 3 times or
   until checkpoint #4 is abnormal and checkpoint #1 is older than 1 minute, finishing the round,
   interruptions included.
6. Wait 90.5 s.
7. Wait until all clear is given or checkpoint #1 (called "low") is below 2, for at most 2 minutes,
   at any time.
   Then end the mission.
8. Go on here.

If a hot spot is detected, pause for at most 10 minutes or else end the mission.
If the battery is low, return to the docking station in starting area 1,
   wait until the battery is charged for at most 1 minute or else resume, with priority -3,
   and wait for the operator.
"""


def test_canonical_form(catalog: Catalog) -> None:
    assert format_script(read(SHORT, catalog), catalog) == SHORT


def test_all_that_a_mission_has_is_said(catalog: Catalog) -> None:
    mission = read(ALL, catalog)
    assert assert_kept(mission, catalog) == ALL
    gate, first, second = (mission.task(name) for name in ("gate", "MEASURE 1", "MEASURE 4"))
    assert gate is not None
    assert first is not None
    assert second is not None
    assert gate.window == TimeWindow(earliest=10, latest=12.345, missed_target="WAIT")
    assert (gate.failure_target, gate.time_limit, gate.optional) == ("MEASURE 4", 60, True)
    assert first.joint_states == JointState(
        names=("a", "b"), positions=(0.5, -1), velocities=(1, 2), efforts=(3, 4)
    )
    assert [(len(t.conditions), t.target) for t in first.transitions] == [
        (2, "gate"),
        (0, "WAIT"),
        (1, "WAIT"),
    ]
    assert [t.target for t in second.transitions] == ["gate", "WAIT (2)"]
    (night,) = mission.groups
    assert (night.start, night.end, night.every) == ("MEASURE 1", "MEASURE 4", 600)
    assert [c.type for c in night.until] == [ConditionType.ABNORMAL, ConditionType.STALE]
    assert [r.on_limit for r in mission.reactions] == [Afterwards.END, Afterwards.RESUME]


def test_names_of_ones_own_beside_the_usual_ones(catalog: Catalog) -> None:
    names = ["WAYPOINT 2", "WAYPOINT 1", "WAYPOINT 3", "DOCK"]
    tasks = in_order(*(drive(name, pose=HERE) for name in names))
    text = assert_kept(Mission(site=catalog.site, tasks=tasks), catalog)
    assert '1. "WAYPOINT 2": go to (1, 2, 0).\n2. Go to (1, 2, 0).' in text


def test_scripts_are_kept(missions: Path, catalog: Catalog) -> None:
    for path in sorted(missions.glob("*.txt")):
        areas = {"start_area": 1, "end_area": 2} if path.name.startswith("mission") else {}
        assert_kept(import_whole(path.read_text(), catalog, **areas).mission, catalog)


def test_originals_are_kept(originals: Path, catalog: Catalog) -> None:
    sheet = (originals / "mission_1.txt").read_text()
    protocol = (originals / "protocol_2.txt").read_text()
    assert_kept(import_whole(sheet, catalog, start_area=1, end_area=2).mission, catalog)
    assert_kept(import_whole(protocol, catalog).mission, catalog)


def test_long_texts_and_many_ways_are_broken_into_lines(catalog: Catalog) -> None:
    name = "long " * 100
    held = [above("1", k) for k in range(120)]
    ways = (way(name, condition) for condition in held)
    task = measure(name, *ways, way(name, *held), object_id="1")
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


# ---- every mission


def refused(mission: Mission, catalog: Catalog) -> str:
    with pytest.raises(DiagnosticError) as caught:
        format_script(mission, catalog)
    (found,) = caught.value.diagnostics
    assert found.code == "script.unwritable"
    assert found.subject is not None
    return found.message


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        (Task(name="a", action=Action.WAIT, wait=WaitRule(duration=1, limit=2)), "`limit`"),
        (measure("a", object_id="1", failure_target="a"), "failure_target"),
        (Task(name="a", action=Action.WAYPOINT, pose=HERE, wait=WaitRule(duration=1)), "`wait`"),
    ],
)
def test_what_has_no_effect_is_refused_by_name(changed: Task, named: str, catalog: Catalog) -> None:
    assert named in refused(Mission(site=catalog.site, tasks=(changed,)), catalog)


def test_what_a_reaction_has_no_use_for_is_refused_by_name(catalog: Catalog) -> None:
    reaction = Reaction(event=EventKind.GAS_LEAK, response=Response.REPORT, pose=HERE)
    task = Task(name="a", action=Action.MEASURE, object_id="1")
    mission = Mission(site=catalog.site, tasks=(task,), reactions=(reaction,))
    assert "`pose`" in refused(mission, catalog)


@pytest.mark.parametrize("tangled", [pytest.param(True, marks=pytest.mark.long), False])
def test_any_mission_is_kept_or_refused_by_name(tangled: bool, catalog: Catalog) -> None:
    kept = 0

    @settings(max_examples=examples(240))
    @given(tangled_missions() if tangled else sound_missions(catalog, most=5))
    def write(drawn: Mission) -> None:
        nonlocal kept
        mission = drawn.model_copy(update={"site": catalog.site})
        assume(not has_errors(check(mission, catalog)))
        try:
            format_script(mission, catalog)
        except DiagnosticError as error:
            found = error.diagnostics
        else:
            kept += 1
            assert_kept(mission, catalog)
            return
        assert {d.code for d in found} == {"script.unwritable"}
        assert all(d.subject for d in found)

    write()
    assert kept > 20


def test_a_round_that_lies_in_one_of_the_same_steps(catalog: Catalog) -> None:
    task = Task(name="MEASURE 1", action=Action.MEASURE, object_id="1", group="A/B")
    groups = tuple(
        Group(name=name, start="MEASURE 1", end="MEASURE 1", max_repeat_count=2)
        for name in ("A", "A/B")
    )
    assert_kept(Mission(site=catalog.site, tasks=(task,), groups=groups), catalog)


# ---- what is documented, shipped, and said back

DOCS = (Path(__file__).parents[3] / "docs" / "script.md").read_text(encoding="utf-8")
EXACT = DOCS[DOCS.index("## The exact forms") : DOCS.index("## Explaining a mission")]
BLOCKS = [block.split("```")[0] for block in EXACT.split("```protocol\n")[1:]]
SAMPLES = [line for block in BLOCKS for line in block.splitlines()]


@pytest.mark.parametrize("line", SAMPLES)
def test_every_exact_form_of_the_reference_is_kept(line: str, catalog: Catalog) -> None:
    steps = "Start area: none\n\n1. Check checkpoint #1.\n2. Check checkpoint #4.\n3. "
    text = f"{steps}Check checkpoint #8.\n\n{line}." if _is_apart(line) else f"{steps}{line}."
    mission = import_whole(text.replace("..", "."), catalog).mission
    assert_kept(mission.model_copy(update={"dock": HERE}), catalog)


def _is_apart(line: str) -> bool:
    return line.startswith(("If ", "Always ", '"Alpha"'))


def test_shipped_missions_are_kept(catalog: Catalog) -> None:
    folder = Path(__file__).parents[3] / "scenarios" / "umad" / "missions"
    found = sorted(folder.glob("*.json"))
    assert found
    for path in found:
        assert_kept(read_mission(path), catalog)


@pytest.mark.parametrize("tangled", [True, False])
def test_what_is_said_back_is_the_same_mission(tangled: bool, catalog: Catalog) -> None:
    @settings(max_examples=examples(30))
    @given(tangled_missions() if tangled else sound_missions(catalog, most=5))
    def read_again(drawn: Mission) -> None:
        mission = drawn.model_copy(update={"site": catalog.site})
        found = check(mission, catalog)
        assume(not has_errors(found))
        try:
            text = read_back(mission, catalog, found).text
        except DiagnosticError:
            return
        assert read(text, catalog) == unplaced(mission)

    read_again()


@pytest.mark.parametrize(
    ("script", "said"),
    [
        (
            "1. Check #1. If it is above 4, end the mission.\n2. Check #4.",
            "2. Check checkpoint #1. If checkpoint #1 is above 4, end the mission.\n"
            "3. Check checkpoint #4.\n",
        ),
        (
            "1. Check #1. If it is above 4, abort. Otherwise dock in area 2.\n2. Go home.",
            "2. Check checkpoint #1.\n"
            "   If checkpoint #1 is above 4, end the mission.\n"
            "   Otherwise return to the docking station in starting area 2.\n"
            "3. Return to the docking station in starting area 1.\n",
        ),
        (
            "1. Check #1. If it is above 4, go home.\n2. Check #4.\n3. Repeat steps 1 and 2 twice.",
            "2. Check checkpoint #1.\n"
            "   If checkpoint #1 is above 4, return to the docking station in starting area 1.\n"
            "3. Check checkpoint #4.\n",
        ),
    ],
)
def test_ends_in_one_case_are_said_in_words(script: str, said: str, catalog: Catalog) -> None:
    text = assert_kept(read(f"Start in starting area 1.\n{script}", catalog), catalog)
    assert said in text
    assert '"END"' not in text
    assert '"DOCK"' not in text


@pytest.mark.parametrize(
    ("name", "way", "velocity"),
    [("home", "home", None), ("DOCK (2)", "DOCK (2)", None), ("DOCK", "DOCK", 0.2)],
)
def test_an_end_that_no_words_make_is_a_step(
    name: str, way: str, velocity: float | None, catalog: Catalog
) -> None:
    mission = read("Start in starting area 1.\nCheck #1. If it is above 4, go home.", catalog)
    first, measure, dock = mission.tasks
    to_dock = measure.transitions[0].model_copy(update={"target": way})
    tasks = (
        first,
        measure.model_copy(update={"transitions": (to_dock,)}),
        dock.model_copy(update={"name": name, "velocity": velocity}),
    )
    text = assert_kept(mission.model_copy(update={"tasks": tasks}), catalog)
    assert f'"{name}": go to starting area 1' in text
