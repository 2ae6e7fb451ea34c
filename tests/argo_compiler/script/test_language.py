"""The script language form by form: what a line plans, and what is said about one that can't be."""

import re
from pathlib import Path

import pytest

from argo_compiler.base.catalog import Catalog, Place
from argo_compiler.base.model import Pose
from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.il import (
    ConditionType,
    EventKind,
    Mission,
    OnFailure,
    Order,
    Response,
)
from argo_compiler.script import parse
from tests.argo_compiler.script.conftest import findings
from tests.whole_scripts import import_whole

PLAN = """\
Mission Protocol #9
1. Set a starting point in starting area 1
2. Check checkpoint #1
3. Check checkpoint #4
4. Go to the front of the site
"""
EXAMPLES = re.findall(
    r"```(protocol|sheet)\n(.*?)```",
    (Path(__file__).parents[3] / "docs" / "script.md").read_text(encoding="utf-8"),
    re.DOTALL,
)


def planned(line: str, catalog: Catalog) -> Mission:
    result = import_whole(f"{PLAN}5. {line}\n", catalog)
    assert result.diagnostics == ()
    return result.mission


def codes(text: str, catalog: Catalog) -> list[str]:
    return [found.code.removeprefix("script.") for found in findings(text, catalog)]


@pytest.mark.parametrize(
    "line", [line for kind, block in EXAMPLES if kind == "protocol" for line in block.splitlines()]
)
def test_every_line_of_the_reference_is_understood(line: str, catalog: Catalog) -> None:
    script = parse(f"Mission Protocol\n{line}", [p.name for p in catalog.places])
    quiet = ("script.comment", "script.title")
    found = [d.code for d in script.diagnostics if d.code not in quiet]
    assert found == [] or line.startswith("Mission Protocol")


def test_the_sheet_of_the_reference(catalog: Catalog) -> None:
    (sheet,) = (block for kind, block in EXAMPLES if kind == "sheet")
    mission = import_whole(sheet, catalog, start_area=1, end_area=2).mission
    assert [t.object_id for t in mission.tasks] == [None, "1", "4", "8", "6", "6", "14", None]


# ---- numbers


@pytest.mark.parametrize(
    ("said", "number"),
    [
        ("fourteen", 14),
        ("#14", 14),
        ("no. 14", 14),
        ("number 14", 14),
        ("twenty", 20),
    ],
)
def test_numbers_of_checkpoints(said: str, number: int, catalog: Catalog) -> None:
    assert planned(f"Check checkpoint {said}", catalog).tasks[-1].object_id == str(number)


@pytest.mark.parametrize(
    ("said", "count"),
    [
        ("twenty-five times", 25),
        ("one hundred and five times", 105),
        ("a hundred times", 100),
        ("two thousand three hundred and forty-two times", 2342),
        ("ninety-nine hundred times", 9900),
        ("nine thousand nine hundred and ninety-nine rounds", 9999),
        ("once in total", 1),
        ("twice", 2),
        ("three more times", 4),
        ("twice more", 3),
        ("again", 2),
        ("1000001 times", 1000001),
    ],
)
def test_counts(said: str, count: int, catalog: Catalog) -> None:
    (group,) = planned(f"Repeat steps 2 to 4 {said}", catalog).groups
    assert group.max_repeat_count == count


# ---- what follows a task


@pytest.mark.parametrize(
    ("said", "type_", "low", "high", "inclusive"),
    [
        ("greater than 5", ConditionType.GREATER, 5, None, False),
        ("more than 5 bar", ConditionType.GREATER, 5, None, False),
        ("above 2.5", ConditionType.GREATER, 2.5, None, False),
        ("less than minus 3", ConditionType.LESS, -3, None, False),
        ("below -3", ConditionType.LESS, -3, None, False),
        ("at least 5", ConditionType.GREATER, 5, None, True),
        ("no less than 5", ConditionType.GREATER, 5, None, True),
        ("greater than or equal to 5", ConditionType.GREATER, 5, None, True),
        ("at most 5", ConditionType.LESS, 5, None, True),
        ("between 2 and 3", ConditionType.WITHIN, 2, 3, False),
        ("from 2 to 3 bar", ConditionType.WITHIN, 2, 3, True),
        ("normal", ConditionType.WITHIN, 3, 7, True),
    ],
)
def test_comparisons(
    said: str,
    type_: ConditionType,
    low: float,
    high: float | None,
    inclusive: bool,
    catalog: Catalog,
) -> None:
    line = f"If the value of checkpoint #1 is {said}, skip to step 2"
    condition = planned(line, catalog).tasks[3].transitions[0].conditions[0]
    assert (condition.type, condition.object_id) == (type_, "1")
    assert (condition.param1, condition.param2, condition.inclusive) == (low, high, inclusive)


@pytest.mark.parametrize(
    ("said", "ways"),
    [
        ("if it is above 5, go to step 2", {"MEASURE 8": [("MEASURE 1", 1), ("WAYPOINT 1", 0)]}),
        (
            "if it is above 5, go to step 2; otherwise end the mission",
            {"MEASURE 8": [("MEASURE 1", 1)]},
        ),
        (
            "if it is above 5 or it is below 1, go to step 2",
            {"MEASURE 8": [("MEASURE 1", 1), ("MEASURE 1", 1), ("WAYPOINT 1", 0)]},
        ),
        (
            "if it is above 5 and checkpoint #4 is below 1, go to step 2",
            {"MEASURE 8": [("MEASURE 1", 2), ("WAYPOINT 1", 0)]},
        ),
        (
            "in all other cases, go on; if it is above 5, go to step 2",
            {"MEASURE 8": [("WAYPOINT 1", 0), ("MEASURE 1", 1)]},
        ),
        ("then go to step 2", {"MEASURE 8": [("MEASURE 1", 0)]}),
        ("then end the mission", {"MEASURE 8": []}),
        (
            "if it is above 5, return to the docking station",
            {"MEASURE 8": [("DOCK", 1), ("WAYPOINT 1", 0)], "WAYPOINT 1": [], "DOCK": []},
        ),
        (
            "if it is above 5, check checkpoint #2 and check checkpoint #3",
            {
                "MEASURE 8": [("MEASURE 2", 1), ("WAYPOINT 1", 0)],
                "MEASURE 2": [("MEASURE 3", 0)],
                "MEASURE 3": [("WAYPOINT 1", 0)],
            },
        ),
        (
            "if it is above 5, check checkpoint #2; otherwise check checkpoint #3",
            {
                "MEASURE 8": [("MEASURE 2", 1), ("MEASURE 3", 0)],
                "MEASURE 2": [("WAYPOINT 1", 0)],
                "MEASURE 3": [("WAYPOINT 1", 0)],
            },
        ),
    ],
)
def test_ways_to_go_on(said: str, ways: dict[str, list[tuple[str, int]]], catalog: Catalog) -> None:
    text = (
        "Mission Protocol\n1. Set a starting point in starting area 1\n2. Check checkpoint #1\n"
        f"3. Check checkpoint #8; {said}.\n4. Go to the front of the site\n"
    )
    mission = import_whole(text, catalog).mission
    for name, expected in ways.items():
        task = mission.task(name)
        assert task is not None
        assert [(t.target, len(t.conditions)) for t in task.transitions] == expected


@pytest.mark.parametrize(
    ("said", "retries", "policy"),
    [
        ("retry twice", 2, OnFailure.CONTINUE),
        ("retry 3 times; if it still fails, return to the docking station", 3, OnFailure.RETURN),
        ("retry once, then abort", 1, OnFailure.ABORT),
        ("retry once. If it fails, return", 1, OnFailure.RETURN),
        ("if it fails, abort the mission", 0, OnFailure.ABORT),
        ("if it fails, retry twice, then continue", 2, OnFailure.CONTINUE),
        ("try again twice; if it still fails, return to the docking station", 2, OnFailure.RETURN),
    ],
)
def test_failures(said: str, retries: int, policy: OnFailure, catalog: Catalog) -> None:
    task = planned(f"Check checkpoint #8, {said}", catalog).tasks[-1]
    assert (task.name, task.retries, task.on_failure) == ("MEASURE 8", retries, policy)
    assert task.transitions == ()


def test_a_branch_after_a_failure(catalog: Catalog) -> None:
    lines = "Check #8; if it fails, check #3 and return to the docking station in starting area 2"
    tasks = {task.name: task for task in planned(lines, catalog).tasks}
    assert tasks["MEASURE 8"].on_failure is OnFailure.BRANCH
    assert tasks["MEASURE 8"].failure_target == "MEASURE 3"
    assert [way.target for way in tasks["MEASURE 3"].transitions] == ["DOCK"]
    assert tasks["DOCK"].pose == catalog.area(2).dock


@pytest.mark.parametrize("line", ["Check #8 twice", "Twice: check #8", "Check #8 for two rounds"])
def test_a_measurement_in_rounds(line: str, catalog: Catalog) -> None:
    mission = planned(line, catalog)
    (group,) = mission.groups
    assert (group.start, group.end, group.max_repeat_count) == ("MEASURE 8", "MEASURE 8", 2)


# ---- places, speeds, rounds


@pytest.mark.parametrize(
    ("said", "pose"),
    [
        ("(12.5, 3, 2.5) heading 180 degrees", Pose(x=12.5, y=3, z=2.5, yaw=3.141592653589793)),
        ("(12.5, 3, 2.5) heading -0.5 rad", Pose(x=12.5, y=3, z=2.5, yaw=-0.5)),
        ("x 12.5 y 3 floor 2", Pose(x=12.5, y=3, z=2.5)),
        ("(-1, minus 2) on the top floor", Pose(x=-1, y=-2, z=12.5)),
        ("x 1, y 2, z 3", Pose(x=1, y=2, z=3)),
        ("the front of the UMAD site", Pose(x=-1, y=4, z=0)),
        ('"front of" " the site"', Pose(x=-1, y=4, z=0)),
        ("starting area 2", Pose(x=-4, y=6, z=0, yaw=1.5)),
    ],
)
def test_places(said: str, pose: Pose, catalog: Catalog) -> None:
    assert planned(f"Go to {said}", catalog).tasks[-1].pose == pose


@pytest.mark.rule("T6")
@pytest.mark.parametrize(
    ("line", "speeds"),
    [
        ("Check checkpoints #2 and #3 at 0.3 m/s", [0.3, 0.3]),
        ("Check #2 at 0.3 m/s, leaving at 3.6 km/h.\n6. Check #3", [0.3, 1.0]),
        ("Check #2.\n6. Check #3 at 0.5 m/s.\n7. Move #3 before #2", [0.5, None]),
        ("Patrol floor 1 twice at 0.3 m/s.\n6. Check #2", [0.3] * 4 + [None]),
        (
            "Check #2, leaving at 0.2 m/s; if it is above 3, check #3; otherwise check #5",
            [None, 0.2, 0.2],
        ),
        (
            "Check #2, leaving at 0.2 m/s.\n6. Repeat step 5 once in total; if #2 is above 3, "
            "check #3.\n"
            "7. Check #5",
            [None, None, 0.2, 0.2],
        ),
    ],
)
def test_a_speed_belongs_to_the_way_to_a_task(
    line: str, speeds: list[float | None], catalog: Catalog
) -> None:
    mission = import_whole(f"{PLAN}5. {line}\n", catalog).mission
    assert [t.velocity for t in mission.tasks][:4] == [None] * 4
    assert [t.velocity for t in mission.tasks][4:] == speeds


def test_a_speed_at_which_nothing_is_left_is_said(catalog: Catalog) -> None:
    assert codes(f"{PLAN}5. Check #2, leaving at 0.1 m/s\n", catalog) == ["speed-unused"]


@pytest.mark.parametrize(
    ("line", "group"),
    [
        ("Repeat steps 2 to 4 twice", ("Repeat 2 to 4", "MEASURE 1", "WAYPOINT 1", 2, 0, "hard")),
        ("Repeat step 3 for 5 min", ("Repeat 3", "MEASURE 4", "MEASURE 4", 0, 300, "hard")),
        (
            '"Alpha": repeat steps 2-3 for 15 minutes or three times, finishing the round',
            ("Alpha", "MEASURE 1", "MEASURE 4", 3, 900, "soft"),
        ),
        ("Repeat all steps again", ("Repeat", "MEASURE 1", "WAYPOINT 1", 2, 0, "hard")),
        (
            'Repeat step "MEASURE 4" endlessly',
            ("Repeat MEASURE 4", "MEASURE 4", "MEASURE 4", 0, 0, "hard"),
        ),
    ],
)
def test_repetitions(line: str, group: tuple[object, ...], catalog: Catalog) -> None:
    result = import_whole(f"{PLAN}5. {line}\n", catalog)
    assert {d.code for d in result.diagnostics} <= {"script.repeated-there"}
    (g,) = result.mission.groups
    assert group == (g.name, g.start, g.end, g.max_repeat_count, g.max_repeat_duration, g.stop)


def test_rounds_lie_in_rounds(catalog: Catalog) -> None:
    text = (
        PLAN + "5. Patrol floor 2 twice\n6. Repeat steps 4 to 5 twice\n7. Repeat steps 2 to 5 twice"
    )
    mission = import_whole(text, catalog).mission
    outer = "Repeat 2 to 5"
    assert [g.name for g in mission.groups] == [
        f"{outer}/Repeat 4 to 5/Patrol floor 2",
        f"{outer}/Repeat 4 to 5",
        outer,
    ]
    assert mission.tasks[1].group == outer
    assert mission.tasks[-1].group == f"{outer}/Repeat 4 to 5/Patrol floor 2"


# ---- reactions


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("If a gas leak is detected, report it", ("gas_leak", "report", None, "end")),
        (
            "If a gas leak is detected, report it and return to the docking station",
            ("gas_leak", "return", None, "end"),
        ),
        (
            "When the battery is low, go to the docking station, recharge and resume",
            ("low_battery", "return", "battery_charged", "resume"),
        ),
        ("In case of an emergency stop, stop and wait", ("emergency_stop", "pause", None, "end")),
        (
            "On connection loss pause until the connection is restored",
            ("connection_lost", "pause", "connection_restored", "end"),
        ),
        (
            "If the GPA sounds, go to the front of the site and wait for the operator",
            ("platform_alarm", "safe_area", None, "wait"),
        ),
        ("In case of a malfunction, abort the mission", ("dysfunction", "abort", None, "end")),
        ("If the time is up, return to the docking station", ("time_up", "return", None, "end")),
    ],
)
def test_reactions(line: str, expected: tuple[str | None, ...], catalog: Catalog) -> None:
    (r,) = planned(line, catalog).reactions
    assert (r.event, r.response, r.until, r.afterwards) == expected
    assert (r.pose is not None) == (r.response is Response.SAFE_AREA)


@pytest.mark.parametrize(
    "line",
    [
        "If a gas leak or a hot spot is detected, return to the docking station and wait",
        "If a gas leak, a hot spot or an abnormal sound is detected, pause until all clear",
        "In case of a dysfunction or low battery: report it",
    ],
)
def test_each_event_of_a_sentence_has_its_reaction(line: str, catalog: Catalog) -> None:
    reactions = planned(line, catalog).reactions
    words = [word for word in _EVENTS if word.replace("_", " ") in line]
    assert [r.event for r in reactions] == [EventKind(word) for word in words]
    assert len({r.model_copy(update={"event": EventKind.GAS_LEAK}) for r in reactions}) == 1


_EVENTS = ("gas_leak", "hot_spot", "abnormal_sound", "dysfunction", "low_battery")


@pytest.mark.rule("R2")
def test_a_reaction_keeps_the_dock_that_it_names(catalog: Catalog) -> None:
    lines = "On low battery: go to the docking station in starting area 2, recharge and resume"
    mission = planned(f"Return to the docking station in starting area 1.\n{lines}", catalog)
    (reaction,) = mission.reactions
    assert (reaction.response, reaction.area) == (Response.RETURN, 2)
    assert reaction.pose == catalog.area(2).dock != mission.dock
    with pytest.raises(DiagnosticError, match="no starting area 7"):
        planned(lines.replace("2", "7"), catalog)


@pytest.mark.rule("R7")
def test_without_a_priority_the_event_decides(catalog: Catalog) -> None:
    said = "On low battery: pause, priority 0\nOn gas leak: pause"
    assert [r.priority for r in planned(said, catalog).reactions] == [0, None]


# ---- changes of the plan, the header, the course of lines


@pytest.mark.parametrize(
    ("line", "measured"),
    [
        ("Move checkpoint #4 before checkpoint #1", ["4", "1"]),
        ("Move step 2 after step 3", ["4", "1"]),
        ("Replace checkpoint #1 by checkpoint #2", ["2", "4"]),
        ("Delete step 2", ["4"]),
        ("Delete checkpoints #1 and #4", []),
        ("Insert checkpoints #2 and #3 before step 3", ["1", "2", "3", "4"]),
        ("Add checkpoint #2 after step 2", ["1", "2", "4"]),
    ],
)
def test_changes(line: str, measured: list[str], catalog: Catalog) -> None:
    tasks = planned(line, catalog).tasks
    assert [t.object_id for t in tasks if t.object_id] == measured
    following = [t.transitions[0].target for t in tasks[:-1]]
    assert following == [t.name for t in tasks[1:]]


def test_the_header(catalog: Catalog) -> None:
    text = (
        "Mission Protocol #9\nMode: supervisory\nMaximum duration: 20'\nOrder: any\n"
        'Designation: "a \\u002a \\"b\\""\nAnomaly specification: anything\n   unusual\n'
        "End area: 2\nCurrent: step 1\nStart area: 1\n1. Check #1\n"
    )
    mission = import_whole(text, catalog).mission
    assert (mission.mode, mission.order, mission.max_duration) == ("supervisory", Order.ANY, 1200)
    assert mission.designation == 'a * "b"'
    assert mission.anomaly_specification == "anything unusual"
    assert [t.name for t in mission.tasks] == ["START", "MEASURE 1", "DOCK"]
    assert (mission.start_area, mission.end_area, mission.current) == (1, 2, "MEASURE 1")
    area = catalog.area(2)
    assert area is not None
    assert mission.dock == area.dock


def test_a_statement_goes_on_in_the_next_line(catalog: Catalog) -> None:
    text = (
        "Mission Protocol\n1. Set a starting point in starting area 1\n"
        "2. Check checkpoints #1,\n#4 and\n   #8. Then go to the front\n   of the site.\n"
        "   If the value of checkpoint #8 is above 5, go to step 2.\n"
    )
    mission = import_whole(text, catalog).mission
    names = [t.name for t in mission.tasks]
    assert names == ["START", "MEASURE 1", "MEASURE 4", "MEASURE 8", "WAYPOINT 1"]
    assert mission.tasks[-1].transitions[0].target == "MEASURE 1"


# ---- what can't be


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("Check checkpoint #4: read valve R12", "checkpoint-mismatch"),
        ("Check checkpoint #4 slowly", "not-understood"),
        ("Check checkpoint #2.5", "number"),
        ("Check checkpoints #3 to #2", "empty-range"),
        ("Patrol floor 1 for 12:30", "ambiguous-duration"),
        ("Patrol floor 1 twice three times", "repeated-limit"),
        ("Check #1 #2", "not-understood"),
        ("Go to (1, 2, 3) on floor 1", "height"),
        ("Repeat steps 2 to 9 twice", "unknown-step"),
        ("Repeat steps 2 to 4", "endless-repeat"),
        ("If checkpoint #1 is not 5, go to step 2", "not-understood"),
        ("If checkpoint #4 is rusty, go to step 2", "not-understood"),
        ("If checkpoint #1 is from 3 to 2, go to step 2", "condition"),
        ("If checkpoint #1 is above 5 deg, go to step 2", "unit"),
        ("If checkpoint #1 is above 5", "unfinished"),
        ("If checkpoint #1 is above 5, go to step 8", "unknown-step"),
        ("If checkpoint #1 is above 5, go to step 5", "empty-step"),
        ("If checkpoint #1 is above 5, delete step 2", "route"),
        ("Then go to step 2; otherwise go to step 3", "otherwise"),
        ("If a gas leak is detected", "unfinished"),
        ("If an obstacle is detected, report it", "ambiguous-event"),
        ("On gas leak: pause. On gas leak: report it.", "second-reaction"),
        ("If a gas leak is detected, check checkpoint #1", "reaction"),
        ("Move checkpoint #1", "unfinished"),
        ("Move checkpoint #1 before checkpoint #1", "self-move"),
        ("Delete step 9", "not-planned"),
        ('"a": check #2 and #3', "one-name"),
        ('"a": check #2 and "a": check #3', "repeated-name"),
        ('"a\\q": check #2', "not-understood"),
        ('"": check #2', "empty-name"),
        ("Patrol floors 1 and 2 for 10 minutes", "ambiguous-duration"),
        ("Check #2. Check #1e999", "number"),
        ("Check #2 and #3; if it fails, check #5", "failure"),
        ("Check #2, retry once, then return to the docking station", "ambiguous-case"),
        ("If #1 is above 5, check #2; then check #3", "ambiguous-case"),
        (
            "If #1 is above 5, check #2. If #4 is above 3, check #3; otherwise check #5",
            "ambiguous-otherwise",
        ),
        (
            "If #1 is above 5, check #2 unless #4 is above 3; otherwise check #5",
            "ambiguous-otherwise",
        ),
        ("Go to step 2. If #1 is above 5, check #2", "second-route"),
        (
            "Check #2; if it is above 5, go on; otherwise go to step 2. If #2 is above 3, check #3",
            "second-route",
        ),
        ("If #1 is above 5, repeat steps 2 to 3 twice", "route"),
        ("Repeat step 2 twice if #1 is above 5", "stray-clause"),
        ("Wait 10 s at 0.3 m/s", "stray-clause"),
        ("Check #2.\n6. Repeat steps 2 to 3 twice.\n7. Repeat steps 3 to 4 twice", "overlap"),
        ("Check #2 at 0.3 m/s, leaving at 0.2 m/s; go to (1, 2, 3) at 0.1 m/s", "two-speeds"),
        ("Repeat step 2 twice at 0.3 m/s", "stray-clause"),
        ("Repeat step 2 99999999999999999999 times", "number"),
        ("Check #2, retry 99999999999 times", "number"),
        ("On gas leak: pause, priority -99999999999", "number"),
        ("Check #2\n" + "Repeat step 5 twice\n" * 501, "deep-rounds"),
        ("Repeat step 6 twice; if #1 is above 2, check #2.\n6. Check #2", "not-planned"),
        ("Repeat steps 2 to 3 twice; if #1 is above 2, check #2", "not-planned"),
        ("If a gas leak and a hot spot is detected, report it", "reaction"),
        ("On gas leak: report it, hot spot", "not-understood"),
    ],
)
def test_what_is_wrong(line: str, code: str, catalog: Catalog) -> None:
    found = codes(f"{PLAN}5. {line}\n", catalog)
    assert [other for other in found if other != "repeated-there"] == [code]


@pytest.mark.parametrize(
    "lines",
    [
        "5. Check #1. If it is above 4, go to step 7.\n"
        "6. Check #2, leaving at 0.1 m/s.\n7. Check #3.",
        "5. Check #1.\n6. Check #2, leaving at 0.1 m/s; go to step 5.",
        "5. Check #1.\n6. Check #2, leaving at 0.1 m/s.\n7. Repeat steps 5 to 6 twice.",
    ],
)
def test_a_speed_that_other_ways_share_is_said(lines: str, catalog: Catalog) -> None:
    assert codes(f"{PLAN}{lines}\n", catalog) == ["speed-shared"]


@pytest.mark.parametrize("start", ["Start in starting area 1", "Set the start in starting area 1"])
def test_ways_to_say_where_it_starts(start: str, catalog: Catalog) -> None:
    text = f"Mission Protocol\n1. {start}\n2. Check #1\n3. Return to the dock in starting area 1\n"
    mission = import_whole(text, catalog).mission
    assert [task.name for task in mission.tasks] == ["START", "MEASURE 1", "DOCK"]


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("Battery: full", "unknown-label"),
        ("Colour of the robot: red", "unknown-label"),
        ("Mode: automatic", "field"),
        ("Mode: supervisory\nMain mode: autonomous", "repeated-field"),
        ("Start area: 2", "area-conflict"),
        ("End area: 7", "unknown-area"),
        ("Site: somewhere", "other-site"),
        ("End area: 7, as planned", ""),
    ],
)
def test_what_is_wrong_in_a_header(line: str, code: str, catalog: Catalog) -> None:
    assert codes(PLAN.replace("1. Set", f"{line}\n1. Set"), catalog) == [code][: len(code)]


def test_an_unknown_label_names_the_known_ones(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match=r"there is no field `Battery`(?s:.*)`Mode:`"):
        import_whole(PLAN + "Battery: full", catalog)


@pytest.mark.parametrize(
    "names", [("Gate", "gate"), ("Gate A", "the gate A"), ("Tür", "Tuer"), ("gate at umad", "Gate")]
)
def test_places_that_are_written_alike_are_asked_about(
    names: tuple[str, str], catalog: Catalog
) -> None:
    poses = (Pose(x=-1, y=4, z=0), Pose(x=-2, y=4, z=0))
    places = tuple(Place(name=n, pose=p) for n, p in zip(names, poses, strict=True))
    catalog = catalog.model_copy(update={"places": (*catalog.places, *places)})
    assert import_whole(PLAN, catalog).diagnostics == ()
    with pytest.raises(DiagnosticError) as raised:
        import_whole(f"{PLAN}5. Go to the {names[1]}\n", catalog)
    (found,) = raised.value.diagnostics
    assert found.code == "script.ambiguous-place"
    assert found.span is not None
    assert found.span.line == 6
    assert all(f"`{name}`" in found.message for name in names)
    assert found.hint is not None
    assert "coordinates" in found.hint


SAID_TWICE = (
    "Check checkpoint #9 not later than 10 minutes after the start. If it is too late, go to"
)


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ("Don't check checkpoint 4", "spared"),
        ("Don't check checkpoint 9", "no-effect"),
        (f"{SAID_TWICE} step 2. If it is too late, go to step 3", "second-route"),
        ("Check checkpoint #9. If it is too late, go to step 2", "too-late"),
        ("Check #9. If it fails, go to step 2. If it fails, go to step 3", "second-route"),
        ("Repeat steps 2 and 4 twice", "step-range"),
        ("Repeat steps 4 to 2 twice", "step-range"),
        ("Repeat step 1 twice", "empty-step"),
        ("Check checkpoint #9 until #1 is above 4 or #4 is above 4", "condition"),
        ("Go to (1, 2)", "height"),
        ("Check checkpoint #9 at 1.200 m/s", "ambiguous-number"),
        ("Wait 1.200 minutes", "ambiguous-duration"),
        ("Wait 0 minutes", "duration"),
        ("Wait 90000000000000 minutes", "duration"),
    ],
)
def test_what_a_line_is_told(line: str, code: str, catalog: Catalog) -> None:
    found = findings(f"{PLAN}5. {line}\n", catalog)
    assert [(f.code, f.span and f.span.line) for f in found] == [(f"script.{code}", 6)]
