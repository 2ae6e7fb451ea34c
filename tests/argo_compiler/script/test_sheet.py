"""Sheets: fields, areas, steps, and what is wrong with them."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Severity
from argo_compiler.il import Mission, Mode, Order
from tests.argo_compiler.script.conftest import findings, only
from tests.whole_scripts import import_whole

HEADER = """\
Mission's designation: Mission #7
Main mode: Autonomous
Maximum mission total duration: 20'
Initial position: docked in "Starting area" 1
End of the mission: docked in "Starting area" 2
"""
ORDER = "Control the checkpoints in this precise order:\n"
STEP = "1. Checkpoint #4: read the position of valve R25\n"
SHEET = HEADER + ORDER + STEP


def mission(text: str, catalog: Catalog) -> Mission:
    return import_whole(text, catalog).mission


def test_a_sheet_that_fixes_its_areas_needs_no_options(catalog: Catalog) -> None:
    result = import_whole(SHEET, catalog)
    assert result.diagnostics == ()
    assert (result.mission.start_area, result.mission.end_area) == (1, 2)
    assert import_whole(SHEET, catalog, start_area=1, end_area=2) == result


def test_case_and_blanks_make_no_difference(catalog: Catalog) -> None:
    expected = [t.name for t in mission(SHEET, catalog).tasks]
    assert [t.name for t in mission(SHEET.upper(), catalog).tasks] == expected
    assert [t.name for t in mission(SHEET.replace(" ", "  "), catalog).tasks] == expected
    assert [t.name for t in mission(SHEET.replace("\n", " \r\n\r\n"), catalog).tasks] == expected


def test_modes_and_orders(catalog: Catalog) -> None:
    assert mission(SHEET.replace("Autonomous", "Supervisory"), catalog).mode is Mode.SUPERVISORY
    any_order = HEADER + "Visit the checkpoints in any order\n" + STEP
    assert mission(any_order, catalog).order is Order.ANY


def test_cells_gather_the_lines_around_their_label(catalog: Catalog) -> None:
    text = SHEET.replace(
        "Initial position: docked",
        "Anomaly specification:\tAll that is\n"
        "\tunusual.\n"
        "\tThis line ends, so it stays above.\n"
        "\tEverything is written down\n"
        "Real-time reporting:\tat once\n"
        "After-mission report:\tA list.\n"
        "\tThe robot waits\n"
        "Initial position:\tand is docked",
    )
    result = import_whole(text, catalog)
    assert result.diagnostics == ()
    assert result.mission.anomaly_specification == (
        "All that is unusual. This line ends, so it stays above."
    )
    assert result.mission.real_time_reporting == "Everything is written down at once"
    assert result.mission.after_mission_report == "A list."


def test_a_sentence_that_ends_in_order_is_not_the_order(catalog: Catalog) -> None:
    text = "Anomaly specification: a gauge that is\n\tout of order\n" + SHEET
    assert mission(text, catalog).anomaly_specification == "a gauge that is out of order"


def test_the_same_checkpoint_twice_gets_two_names(catalog: Catalog) -> None:
    tasks = mission(SHEET + STEP.replace("1.", "2."), catalog).tasks
    assert [t.name for t in tasks][1:3] == ["MEASURE 4", "MEASURE 4 (2)"]
    assert tasks[1].transitions[0].target == "MEASURE 4 (2)"


# ---- areas


def test_an_area_that_the_sheet_does_not_offer(catalog: Catalog) -> None:
    assert only(SHEET, catalog, start_area=2) == ("script.area-not-offered", 4, 45, 1)
    assert only(SHEET, catalog, end_area=1) == ("script.area-not-offered", 5, 47, 1)
    either = SHEET.replace('area" 1', 'area" 1 or 2')
    assert only(either, catalog, start_area=3) == ("script.area-not-offered", 4, 45, 1)
    assert import_whole(either, catalog, start_area=2).mission.start_area == 2


def test_an_or_that_leads_to_no_area(catalog: Catalog) -> None:
    text = SHEET.replace('area" 1', 'area" 1 or so')
    assert findings(text, catalog)[0].code == "script.not-understood"


@pytest.mark.parametrize(
    ("said", "code"), [("0 or 9999999", "number"), ("one", ""), ("x", "not-understood")]
)
def test_numbers_of_areas(said: str, code: str, catalog: Catalog) -> None:
    codes = [d.code for d in findings(SHEET.replace('area" 1', f'area" {said}'), catalog)]
    assert codes == ([f"script.{code}"] if code else [])


def test_a_sheet_without_areas_takes_any_that_the_options_name(catalog: Catalog) -> None:
    text = "\n".join(line for line in SHEET.split("\n") if "area" not in line)
    codes = [d.code for d in findings(text, catalog)]
    assert codes == ["script.no-start"]
    result = import_whole(text, catalog, start_area=2, end_area=1)
    assert (result.mission.start_area, result.mission.end_area) == (2, 1)
    assert result.diagnostics == ()
    undocked = import_whole(text, catalog, start_area=2)
    assert undocked.mission.end_area is None
    assert [t.name for t in undocked.mission.tasks] == ["START", "MEASURE 4"]
    assert undocked.diagnostics == ()


# ---- errors


@pytest.mark.parametrize(
    ("step", "code", "column", "length"),
    [
        ("2. Checkpoint #21: read the value on valve R1", "unknown-checkpoint", 4, 14),
        ("2. Checkpoint #4: read the position of valve R12", "checkpoint-mismatch", 40, 9),
        ("2. Checkpoint #4: read the position of valve R26", "unknown-checkpoint", 40, 9),
        ("2. Checkpoint #1: sing a song", "not-understood", 19, 4),
        ("2. Checkpoint #1: read the value on", "unfinished", 36, 1),
        ("2. Checkpoint 9999999", "unknown-checkpoint", 4, 18),
        ("2. Take a picture", "not-understood", 4, 4),
        ("Battery: full", "unknown-label", 1, 7),
        ("Nothing that belongs here", "not-understood", 1, 7),
        ("Main mode: supervisory", "repeated-field", 12, 11),
        ("Real-time reporting 3", "not-understood", 1, 9),
    ],
)
def test_errors_and_their_places(
    step: str, code: str, column: int, length: int, catalog: Catalog
) -> None:
    assert only(SHEET + step, catalog) == (f"script.{code}", 8, column, length)


@pytest.mark.parametrize(
    ("right", "wrong", "found"),
    [
        *(
            ("20'", said, ("duration", 3, 33, len(said)))
            for said in ("0'", "10 min 20 min", "5 s 1 h")
        ),
        ('area" 1', 'area" 5', ("unknown-area", 4, 45, 1)),
        ('docked in "Starting area" 1', "somewhere", ("unknown-place", 4, 19, 9)),
        ('docked in "Starting area" 1', "docked in its docking station", ("no-area", 4, 19, 29)),
        ("#4", "#1\t4", ("ambiguous-cut", 7, 16, 3)),
        ("the position of", "the level of", ("quantity", 7, 37, 9)),
    ],
)
def test_one_change_is_one_finding(
    right: str, wrong: str, found: tuple[str, int, int, int], catalog: Catalog
) -> None:
    code, *place = found
    assert only(SHEET.replace(right, wrong), catalog) == (f"script.{code}", *place)


def test_a_mismatch_names_both_candidates(catalog: Catalog) -> None:
    (error,) = findings(SHEET.replace("R25", "R12"), catalog)
    assert error.message == "checkpoint #4 is valve R25, and valve R12 is checkpoint #5"


def test_an_unknown_number_shows_the_nearest(catalog: Catalog) -> None:
    (error,) = findings(SHEET.replace("#4", "#99"), catalog)
    assert error.hint == "the nearest numbers are #18, #19 and #20"


def test_every_bad_step_is_one_error_in_the_order_of_the_lines(catalog: Catalog) -> None:
    bad = ["2. Checkpoint #21", "3. Dance", "4. Checkpoint #4: read the position of valve R7"]
    errors = findings(SHEET + "\n".join(bad), catalog)
    assert [(d.code, d.span.line) for d in errors if d.span] == [
        ("script.unknown-checkpoint", 8),
        ("script.not-understood", 9),
        ("script.checkpoint-mismatch", 10),
    ]


def test_a_sheet_without_checkpoints(catalog: Catalog) -> None:
    assert [d.code for d in findings(HEADER + ORDER, catalog)] == ["script.nothing-to-do"]


# ---- warnings


@pytest.mark.parametrize(
    ("right", "wrong"),
    [
        ("checkpoint #4", "chekpoint #4"),
        ("position of", "postion of"),
        ("valve R25", "vavle R25"),
        ("precise order", "precice order"),
        ("Main mode", "Mian mode"),
        ("Initial", "Intial"),
    ],
)
def test_a_misspelt_word_is_a_warning(right: str, wrong: str, catalog: Catalog) -> None:
    text = SHEET.replace("Checkpoint", "checkpoint")
    assert right in text
    result = import_whole(text.replace(right, wrong), catalog)
    (warning,) = result.diagnostics
    assert warning.code == "script.respelled"
    assert warning.severity is Severity.WARNING
    meant = next(a for a, b in zip(right.split(), wrong.split(), strict=True) if a != b)
    misspelt = next(b for a, b in zip(right.split(), wrong.split(), strict=True) if a != b)
    assert warning.message == f"read `{misspelt}` as `{meant.lower()}`"
    assert [t.name for t in result.mission.tasks] == ["START", "MEASURE 4", "DOCK"]


def test_identifiers_are_never_respelled(catalog: Catalog) -> None:
    text = SHEET.replace("#4: read the position of valve R25", "#5: read the position of valve R13")
    assert only(text, catalog)[0] == "script.unknown-checkpoint"


def test_a_gap_in_the_numbers_is_a_warning(catalog: Catalog) -> None:
    text = SHEET + "3. Checkpoint #1: read the value on pressure gauge 1"
    assert only(text, catalog) == ("script.step-number", 8, 4, 49)
