"""The fields of a header: each value is understood as a whole, or refused at its place."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Diagnostic, Severity
from argo_compiler.il import Action, Mission, Mode, Order
from tests.argo_compiler.script.conftest import findings, refusals
from tests.whole_scripts import import_whole

STEPS = "1. Check #4\n"
START = "Start: area 1\n"


def mission(header: str, catalog: Catalog) -> Mission:
    return import_whole(header + "\n" + STEPS, catalog).mission


def faults(text: str, catalog: Catalog) -> list[Diagnostic]:
    return [d for d in findings(text, catalog) if d.severity is not Severity.NOTE]


@pytest.mark.parametrize(
    "header",
    [
        "Start: area 1",
        "Start: starting area 1.",
        "Start area: 1",
        "Initial position: docked in “Starting area” 1, which the team is told on the day",
        "Initial position: The robot is parked in its docking station in starting area 1",
        "Starting point: in area one",
        "START: AREA 1",
    ],
)
def test_starts(header: str, catalog: Catalog) -> None:
    assert mission(header, catalog).start_area == 1


def test_other_places_to_start_and_to_finish_at(catalog: Catalog) -> None:
    found = mission("Start: at the front of the site\nFinish: at the front of the site", catalog)
    place = catalog.find_place("front of the site")
    assert place is not None
    assert [t.pose for t in found.tasks if t.action is not Action.MEASURE] == [place.pose] * 2


def test_fields_in_one_line(catalog: Catalog) -> None:
    found = mission("Start: area 1, end: area 2. Maximum time: half an hour", catalog)
    assert (found.start_area, found.end_area, found.max_duration) == (1, 2, 1800)


def test_all_other_fields(catalog: Catalog) -> None:
    header = """\
Designation: Mission #1
Mode: supervisory
Order: in any order
Maximum duration: none
Anomaly specification: anything outside the normal values.
Site: "other"
Start area: 1, as planned
End area: none
Dock: (3.05, -2.55, 0.0) heading 90 degrees
Left out: "MEASURE 8", "MEASURE 14"
Subject: the weekly tour"""
    found = mission(header, catalog)
    assert (found.designation, found.mode, found.order) == (
        "Mission #1",
        Mode.SUPERVISORY,
        Order.ANY,
    )
    assert (found.max_duration, found.site) == (None, "other")
    assert found.anomaly_specification == "anything outside the normal values."
    assert (found.start_area, found.end_area) == (1, None)
    assert found.dock is not None
    assert (found.dock.x, found.dock.y) == (3.05, -2.55)
    assert found.left_out == ("MEASURE 8", "MEASURE 14")


@pytest.mark.parametrize(
    ("field", "code", "column"),
    [
        ("Start: anywhere but starting area 2", "not-understood", 8),
        ("Start: starting area 1, not 2", "not-understood", 25),
        ("Start: starting area 1 or so", "not-understood", 24),
        ("Start: not in starting area 1", "not-understood", 8),
        ("Start: at the dock", "no-area", 8),
        ("Start: area 1 or 2", "area-choice", 13),
        ("Order: not in any order", "field", 8),
        ("Order: anyhow", "field", 8),
        ("Mode: unsupervised", "field", 7),
        ("Mode: autonomous or supervisory", "field", 7),
        ("Maximum duration: soon", "duration", 19),
        ("Maximum duration: not 20 min", "duration", 19),
        ("Maximum duration: 1.200 s", "ambiguous-duration", 19),
        ("Maximum duration:", "field", 1),
        ("Start area: 1 or 2", "field", 13),
        ("Dock: over there", "field", 7),
        ("Left out: MEASURE 8", "field", 11),
        ("Current: checkpoint", "field", 10),
        ("Battery: full", "unknown-label", 1),
        ("Author: check #8", "unknown-label", 1),
    ],
)
def test_what_is_no_value(field: str, code: str, column: int, catalog: Catalog) -> None:
    start = "" if "Start" in field else START
    (error,) = faults(start + field + "\n" + STEPS, catalog)
    assert error.code == f"script.{code}"
    assert error.span is not None
    assert (error.span.line, error.span.column) == (1 + bool(start), column)
    assert error.hint


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("Maximum duration: 20 min", "Maximum time: 30 min"),
        ("Maximum duration: 20 min", "Maximum time: none"),
        ("Order: any", "Order: precise"),
        ("Mode: autonomous", "Main mode: supervisory"),
        ("End: area 1", "End of the mission: docked in starting area 2"),
        ("End: none", "Finish: docked in starting area 2"),
        ("End area: 1", "End: area 2"),
    ],
)
def test_two_values_are_an_error_that_names_both(first: str, second: str, catalog: Catalog) -> None:
    (error,) = faults(f"{START}{first}\n{second}\n{STEPS}", catalog)
    assert error.code == "script.repeated-field"
    assert error.span is not None
    assert error.span.line == 3
    for field in (first, second):
        assert f"`{field.partition(': ')[2]}`" in error.message


def test_the_same_value_twice_is_none(catalog: Catalog) -> None:
    assert faults(f"{START}Maximum time: 20 min\nTime limit: 20'\n{STEPS}", catalog) == []


def test_a_misspelt_label_is_a_warning(catalog: Catalog) -> None:
    (warning,) = faults(f"{START}Maximun duration: 20 min\n{STEPS}", catalog)
    assert warning.message == "read `Maximun` as `maximum`"


def test_docks_that_are_chosen_later_are_asked_for(catalog: Catalog) -> None:
    text = f"The docks are chosen on the day.\n{STEPS}"
    assert [d.code for d in faults(text, catalog)] == ["script.area-choice"] * 2
    found = import_whole(text, catalog, start_area=1, end_area=2).mission
    assert (found.start_area, found.end_area) == (1, 2)


@pytest.mark.parametrize(
    "end",
    [
        "End of the mission: docking station",
        "End of the mission: docked in its docking station",
        "At the end, return to the docking station.",
        "At the end it goes back to its dock.",
    ],
)
def test_the_end_is_in_the_dock_of_the_start_if_no_area_is_named(
    end: str, catalog: Catalog
) -> None:
    text = f"Start in starting area 2.\n{end}\n1. Check #3.\n2. Check #5."
    found = import_whole(text, catalog).mission
    assert [task.action for task in found.tasks] == ["START", "MEASURE", "MEASURE", "WAYPOINT"]
    assert found.end_area == 2


@pytest.mark.parametrize(
    "text",
    [
        "Check #3.\nAt the end, return to the docking station.\nCheck #5.",
        "Finally, return to the docking station. Then check #3.",
        "At the end, return to the docking station if #3 is above 4.\nCheck #3.",
        "Do the following twice:\n- At the end, return to the docking station.\n- Check #3.",
    ],
)
def test_a_return_at_the_end_among_tasks_is_asked_about(text: str, catalog: Catalog) -> None:
    assert refusals(text, catalog)
