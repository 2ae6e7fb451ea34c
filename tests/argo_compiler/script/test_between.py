"""A wait between two tasks that are neighbours: `Between #1 and #3, wait for 5 minutes.`"""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import format_script
from tests.argo_compiler.script.conftest import refusals
from tests.mission_writing import unplaced
from tests.whole_scripts import import_whole

PLAN = "Start in starting area 1.\n1. Check #1.\n2. Check #3.\n3. Check #4.\n"
EXPECTED = ["START", "MEASURE 1", "WAIT", "MEASURE 3", "MEASURE 4"]


def tasks(script: str, catalog: Catalog) -> list[str]:
    return [task.name for task in import_whole(script, catalog).mission.tasks]


@pytest.mark.parametrize(
    "line",
    [
        "Between #1 and #3, wait for 5 minutes.",
        "Between checkpoints 1 and 3: wait 5 minutes.",
        "Between pressure gauge 1 and the checkpoint #3, pause for 5 minutes.",
        "Wait 5 minutes between #1 and #3.",
        "Between steps 1 and 2, wait 5 minutes.",
        "Between step 1 and step 2, wait 5 minutes.",
        "Zwischen #1 und #3 5 Minuten warten.",
        "Zwischen Checkpoint 1 und Checkpoint 3 fünf Minuten warten.",
        "Warte 5 Minuten zwischen #1 und #3.",
        "Zwischen Schritt 1 und Schritt 2 5 Minuten warten.",
    ],
)
def test_the_wait_is_put_between_the_two(line: str, catalog: Catalog) -> None:
    mission = import_whole(f"{PLAN}4. {line}", catalog).mission
    assert [task.name for task in mission.tasks] == EXPECTED
    assert mission.tasks[2].wait is not None
    assert mission.tasks[2].wait.duration == 300
    again = import_whole(format_script(mission, catalog), catalog).mission
    assert unplaced(again) == unplaced(mission)


def test_steps_are_named_by_the_names_of_their_tasks(catalog: Catalog) -> None:
    lines = 'Start in starting area 1.\n"one": check #1.\n"two": check #3.\n'
    line = 'Between steps "one" and "two", wait 5 minutes.'
    assert tasks(lines + line, catalog) == ["START", "one", "WAIT", "two"]


def test_the_wait_may_have_a_name(catalog: Catalog) -> None:
    assert tasks(f'{PLAN}4. "rest": wait 90 s between #1 and #3.', catalog)[2] == "rest"


def test_a_round_that_ends_or_begins_there_does_not_contain_the_wait(catalog: Catalog) -> None:
    lines = "4. Repeat step 1 twice.\n5. Between #1 and #3, wait 5 minutes."
    (group,) = import_whole(PLAN + lines, catalog).mission.groups
    assert (group.start, group.end) == ("MEASURE 1", "MEASURE 1")


@pytest.mark.parametrize("behind", [True, False])
def test_a_round_of_both_contains_the_wait(behind: bool, catalog: Catalog) -> None:
    lines = ["Between #1 and #3, wait 5 minutes.", "Repeat steps 1 to 2 twice."]
    numbered = [f"{i}. {line}" for i, line in enumerate(lines[:: -1 if behind else 1], start=4)]
    mission = import_whole(PLAN + "\n".join(numbered), catalog).mission
    assert [task.name for task in mission.tasks] == EXPECTED
    assert [(g.start, g.end) for g in mission.groups] == [("MEASURE 1", "MEASURE 3")]


def test_it_comes_after_a_condition_of_the_first_step(catalog: Catalog) -> None:
    script = "Start in starting area 1.\n1. Check #1. If it is above 4, check #8.\n2. Check #3.\n"
    script += "3. Between steps 1 and 2, wait 5 minutes."
    assert tasks(script, catalog)[-4:] == ["MEASURE 1", "MEASURE 8", "WAIT", "MEASURE 3"]


@pytest.mark.parametrize(
    ("lines", "code", "place"),
    [
        ("Between #1 and #4, wait 5 minutes.", "not-neighbours", "#1 and #4"),
        ("Zwischen #1 und #4 5 Minuten warten.", "not-neighbours", "#1 und #4"),
        ("Between #3 and #1, wait 5 minutes.", "not-neighbours", "#3 and #1"),
        ("Between #1 and #1, wait 5 minutes.", "not-neighbours", "#1 and #1"),
        ("Between #1, #3 and #4, wait 5 minutes.", "not-neighbours", "#1, #3 and #4"),
        ("Between #1 or #3, wait 5 minutes.", "ambiguous-or", "#1 or #3"),
        ("Between #1 and #8, wait 5 minutes.", "not-planned", "#1 and #8"),
        ("Check #1.\n5. Between #1 and #3, wait 5 minutes.", "ambiguous-edit", "#1 and #3"),
        ("Between #1 and #3, wait.", "wait", "wait"),
        ("Between #1 and #3, wait 5 minutes if it is above 4.", "stray-clause", "wait 5 minutes"),
        ("Between #1 and #3, wait until it is below 4.", "stray-clause", "wait until it"),
        ("Between #1 and #3, check #8.", "stray-clause", "check #8"),
        (
            "Wait 5 minutes in starting area 2 between #1 and #3.",
            "not-understood",
            "in",
        ),
        (
            "Wait at the front of the site for 5 minutes between #1 and #3.",
            "stray-clause",
            "Wait at the front of the site for 5 minutes between #1 and #3",
        ),
        ("Wait 5 minutes, and between #1 and #3, check #8.", "not-understood", ", and"),
        ("If #1 is above 4, wait 5 minutes between #1 and #3.", "route", "wait 5 minutes between"),
        ("Between #1 and #3, wait 5 minutes.\n5. Delete #3.", "not-neighbours", "wait 5 minutes"),
        ("Wait 90 s between #1 and #3.\n5. The order is free.", "not-neighbours", "Wait 90 s"),
        (
            "Wait 90 s between #1 and #3.\n5. Between #1 and #3, wait 5 minutes.",
            "not-neighbours",
            "#1 and #3",
        ),
    ],
)
def test_what_is_refused(lines: str, code: str, place: str, catalog: Catalog) -> None:
    script = f"{PLAN}4. {lines}"
    (error,) = refusals(script, catalog)
    assert error.code == f"script.{code}"
    assert error.hint
    assert error.span is not None
    assert script.split("\n")[error.span.line - 1][error.span.column - 1 :].startswith(place)


def test_the_message_names_the_task_that_comes_between(catalog: Catalog) -> None:
    (error,) = refusals(f"{PLAN}4. Between #1 and #4, wait 5 minutes.", catalog)
    assert error.message.endswith("`MEASURE 3` (line 3) comes between")


def test_a_wait_that_the_mission_may_pass_by_is_refused(catalog: Catalog) -> None:
    script = (
        "Start in starting area 1.\n1. Check #1. If it is above 4, go to step 2.\n2. Check #3.\n"
    )
    script += "3. Between steps 1 and 2, wait 5 minutes."
    (error,) = refusals(script, catalog)
    assert error.code == "script.bound-task"
