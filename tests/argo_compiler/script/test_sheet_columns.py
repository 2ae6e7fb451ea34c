"""Columns of sheets that give the order, the priority, a count or a case of their rows, and cells
that say when a row is done, or that it is left out."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import Draft, DraftLine, LineState, import_script
from tests.argo_compiler.script.conftest import draft_of, measured_in

OPEN, ASIDE, PROPOSED = LineState.OPEN, LineState.SET_ASIDE, LineState.PROPOSED
UNDERSTOOD = LineState.UNDERSTOOD


def line_at(number: int, draft: Draft) -> DraftLine:
    return next(line for line in draft.lines if line.line == number)


def states(text: str, catalog: Catalog) -> list[LineState]:
    return [line.state for line in draft_of(text, catalog).lines]


# ---- numbers that give the order


ORDERED = """\
{0} | Point | Normal | If outside normal
{1} | PG 2 | 3-7 |
{2} | R25 | | return to dock
{3} | LLG 1 | 20-80 |"""


@pytest.mark.parametrize("heading", ["Seq.", "Order", "Turn", "Reihenfolge", "When"])
@pytest.mark.parametrize(
    "numbers", [("20", "10", "30"), ("2.", "1.", "3."), ("2nd", "1st", "3rd"), ("b", "a", "c")]
)
def test_numbers_out_of_sequence_ask_about_the_headings(
    heading: str, numbers: tuple[str, str, str], catalog: Catalog
) -> None:
    line = draft_of(ORDERED.format(heading, *numbers), catalog).lines[0]
    assert (line.state, line.reason) == (
        OPEN,
        f"`{heading}` can give another order of the rows",
    )


@pytest.mark.parametrize("numbers", [("10", "20", "30"), ("a)", "b)", "c)"), ("1", "", "3")])
def test_numbers_in_sequence_need_no_answer(
    numbers: tuple[str, str, str], catalog: Catalog
) -> None:
    assert draft_of(ORDERED.format("Seq.", *numbers), catalog).lines[0].state is ASIDE


@pytest.mark.parametrize(
    "text",
    [
        "Point   Order   If outside normal\nPG 1    3       return to dock\nR25     1\nR12     2",
        "Point; Order; If abnormal\nPG 1; 3; return to dock\nR25; 1;\nR12; 2;",
        "Point\tSeq\tIf abnormal\nPG 1\t3\treturn to dock\nR25\t1\t\nR12\t2\t",
        "Order | Point\n2 | PG 1\n1 | R25\n3 | R12",
        "Pos | Point\n2 | PG 1\n1 | R25\n3 | R12",
    ],
)
def test_the_order_is_asked_about_in_all_kinds_of_columns(text: str, catalog: Catalog) -> None:
    line = draft_of(text, catalog).lines[0]
    assert line.state is OPEN
    assert "can give another order" in line.reason


def test_a_number_in_some_rows_only_may_give_the_order(catalog: Catalog) -> None:
    text = "When | Point | Normal\n | PG 1 | 3-7\n1 | R25 |\n | R12 |"
    draft = draft_of(text, catalog)
    assert [line.state for line in draft.lines] == [OPEN, *[UNDERSTOOD] * 3]
    assert [line.sentences for line in draft.lines[1:]] == [
        (f"Check checkpoint {id}.",) for id in (1, 4, 5)
    ]


def test_the_order_of_the_numbers_can_be_chosen(catalog: Catalog) -> None:
    text = ORDERED.format("Seq.", "20", "10", "30")
    draft = draft_of(text, catalog)
    assert draft.lines[0].choices == (
        (
            "Check checkpoint 4.",
            "If checkpoint 4 is abnormal, return to dock.",
            "Check checkpoint 3.",
            "Check checkpoint 2.",
        ),
        (),
    )
    draft = import_script(text, catalog, start_area=1, decisions=draft.choose("1", 1))
    assert measured_in(draft.require_mission()) == ["4", "3", "2"]
    assert [line.state for line in draft.lines[1:]] == [ASIDE] * 3


def test_the_order_of_rows_that_are_not_clear_can_not_be_chosen(catalog: Catalog) -> None:
    text = ORDERED.format("Seq.", "20", "10", "30").replace("PG 2", "PG 2, PG 9")
    assert draft_of(text, catalog).lines[0].choices == ((),)


# ---- words that say when a row is done


@pytest.mark.parametrize("heading", ["When", "Remark", "Normal", "Lamp", "Reading", "Initials"])
@pytest.mark.parametrize(
    "cell",
    ["first", "last", "at the end", "before #4", "then", "next", "2nd", "finally", "please last"],
)
def test_a_cell_that_says_when_makes_its_row_open(
    heading: str, cell: str, catalog: Catalog
) -> None:
    text = f"No | Point | Floor | {heading}\n1 | PG 1 | 1 |\n2 | R12 | 2 | {cell}\n3 | R7 | 3 |"
    heading_line, *rows = (line.state for line in draft_of(text, catalog).lines)
    # A number in one row only is asked about at the headings.
    open_rows = [UNDERSTOOD, UNDERSTOOD if heading_line is OPEN else OPEN, UNDERSTOOD]
    assert rows == open_rows
    assert heading_line is (OPEN if (heading, cell) == ("When", "2nd") else ASIDE)


@pytest.mark.parametrize("heading", ["Wann", "Bemerkung", "Soll", "Lampe"])
@pytest.mark.parametrize(
    "cell", ["zuerst", "zuletzt", "am Ende", "dann", "danach", "als zweites", "vor Ventil R25"]
)
def test_a_cell_that_says_when_makes_its_row_open_in_german(
    heading: str, cell: str, catalog: Catalog
) -> None:
    text = f"Nr. | Punkt | Ebene | {heading}\n1 | Manometer 1 | 1 |\n2 | Ventil R12 | 2 | {cell}"
    text += "\n3 | Ventil R7 | 3 |"
    draft = draft_of(text, catalog)
    assert [line.state for line in draft.lines[1:]] == [UNDERSTOOD, OPEN, UNDERSTOOD]


@pytest.mark.parametrize(
    "row", ["R25 first", "R25 (last)", "R25 - at the end", "R25 second", "zuletzt R25"]
)
def test_an_item_that_says_when_it_is_done_is_asked_about(row: str, catalog: Catalog) -> None:
    draft = draft_of(f"CHECKLIST\n[ ] PG 1\n[ ] {row}\n[ ] R12", catalog)
    assert line_at(3, draft).state is OPEN


@pytest.mark.parametrize("remark", ["next", "then", "als zweites", "2nd"])
def test_a_remark_in_a_table_of_tasks_that_says_when_is_asked_about(
    remark: str, catalog: Catalog
) -> None:
    text = f"Point | Remark\nPG 1 |\nR25 | {remark}\nR12 |"
    assert line_at(3, draft_of(text, catalog)).state is OPEN


@pytest.mark.parametrize("cell", ["first stage separator", "last calibration in 2023"])
def test_an_order_word_before_a_name_that_nobody_knows_is_a_word_that_is_not_used(
    cell: str, catalog: Catalog
) -> None:
    text = f"No | Point | Floor | Service\n1 | PG 1 | 1 | {cell}\n2 | R12 | 2 |"
    line = line_at(2, draft_of(text, catalog))
    assert line.state is PROPOSED or OPEN
    assert line.is_left


# ---- numbers below headings


SIGNS = [" ; ", "; ", ", ", " | ", "\t", ";"]


@pytest.mark.parametrize("sign", SIGNS)
@pytest.mark.parametrize(
    ("heading", "state"), [("Priority", OPEN), ("Qty", PROPOSED), ("Team", PROPOSED)]
)
def test_a_number_below_a_heading_is_no_checkpoint(
    sign: str, heading: str, state: LineState, catalog: Catalog
) -> None:
    rows = [("Point", "Floor", "Read", heading), ("R12", "2", "", "9"), ("LLG 2", "2", "", "8")]
    draft = draft_of("\n".join(sign.join(row) for row in rows), catalog)
    assert [line.state for line in draft.lines] == [ASIDE, state, state]
    offered = [line.choices or (line.sentences,) for line in draft.lines[1:]]
    for id, choices in zip((5, 7), offered, strict=True):
        assert any(choices)
        assert all(f"checkpoint {id}" in " ".join(said) for said in choices if said)
        assert not any("checkpoint 9" in " ".join(said) for said in choices)
        assert not any("checkpoint 8" in " ".join(said) for said in choices)


@pytest.mark.parametrize("sign", SIGNS)
def test_a_floor_below_a_heading_has_to_be_that_of_the_site(sign: str, catalog: Catalog) -> None:
    rows = [("Point", "Floor", "Reading"), ("R12", "2", ""), ("LLG 2", "3", "")]
    draft = draft_of("\n".join(sign.join(row) for row in rows), catalog)
    assert [line.state for line in draft.lines] == [ASIDE, UNDERSTOOD, OPEN]
    assert "on floor 2" in draft.lines[2].reason


@pytest.mark.parametrize("heading", ["Qty", "Team", "Retries", "Anzahl"])
def test_a_number_below_an_unknown_heading_is_no_floor(heading: str, catalog: Catalog) -> None:
    text = f"Point | Floor | {heading}\nR12 | 2 | 2\nR7 | 3 | 3"
    assert states(text, catalog) == [ASIDE, PROPOSED, PROPOSED]


@pytest.mark.parametrize("said", ["high", "1", "A", "niedrig"])
def test_a_priority_in_a_sheet_is_never_passed_over(said: str, catalog: Catalog) -> None:
    text = f"Punkt | Ebene | Priorität\nVentil R12 | 2 | {said}\nVentil R7 | 3 |"
    assert states(text, catalog) == [ASIDE, OPEN, UNDERSTOOD]


def test_a_row_with_more_cells_than_headings_is_asked_about(catalog: Catalog) -> None:
    text = "Point, Floor, Normal\nPG 1, 1, 3-7\nPG 2, 1, 2,5, 7"
    assert states(text, catalog) == [ASIDE, UNDERSTOOD, OPEN]


@pytest.mark.parametrize("line", ["R25, R12, R7", "R25; R12; R7", "#4, #5 and #11"])
def test_a_list_without_headings_stays_a_list(line: str, catalog: Catalog) -> None:
    mission = draft_of(f"Check these:\n{line}", catalog).require_mission()
    assert measured_in(mission) == ["4", "5", "11"]


# ---- what is left out


@pytest.mark.parametrize(
    "item",
    ["R12 - N/A", "R12 n/a", "R12: -", "R12 (n/a)", "R12 -- n.a.", "R12 = none", "R12 -"],
)
@pytest.mark.parametrize("mark", ["[ ]", "☐", "( )"])
def test_an_item_that_is_not_applicable_is_asked_about(
    mark: str, item: str, catalog: Catalog
) -> None:
    draft = draft_of(f"CHECKLIST\n{mark} PG 1\n{mark} {item}\n{mark} R7", catalog)
    assert [line.line for line in draft.left] == [3]
    assert draft.left[0].state is OPEN
    assert ("Do not check checkpoint 5.",) in draft.left[0].choices


@pytest.mark.parametrize("item", ["entf.", "- k. A.", ": -", "(entf.)", "- keine Angabe"])
def test_an_item_that_is_not_applicable_is_asked_about_in_german(
    item: str, catalog: Catalog
) -> None:
    text = f"Prüfe alle Punkte der Liste:\n[ ] Manometer 1\n[ ] Ventil R12 {item}\n[ ] Ventil R7"
    assert line_at(3, draft_of(text, catalog)).state is OPEN


@pytest.mark.parametrize("item", ["R12 - N/A", "R12 n/a", "R12 (N/A)", "R12: -"])
def test_a_line_that_is_not_applicable_is_not_read_without_a_question(
    item: str, catalog: Catalog
) -> None:
    draft = draft_of(f"1. PG 1\n2. {item}\n3. R7", catalog)
    assert line_at(2, draft).state is OPEN


@pytest.mark.parametrize("answers", ["OK / Not OK / N/A", "ok / n/a", "OK / N/A"])
def test_an_answer_that_is_offered_is_not_given(answers: str, catalog: Catalog) -> None:
    draft = draft_of(f"CHECKLIST\n[ ] PG 1  {answers}\n[ ] R7  {answers}", catalog)
    assert measured_in(draft.require_mission()) == ["1", "11"]


# ---- cases


@pytest.mark.parametrize(
    "table",
    [
        "Point | If abnormal\nPG 1 |\nR25 | return to dock",
        "| Point | If abnormal |\n| PG 1 | |\n| R25 | return to dock |",
        "Point; If abnormal\nPG 1;\nR25; return to dock",
        "Point\tIf abnormal\nPG 1\t-\nR25\treturn to dock",
        "Point   If abnormal\nPG 1    -\nR25     return to dock",
    ],
)
def test_a_column_of_cases_counts_in_each_kind_of_table(table: str, catalog: Catalog) -> None:
    line = draft_of(table, catalog).lines[-1]
    assert (line.state, line.sentences) == (
        PROPOSED,
        ("Check checkpoint 4.", "If checkpoint 4 is abnormal, return to dock."),
    )


@pytest.mark.parametrize(
    "row",
    [
        "Gauge unreadable | skip it",
        "Gauge unreadable | leave it out",
        "Reading fails | skip that one",
        "Checkpoint not readable | skip this point",
    ],
)
@pytest.mark.parametrize("above", ["Point | Normal\nPG 1 | 3-7\n", "Check PG 1.\n"])
def test_a_reading_that_fails_and_is_passed_over_is_a_reaction(
    above: str, row: str, catalog: Catalog
) -> None:
    line = draft_of(f"{above}{row}", catalog).lines[-1]
    assert (line.state, line.sentences) == (
        PROPOSED,
        ("If a reading fails, go on with the next checkpoint.",),
    )


@pytest.mark.parametrize(
    "row", ["Gauge unreadable | skip PG 3", "Gauge unreadable | skip the rest", "Gauge | skip it"]
)
def test_a_failure_that_leaves_out_more_is_asked_about(row: str, catalog: Catalog) -> None:
    assert draft_of(f"Point | Normal\nPG 1 | 3-7\n{row}", catalog).lines[-1].state is OPEN


@pytest.mark.parametrize("case", ["Heavy rain", "Radio silence", "Visitors on deck", "Fog"])
@pytest.mark.parametrize("act", ["go home", "return to dock", "wait 5 min", "abort", "skip it"])
@pytest.mark.parametrize(
    "above", ["Point | Normal\nPG 1 | 3-7\n", "Event | Action\nGas leak | go home\n", ""]
)
def test_an_act_is_never_offered_without_its_case(
    above: str, act: str, case: str, catalog: Catalog
) -> None:
    line = draft_of(f"Check #3.\n\n{above}{case} | {act}", catalog).lines[-1]
    assert (line.state, line.choices) == (OPEN, ((),))


# ---- floors over lines without blanks


@pytest.mark.parametrize("heading", ["FLOOR 4", "Floor 4", "Floor 4:", "4th floor", "Etage 4"])
def test_a_floor_over_a_line_says_which_checkpoints_are_meant(
    heading: str, catalog: Catalog
) -> None:
    text = f"ROUND\n{heading}\nall gauges\nPRESSURE GAUGES (bar)\nno. 4 ____"
    text = text.replace("all gauges", "alle Manometer") if heading == "Etage 4" else text
    draft = draft_of(text, catalog)
    assert line_at(2, draft).state is ASIDE
    assert line_at(3, draft).state is PROPOSED
    check = "Check checkpoint 13 and checkpoint 15 in any order."
    assert line_at(3, draft).sentences == (check,)


@pytest.mark.parametrize(
    "line", ["all gauges but PG 7", "all level gauges", "valve R25", "all gauges twice"]
)
def test_a_line_that_does_not_fit_the_floor_above_is_asked_about(
    line: str, catalog: Catalog
) -> None:
    assert line_at(2, draft_of(f"FLOOR 4\n{line}\n\nCheck #3.", catalog)).state is OPEN


def test_a_line_that_names_a_checkpoint_of_the_floor_above_is_understood(catalog: Catalog) -> None:
    draft = draft_of("Floor 4\nvalve R18\nFloor 1\nvalve R25", catalog)
    assert measured_in(draft.require_mission()) == ["14", "4"]


def test_a_floor_over_nothing_is_asked_about(catalog: Catalog) -> None:
    assert states("Check #3.\nFloor 4\n\nFloor 5", catalog)[1:] == [OPEN, OPEN]


# ---- how to drive, and parts of a round


@pytest.mark.parametrize(
    "field",
    [
        *("Speed: slow", "Driving speed: slow", "Pace: gentle", "Velocity: low", "Gear: low"),
        *("Driving style: calm", "Tempo: langsam", "Fahrweise: vorsichtig", "Motion: smooth"),
        *("Geschwindigkeit: gering", "Speed | slow", "Speed: 0.3 m/s"),
    ],
)
@pytest.mark.parametrize("text", ["{}\nCheck #3.\nCheck #4.", "Check #3.\nCheck #4.\n{}"])
def test_a_field_that_says_how_to_drive_is_asked_about(
    text: str, field: str, catalog: Catalog
) -> None:
    assert OPEN in states(text.format(field), catalog)


@pytest.mark.parametrize(
    "step", ["Close-out", "Start-up", "Shutdown", "Wrap-up", "Power off", "Abschluss", "Petra"]
)
def test_a_numbered_step_is_no_signature(step: str, catalog: Catalog) -> None:
    draft = draft_of(f"1. Check #3.\n2. Check #4.\n3. {step}", catalog)
    assert draft.lines[-1].state is OPEN


def test_a_name_below_the_tasks_is_a_signature(catalog: Catalog) -> None:
    assert draft_of("Check #3.\nCheck #4.\n\nPetra", catalog).lines[-1].state is ASIDE
