"""Kinds of sheets: headings over rows, boxes, data keys, tables of events, what is filled in."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import EventKind
from argo_compiler.script import Draft, LineState, import_script
from tests.argo_compiler.script.conftest import draft_of, measured_in

START = "Start in starting area 1.\n"


def confirmed(text: str, catalog: Catalog) -> Draft:
    draft = draft_of(START + text, catalog)
    return draft_of(START + text, catalog, draft.confirm())


def test_a_heading_says_which_points_the_numbers_below_it_name(catalog: Catalog) -> None:
    text = (
        "PRESSURE GAUGES (bar)\n   no. 1    ........\n   no. 4    ........\n"
        "LIQUID LEVEL GAUGES (%)\n   no. 5    ........\nVALVES (o / c)\n   R31      ........\n"
    )
    draft = confirmed(text, catalog)
    assert measured_in(draft.require_mission()) == ["1", "9", "20", "10"]


def test_a_number_that_a_heading_leaves_open_is_asked_about(catalog: Catalog) -> None:
    draft = confirmed(
        "PRESSURE GAUGES (bar)\n   no. 3    ........\n   no. 1    ........\n", catalog
    )
    (line,) = draft.left
    assert line.reason == "`no. 3` can be pressure gauge 3 (#6) or pressure gauge 2 (#3)"


def test_a_row_is_not_lost_in_the_line_below_it(catalog: Catalog) -> None:
    draft = draft_of(f"{START}pressure gauge 1  ......\npressure gauge 4  N/A", catalog)
    assert [line.text for line in draft.lines[1:]] == [
        "pressure gauge 1 ......",
        "pressure gauge 4 N/A",
    ]


@pytest.mark.parametrize(
    ("text", "area", "duration_s"),
    [
        ("| Start area: [ ] 1   [X] 2 |\n| Limit: 12 min |\nCheck #1.", 2, None),
        ("start_area,2\nmax_duration_min,35\nCheck #1.", 2, 2100),
        ("Start: ☐ 1 ☑ 2\nCheck #1.", 2, None),
        ("Start in area 2.\nCheck #1, then back to its dock\nmax 12 min!!", 2, 720),
    ],
)
def test_fields_of_forms_and_data_files(
    text: str, area: int, duration_s: float | None, catalog: Catalog
) -> None:
    draft = import_script(text, catalog)
    decisions = draft.set_aside([line.label for line in draft.left])
    mission = import_script(text, catalog, decisions=decisions).require_mission()
    assert (mission.start_area, mission.max_duration) == (area, duration_s)


def test_a_table_of_events(catalog: Catalog) -> None:
    text = (
        "Check #1.\nEvent                Reaction\nGas detected         return to the dock\n"
        "battery under 20 %   return to the dock\n"
    )
    mission = confirmed(text, catalog).require_mission()
    assert {reaction.event for reaction in mission.reactions} == {
        EventKind.GAS_LEAK,
        EventKind.LOW_BATTERY,
    }


def test_what_is_done_on_an_abnormal_reading(catalog: Catalog) -> None:
    text = (
        "No | Point | Normal | If outside normal\n1 | pressure gauge 8 | 3-7 bar | go to the dock\n"
        "2 | valve R9 | 0-10 ° | no action\n3 | valve R7 | 0-10 ° | polish it\n"
    )
    draft = draft_of(START + text, catalog)
    states = {line.text.split(" | ")[1]: line for line in draft.lines[2:]}
    assert states["pressure gauge 8"].sentences == (
        "Check checkpoint 18.",
        "If checkpoint 18 is abnormal, go to the dock.",
    )
    assert states["valve R9"].state is LineState.UNDERSTOOD
    assert states["valve R7"].state is LineState.OPEN


def test_a_reading_that_is_filled_in_is_asked_about_without_headings(catalog: Catalog) -> None:
    text = "pressure gauge 1    4.4   JK\nvalve R25   ___   ___\nvalve R12   ___   ___\n"
    first, *others = draft_of(START + text, catalog).lines[1:]
    assert first.state is LineState.OPEN
    assert "may be done already" in first.reason
    assert {line.state for line in others} == {LineState.UNDERSTOOD}


def test_a_blank_for_what_the_site_does_not_have_is_open(catalog: Catalog) -> None:
    text = "pressure gauge 1   ____ bar\nConductivity       ____ uS\nSignature          ____\n"
    gauge, foreign, signature = draft_of(START + text, catalog).lines[1:]
    assert (gauge.state, foreign.state) == (LineState.UNDERSTOOD, LineState.OPEN)
    assert signature.state is LineState.SET_ASIDE


def test_an_empty_label_asks_for_nothing(catalog: Catalog) -> None:
    draft = draft_of(f"{START}Tag: valve R18\nValue:\nCheck #1.", catalog)
    assert measured_in(draft.require_mission()) == ["14", "1"]


def test_a_chat_without_times(catalog: Catalog) -> None:
    text = "Kim: check #1 please\nrobotdesk: ok\nKim: and then #4\n"
    assert measured_in(confirmed(text, catalog).require_mission()) == ["1", "4"]


def test_a_return_above_the_tasks_says_where_the_mission_ends(catalog: Catalog) -> None:
    text = "Arrivée / Arrival : starting area 2\nvalve R25\n"
    draft = draft_of(START + text, catalog)
    assert ("End of the mission: starting area 2.",) in draft.lines[1].choices
