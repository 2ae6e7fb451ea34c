"""Sheets that people fill in: each row becomes what it asks for, or is asked about."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import Draft, DraftLine, LineState, import_script
from tests.argo_compiler.script.conftest import draft_of, measured_in

HEADINGS = "Item   Description              Normal       Unit   Reading    Initials\n"


def at(draft: Draft, line: int) -> DraftLine:
    (found,) = (one for one in draft.lines if one.line == line)
    return found


@pytest.mark.parametrize(
    "row",
    [
        "1.1    Pressure gauge 1         3 - 7        bar    _______    ______",
        "1.1    pressure gauge 1         3 to 7       bar    .......    ______",
        "1.1    Pressure gauge 1                             _______    ______",
        "1      Checkpoint 1             3 - 7        bar                     ",
    ],
)
def test_a_row_that_agrees_with_the_site_is_understood(row: str, catalog: Catalog) -> None:
    draft = draft_of(f"{HEADINGS}{row}\n", catalog)
    assert at(draft, 2).state is LineState.UNDERSTOOD
    assert at(draft, 2).sentences == ("Check checkpoint 1.",)
    assert measured_in(draft.require_mission()) == ["1"]


def test_another_range_than_that_of_the_site_is_a_warning(catalog: Catalog) -> None:
    row = "1.1    Pressure gauge 1         3 - 5        bar    _______    ______"
    draft = draft_of(f"{HEADINGS}{row}\n", catalog)
    assert at(draft, 2).state is LineState.UNDERSTOOD
    told = [d for d in draft.diagnostics if d.code == "script.other-range"]
    assert "3 to 5 here, but 3 to 7 bar on the site" in told[0].message


def test_a_range_in_another_unit_is_the_same(catalog: Catalog) -> None:
    row = "1.1    Pressure gauge 1         300 - 700 kPa               _______    ______"
    draft = draft_of(f"{HEADINGS}{row}\n", catalog)
    assert "script.other-range" not in {d.code for d in draft.diagnostics}


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ("[x] pressure gauge 1       4.1 bar", "ticked"),
        ("[-] pressure gauge 1       floor 3 closed until noon", "ticked"),
        ("☑ pressure gauge 1", "ticked"),
        ("~~pressure gauge 1~~", "ticked"),
        ("1. ~~pressure gauge 1~~ deleted GP", "ticked"),
        ("1 ✓ pressure gauge 1   55", "ticked"),
        ("2. [x] pressure gauge 1", "ticked"),
        ("#1 ..... --\n#4 ..... ____", "left out"),
        ("3) ✗ pressure gauge 1   (scaffold in the way)", "ticked"),
        ("1.1    Pressure gauge 1         3 - 7        bar    N/A        ______", "left out"),
        ("1.1    Pressure gauge 1         3 - 7        bar    --         ______", "left out"),
        ("1.1    Pressure gauge 1 unless it is hot   3 - 7   bar    ____       ______", "change"),
    ],
)
def test_a_row_that_may_not_be_meant_is_asked_about(row: str, words: str, catalog: Catalog) -> None:
    draft = draft_of(f"{HEADINGS}{row}\n", catalog)
    line = at(draft, 2)
    assert line.state is LineState.OPEN
    assert words in line.reason
    assert ("Check checkpoint 1.",) in line.choices
    assert ("Do not check checkpoint 1.",) in line.choices


@pytest.mark.parametrize(
    "row",
    [
        "1.1    Pressure gauge 1         3 - 7        bar    skip       ______",
        "1.1    Pressure gauge 1         out of service, do not read    ______",
        "Not to be visited    pressure gauge 1",
    ],
)
def test_a_row_that_leaves_something_out_never_becomes_a_check(row: str, catalog: Catalog) -> None:
    draft = draft_of(
        f"{HEADINGS}{row}\n1.2   Pressure gauge 2     3 - 7   bar   ____  ____\n", catalog
    )
    assert at(draft, 2).state is LineState.PROPOSED
    assert at(draft, 2).sentences == ("Do not check checkpoint 1.",)
    mission = draft_of(
        "\n".join([HEADINGS.strip(), row, "1.2   Pressure gauge 2     3 - 7   bar   ____  ____"]),
        catalog,
        draft.confirm(),
    )
    assert measured_in(mission.require_mission()) == ["3"]


def test_words_that_a_row_does_not_use_have_to_be_confirmed(catalog: Catalog) -> None:
    text = "Point                   Reading       Remarks\n"
    text += "pressure gauge 1        ____ bar      tap the glass first\n"
    draft = draft_of(text, catalog)
    assert at(draft, 2).state is LineState.PROPOSED
    assert at(draft, 2).unused == ("tap the glass first",)


@pytest.mark.parametrize("words", ["alarm operator", "call the operator", "fetch another person"])
def test_words_for_people_are_not_used_as_a_whole(words: str, catalog: Catalog) -> None:
    """Also those that mean something elsewhere: `until the operator lets it go`."""
    draft = draft_of(f"Tag | Name | Unit | Action\n3 | pressure gauge 2 | bar | {words}\n", catalog)
    assert at(draft, 2).state is LineState.PROPOSED
    assert at(draft, 2).unused == (words,)


def test_a_row_on_another_floor_is_asked_about(catalog: Catalog) -> None:
    text = "Valve   Location    Required       Found\nR25     floor 2     OPEN           _____\n"
    line = at(draft_of(text, catalog), 2)
    assert line.state is LineState.OPEN
    assert "floor 1" in line.reason


@pytest.mark.parametrize(
    "line",
    [
        "[ ] Fire extinguisher in place, seal unbroken",
        "[ ] No oil on the grating",
        "[ ] Emergency shower tested for 10 s",
    ],
)
def test_a_row_that_names_no_checkpoint_is_open(line: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #8.\n\n{line}\n[ ] Valve R40 open (Y/N) ____\n", catalog)
    assert at(draft, 3).state is LineState.OPEN
    assert at(draft, 4).sentences == ("Check checkpoint 17.",)


@pytest.mark.parametrize(
    "line",
    [
        "Signature: ____________________",
        "Operator's signature: ____________________  Time: ______",
        "Date: __.__.____",
        "Comments: ______________________________",
    ],
)
def test_a_field_that_a_person_fills_in_is_set_aside(line: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #8.\n\n{line}\n", catalog)
    assert at(draft, 3).state is LineState.SET_ASIDE
    assert "script.set-aside" in {d.code for d in draft.diagnostics}


@pytest.mark.parametrize(
    "lines",
    [
        "Start ................ starting area 2\nTime limit ........... 25 min",
        "start area;2\ntime budget (s);1500",
        "Start                starting area 2\nAllowed time         25 minutes",
        "| Start position | starting area 2 |\n| Duration | not more than 25 minutes |",
        "Starting area\t2\nMaximum time\t25 min",
    ],
)
def test_labels_and_values_in_columns_are_fields(lines: str, catalog: Catalog) -> None:
    draft = import_script(f"{lines}\n\nCheck #8.", catalog)
    mission = draft.require_mission()
    assert (mission.start_area, mission.max_duration) == (2, 1500)


def test_a_value_goes_on_in_the_line_below(catalog: Catalog) -> None:
    text = (
        "Start                Robot docked in starting area 1, battery\n"
        "                     charged\n"
        "Targets              pressure gauge 1 (floor 1), valve R12\n"
        "                     (floor 2)\n"
    )
    draft = import_script(text, catalog)
    mission = import_script(text, catalog, decisions=draft.confirm()).require_mission()
    assert measured_in(mission) == ["1", "5"]


def test_a_chat_is_read_without_its_time_stamps(catalog: Catalog) -> None:
    text = "[07:52, 14/03] Jonas: check valve R25\n[07:53, 14/03] Priya: then pressure gauge 1\n"
    assert measured_in(draft_of(text, catalog).require_mission()) == ["4", "1"]


@pytest.mark.parametrize(
    ("line", "sentences"),
    [
        ("sorry, not R25 but R12!", ("Replace checkpoint 4 by checkpoint 5.",)),
        ("skip PG 7, no ladder there today", ("Do not check checkpoint 15.",)),
        ("Please keep it under 15 minutes", ("Maximum duration: 15 minutes.",)),
        ("Ten minutes later read valve R18", ("Wait for 10 minutes.", "Check checkpoint 14.")),
        (
            "Pressure gauge 3: two readings, ten minutes apart",
            ("Check checkpoint 6.", "Wait for 10 minutes.", "Check checkpoint 6."),
        ),
        ("I'd like to have valve R18", ("Check checkpoint 14.",)),
        ("danach ab ins Dock", ("Return to the docking station.",)),
        ("Liegt der Wert ueber 5, auch", ()),
    ],
)
def test_what_a_line_proposes(line: str, sentences: tuple[str, ...], catalog: Catalog) -> None:
    draft = draft_of(f"Check valve R25.\n{line}", catalog)
    assert at(draft, 2).sentences == sentences
    assert at(draft, 2).state is (LineState.PROPOSED if sentences else LineState.OPEN)


@pytest.mark.parametrize(
    ("line", "sentences"),
    [
        ("Danach soll er noch Manometer 5 auf der zweiten Ebene prüfen", ("Check checkpoint 8.",)),
    ],
)
def test_a_line_of_which_all_words_are_used_is_understood(
    line: str, sentences: tuple[str, ...], catalog: Catalog
) -> None:
    draft = draft_of(f"Check valve R25.\n{line}", catalog)
    assert at(draft, 2).sentences == sentences
    assert at(draft, 2).state is LineState.UNDERSTOOD


def test_a_list_without_items_is_no_box_to_tick(catalog: Catalog) -> None:
    step = 'The steps are:\n1. "T0": check checkpoint #1, standing at (0, 0, 0) heading 0 degrees,'
    draft = draft_of(f"{step}\n   with joints [].\n", catalog)
    assert not draft.left
    assert measured_in(draft.require_mission()) == ["1"]
