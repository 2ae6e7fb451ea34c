"""Kinds of scripts as people write them: what a draft proposes, asks and sets aside of each."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import Mission, Order
from argo_compiler.script import DraftLine, LineState
from tests.argo_compiler.script.conftest import draft_of, measured_in

OPEN, PROPOSED = LineState.OPEN, LineState.PROPOSED
ASIDE, UNDERSTOOD = LineState.SET_ASIDE, LineState.UNDERSTOOD


def confirmed(text: str, catalog: Catalog) -> Mission:
    """Return the mission after all that is proposed is confirmed."""
    draft = draft_of(text, catalog)
    return draft_of(text, catalog, draft.confirm()).require_mission()


def last(text: str, catalog: Catalog) -> DraftLine:
    return draft_of(text, catalog).lines[-1]


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("Skip R12 unless #1 is above 6 bar.", "If #1 is above 6 bar, check R12."),
        ("Leave out R12 if #1 is above 6 bar.", "Check R12 unless #1 is above 6 bar."),
        ("Battery under 25 %: return to the dock.", "If Battery under 25 %, return to the dock."),
        ("Gas alarm: go home", "If Gas alarm, go home."),
        ("when 50 % is passed: read #4", "If it is above 50 %: read #4."),
        ("If #6 is too high, check R12.", "If #6 is above 7, check R12."),
        ("Between minute 5 and 10: R12", "Check R12 between minute 5 and minute 10."),
        ("Everything must be finished by minute 45", "Maximum duration: 45 minutes."),
        ("read it every 2 min, six readings", "Read it every 2 min, six times."),
    ],
)
def test_a_condition_in_other_words_is_proposed_whole(
    line: str, sentence: str, catalog: Catalog
) -> None:
    found = last(f"Check liquid level gauge 1.\n{line}", catalog)
    assert (found.state, found.sentences, found.unused) == (PROPOSED, (sentence,), ())


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (
            "Bei Gasalarm sofort ins Dock.",
            "Wenn ein Gasleck erkannt wird, kehre zur Dockingstation zurück.",
        ),
        (
            "alle 15 Minuten eine Runde, insgesamt vier",
            "Wiederhole alles alle 15 Minuten, vier mal.",
        ),
    ],
)
def test_a_german_condition_likewise(line: str, sentence: str, catalog: Catalog) -> None:
    found = last(f"Prüfe Ventil R25 und Ventil R12.\n{line}", catalog)
    assert (found.state, found.sentences) == (PROPOSED, (sentence,))


@pytest.mark.parametrize(
    "line",
    [
        "On smoke, return to the dock.",
        "In case of rain: return to the dock",
        "With the lid closed, read valve R12.",
        "If it rains, check valve R12.",
        "Check liquid level gauge 4 as long as R40 is closed.",
        "Check R9 and, provided the hatch is open, R12.",
        "Check valve R12 unless the gate is locked off.",
        "R12 once R25 was read",
        "Done today: R12, R31",
        "R12 - out of order?",
        "R12 = R31",
        "back to the dock, but not before R12 was read",
        "ten minutes later R12 if the hatch is open",
        "R12: two readings not ten minutes apart",
        "everything finished by minute 45 except R12",
        "sorry, not R25 but R12 or R31",
        "do not leave out R12",
        "there is no need for R12 to be skipped",
        "any order is fine except R12 first",
        "After three failures in all, come home.",
        "An abnormal reading is read again once; the run is not broken off.",
        "Be back in the dock before the tea break.",
        "Do not let it climb to floor 5.",
    ],
)
def test_a_condition_that_is_not_understood_is_never_passed_over(
    line: str, catalog: Catalog
) -> None:
    draft = draft_of(f"Check #1.\n{line}", catalog)
    states = {one.state for one in draft.lines if one.line == 2}
    assert OPEN in states
    assert draft_of(f"Check #1.\n{line}", catalog, draft.confirm()).mission is None


@pytest.mark.parametrize(
    ("line", "ids"),
    [
        ("sorry, not R25 but R12", ["1", "5"]),
        ("no wait, R12 instead of R25", ["1", "5"]),
        ("correction: R12, not R25", ["1", "5"]),
        ("R12 instead of R25", ["1", "5"]),
        ("leave out R25, the fitter is working on it", ["1"]),
        ("let's leave it", ["1"]),
        ("R25 is not needed, scaffolding", ["1"]),
    ],
)
def test_a_correction_changes_what_stands_above_it(
    line: str, ids: list[str], catalog: Catalog
) -> None:
    assert measured_in(confirmed(f"pressure gauge 1\nvalve R25\n{line}", catalog)) == ids


def test_a_german_correction(catalog: Catalog) -> None:
    text = "Manometer 1\nVentil R25\nach Quatsch, nicht R25, sondern R12\nManometer 1 doch nicht"
    assert measured_in(confirmed(text, catalog)) == ["5"]


def test_what_is_left_out_twice_is_left_out_once(catalog: Catalog) -> None:
    text = "check R25\ncheck R40\nlet's leave it\nok leave it\nback home"
    draft = draft_of(text, catalog)
    assert [line.state for line in draft.lines][2:4] == [PROPOSED, ASIDE]
    assert measured_in(confirmed(text, catalog)) == ["4"]


def test_a_correction_of_what_is_not_asked_for_is_asked_about(catalog: Catalog) -> None:
    assert last("Check #1.\nR12 instead of R25", catalog).state is OPEN


@pytest.mark.parametrize(
    "line",
    [
        "Yes.",
        "ok, thanks",
        "Sure, what should it look at?",
        "How long will that take?",
        "Ping me if it gets stuck.",
        "Enter a dash where no reading was taken.",
        "The inspector's badge is at reception.",
        "As announced on Monday, the demonstration takes place in the yard.",
        "No need to go upstairs.",
        "PERMITS",
        "None open",
        "-----Original Message-----",
        "Name:        Date:",
        "Team: Blue       Trial: 2",
    ],
)
def test_a_line_that_asks_for_nothing_is_set_aside_with_a_reason(
    line: str, catalog: Catalog
) -> None:
    draft = draft_of(f"Check #1.\n\n{line}\n\nCheck #4.", catalog)
    found = [one for one in draft.lines if one.line == 3]
    assert {one.state for one in found} == {ASIDE}
    assert all(one.reason for one in found)


@pytest.mark.parametrize(
    "line",
    [
        "Photograph the pump.",
        "PHOTOGRAPH THE PUMP AND #8",
        "What about R12?",
        "Should it check R12 too?",
        "Ping R12 twice.",
        "The robot takes the other stairs.",
        "No need to read R12 slowly, but read it.",
        "Norbert",
    ],
)
def test_a_line_is_not_set_aside_because_it_is_unknown(line: str, catalog: Catalog) -> None:
    draft = draft_of(f"Check #1.\n\n{line}\n\nCheck #4.\nCheck #8.\nGo home.", catalog)
    (first, *_) = [one.state for one in draft.lines if one.line == 3]
    assert first is not ASIDE


@pytest.mark.parametrize("line", ["R12 last", "R12 on", "R12 maybe", "R12 in the morning"])
def test_a_line_with_a_word_that_may_mean_more_has_to_be_confirmed(
    line: str, catalog: Catalog
) -> None:
    assert last(f"Check #1.\n{line}", catalog).state is PROPOSED


def test_what_comes_last_is_last(catalog: Catalog) -> None:
    text = "pressure gauge 1\nR12 last\n"
    assert measured_in(confirmed(text, catalog)) == ["1", "5"]
    draft = draft_of(f"{text}R31\n", catalog)
    assert draft.lines[1].state is OPEN


def test_an_order_of_its_own_contradicts_what_leaves_it_out(catalog: Catalog) -> None:
    draft = draft_of("R12 is out of service.\nCheck #1.\nCheck R12.", catalog)
    assert draft_of("R12 is out of service.\nCheck #1.\nCheck R12.", catalog, draft.confirm()).left


def test_no_line_becomes_the_title_when_the_one_above_it_is_set_aside(catalog: Catalog) -> None:
    text = "Photograph the pump.\narea 1 as always\nCheck #1."
    draft = draft_of(text, catalog)
    aside = draft_of(text, catalog, draft.set_aside(["1"]))
    assert [line.state for line in aside.lines] == [ASIDE, OPEN, UNDERSTOOD]


def test_a_reply_takes_the_list_that_it_quotes(catalog: Catalog) -> None:
    text = (
        "Same list as below please, but leave out R31.\nIn any order.\n\nRegards\nInes\n\n"
        "> Hi Ines,\n> - checkpoint 9\n> - checkpoint 10\n> - checkpoint 11\n"
    )
    mission = confirmed(text, catalog)
    assert sorted(measured_in(mission)) == ["11", "9"]
    assert mission.order is Order.ANY


def test_a_reply_with_tasks_of_its_own_asks_about_the_quoted_ones(catalog: Catalog) -> None:
    draft = draft_of("Check #1.\n\n> Check #4.\n> Check #5.\n", catalog)
    assert draft.mission is None
    assert OPEN in {line.state for line in draft.lines}


def test_a_plan_by_the_clock_counts_from_its_start(catalog: Catalog) -> None:
    text = "23:50 start in area 1\n00:00 pressure gauge 1\n00:20 R25\nby 00:30 back in the dock\n"
    mission = confirmed(text, catalog)
    windows = [(task.window.earliest, task.window.latest) for task in mission.tasks if task.window]
    assert measured_in(mission) == ["1", "4"]
    assert windows == [(600, None), (1800, None), (0, 2400)]


@pytest.mark.parametrize(
    "text",
    [
        "07:40 pressure gauge 1\n08:00 valve R25\n",
        "Plan for 20 June\n07:30 start in area 1\n07:40 pressure gauge 1\n",
        "07:30 start in area 1\nuntil 08:00 wait on floor 5\n",
    ],
)
def test_a_clock_that_can_not_be_counted_is_asked_about(text: str, catalog: Catalog) -> None:
    draft = draft_of(text, catalog)
    assert OPEN in {line.state for line in draft.lines}
    assert draft_of(text, catalog, draft.confirm()).mission is None


@pytest.mark.parametrize(
    "line",
    [
        "Read R25 at least 5 but at most 8 minutes after pressure gauge 1.",
        "Read R25 between 5 and 8 minutes after pressure gauge 1.",
        "R25 5 to 8 minutes after pressure gauge 1",
        "Read R25 no sooner than 5 and no later than 8 min after pressure gauge 1.",
    ],
)
def test_a_time_between_two_limits_after_a_reading(line: str, catalog: Catalog) -> None:
    found = last(f"Check pressure gauge 1.\n{line}", catalog)
    wanted = ("Wait for 5 minutes.", "Check checkpoint 4, taking at most 3 minutes.")
    assert (found.state, found.sentences) == (PROPOSED, wanted)
    assert last(f"Check #1. Check #5.\n{line}", catalog).state is OPEN


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("Checkpoint #1 3: read the value on pressure gauge 6", ["13"]),
        ("Checkpoint # 10: read the position of valve R3 1", ["10"]),
    ],
)
def test_figures_are_put_together_where_number_and_name_agree(
    text: str, ids: list[str], catalog: Catalog
) -> None:
    assert last(f"Check #1.\n{text}", catalog).state is PROPOSED
    assert measured_in(confirmed(f"Check #1.\n{text}", catalog)) == ["1", *ids]


def test_figures_are_left_where_number_and_name_differ(catalog: Catalog) -> None:
    line = last("Check #1.\nCheckpoint #1 3: read the value on pressure gauge 5", catalog)
    assert line.state is OPEN


@pytest.mark.parametrize(
    ("line", "choices"),
    [
        (
            "If it is out of range, read it again.",
            [
                "If checkpoint 9 is out of range, read checkpoint 9 again.",
                "If checkpoint 13 is out of range, read checkpoint 13 again.",
            ],
        ),
        ("Check gauge 8.", ["Check checkpoint 8.", "Check checkpoint 18."]),
        ("R40 or R9", ["Check checkpoint 17.", "Check checkpoint 19."]),
        ("R12 -- done by hand, leave out", ["Check checkpoint 5.", "Do not check checkpoint 5."]),
    ],
)
def test_what_has_several_meanings_has_them_as_choices(
    line: str, choices: list[str], catalog: Catalog
) -> None:
    found = last(f"Check pressure gauge 4 and pressure gauge 6.\n{line}", catalog)
    assert found.state is OPEN
    assert {(choice,) for choice in choices} | {()} <= {*found.choices}


@pytest.mark.parametrize(
    ("text", "chosen"),
    [
        ("If it is too high, check valve R7.", "If checkpoint 13 is above 7, check valve R7."),
        ("If the pressure was too low, go home.", "If checkpoint 13 was below 3, go home."),
    ],
)
def test_each_candidate_of_a_pronoun_is_a_choice(text: str, chosen: str, catalog: Catalog) -> None:
    line = last(f"Check pressure gauge 4 and pressure gauge 6.\n{text}", catalog)
    assert line.state is OPEN
    assert (chosen,) in line.choices
    assert (chosen.replace("13", "9"),) in line.choices


@pytest.mark.parametrize(
    ("line", "sentences"),
    [
        (
            "Valves R7 and R31 twice each",
            ("Check checkpoint 11 2 times.", "Check checkpoint 10 2 times."),
        ),
        (
            "for the visit we need the whole third floor: all gauges and valves there except R7",
            ("Check checkpoint 9, checkpoint 12 and checkpoint 10 in any order.",),
        ),
        (
            "On the second floor it reads both pressure gauges",
            ("Check checkpoint 6 and checkpoint 8 in any order.",),
        ),
        ("End: docking station, same area", ("End of the mission: starting area 1.",)),
    ],
)
def test_a_clause_is_proposed(line: str, sentences: tuple[str, ...], catalog: Catalog) -> None:
    found = last(f"Check #1.\n{line}", catalog)
    assert found.sentences == sentences
    assert found.state in (PROPOSED, UNDERSTOOD)


HEADINGS = "No | Point | Normal | Reading | Remark\n"


@pytest.mark.parametrize(
    ("row", "state"),
    [
        ("1 | valve R25 | in open position | | ", UNDERSTOOD),
        ("1 | Is valve R25 closed? | | | ", UNDERSTOOD),
        ("1 | R25: confirm it is still closed | | | ", UNDERSTOOD),
        ("1 | valve R25 | closed | | tap the glass", PROPOSED),
        ("1 | valve R25 | closed | x | ", OPEN),
        ("1 | valve R25 | closed | done | ", OPEN),
        ("1 | valve R25 | closed | | n/a", OPEN),
        ("1 | valve R25 | closed | | out of service", PROPOSED),
        ("1 | ladder in good condition | | | ", OPEN),
    ],
)
def test_a_row_of_a_checklist(row: str, state: LineState, catalog: Catalog) -> None:
    found = draft_of(f"{HEADINGS}{row}\n2 | #1 | | |\n", catalog).lines[1]
    assert found.state is state


@pytest.mark.parametrize(
    "title",
    [
        "OUTSIDE ROUND - UNIT 20                Sheet 2",
        "WEEKLY WALK-DOWN     Floors 5 and 6     Week no. ____",
        "Weekend round (reduced)     Sat [ ]   Sun [ ]",
    ],
)
def test_the_first_row_of_a_sheet_is_its_title(title: str, catalog: Catalog) -> None:
    draft = draft_of(f"{title}\nPoint     Reading\nR25       ____\n", catalog)
    assert draft.lines[0].reason == "the title"
    assert measured_in(draft.require_mission()) == ["4"]


def test_rows_that_commas_cut(catalog: Catalog) -> None:
    text = "Point,Normal,Reading,Remark\npressure gauge 4,3-7 bar,,\nvalve R7,closed,,leave out\n"
    assert measured_in(confirmed(text, catalog)) == ["9"]


def test_a_limit_before_then_is_of_the_whole_mission(catalog: Catalog) -> None:
    for _ in range(2):  # a text that was read before says the same
        text = "Check #1.\n20 min max, then back to its dock"
        assert confirmed(text, catalog).max_duration == 1200
    assert confirmed("Check #1.\nCheck #4.\nmax 15 min", catalog).max_duration == 900


@pytest.mark.parametrize(
    "text", ["Do not forget the coffee ;-)", "Kaffee nicht vergessen ;-)", "x , y"]
)
def test_a_blank_before_a_sign_is_read(text: str, catalog: Catalog) -> None:
    draft = draft_of(f"Start in starting area 1.\nCheck #1.\n{text}", catalog)
    assert draft.lines


@pytest.mark.parametrize(
    "line",
    ["Take checkpoint #18 out again", "Cross R12 off then", "Nimm Messpunkt 18 wieder raus"],
)
def test_a_word_that_takes_away_is_never_passed_over(line: str, catalog: Catalog) -> None:
    (*_, last) = draft_of(f"Check checkpoint 18 and R12.\n{line}", catalog).lines
    assert last.state is LineState.OPEN
    assert any(said.startswith("Delete") for sentences in last.choices for said in sentences)
