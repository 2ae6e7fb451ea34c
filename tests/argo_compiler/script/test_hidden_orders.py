"""What asks for something where nothing is expected to: in titles, brackets, notes, signatures. It
is read, asked about or warned of, never dropped."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import DiagnosticError, Severity
from argo_compiler.il import EventKind, Order
from argo_compiler.script import format_script
from tests.argo_compiler.script.conftest import measured
from tests.whole_scripts import import_whole

START = "Start in starting area 1. Check #1"


@pytest.mark.parametrize(
    "text",
    [
        f"No valves today\n{START}.",
        f"Please be careful and stay on floor 1\n{START}.",
        f"Quick round, go home\n{START}.",
        f"Hi all, no gauges today,\n{START}.",
        f"{START} (and 4).",
        f"{START} (report it).",
        f"{START} (before the valve).",
        f"{START} - then home",
        f"{START} for the second time.",
        f"{START}.\nRegards\nPaul\nP.S. valve R25 too",
        f"{START}.\nSee you at starting area 2",
        f"{START}.\nHave a nice day, robot, and go home",
        f"{START}.\n| checkpoint | remark |\n| 4 | only if it is safe |",
        f"{START}.\n| checkpoint | remark |\n| 4 | skip |",
        f"{START}.\nIn any order:\n- #4\n- #5",
        f"{START}.\nOptional:\n- #4\n- #5",
        f"{START}.\nIf there is time:\n- #4\n- #5",
        f"{START}.\nNote: leave out checkpoint 1.",
        f"{START}.\n#1-#4\nNote: without the valve",
    ],
)
def test_it_is_asked_about(text: str, catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError):
        import_whole(text, catalog)


@pytest.mark.parametrize(
    "remark",
    [
        "Note: check checkpoint 5",
        "Hint: go home afterwards.",
        "NB: the robot must not be faster than 0.3 m/s",
    ],
)
def test_a_remark_that_asks_for_something_is_a_warning(remark: str, catalog: Catalog) -> None:
    found = import_whole(f"{START}.\n{remark}", catalog).diagnostics
    assert [d.code for d in found if d.severity is Severity.WARNING] == ["script.remark"]


@pytest.mark.parametrize(
    "text",
    [
        f"Wear gloves\n{START}.",
        f"Round of the plant\n{START}.",
        f"{START} (after lunch).",
        f"{START}, because valve R25 was repaired.",
        f"{START}.\nNote: checkpoint 5 is broken",
        f"{START}.\nRegards\nPaul\nShift B",
    ],
)
def test_what_asks_for_nothing_is_a_warning(text: str, catalog: Catalog) -> None:
    resolved = import_whole(text, catalog)
    assert {d.code for d in resolved.diagnostics} <= {
        "script.comment",
        "script.no-effect",
        "script.title",
    }
    assert resolved.diagnostics
    assert measured(text, catalog) == ["1"]


def test_a_number_is_never_put_right(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match="seven"):
        import_whole(f"{START}.\nCheck checkpoint sevn", catalog)


@pytest.mark.parametrize(
    ("text", "checkpoints"),
    [
        (f"Check checkpoint 5 first\n{START}.", ["5", "1"]),
        (f"Hi Sam, check valve R25!\n{START}.", ["4", "1"]),
        (f"{START}.\nRegards\nPaul\n\nand valve R25", ["1", "4"]),
        (f"{START} (twice). Should checkpoint 1 be above 5, check #8.", ["1", "8"]),
        ("area 2 start\nvalve r31 and valve r7", ["10", "11"]),
        ("Can you check valve R25? Start in starting area 1.", ["4"]),
        (f"Can you run a short check for me after lunch? {START}.", ["1"]),
        ("Hello,\nplease plan checkpoints 13 and 15, start in starting area 1.", ["13", "15"]),
        ("The lower levels. Start: area 1. End: area 1. Check #1.", ["1"]),
    ],
)
def test_orders_as_people_say_them(text: str, checkpoints: list[str], catalog: Catalog) -> None:
    assert measured(text, catalog) == checkpoints


def test_an_inverted_condition_is_a_reaction(catalog: Catalog) -> None:
    text = f"{START}. Should the platform alarm sound, the robot goes home. Check #4."
    mission = import_whole(text, catalog).mission
    assert [reaction.event for reaction in mission.reactions] == [EventKind.PLATFORM_ALARM]


def test_several_fields_stand_behind_a_sentence(catalog: Catalog) -> None:
    text = "Start and end in starting area 2. Order: any. Maximum duration: 15 min.\nCheck #1"
    mission = import_whole(text, catalog).mission
    assert (mission.end_area, mission.order, mission.max_duration) == (2, Order.ANY, 900.0)


def test_what_stands_in_brackets_is_said_of_the_task(catalog: Catalog) -> None:
    mission = import_whole(f"{START} (priority 3). Check #4 (at 0.2 m/s).", catalog).mission
    first, second = (task for task in mission.tasks if task.object_id is not None)
    assert (first.priority, second.velocity) == (3, 0.2)


def test_everything_is_repeated_that_stands_below_the_number_of_rounds(catalog: Catalog) -> None:
    above = import_whole(
        f"Repeat everything twice. {START}. Check #4. Return to the dock.", catalog
    )
    below = import_whole(
        f"{START}. Check #4. Repeat everything twice. Return to the dock.", catalog
    )
    assert format_script(above.mission, catalog) == format_script(below.mission, catalog)


def test_nothing_is_repeated_where_nothing_is_planned(catalog: Catalog) -> None:
    with pytest.raises(DiagnosticError, match="there is nothing before this to repeat"):
        import_whole("Start in starting area 1. Repeat everything twice. Return home.", catalog)
