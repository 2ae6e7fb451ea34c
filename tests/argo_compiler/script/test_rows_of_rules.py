"""Rows and fields of sheets that say when, how often and in which case, and rows like them that
are asked about."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import Draft, DraftLine, LineState
from tests.argo_compiler.script.conftest import draft_of, measured_in

OPEN, ASIDE, PROPOSED = LineState.OPEN, LineState.SET_ASIDE, LineState.PROPOSED


def last_line(text: str, catalog: Catalog) -> DraftLine:
    return draft_of(text, catalog).lines[-1]


def below_tasks(line: str, catalog: Catalog) -> DraftLine:
    """Return what a line becomes below two tasks."""
    return last_line(f"Check #16.\nCheck #18.\n\n{line}", catalog)


def line_at(number: int, draft: Draft) -> DraftLine:
    return next(line for line in draft.lines if line.line == number)


# ---- boxes and times


@pytest.mark.parametrize("box", ["(x)", "(X)", "( x )", "(✓)"])
def test_a_ticked_box_in_round_brackets_is_asked_about(box: str, catalog: Catalog) -> None:
    draft = draft_of(f"Checklist\n{box} Valve R12\n( ) Pressure gauge 3", catalog)
    assert [line.line for line in draft.left] == [2]
    assert ("Do not check checkpoint 5.",) in draft.left[0].choices


@pytest.mark.parametrize("mark", ["(a)", "(1)", "(i)"])
def test_the_number_of_an_item_in_brackets_is_no_box(mark: str, catalog: Catalog) -> None:
    assert measured_in(draft_of(f"{mark} Valve R12", catalog).require_mission()) == ["5"]


@pytest.mark.parametrize(
    "when",
    [
        "10 to 15 min after step 1",
        "within 3 min of step 1",
        "after pressure gauge 8",
        "every 5 min",
        "before noon",
        "max 20 min",
        "pause 2 min",
    ],
)
def test_a_cell_that_says_when_is_not_passed_over(when: str, catalog: Catalog) -> None:
    rows = f"1 | pressure gauge 4 | at start\n2 | pressure gauge 6 | {when}"
    assert last_line(rows, catalog).state is OPEN


def test_a_time_after_the_row_above_is_offered_as_a_wait(catalog: Catalog) -> None:
    rows = "1 | pressure gauge 4 | at start\n2 | pressure gauge 6 | 10 to 15 min after step 1"
    wait = ("Wait for 10 minutes.", "Check checkpoint 13, taking at most 5 minutes.")
    assert last_line(rows, catalog).choices[0] == wait


@pytest.mark.parametrize("cell", ["T 10 to 15", "min 10-15", "t=10-15", "slot 10 - 15"])
def test_a_range_that_may_be_one_of_minutes_is_asked_about(cell: str, catalog: Catalog) -> None:
    line = last_line(f"{cell} | pressure gauge 3\n{cell} | valve R12", catalog)
    assert line.state is OPEN
    assert ("Check checkpoint 5 between minute 10 and minute 15.",) in line.choices


@pytest.mark.parametrize("cell", ["4-6 bar", "normal 4-6", "range: 4 - 6", "4..6 bar", "4-6"])
def test_a_range_that_is_told_to_be_normal_needs_no_answer(cell: str, catalog: Catalog) -> None:
    line = last_line(f"pressure gauge 3 | {cell}\npressure gauge 3 | {cell}", catalog)
    assert line.state is not OPEN


# ---- floors


SECTIONS = "FLOOR 4\npressure gauge 6   ____\n{}   ____\nFLOOR 6\nvalve R9   ____"


def test_all_of_a_kind_are_those_on_the_floor_above(catalog: Catalog) -> None:
    line = line_at(3, draft_of(SECTIONS.format("all gauges"), catalog))
    assert (line.state, line.sentences) == (
        PROPOSED,
        ("Check checkpoint 13 and checkpoint 15 in any order.",),
    )


@pytest.mark.parametrize(
    "row",
    ["all gauges | n/a", "all gauges twice", "all gauges but not PG 7", "the gauge", "gauges"],
)
def test_a_row_that_may_mean_others_on_the_floor_is_asked_about(row: str, catalog: Catalog) -> None:
    assert line_at(3, draft_of(SECTIONS.format(row.replace("|", "  ")), catalog)).state is OPEN


def test_a_heading_that_names_no_floor_ends_that_of_a_floor(catalog: Catalog) -> None:
    draft = draft_of(SECTIONS.format("valve R18") + "\nSEPARATOR\nall valves  ____", catalog)
    assert draft.lines[-1].state is OPEN


@pytest.mark.parametrize("row", ["the valve", "gauge", "the pressure gauge"])
def test_a_kind_alone_is_not_what_the_row_above_names(row: str, catalog: Catalog) -> None:
    assert last_line(f"valve R12  ____\npressure gauge 1  ____\n{row}  ____", catalog).state is OPEN


# ---- cases


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("gauge unreadable: try again twice", "If a reading fails, try again twice."),
        (
            "Reading fails: try once more, then carry on with the next",
            "If a reading fails, try once more, then carry on with the next.",
        ),
        (
            "checkpoint not readable | 2 more tries, then go on with the next\ngas | home",
            "If a reading fails, try again 2 times, then go on with the next.",
        ),
        ("point cannot be read: one more attempt", "If a reading fails, try again once."),
    ],
)
def test_a_failure_of_any_reading_is_a_rule(line: str, sentence: str, catalog: Catalog) -> None:
    found = line_at(4, draft_of(f"Check #16.\nCheck #18.\n\n{line}", catalog))
    assert (found.state, found.sentences) == (PROPOSED, (sentence,))


def test_a_failure_of_any_reading_is_a_rule_in_german(catalog: Catalog) -> None:
    text = "Prüfe #16.\n\nAnzeige nicht lesbar: zweimal wiederholen, dann weiter zum nächsten Punkt"
    rule = "Wenn ein Kontrollpunkt nicht gemessen werden kann, versuche es noch zweimal, dann "
    assert last_line(text, catalog).sentences == (f"{rule}fahre fort.",)


@pytest.mark.parametrize(
    "line",
    [
        "pressure gauge unreadable: try again twice",
        "gauge not unreadable: go home",
        "gauge unreadable twice: go home",
        "checkpoint readable: go home",
        "Reading fails: call me",
        "Reading fails: skip the rest",
        "Heavy rain: go back to the dock",
        "Radio silence: return to the dock",
        "Rain: wait 5 min",
        "Visitors: pause",
        "Lamp red: abort the mission",
        "Radio silence | return to the dock\nHeavy rain | return to the dock",
    ],
)
def test_a_case_that_is_not_known_is_asked_about(line: str, catalog: Catalog) -> None:
    assert below_tasks(line, catalog).state is OPEN


def test_a_limit_of_what_was_read_last_is_a_condition(catalog: Catalog) -> None:
    line = below_tasks("#18 over 8 bar | go home\n#18 below 7 bar | check #16", catalog)
    assert (line.state, line.sentences) == (PROPOSED, ("If #18 below 7 bar, check #16.",))


@pytest.mark.parametrize(
    "row",
    [
        "#16 over 50 % | go home",
        "#16 over 50 % | check #18 a second time",
        "#18 over 8 bar | skip #16",
        "#18 over 8 bar | don't go home",
        "#18 over 8 bar | call me",
        "#18 over 8 bar | 5",
        "#19 open | check #16",
        "#18 not over 8 bar or so | go home",
    ],
)
def test_a_limit_in_a_row_is_never_passed_over(row: str, catalog: Catalog) -> None:
    assert below_tasks(f"gas detected | go home\n{row}", catalog).state is OPEN


# ---- rounds


@pytest.mark.parametrize(
    ("rows", "sentence"),
    [
        ("Rounds: 4", "Repeat everything 4 times."),
        ("No. of rounds ..... 4", "Repeat everything 4 times."),
        ("Rounds | 4 | every 30 min", "Repeat everything every 30 minutes, 4 times."),
        (
            "Number of rounds | 4\nNew round every | 30 min",
            "Repeat everything every 30 minutes, 4 times.",
        ),
        (
            "A2 Pause between rounds ..... 10 min\nA3 Rounds ..... 4",
            "Repeat everything 4 times, with a wait of 10 minutes in between.",
        ),
    ],
)
def test_fields_say_how_many_rounds_there_are(rows: str, sentence: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #16.\n\n{rows}\n\nCheck #18.", catalog)
    proposed = [line for line in draft.left if line.state is PROPOSED]
    assert [line.sentences for line in proposed] == [(sentence,)]
    assert len(draft.left) == 1


@pytest.mark.parametrize(
    "rows",
    [
        "Rounds: 2 or 3",
        "Rounds: not 4",
        "Rounds done: 4",
        "Rounds per day: 4",
        "Rounds | ____\nNumber of rounds | ____",
        "Number of rounds | as needed\nInterval | 30 min",
        "Rounds | 4 of PG 8\nInterval | 30 min",
        "Rounds | 4\nRounds | 3",
        "Rounds | 4\nEvery | 30 min\nPause between rounds | 5 min",
        "Every: 30 min",
        "Rounds: 1.5",
        "Rounds: if needed 4",
    ],
)
def test_fields_that_do_not_tell_the_rounds_are_asked_about(rows: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #16.\n\n{rows}\n\nCheck #18.", catalog)
    assert OPEN in {line.state for line in draft.left}
    assert not any("Repeat" in sentence for line in draft.lines for sentence in line.sentences)


def test_fields_say_in_german_how_many_rounds_there_are(catalog: Catalog) -> None:
    draft = draft_of("Prüfe #16.\n\nAnzahl der Runden: 4\nAbstand der Runden: 1 h", catalog)
    assert [line.sentences for line in draft.left] == [
        ("Repeat everything every 60 minutes, 4 times.",)
    ]


def test_rounds_above_tasks_that_are_open_need_no_other_answer(catalog: Catalog) -> None:
    draft = draft_of("Rounds: 3\nRead the pressure gauge 1 or 2.", catalog)
    assert [line.state for line in draft.lines] == [PROPOSED, OPEN]


def test_a_time_may_stand_before_the_words_that_make_it_the_latest(catalog: Catalog) -> None:
    rows = "06:15   leave the dock in area 1\n06:20   pressure gauge 1\n{}   back in the dock"
    line = last_line(rows.format("08:00 at the latest"), catalog)
    back = "Return to the docking station, not later than 105 minutes after the start."
    assert line.sentences == (back,)


# ---- tags, scans and counts


@pytest.mark.parametrize("heading", ["Key to tags:", "Key to the tags:", "Tag key:"])
def test_a_key_to_tags_explains_them(heading: str, catalog: Catalog) -> None:
    text = f"{heading} PI-11 = pressure gauge 1, PI-12 = pressure gauge 2\nPI-12  ____\nPI-11  ____"
    assert measured_in(draft_of(text, catalog).require_mission()) == ["3", "1"]


@pytest.mark.parametrize(
    "heading", ["Key to the valves: R7 is shut", "Key to tags: PI-11 = PG 1, PI-11 = PG 2"]
)
def test_a_key_that_does_not_tell_one_point_is_asked_about(heading: str, catalog: Catalog) -> None:
    draft = draft_of(f"{heading}\nPI-11  ____\nvalve R12  ____", catalog)
    assert OPEN in {line.state for line in draft.lines}


@pytest.mark.parametrize(
    ("row", "id"),
    [
        ("' 5 Va lve Rl2    CL0SED   ______", 5),
        ("13  Valve R3 1  3  open   .......", 10),
        ("Press ure gauge B   7 - 9 bar ______", 18),
        ("Liq uid leve l gauge 2  ( % )  ______", 7),
    ],
)
def test_a_scanned_row_offers_its_checkpoint(row: str, id: int, catalog: Catalog) -> None:
    line = last_line(f"valve R9  ______\n{row}", catalog)
    assert line.state is OPEN
    assert (f"Check checkpoint {id}.",) in line.choices


def test_a_remark_that_counts_readings_is_offered_as_such(catalog: Catalog) -> None:
    rows = "Gauge | Today | Remark\nPG 6 | ____ | please read twice, needle sticks\nPG 7 | ____ |"
    line = line_at(2, draft_of(rows, catalog))
    assert (line.state, line.choices[0]) == (OPEN, ("Check checkpoint 13 2 times.",))


@pytest.mark.parametrize("title", ["Floor 3, bottom to top", "Tanks (left column first)"])
def test_a_title_that_turns_the_order_is_asked_about(title: str, catalog: Catalog) -> None:
    assert draft_of(f"{title}\nCheck #1.\nCheck #4.", catalog).lines[0].state is OPEN


@pytest.mark.parametrize(
    "heading", ["No", "Expected", "Points", "Remark", "Reading", "Time", "Initials", "Lamp"]
)
@pytest.mark.parametrize(
    "cell",
    ["if time", "not today", "after 10 min", "only if open", "skip", "tomorrow", "on Monday"],
)
def test_no_cell_beside_a_target_is_passed_over(heading: str, cell: str, catalog: Catalog) -> None:
    for target in ("valve R25", "dock", "wait 3 min"):
        rows = f"| 1 | valve R12 | |\n| 2 | {target} | {cell} |"
        line = draft_of(f"| Step | Target | {heading} |\n|---|---|---|\n{rows}", catalog).lines[-1]
        assert line.is_left, (target, line.sentences)


@pytest.mark.parametrize(
    ("heading", "cell"),
    [
        ("If exceeded", "return to dock"),
        ("What then", "abort"),
        ("Wenn zu hoch", "zurück zur Ladestation"),
        ("Speed", "0.3 m/s"),
        ("Retries", "2"),
        ("Times", "7"),
        ("Group", "A"),
        ("Lamp", "charge"),
    ],
)
def test_no_cell_of_a_checkpoint_is_passed_over(heading: str, cell: str, catalog: Catalog) -> None:
    rows = f"No | Item | {heading}\n1 | pressure gauge 1 | {cell}\n2 | valve R12 | "
    line = draft_of(f"Check #3.\n{rows}", catalog).lines[2]
    assert line.is_left, line.sentences


@pytest.mark.parametrize(
    "row",
    [
        "- [ ] #9 pressure gauge 4 after #10",
        "- [ ] #10 valve R31 (see #11)",
        "- [ ] ~~#17 valve R40~~",
        "- [ ] #13 pressure gauge 6, only if #3 is out of range",
        "- [ ] #8 pressure gauge 5, then home",
    ],
)
def test_a_row_of_a_checklist_is_read_whole_or_left(row: str, catalog: Catalog) -> None:
    assert draft_of(f"Check #3.\n{row}\n- [ ] #6", catalog).lines[1].is_left
