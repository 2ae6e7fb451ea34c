"""Sentences that are easily misread: each is read as it is meant, or asked about."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.il import Afterwards, ConditionType, EventKind, Mission, OnFailure, Response
from tests.argo_compiler.script.conftest import measured_in, refusals
from tests.whole_scripts import import_whole

START = "Start in starting area 1.\n"


def read(text: str, catalog: Catalog) -> Mission:
    return import_whole(f"{START}{text}", catalog).mission


Bounds = list[tuple[str | None, ConditionType, object]]


def bounds(mission: Mission, name: str) -> list[Bounds]:
    task = mission.task(name)
    assert task is not None
    return [[(c.object_id, c.type, c.param1) for c in t.conditions] for t in task.transitions]


@pytest.mark.parametrize(
    ("text", "code", "readings"),
    [
        ("Check checkpoint 1 or 4.", "ambiguous-or", ["either of them", "both"]),
        ("Check #1. Check the whole round again.", "ambiguous-all", ["so far", "of the site"]),
        (
            "# The valves come first\nCheck #1 and #4.",
            "ambiguous-order",
            ["all of them", "the order of"],
        ),
        (
            "Die Ventile zuerst\nPrüfe #1 und #4.",
            "ambiguous-order",
            ["all of them", "the order of"],
        ),
        (
            "Note: the gauges come last\nCheck #1.",
            "ambiguous-order",
            ["all of them", "the order of"],
        ),
        ("Check #1. Check the whole list.", "ambiguous-all", ["so far", "of the site"]),
        ("Check #1 and #4. Check everything twice.", "ambiguous-all", ["so far", "of the site"]),
        ("Check #1. Check everything once more.", "ambiguous-all", ["so far", "of the site"]),
        ("Check #1. Read the whole list a second time.", "ambiguous-all", ["so far"]),
        (
            "Check all valves on the ground floor and all gauges on the first floor.",
            "ambiguous-floor",
            ["the same", "two floors"],
        ),
        ("Check valve R25 and 5.", "ambiguous-checkpoint", ["valve R12"]),
        ("Maximum duration: 1.200 s\nCheck #1.", "ambiguous-duration", ["1.2 s", "1200 s"]),
        (
            "Check #1. If it is above 5, check #4. If it is above 80, check #8.",
            "ambiguous-pronoun",
            ["#1", "#4"],
        ),
        ("Check #1 and check #4, retry twice.", "ambiguous-manner", ["last", "each"]),
        ("Check #1, retry once, then return home.", "ambiguous-case", ["fails", "any case"]),
        ("Check #1. If it is above 5, check #4; then check #8.", "ambiguous-case", ["this case"]),
        ("Check #1 and #4 not in any order.", "not-understood", ["`not`"]),
        ("Order: not any\nCheck #1.", "field", ["`not any`"]),
        (
            "End of the mission: anywhere but starting area 2\nCheck #1.",
            "not-understood",
            ["anywhere"],
        ),
        (
            "Check #1. Go to the docking station in starting area 2 and wait.",
            "wait",
            ["no duration"],
        ),
        (
            "Check valve R40 on the third floor.",
            "checkpoint-mismatch",
            ["on floor 5", "not on floor 3"],
        ),
        (
            "On the second floor, check all valves on the third floor.",
            "ambiguous-floor",
            ["all valves on the third floor"],
        ),
        ("Check #1. If it is above 5, skip the next step. Check #4.", "step-range", ["which step"]),
        ("Check #1. Return to the dock in area 1 (area 2).", "several-places", ["two places"]),
        ("Check #5. Before you read #5, check #7.", "ambiguous-edit", ["already measured before"]),
        (
            "Before you read #5, check #7. Check #5.",
            "ambiguous-edit",
            ["measured here as well", "only there"],
        ),
        ("Check #1. If it is above 5 and below 3, check #4.", "condition", ["no value"]),
        ("Check #1 and #4. Check one of them.", "ambiguous-or", ["either of them"]),
        ("Check #4 if it is above 4.", "which-checkpoint", ["nothing is measured"]),
        ("Check #1. Unless a gas leak is detected, go home.", "condition", ["unless"]),
        ("Check #1. Unless the battery is below 30 %, go home.", "condition", ["unless"]),
        ("Check #1 within 10 min. Unless it is too late, check #4.", "condition", ["unless"]),
        ("Check #1, if possible.", "ambiguous-manner", ["by when", "optional"]),
        (
            "Check #1, #2 and #4. If #1 is above 4 and #2 is below 50 or #4 is above 2, check #8.",
            "ambiguous-and-or",
            ["#2 is below 50, or #4 is above 2`", "#1 is above 4, and #2 is below 50 or"],
        ),
        (
            "Check #1 and #4. If #1 is above 4 or below 2 and #4 is above 2, check #8.",
            "ambiguous-and-or",
            ["below 2, and #4 is above 2`", "above 4, or below 2"],
        ),
        (
            "Check #1. If it is above 5, check #8. If it fails, go home.",
            "ambiguous-pronoun",
            ["pressure gauge 1 (#1)", "pressure gauge 5 (#8)"],
        ),
        (
            "Check 18 and 7. Check 7 before 18.",
            "precedence",
            ["'MEASURE 7' must come before 'MEASURE 18'"],
        ),
        ("Check #1 and #4 (6 instead of 4).", "ambiguous-remark", ["instead", "a remark"]),
        ("Check #1 and #4 - I mean 8.", "ambiguous-remark", ["I mean"]),
        ("Check valve R25 (cancelled).", "ambiguous-remark", ["cancelled"]),
        ("Check valve R25 (only in an emergency).", "ambiguous-remark", ["only"]),
        ("Check valve R25 (slowly).", "ambiguous-remark", ["slowly"]),
        ("Prüfe Ventil R25 (entfällt).", "ambiguous-remark", ["entfällt"]),
        ("Prüfe #1 und #4 (Korrektur: 6 statt 4).", "ambiguous-remark", ["Korrektur"]),
        ("- #1\nNice to have:\n- #4", "ambiguous-title", ["not always"]),
        ("1. Check #1\nAlternatively:\n2. Check #4", "ambiguous-title", ["not always"]),
        ("- check #1\nIn an emergency:\n- go home", "ambiguous-title", ["not always"]),
        ("- check #1\nAt 10:00:\n- check #4", "ambiguous-title", ["not always"]),
        ("- check #1\nAfter the alarm:\n- check #4", "ambiguous-title", ["not always"]),
        ("- check #1\nOptional:\n- check #4", "stray-clause", ["other lines"]),
        ("- check #1\nIn any order\n- check #4\n- check #2", "stray-clause", ["other lines"]),
        ("Checkpoint | Floor\n1 | 1\n5 | 1", "checkpoint-mismatch", ["not on floor 1"]),
        ("Checkpoint | Done\n1 | no\n4 | x", "ambiguous-cell", ["already"]),
        ("Checkpoint | Remark\n1 | postponed\n4 | ", "ambiguous-remark", ["postponed"]),
        ("Checkpoint | Condition\n1 | -\n4 | R25 is rusty", "not-understood", ["rusty"]),
        ("Checkpoint | Result\n1 | above 4: check #8\n4 | ", "ambiguous-remark", ["check #8"]),
        ("Check #1 and #8. If only one of them is above 3, go home.", "ambiguous-word", ["others"]),
        ("Check #1 and #8. If only #1 is above 3, go home.", "ambiguous-word", ["`only`"]),
        ("Check #1 and #8. If #1 plus #8 is above 7, go home.", "ambiguous-word", ["their sum"]),
        ("Prüfe #1, #4. Wenn #1 + #4 über 7 liegt, prüfe #8.", "ambiguous-word", ["their sum"]),
        ("Check #1. Check #8 also if it is above 4.", "ambiguous-word", ["even if"]),
        ("Prüfe #1. Prüfe #8, auch wenn #1 über 4 liegt.", "ambiguous-word", ["even if"]),
        ("Go to the front of the site. Check #8. Go back there.", "ambiguous-word", ["named"]),
        ("Prüfe #1, #4 und #8 hin und zurück.", "ambiguous-word", ["in reverse order"]),
        (
            "Drive at 0.2 m/s on the second floor. Check #5.",
            "ambiguous-place",
            ["where the speed applies"],
        ),
        ("Fahre im zweiten Stock mit 0,2 m/s.", "ambiguous-place", ["the destination"]),
        (
            "Check all valves except two.",
            "ambiguous-exception",
            ["(#2)", "the number of exceptions"],
        ),
        (
            "Prüfe alle Ventile bis auf zwei.",
            "ambiguous-exception",
            ["(#2)", "the number of exceptions"],
        ),
        (
            "Check all valves except four.",
            "ambiguous-exception",
            ["(#4)", "the number of exceptions"],
        ),
        ("Check all valves on the third floor, R7.", "ambiguous-measure", ["measure it twice"]),
        ("Check #1, #4 and #8, #8 first.", "ambiguous-measure", ["once more"]),
        ("Check 8, 1 and 4, 8 at the end.", "ambiguous-measure", ["once more"]),
        ("Check #8 second, #1 first.", "not-understood", ["second"]),
        ("Check #1 and #8. If both fail, go home.", "failure", ["each of them", "all together"]),
        ("Check #1. Check #8. If both of them fail, go home.", "failure", ["each of them"]),
        ("Check #1. Check #8. If one of them fails, go home.", "failure", ["each of them"]),
        ("Check #1. As soon as it is above 4, check #8.", "ambiguous-case", ["at any time"]),
        ("Check #1. Check #8 as soon as it is above 4.", "ambiguous-case", ["at any time"]),
        ("Prüfe #1. Sobald er über 4 liegt, prüfe #8.", "ambiguous-case", ["at any time"]),
        ("Check #1, #4, ...", "ambiguous-word", ["more tasks follow"]),
        ("1. Check #1\n2. ...\n3. Check #4", "ambiguous-word", ["more tasks follow"]),
        ("Check #1 and #4…", "ambiguous-word", ["more tasks follow"]),
        ("Check checkpoint 1 (or 4).", "not-understood", ["`or`"]),
        ("Check #1. If it is above 4, check #8. Only then go home.", "ambiguous-word", ["case"]),
        (
            "Check #1. If it is not above 4 or below 2, check #8.",
            "ambiguous-and-or",
            ["the first of these", "both"],
        ),
        ("Check #1. If it isn't above 4 and below 6, go home.", "ambiguous-and-or", ["both"]),
        (
            "Check #1, #8. If neither of them is above 4 or below 2, check #14.",
            "ambiguous-and-or",
            ["both"],
        ),
        ("Prüfe #1. Wenn er nicht über 4 oder unter 2 liegt, ende.", "ambiguous-and-or", ["both"]),
        (
            "Check #14. Check #1 within 2 minutes.",
            "ambiguous-word",
            ["the start", "the previous task"],
        ),
        ("Check #14, then check #1 within 2 minutes.", "ambiguous-word", ["the previous task"]),
        ("Check #14.\nAlso check #1 within 2 minutes.", "ambiguous-word", ["the previous task"]),
        (
            "1. Check #1 within 2 minutes.\n2. Check #4.\n3. Check #1 within 2 minutes.",
            "ambiguous-word",
            ["the previous task"],
        ),
        ("Check 1 and 8. If 1 is higher than 8, go home.", "ambiguous-number", ["8 bar", "(#8)"]),
        (
            "Check 1, 8. If 1 but not 8 is above 4, go home.",
            "condition",
            ["the excepted checkpoint"],
        ),
        ("First floor\n- check #1\n- check #5", "checkpoint-mismatch", ["not on floor 1"]),
        ("Third floor:\n1. Check all valves on floor 2.", "ambiguous-floor", ["two floors"]),
        ("> 1. Check #1\n> 2. Check #4\nCheck #8.", "ambiguous-quote", ["quoted"]),
        ("Prüfe #1. Während du an #1 wartest, prüfe #4.", "not-understood", ["wartest"]),
        ("Check valve #1.", "checkpoint-mismatch", ["checkpoint #1 is pressure gauge 1"]),
        ("Check pressure gauge #8.", "ambiguous-checkpoint", ["gauge 8 (#18)", "gauge 5 (#8)"]),
        ("Check level gauge no. R31.", "unknown-checkpoint", ["no liquid level gauge R31"]),
        ("Check checkpoints 1 and 4 except 1 and 4.", "no-checkpoint", ["leaves no checkpoint"]),
        (
            "Check #1, #2 and #4. If #1 and #2 or #4 are abnormal, check #8.",
            "ambiguous-and-or",
            ["#1 and #2, or #4", "#1, and #2 or #4"],
        ),
        ("Check #1. If it is above 4 for 2 min, check #4.", "ambiguous-manner", ["condition"]),
        ("Check #1. If it is above 4 twice, check #4.", "ambiguous-manner", ["condition"]),
        ("Check #1. Check #4 if #1 is above 4 for 2 min.", "ambiguous-manner", ["condition"]),
        ("If a gas leak is detected twice, go home.", "ambiguous-manner", ["condition"]),
        ("Check #1. If so, check #4.", "not-understood", []),
        (
            "Check #1. If it is above 4, check #4. In that case, check #8, too.",
            "not-understood",
            [],
        ),
        ("Check all valves which hang on floor 2.", "not-understood", ["`which`"]),
        (
            "Check the valves, which must be on floor 2, and checkpoint 3.",
            "not-understood",
            ["`which`"],
        ),
    ],
)
def test_what_is_asked_about(text: str, code: str, readings: list[str], catalog: Catalog) -> None:
    errors = refusals(f"{START}{text}", catalog)
    assert [error.code for error in errors] == [f"script.{code}"]
    assert all(reading in errors[0].message for reading in readings)
    assert errors[0].span is not None


@pytest.mark.parametrize(
    ("text", "checkpoints"),
    [
        ("Check pressure gauges 1, 5 and 8.", ["1", "8", "18"]),
        ("1. Check checkpoint 1, 2. Check checkpoint 4", ["1", "4"]),
        ("Check all valves on the third floor except R31.", ["11"]),
        ("Check all valves on the third floor except 10.", ["11"]),
        ("- check #1\n\nThird floor\n- all valves\n\nCheck #2.", ["1", "10", "11", "2"]),
        ("# Floor 1\nCheck all valves.\n# Floor 2\nCheck all gauges.", ["4", "6", "7", "8"]),
        ("Erdgeschoss\n- alle Ventile\n\nZweiter Stock\n- alle Manometer", ["4", "6", "8"]),
        ("1. Floor 1\n   - all valves\n2. Floor 2\n   - all gauges", ["4", "6", "7", "8"]),
        ("Floors 1 and 2:\n- all valves", ["4", "5"]),
        ("> 1. Check #1\n> 2. Check #4\n\nKind regards, Jane", ["1", "4"]),
        ("Check valve no. 4 and pressure gauge number 5.", ["4", "8"]),
        ("Check all valves on the third floor in any order, except R31.", ["11"]),
        ("Check valve R12 on the second floor.", ["5"]),
        ("On the second floor, check the valve and then the liquid level gauge.", ["5", "7"]),
        ("On the second floor, check the valve, then read the liquid level gauge.", ["5", "7"]),
        ("On the second floor: valve R12", ["5"]),
        ("Check all valves which are on floor 3.", ["10", "11"]),
        ("Check all valves, which are on the third floor.", ["10", "11"]),
        ("Check all valves that are located on floor 3.", ["10", "11"]),
        ("Check the valve that is on floor 2.", ["5"]),
        ("Go to checkpoint 4 and check it there.", ["4"]),
        ("Before you read liquid level gauge 2, check valve R12.", ["5", "7"]),
        ("After you have read liquid level gauge 2, check valve R12.", ["7", "5"]),
        ("Check #7. After you have read it, check valve R12.", ["7", "5"]),
        ("Check #7 and #5. In any case it also has to check #8.", ["7", "5", "8"]),
        ("First it reads pressure gauge 1, then it goes up and looks at valve R12.", ["1", "5"]),
        ("Go to the second floor to valve R12, which is to be checked.", ["5"]),
        ("Check #4. When all of this is done, read #5.", ["4", "5"]),
        ("It must to control the valve R31, after this the valve R7.", ["10", "11"]),
        ("Go to the second floor to valve R12 and check it.", ["5"]),
        ("Check checkpoint 1. If it is above 4,5, check checkpoint 8.", ["1", "8"]),
        *(
            (text, ["1", "4", "5", "8"])
            for text in (
                "First of all check 1. Check 4. Finally, check 5 and 8, then return to the dock.",
                "Check 1 first. Check 4. Finally check 5. If it is abnormal, check 8.",
                "Check 1. Check 4 over there. Check 5. If it fails, check 8 instead.",
            )
        ),
    ],
)
def test_lists(text: str, checkpoints: list[str], catalog: Catalog) -> None:
    assert measured_in(read(text, catalog)) == checkpoints


@pytest.mark.parametrize(
    ("condition", "alternatives"),
    [
        ("#1 is above 4 and #2 is below 50, or #4 is abnormal", [["1", "2"], ["4"]]),
        ("#1 is above 4, and #2 is below 50 or #4 is abnormal", [["1", "2"], ["1", "4"]]),
        ("either #1 is above 4 or #2 is below 50, and #4 is abnormal", [["1", "4"], ["2", "4"]]),
        ("#1 is above 4, #2 is below 50, or #4 is abnormal", [["1"], ["2"], ["4"]]),
        ("#1 is above 4, #2 is below 50, and #4 is abnormal", [["1", "2", "4"]]),
        ("#1 is above 4 and below 7 or #4 is abnormal", [["1", "1"], ["4"]]),
    ],
)
def test_what_a_comma_parts(
    condition: str, alternatives: list[list[str]], catalog: Catalog
) -> None:
    mission = read(f"Check #1, #2 and #4. If {condition}, check #8.", catalog)
    found = [[number for number, _, _ in way] for way in bounds(mission, "MEASURE 4")]
    assert [way for way in found if way] == alternatives


def above(number: str, bound: float) -> list[Bounds]:
    return [[(number, ConditionType.GREATER, bound)]]


def abnormal(*numbers: str) -> list[Bounds]:
    return [[(number, ConditionType.ABNORMAL, None)] for number in numbers]


@pytest.mark.parametrize(
    ("text", "task", "ways"),
    [
        ("Check #1. Anything above 5 bar needs a look at #4.", "1", above("1", 5)),
        ("Check #1. Above 5 bar, check #4.", "1", above("1", 5)),
        ("Check #1. At more than 5 bar check #4.", "1", above("1", 5)),
        ("Check #1. If p > 5 bar: check #4", "1", above("1", 5)),
        ("Check #1. In case when it shows more than 5 bar, check #4.", "1", above("1", 5)),
        (
            "Check #1. Only if pressure gauge 1 was above 5 bar does it also have to check #4.",
            "1",
            above("1", 5),
        ),
        ("Check #1. If it stands at more than 5 bar, check #4.", "1", above("1", 5)),
        ("Check checkpoint 1. If it is above 4,5, check checkpoint 8.", "1", above("1", 4.5)),
        # of the only one of its kind so far
        (
            "Check #5 and #7. Check #1. If the valve is above 3 degrees, check #8.",
            "1",
            above("5", 3),
        ),
        # before a measurement, of the one before it
        ("Check #1. Check #4 if it is above 4.", "1", above("1", 4)),
        ("Check #1. Check #4 only if it is above 4.", "1", above("1", 4)),
        # of each that is named
        (
            "Check #1 and #4. If checkpoint 1 or checkpoint 4 is abnormal, check checkpoint 8.",
            "4",
            abnormal("1", "4"),
        ),
        # of one of them, and not of checkpoint 1
        ("Check #1 and #4. If one of them is abnormal, check #8.", "4", abnormal("1", "4")),
        ("Check #4, #5. If one is abnormal, check #8.", "5", abnormal("4", "5")),
        ("Check #4, #5. If any one is abnormal, check #8.", "5", abnormal("4", "5")),
        ("Check #4, #5. If either of the two is abnormal, check #8.", "5", abnormal("4", "5")),
        ("Check #4, #5. Should one of the two be abnormal, check #8.", "5", abnormal("4", "5")),
        ("Prüfe #4, #5. Wenn eins auffällig ist, prüfe #8.", "5", abnormal("4", "5")),
        ("Prüfe #4, #5. Ist eins auffällig, prüfe #8.", "5", abnormal("4", "5")),
        ("Prüfe #4, #5. Wenn einer der beiden auffällig ist, prüfe #8.", "5", abnormal("4", "5")),
    ],
)
def test_what_a_condition_is_asked_of(
    text: str, task: str, ways: list[Bounds], catalog: Catalog
) -> None:
    assert bounds(read(text, catalog), f"MEASURE {task}") == ways


@pytest.mark.parametrize(
    ("skipped", "way"),
    [("skip the next step", "3"), ("skip step 4", "3"), ("leave out steps 4 and 5", "8")],
)
def test_a_step_that_is_skipped(skipped: str, way: str, catalog: Catalog) -> None:
    """Only where the condition holds; it goes on behind the step."""
    lines = f"2. Check #1\n3. If it is above 5, {skipped}\n4. Check #2\n5. Check #3\n6. Check #8"
    first = import_whole(f"1. Start in area 1\n{lines}", catalog).mission.task("MEASURE 1")
    assert first is not None
    assert [w.target for w in first.transitions] == [f"MEASURE {way}", "MEASURE 2"]


def test_a_speed_is_the_highest_on_its_way(catalog: Catalog) -> None:
    assert read("Check #4 at no more than 0.3 m/s.", catalog).tasks[-1].velocity == 0.3


def test_each_event_that_is_named(catalog: Catalog) -> None:
    text = "Check #1.\nIf a gas leak or a hot spot is detected, return to the docking station."
    reactions = read(text, catalog).reactions
    assert [r.event for r in reactions] == [EventKind.GAS_LEAK, EventKind.HOT_SPOT]
    assert {r.response for r in reactions} == {Response.RETURN}


def test_the_dock_that_is_named(catalog: Catalog) -> None:
    area = catalog.area(2)
    assert area is not None
    mission = read("Check #1. Go to the docking station in starting area 2.", catalog)
    assert (mission.tasks[-1].pose, mission.end_area) == (area.dock, 2)
    text = "Check #1. If the platform alarm sounds, go to the dock in starting area 2 and wait."
    (reaction,) = read(text, catalog).reactions
    assert (reaction.pose, reaction.area, reaction.afterwards) == (area.dock, 2, "wait")


def test_an_end_that_is_only_for_a_failure(catalog: Catalog) -> None:
    text = "Check #1; if it fails, return to the docking station and end the mission. Check #4."
    mission = read(text, catalog)
    first = mission.task("MEASURE 1")
    assert first is not None
    assert [way.target for way in first.transitions] == ["MEASURE 4"]
    assert (first.on_failure, first.failure_target) == (OnFailure.BRANCH, "DOCK")


def test_a_condition_with_its_other_case_stays_in_its_round(catalog: Catalog) -> None:
    mission = import_whole(
        "1. Start in starting area 1.\n2. Check #1\n"
        "3. Check #4. If it is above 5, check #8, otherwise check #14.\n"
        "4. Repeat steps 2 to 3 twice",
        catalog,
    ).mission
    (group,) = mission.groups
    names = [task.name for task in mission.tasks]
    inside = names[names.index(group.start) : names.index(group.end) + 1]
    assert {"MEASURE 1", "MEASURE 4", "MEASURE 8", "MEASURE 14"} <= {*inside}
    assert group.max_repeat_count == 2


def test_a_condition_behind_a_patrol_is_looked_at_after_it(catalog: Catalog) -> None:
    mission = import_whole(
        "1. Start in starting area 1.\n2. Check #1\n"
        "3. Patrol the first floor for 10 minutes. If checkpoint #1 is above 4, check #8.\n"
        "4. Check #14",
        catalog,
    ).mission
    (group,) = mission.groups
    end = mission.task(group.end)
    assert end is not None
    (way,) = end.transitions
    assert way.conditions == ()
    assert bounds(mission, way.target) == [[("1", ConditionType.GREATER, 4.0)], []]


@pytest.mark.parametrize(
    "text", ["Check #1 and #4, retry twice.", "Check #1. Check #4, retry twice."]
)
def test_retries_are_those_of_the_sentence(text: str, catalog: Catalog) -> None:
    retries = [task.retries for task in read(text, catalog).tasks[1:]]
    assert retries == ([2, 2] if "#1 and" in text else [0, 2])


def test_it_is_what_has_the_unit(catalog: Catalog) -> None:
    text = "Check #1. If it is above 5, check #2. If it is above 80 %, check #8."
    mission = read(text, catalog)
    asked = [c for t in mission.tasks for w in t.transitions for c in w.conditions]
    assert [(c.object_id, c.param1) for c in asked] == [("1", 5.0), ("2", 80.0)]


def test_several_conditions_are_looked_at_in_turn(catalog: Catalog) -> None:
    text = "Check #1. If #1 is above 5, check #2. If #1 is above 3, check #3. Check #4."
    mission = read(text, catalog)
    branch = mission.task("MEASURE 2")
    assert branch is not None
    assert bounds(mission, branch.transitions[0].target)[0] == [("1", ConditionType.GREATER, 3.0)]


def test_otherwise_behind_conditions_that_exclude_each_other_is_of_all(catalog: Catalog) -> None:
    text = "Check #1. If #1 is above 5, check #2. If #1 is below 3, check #3. Otherwise check #4."
    first = read(text, catalog).task("MEASURE 1")
    assert first is not None
    assert [w.target for w in first.transitions] == ["MEASURE 2", "MEASURE 3", "MEASURE 4"]


def test_one_of_them_fails(catalog: Catalog) -> None:
    mission = read("Check #1 and #4. If one of them fails, abort the mission.", catalog)
    assert [t.on_failure for t in mission.tasks if t.object_id] == [OnFailure.ABORT] * 2


@pytest.mark.parametrize(
    "when", ["If there is a failure", "In case of failure", "If it has failed"]
)
def test_a_failure_is_that_of_the_task(when: str, catalog: Catalog) -> None:
    mission = read(f"Check #1. {when}, return to the docking station.", catalog)
    assert mission.reactions == ()
    assert mission.tasks[1].on_failure is OnFailure.RETURN


@pytest.mark.parametrize(
    "title", ["Mission Protocol: one", "Mission: 1", "Round: 4", "Protocol: all valves"]
)
def test_a_title_is_no_measurement(title: str, catalog: Catalog) -> None:
    steps = "1. Start in starting area 1.\n2. Check checkpoint #8."
    found = import_whole(f"{title}\n{steps}", catalog).mission
    assert measured_in(found) == ["8"]


def test_a_name_at_the_beginning_of_a_line_is_no_part_of_one_above(catalog: Catalog) -> None:
    text = '1. "A": check #1\n"B": add checkpoint #2 after step "A"\n"C": add #8 after step "B"'
    assert [task.name for task in read(text, catalog).tasks[1:]] == ["A", "B", "C"]


def test_what_was_replaced_can_be_repeated(catalog: Catalog) -> None:
    text = '1. "A": check #1.\nRepeat step "A" twice.\nReplace step "A" by checkpoint #2.'
    mission = read(text, catalog)
    assert [task.object_id for task in mission.tasks[1:]] == ["2"]
    assert mission.groups[0].max_repeat_count == 2


def test_a_slip_with_several_spellings_of_one_word(catalog: Catalog) -> None:
    found = import_whole("Start in starting area 1.\nCheck presure guage 3.", catalog)
    assert measured_in(found.mission) == ["6"]
    assert [d.code for d in found.diagnostics if d.severity is Severity.WARNING] == [
        "script.respelled"
    ] * 2


def test_unless_it_fails(catalog: Catalog) -> None:
    task = read("Check #1. Unless it fails, check #4. Then check #8.", catalog).task("MEASURE 1")
    assert task is not None
    assert task.failure_target is None
    (failed, otherwise) = task.transitions
    assert [c.type for c in failed.conditions] == [ConditionType.FAILED]
    assert (failed.target, otherwise.target) == ("MEASURE 8", "MEASURE 4")


@pytest.mark.parametrize(
    ("text", "response", "afterwards"),
    [
        ("return to the docking station and stay there", Response.RETURN, Afterwards.END),
        ("return to the docking station and wait there", Response.RETURN, Afterwards.WAIT),
        ("the robot breaks off and goes back to its dock", Response.RETURN, Afterwards.END),
        ("abort the mission and go home", Response.RETURN, Afterwards.END),
        ("bring it back to its dock", Response.RETURN, Afterwards.END),
        ("break off", Response.ABORT, Afterwards.END),
    ],
)
@pytest.mark.parametrize("label", ["", "General: ", "Safety rule: "])
def test_what_is_done_in_an_event_is_one_thing(
    label: str, text: str, response: Response, afterwards: Afterwards, catalog: Catalog
) -> None:
    (reaction,) = read(f"{label}If a gas leak is detected, {text}.\n\nCheck #4.", catalog).reactions
    assert (reaction.response, reaction.afterwards) == (response, afterwards)


@pytest.mark.parametrize(
    "start",
    [
        "Starting area 2",
        "Starting area 2.",
        "strating area 2",
        "The robot in starting area 2.",
        "The robot sits in starting area 2.",
        "From: J. Smith, shift C\nThe robot is sitting in starting area 2.",
        "Startbereich 2",
    ],
)
def test_a_starting_area_by_itself_is_the_start(start: str, catalog: Catalog) -> None:
    check = "Prüfe Kontrollpunkt 4" if start.startswith("Startb") else "Check checkpoint 4"
    mission = import_whole(f"{start}\n- {check}\n", catalog).mission
    assert mission.tasks[0].pose == catalog.areas[1].dock
    assert measured_in(mission) == ["4"]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Prüfe Kontrollpunkt 1. Prüfe die ganze Runde noch einmal.", "ambiguous-all"),
        ("Lies Kontrollpunkt 1 ab. Prüfe dann alles nochmals.", "ambiguous-all"),
        ("Ventil R25 im Erdgeschoss prüfen, alle Manometer im ersten Stock prüfen.", "ambiguous-"),
        ("Prüfe alle Ventile im 1. Stock und alle Manometer im EG.", "ambiguous-floor"),
    ],
)
def test_german_that_may_mean_two_things_is_asked_about(
    text: str, code: str, catalog: Catalog
) -> None:
    found = refusals(f"Start in Startbereich 1.\n{text}", catalog)
    assert any(code in error.code for error in found)


@pytest.mark.parametrize(
    "still",
    [
        "it still cannot be read",
        "it still can't be read",
        "it cannot still be read",
        "it still fails",
    ],
)
def test_what_still_cannot_be_read_has_failed(still: str, catalog: Catalog) -> None:
    said = f"Check #4. If it cannot be read, try again twice. If {still}, go home."
    assert read(said, catalog) == read(said.replace(still, "it fails again"), catalog)


@pytest.mark.parametrize(
    "failure",
    [
        "On failure of the robot, go home.",
        "If the robot fails, go home.",
        "If the robot has failed, go home.",
        "On robot failure, go home.",
        "Bei Ausfall des Roboters fahr nach Hause.",
        "Wenn der Roboter ausfällt, fahr nach Hause.",
        "Wenn der Roboter fehlschlägt, fahr nach Hause.",
    ],
)
def test_a_failure_of_the_robot_is_none_of_a_measurement(failure: str, catalog: Catalog) -> None:
    measure = "Prüfe #1." if "Roboter" in failure else "Check #1."
    mission = read(f"{measure} {failure}", catalog)
    assert {task.on_failure for task in mission.tasks} == {OnFailure.CONTINUE}
    assert [r.event for r in mission.reactions] == [EventKind.DYSFUNCTION]


@pytest.mark.parametrize(
    ("text", "code"),
    [
        ("Check #1. Go to starting area 2. If it does not fail, check #4.", "ambiguous-pronoun"),
        ("Check #1. Go to starting area 2. Unless it fails, check #4.", "ambiguous-pronoun"),
        ("Check #1 and #4. If they have not failed, check #8.", "condition"),
    ],
)
def test_what_has_not_failed_has_to_be_clear(text: str, code: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError) as error:
        read(text, catalog)
    assert [d.code for d in error.value.diagnostics] == [f"script.{code}"]


@pytest.mark.parametrize(
    ("text", "asked"),
    [
        ("Check 4 at the end. Check 5.", "has to come last, but line 2"),
        ("Check 4 at the end, then check 5.", "has to come last, but line 2"),
        (
            "Prüfe Kontrollpunkt 4 zum Schluss. Prüfe Kontrollpunkt 5.",
            "has to come last, but line 2",
        ),
        ("Check 4. First of all check 1.", "has to come first, but line 2"),
        ("Check 4. Check 5 first.", "has to come first, but line 2"),
        ("Go to floor 3. Check everything there.", "where `there` is"),
        ("Fahre auf Ebene 3. Prüfe dort alle Ventile.", "where `there` is"),
        ("Check 1. If it is above 4, check 8 instead. Check 5.", "what this replaces"),
        ("Check 1 along the way to 5.", "does not understand `along`"),
        ("Check 1, then each time check 4.", "does not understand"),
        ("Check 1. If it is still above 4 after 5 minutes, check 8.", "belong to the condition"),
        ("Check 1 twice an hour.", "does not understand `hour`"),
        ("Check 4 and note the value.", "the last measurement, or another one"),
        ("Check 1. Whenever it is above 4, check 8.", "not at any time"),
        ("Check 1. Immer wenn es über 4 liegt, prüfe 8.", "not at any time"),
        ("Check 1, up to 3 attempts.", "does not understand `attempts`"),
        ("Check 4 with priority 1, check 8 with priority 2.", "the highest or the lowest"),
        ("Check 1. Repeat the reading twice.", "once more in any case"),
        ("Check 1 and 5. If either 1 and 5 is abnormal, check 8.", "does not understand `either`"),
        ("Check #1, then #4 unless #1 was abnormal.", "the last of these only"),
        (
            "Check all gauges except #1 and all valves.",
            "a further exception, or a further checkpoint",
        ),
        ("Check #1 now and again at the end.", "at another time"),
        ("Prüfe #1 und noch einmal am Ende.", "at another time"),
        ("Already done:\n- check 4\nStill to do:\n- check 8", "are not tasks"),
        ("Check 8.\n\n# Postponed\n- check 4", "are not tasks"),
        ("Prüfe 8.\n\nSchon erledigt:\n- prüfe 4", "are not tasks"),
        (
            "Check 1. If it fails, skip it. If it fails, end the mission.",
            "already says what to do if it fails",
        ),
        ("Go to (1, 2, 0) heading -1e999 degrees.", "too large a number"),
        ("Check 1. Go on here for at most 10 minutes. Check 4.", "a time limit"),
        ("Check 4 not before 5 min. Unless it is too late by importance: check 1.", "condition"),
        (
            "Check #1. If #1 is above 5, wait 10 s. If it fails, check #3; otherwise check #4.",
            "needs a condition before it",
        ),
        *(
            (f"{kind}\n1\n3", f"checkpoint 3, one more of the `{kind}` above")
            for kind in ("Pressure gauges", "Manometer")
        ),
        *(
            (
                f"Daily round\n\nCheck checkpoint 1.\n\n{line}\n\nCheck checkpoint 8.",
                "or have no meaning",
            )
            for line in ("4", "four", "  4")
        ),
    ],
)
def test_what_has_no_clear_place_or_meaning_is_asked_about(
    text: str, asked: str, catalog: Catalog
) -> None:
    with pytest.raises(DiagnosticError, match=asked):
        read(text, catalog)


@pytest.mark.parametrize(
    "text",
    [
        "Start in starting area 1.\nCheck #4. If it is above 5, check #6 and, in any case, #7.",
        "Start in starting area 1.\nCheck #4. Go to the docking station of starting area 1, not 1.",
        "Start in starting area 1.\nCheck #4. Repeat step 2 in reverse order.",
        *(f"Start in starting area 1. Check {name}." for name in ("TG 4", "V 4", "PG R12")),
        *(
            f"{line}\n\n1. Start in starting area 1.\n2. Check #1."
            for line in (
                "Check the pump house",
                "Check pump house valve",
                "Watch the pump if it leaks",
            )
        ),
    ],
)
def test_what_makes_no_sense_is_refused(text: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError):
        import_whole(text, catalog)


@pytest.mark.parametrize("text", ["Check #1, report it.", "Check #1, then go on. Check #4."])
def test_what_is_done_anyway_has_no_effect(text: str, catalog: Catalog) -> None:
    found = import_whole(f"{START}{text}", catalog).diagnostics
    assert [d.code for d in found] == ["script.no-effect"]


def test_steps_that_are_repeated_apart_from_the_line_that_says_so(catalog: Catalog) -> None:
    text = "1. Start in starting area 1.\n2. Check #1.\n3. Check #4.\n4. Repeat step {}."
    there = import_whole(text.format("2 twice"), catalog)
    assert [d.code for d in there.diagnostics] == ["script.repeated-there"]
    assert measured_in(there.mission) == ["1", "4"]
    assert measured_in(import_whole(text.format("2 again"), catalog).mission) == ["1", "4", "1"]
    assert not import_whole(text.format("3 twice"), catalog).diagnostics
    home = text.replace("3. Check #4", "3. Return to the docking station in starting area 1")
    assert not import_whole(home.format("2 twice"), catalog).diagnostics


def test_what_comes_before_what_is_said_as_an_order(catalog: Catalog) -> None:
    mission = read("Check 18, 7 and 9 in any order. Check 7 before checking 18.", catalog)
    assert mission.before == (("MEASURE 7", "MEASURE 18"),)


@pytest.mark.parametrize(
    "text", ["Check all level gauges on floors 1 and 4.", "On floors 1, 2 and 4, check #1 and #5."]
)
def test_a_floor_without_any_is_named(text: str, catalog: Catalog) -> None:
    found = import_whole(f"Start in area 1.\n{text}", catalog)
    assert [d.code for d in found.diagnostics] == ["script.empty-floor"]
    assert "floor 4" in found.diagnostics[0].message


def test_what_fails_behind_a_case_that_asks_of_the_same(catalog: Catalog) -> None:
    text = (
        "1. Check #1.\n2. Check #2. If it fails, return to the docking station.\n"
        "3. Check #1.\n   In all other cases go on.\n"
        "   If checkpoint #1 is unreadable, go to step 1.\n"
        "   If it fails, return to the docking station.\n4. Check #4."
    )
    assert read(text, catalog).tasks[3].on_failure is OnFailure.RETURN


@pytest.mark.parametrize(
    ("text", "code", "named"),
    [
        ("Check #1. If it is above 2 or below 4, check #4.", "always-holds", "every value"),
        ("Check #1. If it is above 2 or not above 2, check #4.", "always-holds", "every value"),
        ("Check checkpoints 5, 6, 6 and 7.", "listed-twice", "#6"),
        ("Check valve R12, checkpoint 4 and checkpoint 5.", "listed-twice", "#5"),
        ("Check #1. If there is time left, check #4.", "no-time-limit", "always time"),
    ],
)
def test_what_is_odd_is_a_warning(text: str, code: str, named: str, catalog: Catalog) -> None:
    (found,) = import_whole(f"{START}{text}", catalog).diagnostics
    assert (found.code, found.severity) == (f"script.{code}", Severity.WARNING)
    assert named in found.message


@pytest.mark.parametrize(
    "text",
    [
        "Check #1. If it is below 2 or above 4, check #4.",
        "Check #1 and #4. If #1 is above 2 or #4 is below 4, check #8.",
        "Maximum duration: 20 min\nCheck #1. If there is time left, check #4.",
        "Check #1 within 10 minutes. If there is time left, check #4.",
        "Check #5. Check #5 again.",
    ],
)
def test_what_is_not_odd_is_none(text: str, catalog: Catalog) -> None:
    assert not import_whole(f"{START}{text}", catalog).diagnostics


@pytest.mark.parametrize(
    "title", ["Depressurising line 7 - follow-up by robot", "Füllstand Kolonne beobachten"]
)
def test_a_title_with_the_words_of_an_order_is_a_warning(title: str, catalog: Catalog) -> None:
    text = f"{title}\n\n1. Start in starting area 1.\n2. Check #1."
    script = import_whole(text, catalog, source_name="script")
    assert [t.name for t in script.mission.tasks][-1:] == ["MEASURE 1"]
    (warning,) = [d for d in script.diagnostics if d.severity is Severity.WARNING]
    assert "adds no task" in warning.message


@pytest.mark.parametrize("name", ['"a*b"', "\u201ca*b\u201d", '"*a* b"'])
def test_stars_in_a_name_are_kept(name: str, catalog: Catalog) -> None:
    assert read(f"{name}: check #1.", catalog).tasks[-1].name == name[1:-1]


@pytest.mark.parametrize(
    "said",
    [
        "Return to dock 2.",
        "Return to the docking station in starting area 2.",
        "Return to the dock (area 2).",
    ],
)
def test_a_dock_by_its_number_is_that_of_the_area(said: str, catalog: Catalog) -> None:
    assert read(f"Check #1. {said}", catalog).end_area == 2
