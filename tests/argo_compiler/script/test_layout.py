"""Steps, bullets, tables, letters and titles: what belongs together, and what has no effect."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.diagnostics import Severity
from argo_compiler.il import Order
from argo_compiler.script import LineState, import_script, parse
from tests.argo_compiler.script.conftest import draft_of, findings, measured, measured_in
from tests.whole_scripts import import_whole

START = "Start in starting area 1\n"


def errors(text: str, catalog: Catalog) -> list[tuple[int, str]]:
    """The lines of the errors, with the words at which they are."""
    lines = text.split("\n")
    found = [d for d in findings(text, catalog) if d.severity is Severity.ERROR]
    spans = [d.span for d in found if d.span is not None]
    return [(s.line, lines[s.line - 1][s.column - 1 : s.column - 1 + s.length]) for s in spans]


def notes(text: str, catalog: Catalog) -> list[str]:
    return [
        d.message.split("`")[1] for d in findings(text, catalog) if d.severity is not Severity.ERROR
    ]


@pytest.mark.parametrize(
    "lines",
    [
        "1. Check #4\n2. Check #8",
        "1) Check #4\n2) Check #8",
        "(1) Check #4\n(2) Check #8",
        "Step 1: check #4\nstep 2: check #8",
        "1 - Check #4\n2 - Check #8",
        "- Check #4\n- Check #8",
        "* Check #4\n* Check #8",
        "+ Check #4\n+ Check #8",
        "• Check #4\n– Check #8",
        "- [ ] Check #4\n- [ ] Check #8",
        "1. Check #4, 2. Check #8",
        "1. Check #4\n   a) Check #8",
        "Tasks:\n1. Check #4\n2. Check #8",
        "# Tasks\n- #4\n- #8",
        "Tasks\n=====\n\n- #4\n- #8",
        "Floor 1\n - #4\nFloor 2\n - #8",
        "1. Check\n   #4\n2. Check #8",
        "1. Check\n#4 and\n#8",
        "Check check-\npoint 4 and #8",
        "Check #4.\nCheck #8.",
    ],
)
def test_steps_in_all_shapes(lines: str, catalog: Catalog) -> None:
    assert measured(START + lines, catalog) == ["4", "8"]


@pytest.mark.parametrize(
    "table",
    [
        "| No | Checkpoint | Reading |\n|----|---|---|\n| 1 | #4 | valve R25 |\n| 2 | #8 | |",
        "No\tCheckpoint\tReading\n1\t#4\tvalve R25\n2\t#8\tpressure gauge 5",
        "No  Checkpoint  Remark\n1   4           the red one\n2   8",
        "| Checkpoint | Reading |\n| #4 | valve R25 |\n| | pressure gauge 5 |",
        "| Action | Checkpoint |\n| check | #4 |\n| read | #8 |",
    ],
)
def test_tables(table: str, catalog: Catalog) -> None:
    assert measured(f"{START}\n{table}\n", catalog) == ["4", "8"]


def test_what_a_table_says_of_its_steps(catalog: Catalog) -> None:
    table = (
        "| Checkpoint | Priority | Optional | Speed |\n"
        "| #4 | high | no | 0.3 m/s |\n| #8 | low | yes | |"
    )
    first, second = import_whole(f"{START}\n{table}", catalog).mission.tasks[1:]
    assert first.priority is not None
    assert second.priority is not None
    assert first.priority > second.priority
    assert (first.optional, second.optional) == (False, True)


@pytest.mark.parametrize(
    ("heading", "priorities"),
    [
        ("Priority (1 = highest)", [2, 3, 1]),
        ("Priority (1 is the most important)", [2, 3, 1]),
        ("Prio [1 = low, 3 = high]", [2, 1, 3]),
        ("Priority: 3 = highest", [2, 1, 3]),
        ("Importance - 5 means top priority", [2, 1, 3]),
        ("Priorität (1 = am wichtigsten)", [2, 3, 1]),
    ],
)
def test_numbers_of_priorities_count_as_the_heading_says(
    heading: str, priorities: list[int], catalog: Catalog
) -> None:
    german = heading.startswith("Priorität")
    point, start = ("Prüfpunkt", "Starte in Startbereich 1.") if german else ("Checkpoint", START)
    rows = "\n".join(f"| #{k} | {n} |" for k, n in ((4, 2), (8, 1), (10, 3)))
    table = f"| {point} | {heading} |\n|---|---|\n{rows}"
    tasks = import_whole(f"{start}\n{table}", catalog).mission.tasks
    assert [task.priority for task in tasks[1:]] == priorities


def test_numbers_of_priorities_are_asked_about_once(catalog: Catalog) -> None:
    table = f"{START}\n| Checkpoint | Priority |\n| #4 | 2 |\n| #8 | 1 |"
    assert [d.code for d in findings(table, catalog)] == ["script.ambiguous-priority"]


def test_a_remark_in_a_table_may_say_something(catalog: Catalog) -> None:
    table = "Pos\tCP\tTag\tRemark\n1\t4\tvalve R25\ttwice\n2\t8\t\tonly if #4 is above 5 degrees"
    mission = import_whole(f"{START}\n{table}", catalog).mission
    first = mission.task("MEASURE 4")
    assert first is not None
    assert mission.groups[0].max_repeat_count == 2
    assert errors(f"{START}\n{table} and Joe is there", catalog) == [(5, "Joe")]


def test_a_column_that_there_is_not(catalog: Catalog) -> None:
    text = f"{START}\n| Checkpoint | Colour |\n| #4 | red |"
    (row,) = (line for line in import_script(text, catalog).lines if line.line == 4)
    assert (row.state, row.sentences) == (LineState.PROPOSED, ("Check checkpoint 4.",))
    assert row.unused == ("red",)


def test_a_letter(catalog: Catalog) -> None:
    text = """\
Dear Marc,

I hope you are well. Please start in starting area 1 and check checkpoint 4 tonight (it was odd).
Then check valve R12, which is next to the ladder. Note: the lamp is broken.
Check checkpoint 8 - it's the one at the door.

Kind regards
Ines Miller
"""
    assert measured(text, catalog) == ["4", "5", "8"]
    assert notes(text, catalog) == [
        "Dear Marc,",
        "I hope you are well",
        "tonight",
        "(it was odd)",
        "which is next to the ladder",
        "Note: the lamp is broken",
        "it's the one at the door",
        "Kind regards",
        "Ines Miller",
    ]


def test_an_initial_is_part_of_a_signature(catalog: Catalog) -> None:
    text = f"{START}Check checkpoint 4.\n\nKind regards\nT. Miller"
    assert notes(text, catalog) == ["Kind regards", "Miller"]


def test_what_a_sentence_is_for_is_a_note(catalog: Catalog) -> None:
    text = f"{START}For our visitors in Graz, check checkpoint 4."
    assert notes(text, catalog) == ["For our visitors in Graz"]
    for order in ("For the visitors wait foo", "For the valve with the leak", "For 5 minutes foo"):
        assert errors(f"{START}{order}, check checkpoint 4.", catalog)


def test_titles_and_headings_are_notes(catalog: Catalog) -> None:
    text = f"Weekly tour, unit A\n\n{START}Safety rules:\n- check #4"
    assert notes(text, catalog) == ["Weekly tour, unit A", "Safety rules:"]
    for title in ("Team Salamander, run 2", "Behaviour test 12"):
        assert notes(f"{title}\n\n{START}- check #4", catalog) == [title]
    assert import_whole(text, catalog).mission.designation == "Weekly tour, unit A"


@pytest.mark.parametrize(
    "title",
    [
        "Close valve R12",
        "Send an SMS to the control room",
        "Do not use any stairs",
        "Photograph the pump",
        "Round, but not on floor 2",
        "Tour, 20 minutes, then wait",
    ],
)
def test_a_title_swallows_no_instruction(title: str, catalog: Catalog) -> None:
    assert [line for line, _ in errors(f"{title}\n{START}Check #4", catalog)] == [1]


def test_a_title_may_say_something_of_the_mission(catalog: Catalog) -> None:
    text = "Evening round, start and end in starting area 2, in any order, at most 15 minutes\n- #4"
    mission = import_whole(text, catalog).mission
    assert (mission.designation, mission.order) == ("Evening round", Order.ANY)
    assert (mission.max_duration, mission.start_area, mission.end_area) == (900, 2, 2)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("Do not use any stairs", None),
        ("send an SMS", "send"),
        ("Close valve R12", "Close"),
        ("Check #8. If it looks strange, check #9. Otherwise check #10", None),
        ("Repeat steps 2 to 3 a few times", "few"),
        ("Check #8 (and valve R12)", None),
        ("Check #8 or", "or"),
    ],
)
def test_what_cant_be_done_is_one_error_in_its_line(
    line: str, words: str | None, catalog: Catalog
) -> None:
    text = f"1. {START}2. Check #4\n3. {line}\n4. If it is above 5, check #8\n5. Otherwise check #9"
    ((number, said),) = errors(text, catalog)
    assert number == 3
    assert words is None or said == words


def test_a_line_that_makes_no_sense_leaves_those_around_it_as_they_are(catalog: Catalog) -> None:
    text = f"{START}Check #4\nFly to the moon\nCheck #8"
    assert [line for line, _ in errors(text, catalog)] == [3]


@pytest.mark.parametrize(("said", "meant"), [("#l7", "17"), ("checkpoint 1O", "10"), ("#I2", "12")])
def test_a_letter_among_digits_is_a_digit_with_a_warning(
    said: str, meant: str, catalog: Catalog
) -> None:
    result = import_whole(f"{START}Check {said}", catalog)
    assert [t.object_id for t in result.mission.tasks][1:] == [meant]
    (warning,) = result.diagnostics
    assert warning.code == "script.respelled"
    assert warning.severity is Severity.WARNING


def test_names_with_letters_and_digits_stay_as_they_are(catalog: Catalog) -> None:
    (error,) = findings(f"{START}Check valve R1O", catalog)
    assert error.code == "script.unknown-checkpoint"


def test_hints_tell_what_fits(catalog: Catalog) -> None:
    (few,) = findings(f"1. {START}2. Check #4\n3. Repeat steps 1 to 2 a few times", catalog)
    assert few.hint is not None
    assert "`repeat steps 2 to 4 three times`" in few.hint
    (slip,) = findings(f"{START}Check chekpont 4 quirkily", catalog)
    assert slip.hint is not None
    assert "`checkpoint`" in slip.hint


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("Check these pressure gauges:\n- 1\n- 3", ["1", "6"]),
        ("Check the pressure gauges:\n1. 1\n2. 3", ["1", "6"]),
        ("Pressure gauges\n- 1\n- 3", ["1", "6"]),
        ("2. Pressure gauges:\n   a) 1\n   b) 3\n3. Check #2", ["1", "6", "2"]),
        ("The following valves:\n- R12\n- R25", ["5", "4"]),
        ("Check the following checkpoints:\n- pressure gauge 1\n- #4", ["1", "4"]),
        ("Prüfe diese Ventile:\n- R12\n- R25\nFahre dann zurück", ["5", "4"]),
        ("Checkpoints\n1. Check #1\n2. Check #4", ["1", "4"]),
        ("Gauges:\n- Check #1", ["1"]),
    ],
)
def test_what_stands_over_a_list(text: str, expected: list[str], catalog: Catalog) -> None:
    assert measured(START + text, catalog) == expected


def test_all_of_them_or_those_below(catalog: Catalog) -> None:
    assert errors("Check all valves\n- R12", catalog) == [(1, "Check all valves")]
    assert errors("Check all valves:\n- #3", catalog) == [(1, "valves:")]


@pytest.mark.parametrize(
    "text",
    [
        "Check all valves:\n- R12\n- R25",
        "All valves:\n- R12\n- R25",
        "All valves:\nR12\nR25",
        "1. Check all of the valves:\n   - R12\n   - R25",
        "Check #1. Then check all valves:\n- R12\n- R25",
        "Prüfe alle Ventile:\n- R12\n- R25",
    ],
)
def test_all_over_some_of_them_is_a_heading_with_a_warning(text: str, catalog: Catalog) -> None:
    draft = draft_of(text, catalog)
    aside = [line for line in draft.lines if line.state is LineState.SET_ASIDE]
    assert [line.text[-1] for line in aside] == [":"]
    assert measured_in(draft.require_mission())[-2:] == ["5", "4"]


def test_a_step_that_only_leads_to_itself_is_an_error(catalog: Catalog) -> None:
    text = "Start in starting area 1\nGo to step 1\nCheck #1"
    assert errors(text, catalog) == [(2, "step 1")]


def test_a_sentence_of_very_many_lines_is_refused_with_its_length() -> None:
    text = "1. Start in starting area 1.\n2. Check #2.\n" + "check #1 and\n" * 1000 + "check #4.\n"
    errors = [d for d in parse(text).diagnostics if d.severity == "error"]
    assert [(d.code, d.span.line) for d in errors if d.span] == [("script.too-long", 3)]
    assert "13008 characters; at most 10000" in errors[0].message


@pytest.mark.parametrize(
    "text",
    [
        "Pressure gauges\n1, 4\nLevel gauges\n2, 3",
        "Pressure gauges:\n1, 4\nLevel gauges:\n2, 3",
        "Check pressure gauges 1, 4\nLevel gauges 2, 3",
    ],
)
def test_a_number_at_the_end_of_a_line_counts_no_kind_below_it(text: str, catalog: Catalog) -> None:
    draft = draft_of(text, catalog)
    assert draft.mission is None or measured_in(draft.mission) == ["1", "9", "7", "12"]
