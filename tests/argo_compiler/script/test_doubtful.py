"""Sentences that leave something open: taken as they make sense, and said so, or asked about."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Severity
from argo_compiler.il import Mission
from argo_compiler.script import format_script
from tests.argo_compiler.script.conftest import measured, refusals
from tests.whole_scripts import import_whole

_ENGLISH = "1. Start in starting area 1.\n"
_GERMAN = "1. Start in Startbereich 1.\n"
_TWO = "2. Check #1.\n3. Check #4.\n"
_ZWEI = "2. Prüfe #1.\n3. Prüfe #4.\n"


def read(text: str, catalog: Catalog) -> tuple[Mission, set[str]]:
    """The mission, and the codes of what was warned of."""
    result = import_whole(text, catalog)
    warned = {d.code for d in result.diagnostics if d.severity is Severity.WARNING}
    return result.mission, warned


@pytest.mark.parametrize(
    ("text", "count", "assumed"),
    [
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 once", 2, True),
        (f"{_ENGLISH}{_TWO}4. Redo steps 2 to 3 one time", 2, True),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 for 10 minutes or once", 2, True),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 once more", 2, False),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 one more time", 2, False),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 once in total", 1, False),
        (f"{_ENGLISH}{_TWO}4. Run through steps 2 and 3 once in total", 1, False),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 twice in total", 2, False),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 twice", 2, False),
        (f"{_GERMAN}{_ZWEI}4. Schritte 2 und 3 einmal wiederholen", 2, True),
        (f"{_GERMAN}{_ZWEI}4. Wiederhole die Schritte 2 und 3 einmal", 2, True),
        (f"{_GERMAN}{_ZWEI}4. Wiederhole die Schritte 2 und 3 noch einmal", 2, False),
        (f"{_GERMAN}{_ZWEI}4. Wiederhole die Schritte 2 und 3 insgesamt einmal", 1, False),
    ],
)
def test_to_repeat_once(text: str, count: int, assumed: bool, catalog: Catalog) -> None:
    mission, warned = read(text, catalog)
    assert [group.max_repeat_count for group in mission.groups] == [count]
    assert ("script.once-more" in warned) == assumed
    again, warned = read(format_script(mission, catalog), catalog)
    assert [group.max_repeat_count for group in again.groups] == [count]
    assert not warned


@pytest.mark.parametrize(
    ("text", "code", "readings"),
    [
        (f"{_ENGLISH}{_TWO}4. Do steps 2 and 3 once", "repeat", ["once in total", "once more"]),
        (f"{_GERMAN}{_ZWEI}4. Führe die Schritte 2 und 3 einmal durch", "repeat", ["once more"]),
        (f"{_ENGLISH}2. Check #1 up to three times", "repeat", ["exact number", "maximum"]),
        (f"{_ENGLISH}2. Patrol floor 1 at most 3 times", "repeat", ["exact number", "maximum"]),
        (f"{_ENGLISH}{_TWO}4. Repeat steps 2 and 3 at most 3 times", "repeat", ["maximum"]),
        (f"{_GERMAN}2. Prüfe #1 höchstens dreimal", "repeat", ["exact number", "maximum"]),
        (f"{_GERMAN}2. Prüfe #1 bis zu dreimal", "repeat", ["exact number", "maximum"]),
        (f"{_ENGLISH}{_TWO}4. Return home after 20 minutes", "duration", ["wait", "the start"]),
        (f"{_ENGLISH}{_TWO}4. After 20 minutes, go home", "duration", ["wait", "the start"]),
        (f"{_ENGLISH}2. Go to starting area 2 after 5 minutes", "duration", ["wait"]),
        (f"{_ENGLISH}2. Return to the dock in area 2 after 5 minutes", "duration", ["wait"]),
        (f"{_GERMAN}{_ZWEI}4. Fahre nach 5 Minuten zu Startbereich 2", "duration", ["wait"]),
        (f"{_ENGLISH}{_TWO}4. If 1 or 4 are both abnormal, check #5", "and-or", ["one", "both"]),
        (f"{_ENGLISH}{_TWO}4. If #1 and #4 is either abnormal, check #5", "and-or", ["both"]),
        (f"{_ENGLISH}2. Check #1, and 4 only if 1 is above 4", "manner", ["last", "both"]),
        (f"{_ENGLISH}2. Check #1, and #4 if #1 is above 4", "manner", ["last", "both"]),
        (f"{_GERMAN}2. Prüfe #1, und #4 nur wenn #1 über 4 liegt", "manner", ["last", "both"]),
        (f"Test 12\n{_ENGLISH}{_TWO}", "title", ["title", "command"]),
        (f"Check 7\n\n{_ENGLISH}{_TWO}", "title", ["title", "command"]),
        (f"Test 12\n{_GERMAN}{_ZWEI}", "title", ["title", "command"]),
        (f"Prüfe 7\n{_GERMAN}{_ZWEI}", "title", ["title", "command"]),
    ],
)
def test_what_is_asked_about(text: str, code: str, readings: list[str], catalog: Catalog) -> None:
    errors = refusals(text, catalog)
    assert [error.code for error in errors] == [f"script.ambiguous-{code}"]
    assert all(reading in errors[0].message for reading in readings)
    assert errors[0].span is not None


@pytest.mark.parametrize(
    "text",
    [
        f"{_ENGLISH}2. Check #1 every 10 minutes, at most three times",
        f"{_ENGLISH}2. Check #1 for 10 minutes, at most three times",
        f"{_ENGLISH}2. Check #1 until it is above 4, at most three times",
        f"{_GERMAN}2. Prüfe #1 alle 10 Minuten, höchstens dreimal",
    ],
)
def test_at_most_so_often_with_what_ends_it(text: str, catalog: Catalog) -> None:
    mission, _ = read(text, catalog)
    assert [group.max_repeat_count for group in mission.groups] == [3]


@pytest.mark.parametrize(
    ("condition", "ways"),
    [
        ("either #1 or #4 is abnormal", 2),
        ("#1 or #4 is abnormal", 2),
        ("both #1 and #4 are abnormal", 1),
        ("#1 and #4 are both abnormal", 1),
    ],
)
def test_one_of_them_or_both(condition: str, ways: int, catalog: Catalog) -> None:
    mission, _ = read(f"{_ENGLISH}{_TWO}4. If {condition}, check #5", catalog)
    task = mission.task("MEASURE 4")
    assert task is not None
    assert sum(bool(way.conditions) for way in task.transitions) == ways


@pytest.mark.parametrize(
    "text", ["Check #7\n", "Morning test 12\n", "Behaviour, test 12\n", "Designation: Test 12\n"]
)
def test_lines_over_the_steps_that_are_clear(text: str, catalog: Catalog) -> None:
    found = measured(f"{text}{_ENGLISH}{_TWO}", catalog)
    assert found == (["7", "1", "4"] if "#" in text else ["1", "4"])
