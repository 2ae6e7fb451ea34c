"""Protocols: commands, edits, options, and what is wrong with them."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Remedy
from argo_compiler.diagnostics import Severity
from argo_compiler.il import Action
from tests.argo_compiler.script.conftest import findings, measured, only
from tests.whole_scripts import import_whole

START = "Mission Protocol #9\n1. Set a starting point in starting area 1\n"


def steps(*lines: str) -> str:
    return START + "".join(f"{i}. {line}\n" for i, line in enumerate(lines, start=2))


@pytest.mark.parametrize(
    "step",
    [
        "Check the checkpoint #14",
        "measure checkpoint 14.",
        "Read checkpoint # 14",
        "Inspect checkpoint fourteen",
        "Check valve R18",
        "Read the position of the valve r18",
        "Let the robot control checkpoint #14",
        "Add checkpoint #14",
        "Insert the measuring of checkpoint #14!",
    ],
)
def test_ways_to_ask_for_a_measurement(step: str, catalog: Catalog) -> None:
    result = import_whole(steps(step, "Done!"), catalog)
    assert result.diagnostics == ()
    assert [t.name for t in result.mission.tasks] == ["START", "MEASURE 14"]
    assert result.mission.start_area == 1


@pytest.mark.parametrize(
    ("step", "floor", "count", "duration"),
    [
        ("Patrol the second floor in circles for 10 minutes", 2, 0, 600),
        ("Let the robot patrol the 3rd floor in circles for 10 min", 3, 0, 600),
        ("Patrol floor 2 three times", 2, 3, 0),
        ("Patrol floor six 3 times in circles", 6, 3, 0),
        ("Patrol the first floor for 10 minutes or three times", 1, 3, 600),
        ("Patrol the first floor twice or for 1 h 30 min", 1, 2, 5400),
        ("Patrol the first floor for 10 minutes or 3 rounds", 1, 3, 600),
        ("Patrol the first floor in circles for two rounds", 1, 2, 0),
    ],
)
def test_patrols(step: str, floor: int, count: int, duration: float, catalog: Catalog) -> None:
    result = import_whole(steps(step), catalog)
    assert result.diagnostics == ()
    (group,) = result.mission.groups
    assert group.name == f"Patrol floor {floor}"
    assert (group.max_repeat_count, group.max_repeat_duration) == (count, duration)
    expected = next(f.patrol for f in catalog.floors if f.number == floor)
    assert tuple(t.pose for t in result.mission.tasks if t.group) == expected


def test_two_patrols_and_a_waypoint_have_names_of_their_own(catalog: Catalog) -> None:
    patrol = "Patrol the first floor twice"
    mission = import_whole(
        steps(patrol, "Go to the front of the UMAD site", patrol), catalog
    ).mission
    assert [g.name for g in mission.groups] == ["Patrol floor 1", "Patrol floor 1 (2)"]
    names = [t.name for t in mission.tasks]
    assert names == ["START", *(f"WAYPOINT {i}" for i in range(1, 10))]
    assert mission.tasks[5].group == ""
    assert [(g.start, g.end) for g in mission.groups] == [
        ("WAYPOINT 1", "WAYPOINT 4"),
        ("WAYPOINT 6", "WAYPOINT 9"),
    ]


def test_edits_are_carried_out_in_order(catalog: Catalog) -> None:
    text = steps(
        "Check checkpoint #14",
        "Add checkpoint #2 after checkpoint #14",
        "Check checkpoint #7 and check checkpoint #8",
        "Delete the measuring of checkpoint #2 and add the checkpoint #2 before checkpoint #14",
        "Remove checkpoint #7 and then insert valve R25 before pressure gauge 5",
    )
    assert measured(text, catalog) == ["2", "14", "4", "8"]


def test_a_waypoint_that_is_about_an_object_is_moved_and_deleted_like_any_other(
    catalog: Catalog,
) -> None:
    lines = [
        "Mission Protocol",
        "Start here",
        '"gate": go to (1, 2, 0), about object "8"',
        "Check checkpoint #1",
        "Check checkpoint #8",
        'Move step "gate" after checkpoint #1',
        "Move checkpoint #8 before checkpoint #1",
    ]
    moved = import_whole("\n".join(lines), catalog).mission
    assert [t.name for t in moved.tasks] == ["START", "MEASURE 8", "MEASURE 1", "gate"]
    left = import_whole("\n".join([*lines, 'Delete step "gate"']), catalog).mission
    assert [t.name for t in left.tasks] == ["START", "MEASURE 8", "MEASURE 1"]


def test_a_hint_is_kept_and_does_nothing(catalog: Catalog) -> None:
    text = steps("Check checkpoint #1") + "   Hint: at least 3 robots were here\n"
    (note,) = import_whole(text, catalog).diagnostics
    assert (note.code, note.severity) == ("script.comment", Severity.NOTE)
    assert note.span is not None
    assert (note.span.line, note.span.column, note.span.length) == (4, 4, 33)


# ---- where it starts and ends


def test_the_way_home(catalog: Catalog) -> None:
    text = steps("Check checkpoint #1", "Return to the docking station")
    assert import_whole(text, catalog).mission.end_area == 1  # where it starts
    mission = import_whole(text, catalog, end_area=2).mission
    assert [t.name for t in mission.tasks] == ["START", "MEASURE 1", "DOCK"]
    assert mission.tasks[-1].action is Action.WAYPOINT
    assert mission.end_area == 2
    named = steps("Check checkpoint #1", "Return to the docking station in starting area 2")
    at_home = import_whole(named, catalog).mission
    assert [(t.name, t.pose) for t in at_home.tasks] == [(t.name, t.pose) for t in mission.tasks]
    assert at_home.end_area == 2
    assert only(named, catalog, end_area=1) == ("script.area-conflict", 4, 18, 34)


def test_a_dock_is_appended_where_the_option_asks_for_it(catalog: Catalog) -> None:
    mission = import_whole(steps("Check checkpoint #1"), catalog, end_area=1).mission
    assert [t.name for t in mission.tasks] == ["START", "MEASURE 1", "DOCK"]
    assert mission.tasks[-1].source is None


def test_driving_to_a_starting_area_is_not_docking(catalog: Catalog) -> None:
    text = steps("Drive to starting area 2", "Check checkpoint #1")
    mission = import_whole(text, catalog).mission
    assert [t.name for t in mission.tasks] == ["START", "WAYPOINT 1", "MEASURE 1"]
    assert mission.end_area is None


def test_the_start_option(catalog: Catalog) -> None:
    text = steps("Check checkpoint #1")
    assert import_whole(text, catalog, start_area=1).mission.start_area == 1
    assert only(text, catalog, start_area=2) == ("script.area-conflict", 2, 4, 39)
    front = text.replace("in starting area 1", "in front of the site")
    assert only(front, catalog, start_area=1)[0] == "script.area-conflict"
    without = "Mission Protocol\n1. Check checkpoint #1"
    assert import_whole(without, catalog, start_area=2).mission.start_area == 2
    (error,) = findings(without, catalog)
    assert error.code == "script.no-start"
    assert error.hint is not None
    assert "choose area 1 or 2" in error.hint
    assert error.remedies == (Remedy.CHOOSE_START,)


# ---- errors


@pytest.mark.parametrize(
    ("step", "code", "column", "length"),
    [
        ("Add checkpoint #2 after checkpoint #3", "not-planned", 28, 13),
        ("Delete checkpoint #2", "not-planned", 11, 13),
        ("Delete checkpoint #1", "ambiguous-edit", 11, 13),
        ("Check checkpoint #21", "unknown-checkpoint", 10, 14),
        ("Check valve R26", "unknown-checkpoint", 10, 9),
        ("Patrol the ninth floor twice", "unknown-floor", 15, 5),
        ("Patrol the first floor", "endless-patrol", 4, 22),
        ("Patrol the first floor zero times", "not-understood", 27, 4),
        ("Patrol the first floor 0 times", "rounds", 4, 30),
        ("Patrol the first floor for 0 min", "duration", 27, 9),
        ("Go to the moon", "unknown-place", 14, 4),
        ("Drive to starting area 3", "unknown-area", 13, 15),
        ("Set a starting point in starting area 2", "second-start", 4, 39),
        ("Fly away", "not-understood", 4, 3),
        ("Check checkpoint #3 quickly", "not-understood", 24, 7),
        ("Check", "unfinished", 9, 1),
        ("Check checkpoint #3 § #4", "not-understood", 24, 1),
    ],
)
def test_errors_and_their_places(
    step: str, code: str, column: int, length: int, catalog: Catalog
) -> None:
    text = START + "2. Check checkpoint #1\n3. Check checkpoint #1\n4. " + step
    assert only(text, catalog) == (f"script.{code}", 5, column, length)


def test_what_comes_after_the_end(catalog: Catalog) -> None:
    text = steps("Check checkpoint #1", "Done!", "Check checkpoint #2")
    assert only(text, catalog) == ("script.after-done", 5, 4, 19)
    text = steps("Return to the docking station in starting area 1", "Check checkpoint #2")
    assert only(text, catalog) == ("script.after-docking", 4, 4, 19)


def test_an_edit_of_what_was_not_understood_is_no_second_error(catalog: Catalog) -> None:
    text = steps("Chuck away #14", "Add checkpoint #2 after checkpoint #14")
    assert only(text, catalog)[1] == 3


@pytest.mark.parametrize(
    "text",
    [
        "Mission Protocol #2",
        START,
        START + "2. Done!",
        steps("Check checkpoint #1", "Delete checkpoint #1"),
    ],
)
def test_nothing_to_do(text: str, catalog: Catalog) -> None:
    assert [d.code for d in findings(text, catalog)] == ["script.nothing-to-do"]


# ---- warnings


def test_misspelt_words_are_warnings(catalog: Catalog) -> None:
    text = """\
Mission Protocol #2
1. Set a strating point in frnt of the site
2. Patrol the secnd floor in cirlces for 10 minuts
3. Mesure chekpoint #14
"""
    result = import_whole(text, catalog)
    assert [(d.code, d.span.line, d.span.column) for d in result.diagnostics if d.span] == [
        ("script.respelled", 2, 10),
        ("script.respelled", 2, 28),
        ("script.respelled", 3, 15),
        ("script.respelled", 3, 30),
        ("script.respelled", 3, 45),
        ("script.respelled", 4, 4),
        ("script.respelled", 4, 11),
    ]
    assert result.diagnostics[1].message == "read `frnt` as `front`"
    assert [t.name for t in result.mission.tasks][-1] == "MEASURE 14"
