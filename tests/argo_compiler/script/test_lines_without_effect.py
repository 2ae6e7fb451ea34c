"""Kinds of lines that have no effect on a mission, and lines like them that ask for something."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import LineState
from tests.argo_compiler.script.conftest import draft_of, measured_in

OPEN, ASIDE = LineState.OPEN, LineState.SET_ASIDE
LIST = "- valve R7\n- pressure gauge 3\n- valve R12"


def states(text: str, number: int, catalog: Catalog) -> set[LineState]:
    """Return the states of the parts of a line."""
    return {one.state for one in draft_of(text, catalog).lines if one.line == number}


@pytest.mark.parametrize(
    "line",
    [
        "thankss 😀",
        "Thank youuu!",
        "tx, Ola",
        "no hurry",
        "👍",
        "Ticket #771204",
        "Closed by a.lund",
        "valid from 03.05",
        "Work notes",
        "This e-mail may contain confidential information.",
        "All visitors must keep behind the fence while the robot is moving.",
        "Spectators stay behind the barrier.",
        "Please do not touch the robot.",
        "If the weather is bad text me before you send it.",
        "Jo is ill, phone Ann",
        "Commissioning of the new train is scheduled",
        "Penalty: 3 points for each collision",
        "ITEM UNIT NORMAL REMARKS",
        "Task 3 of 7",
    ],
)
def test_a_line_that_asks_for_nothing_is_set_aside(line: str, catalog: Catalog) -> None:
    assert states(f"Check #1.\n\n{line}\n\nCheck #4.\nCheck #8.\nGo home.", 3, catalog) == {ASIDE}


@pytest.mark.parametrize(
    "field", ["Bcc: night desk", "Reporter: r.silva", "Objet : robot", "Sent: 08:10"]
)
def test_a_field_of_a_mail_or_a_ticket_has_no_effect(field: str, catalog: Catalog) -> None:
    draft = draft_of(f"{field}\n\nCheck #1.", catalog)
    assert measured_in(draft.require_mission()) == ["1"]


@pytest.mark.parametrize("field", ["Reporter: R7", "Labels: valve R7", "Ticket: read R7"])
def test_a_field_that_names_a_checkpoint_is_asked_about(field: str, catalog: Catalog) -> None:
    draft = draft_of(f"{field}\n\nCheck #1.", catalog)
    assert [one.line for one in draft.left] == [1]


@pytest.mark.parametrize(
    "line",
    [
        "Look at the flare drum",
        "thank youuu, and R12",
        "ok flare drum",
        "no rush R7",
        "✓",
        "checked R25",
        "Ticket R25",
        "Total 25 min",
        "Total: 3 rounds",
        "Visitors' lift",
        "Staff room: look at the door",
        "Photograph the flare drum and call me",
        "If it is open call me and photograph it",
        "if the lift is broken photograph it",
        "The lift is planned and photograph it",
        "Valve R25 Position Remarks",
        "Sent from my phone: read R7 slowly please",
        "Flare drum 12:00",
        "Valve 2 of 3",
        "Run: 3",
        "Moment, the other way round",
    ],
)
def test_a_line_like_them_that_may_ask_for_something_is_left(line: str, catalog: Catalog) -> None:
    found = states(f"Check #1.\n\n{line}\n\nCheck #4.\nCheck #8.\nGo home.\nEnd.", 3, catalog)
    assert ASIDE not in found


@pytest.mark.parametrize(
    "line",
    [
        "For the pump trial on Monday please set the robot up like this",
        "Ines asked me to have the robot do these this evening:",
        "Would it be possible for the robot to read the following during our visit?",
        "Robot to confirm the position of the following valves:",
        "for the robot this evening:",
        "for the trip in week 31 we need:",
    ],
)
def test_words_that_announce_a_list_are_set_aside(line: str, catalog: Catalog) -> None:
    text = f"Hello,\nRound by robot\n\n{line}\n{LIST}"
    draft = draft_of(text, catalog)
    assert {one.state for one in draft.lines if one.line == 4} == {ASIDE}
    assert measured_in(draft.require_mission()) == ["11", "6", "5"]


@pytest.mark.parametrize(
    "line",
    [
        "Please leave these to the fitters",
        "Please get the fitters to do these",
        "Please do these twice:",
        "Robot, do these carefully:",
        "please read these last:",
        "don't do these:",
        "Could the robot ignore the following?",
        "The robot has done these:",
        "please do these only if dry:",
        "Please stop doing these:",
        "robot can't reach these:",
        "within 20 min please do these:",
        "Robot to do these after the gas test:",
        "do these in reverse please:",
        "Petra reads these by hand",
    ],
)
def test_words_that_say_how_or_whether_a_list_is_done_are_left(line: str, catalog: Catalog) -> None:
    assert ASIDE not in states(f"Check #1.\n\n{line}\n{LIST}", 3, catalog)


def test_a_request_over_no_list_is_left(catalog: Catalog) -> None:
    text = "Check #1.\n\nPlease do these with the robot\n\nThanks, Bo"
    assert ASIDE not in states(text, 3, catalog)


LOG = """SHIFT LOG day
06:00 took over from Ada, all quiet
{}
18:00 handed over

For the robot:
- valve R7
- pressure gauge 3"""


@pytest.mark.parametrize(
    "entry",
    [
        "07:10 compressor tripped, restarted",
        "08:20 level gauge 5 read 62 %",
        "08:20 R9 found at 20 deg, closed by hand",
        "09:30 crane delayed, no change",
    ],
)
def test_an_entry_of_a_log_is_set_aside(entry: str, catalog: Catalog) -> None:
    assert states(LOG.format(entry), 3, catalog) == {ASIDE}


@pytest.mark.parametrize(
    "entry",
    [
        "22:00 robot to look at the flare drum",
        "22:00 robot: photograph the flare drum",
        "22:00 valve R7",
        "22:00 read level gauge 5 until 62 %",
        "22:00 do not read R7, it was at 3 bar",
        "22:00 robot should read R7, was 4.5 bar",
        "22:00 skip R7, leaking 3.2 bar",
        "22:00 wait 20 min",
    ],
)
def test_a_task_in_a_log_is_left(entry: str, catalog: Catalog) -> None:
    assert ASIDE not in states(LOG.format(entry), 3, catalog)


def test_what_a_plan_does_by_the_clock_is_no_log(catalog: Catalog) -> None:
    text = "SHIFT LOG plan\n06:00 start in starting area 1\n06:20 valve R7\n06:40 flare drum"
    assert ASIDE not in {one.state for one in draft_of(text, catalog).lines if one.line > 2}


def test_headings_over_numbered_items_are_set_aside(catalog: Catalog) -> None:
    text = "Isolation\n\n1  Scope\n\n2  Preparation\n2.1  Check R7.\n3  Final check of the drum\n"
    found = {one.line: one.state for one in draft_of(text, catalog).lines}
    assert found[3] is found[5] is ASIDE
    assert found[7] is not ASIDE


@pytest.mark.parametrize(
    "title",
    ["DAIRY WALK SHEET DW-07", "VALVE CHECKLIST  Train C, before restart", "Run sheet no. 31"],
)
def test_the_name_of_a_document_is_set_aside(title: str, catalog: Catalog) -> None:
    assert states(f"Site 3, unit 5\n{title}\n\n{LIST}", 2, catalog) == {ASIDE}


@pytest.mark.parametrize(
    "line",
    [
        "READ ALL VALVES ON THIS SHEET",
        "Photograph the pump, form OPS-20",
        "ROUND SHEET R7",
        "Superseded by sheet 2",
        "2 ROUNDS SHEET 4",
        "ROUND SHEET 20 MIN",
    ],
)
def test_a_line_that_only_names_a_document_besides_is_left(line: str, catalog: Catalog) -> None:
    assert ASIDE not in states(f"Unit 5\nCheck #1.\n{line}\n\n{LIST}", 3, catalog)
    assert ASIDE not in states(f"Unit 5, east\nnight\n{line}\n\n{LIST}", 3, catalog)


@pytest.mark.parametrize(
    ("row", "state"),
    [
        ("Total                 65     ____", ASIDE),
        ("Values: a) ______ bar     c) ______ bar", ASIDE),
        ("Written: P. Costa     Checked: J. Roth", ASIDE),
        ("Total                 25 min ____", OPEN),
        ("Drum: a) ______ bar     c) ______ bar", OPEN),
    ],
)
def test_a_row_without_a_task(row: str, state: LineState, catalog: Catalog) -> None:
    sheet = "Check #1.\nCP    what               points given\n#1    pressure gauge 1   20   ____"
    assert states(f"{sheet}\n{row}", 4, catalog) == {state}


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("Prüfe Ventil R7.\n\nkeine Eile", 3),
        ("Schichtbuch\n06:00 Übernahme von Jo, alles ruhig\n07:10 Probe gezogen\nPrüfe R7.", 3),
        ("Rundgang 4\n\nbitte den Roboter folgendes machen lassen:\n- Ventil R7\n- Manometer 3", 3),
    ],
)
def test_german_lines_likewise(text: str, number: int, catalog: Catalog) -> None:
    assert states(text, number, catalog) == {ASIDE}


@pytest.mark.parametrize(
    "heading",
    [
        "The robot keeps away from these:",
        "Petra will do these:",
        "Keep clear of the following",
        "Off limits",
        "Isolated:",
        "Blocked by scaffold",
        "Reserve:",
        "The contractor reads:",
        "Manual round",
        "The robot can't get to these:",
        "Check these twice:",
        "Diese prüft der Kollege:",
        "Nicht erreichbar:",
        "From bottom to top of this list:",
        "Von unten nach oben abarbeiten:",
        "Exceptions:",
        "Macht der Schichtführer:",
    ],
)
def test_a_heading_that_may_exclude_its_list_is_asked_about(heading: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #1.\n{heading}\n- valve R7\n- valve R12\n", catalog)
    assert draft.mission is None
    assert {one.state for one in draft.lines if one.line == 2} == {LineState.OPEN}


@pytest.mark.parametrize("heading", ["Upper decks:", "Today's points", "Please check these:"])
def test_a_plain_heading_over_a_list_is_set_aside(heading: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #1.\n{heading}\n- valve R7\n- valve R12\n", catalog)
    assert measured_in(draft.require_mission()) == ["1", "11", "5"]
