"""Choices of open lines: the nearest readings, of which a person takes one."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import LineState, import_script
from tests.argo_compiler.script.conftest import draft_of, measured_in

BEFORE = "Check pressure gauge 3 and valve R12.\n"


@pytest.mark.parametrize(
    ("line", "choice"),
    [
        # by parts
        ("PG3 > LG2 > PG5 hmm", "Check checkpoint 6. Check checkpoint 7. Check checkpoint 8."),
        (
            "then go up to the top floor and read the liquid level gauge there, um, "
            "if it isn't foggy, and come home",
            "Check checkpoint 20. Return to the docking station.",
        ),
        ("hmm than level guage 3, its up there", "Check checkpoint 12."),
        (
            "Kim: hmm, everything on floor 6, but why?",
            "Check checkpoint 19 and checkpoint 20 in any order.",
        ),
        # what is taken back
        ("R7, then R31 - oh wait, not R31, R40", "Check checkpoint 11 and checkpoint 17."),
        # areas, also by their initial
        ("the bot parks in A2 over the weekend", "Start in starting area 2."),
        ("yep, docked at area 2 since 6", "Start in starting area 2."),
        (
            "Area 2, there and back again",
            "Start in starting area 2. End of the mission: starting area 2.",
        ),
        # events
        (
            "In the event of gas alarm everybody leaves, robot goes to its dock",
            "If a gas leak is detected, return to the docking station.",
        ),
        # conditions, whatever their grammar
        (
            "Attention: if manometer 3 is more than 6 bar the tour is finished and the robot come "
            "back to the docking station",
            "If checkpoint 6 is above 6 bar, return to the docking station.",
        ),
        (
            "PG 7 under 0.5 bar -> stop there, whatever is left gets dropped",
            "Check checkpoint 15. If checkpoint 15 is below 0.5 bar, abort the mission.",
        ),
        (
            "hm R12 not inside 40 to 50 deg, wait 2 min n look at it again",
            "If checkpoint 5 is outside 40 to 50 deg, wait for 2 minutes and "
            "check checkpoint 5 again.",
        ),
        (
            "Bob says: poll pressure gauge 3 every minute until it shows more than 5 bar",
            "Check checkpoint 6 every 1 minute until it is above 5 bar.",
        ),
        # failures
        ("gauge cannot be read: one more try, Joe", "If a reading fails, try again once."),
        (
            "Way to the gauge obstructed: omit it, carry on pls",
            "If a reading fails, go on with the next checkpoint.",
        ),
        (
            "blocked path -> hang on 2 min, Joe",
            "If a positive obstacle is detected, pause for at most 2 minutes, and resume.",
        ),
        # changes of what stands above
        ("hm, PG 3 is wrong there, Bob meant PG 4", "Replace checkpoint 6 by checkpoint 9."),
        ("please put R12 first of all in that list, Bob", "Move checkpoint 5 before checkpoint 6."),
        ("Bob wants the pressure gauge 3 last", "Move checkpoint 6 after checkpoint 5."),
        ("R12 falls out tomorrow only if it rains", "Delete checkpoint 5."),
        # rounds
        (
            "Jeweils 3 Runden, zwischen den Runden 10 Minuten Pause",
            "Repeat everything 3 times, with a wait of 10 minutes in between.",
        ),
        ("Do a tour at 06:00 and then at 10:00", "Repeat everything every 240 minutes, 2 times."),
        (
            "full sets hourly: every hour, 08:00 first, 11:00 last",
            "Repeat everything every 60 minutes, 4 times.",
        ),
        # one after the other
        (
            "Bob: PG 4, 2 min of peace, PG 5, home",
            "Check checkpoint 9. Wait for 2 minutes. Check checkpoint 8. "
            "Return to the docking station.",
        ),
        (
            "7 points, Bob: 19 20 18 17",
            "Check checkpoint 19, checkpoint 20, checkpoint 18 and checkpoint 17.",
        ),
        (
            "#2 - #4 - #7 - #6 - then dock in area 1, ok?",
            "Check checkpoint 2, checkpoint 4, checkpoint 7 and checkpoint 6. "
            "Return to the docking station in starting area 1.",
        ),
        # failures
        (
            "gauge illegible - hmm, try again twice, carry on",
            "If a reading fails, try again twice.",
        ),
        (
            "No reading - 2 more tries and after that, hmm, dock",
            "If a reading fails, try again twice. If it still fails, return to the docking "
            "station.",
        ),
        (
            "and if it can't see R12 skip it",
            "If checkpoint 5 fails, go on with the next checkpoint.",
        ),
        (
            "Check R7. If it can't be read try twice more, and if that fails too take PG4 instead",
            "If checkpoint 11 fails, try again twice. If it still fails, check checkpoint 9.",
        ),
        (
            "Should pressure gauge 3 be unreadable, take valve R7 in its place",
            "If checkpoint 6 fails, check checkpoint 11.",
        ),
        # changes of the list above
        (
            "Hang valve R7 between pressure gauge 3 and valve R12",
            "Add checkpoint 11 after checkpoint 6.",
        ),
        ("Put valve R7 at the beginning of your list", "Add checkpoint 11 before checkpoint 6."),
        # the order, times, and numbers that can be checkpoints
        ("The exact sequence is up to you", "Order: any."),
        ("Hurry up, lunch is in 20 minutes", "Maximum duration: 20 minutes."),
        ("oh, and 14 too I guess", "Check checkpoint 14."),
    ],
)
def test_an_open_line_offers_its_nearest_readings(line: str, choice: str, catalog: Catalog) -> None:
    (*_, last) = draft_of(BEFORE + line, catalog).lines
    assert last.state is LineState.OPEN
    assert choice in [" ".join(sentences) for sentences in last.choices]
    assert last.choices[-1] == (), "it can be set aside"


def test_a_choice_is_worked_into_the_mission(catalog: Catalog) -> None:
    draft = draft_of(f"{BEFORE}R7, then R31 - oh wait, not R31, R40", catalog)
    decisions = draft.choose("2", 1)
    mission = draft_of(draft.text, catalog, decisions).require_mission()
    assert measured_in(mission) == ["6", "5", "11", "17"]


def test_a_line_that_does_not_fit_offers_its_readings_too(catalog: Catalog) -> None:
    (line,) = draft_of("Checkpoint #7: read pressure gauge 7", catalog).lines
    assert line.is_question
    assert {("Check checkpoint 7.",), ("Check checkpoint 15.",)} <= {*line.choices}


def test_a_time_with_two_readings_is_in_no_choice(catalog: Catalog) -> None:
    (*_, last) = draft_of(f"{BEFORE}4 rounds: 06:00, 08:00, 10:00 and 12:00, or so", catalog).lines
    said = [sentence for sentences in last.choices for sentence in sentences]
    assert "Repeat everything 4 times." in said
    assert not any("None" in sentence for sentence in said)


def test_the_text_of_an_open_line_is_no_choice(catalog: Catalog) -> None:
    (*_, last) = draft_of(f"{BEFORE}every 30 min, 4 rounds total", catalog).lines
    assert last.choices[0] == ("Repeat everything every 30 minutes, 4 times.",)


def test_a_choice_that_does_not_fit_leaves_the_others(catalog: Catalog) -> None:
    text = f"{BEFORE}If that one is more than 30 deg, halt there and go to the dock in area 1."
    draft = draft_of(text, catalog)
    line = draft.lines[-1]
    wrong = next(i for i, one in enumerate(line.choices, start=1) if "halt there" in one[0])
    again = draft_of(text, catalog, draft.choose(line.label, wrong)).lines[-1]
    assert again.state is LineState.OPEN
    assert again.choices == (*line.choices[: wrong - 1], *line.choices[wrong:])


def test_an_end_and_a_limit_of_time_are_one_choice(catalog: Catalog) -> None:
    (*_, last) = draft_of(f"{BEFORE}finish in starting area 1 within 45 min", catalog).lines
    end = "Return to the docking station in starting area 1."
    assert ("Maximum duration: 45 minutes.", end) in last.choices


def test_a_sentence_about_a_step_is_not_that_step(catalog: Catalog) -> None:
    text = "Step 1 check R7\nStep 2 check R12\nStep 2 is cancelled"
    (*_, last) = draft_of(text, catalog).lines
    assert last.text == "Step 2 is cancelled"
    assert last.choices[0] == ("Delete checkpoint 5.",)


def test_the_hint_of_an_open_line_is_about_its_own_checkpoint(catalog: Catalog) -> None:
    draft = draft_of(f"{BEFORE}Befriend valve R7.", catalog)
    assert draft.lines[-1].hint == ""  # the choices stand beside it
    assert "`Check checkpoint 11.`" in str(draft.diagnostics[-1].hint)


def test_rounds_may_be_chosen_above_the_tasks_that_are_open(catalog: Catalog) -> None:
    text = "every 30 min do a round, 6 rounds in all\nround = R7, PG3, somehow"
    draft = draft_of(text, catalog)
    rounds, tasks = draft_of(text, catalog, draft.choose("1", 1)).lines
    assert rounds.state is LineState.UNDERSTOOD
    assert tasks.state is LineState.OPEN


def test_a_return_that_is_chosen_above_the_tasks_is_the_end(catalog: Catalog) -> None:
    text = "3.2 The whole thing ends docked where it began, Mia.\n1. Check #3.\n2. Check #5."
    choices = import_script(text, catalog).lines[0].choices
    assert ("End of the mission: docking station.",) in choices


def test_a_time_before_which_nothing_is_done_moves_no_checkpoint(catalog: Catalog) -> None:
    (*_, last) = draft_of(f"{BEFORE}hmm, R7 but not before 11:00, they are filling", catalog).lines
    assert last.choices[0] == ("Check checkpoint 11.",)


@pytest.mark.parametrize(
    ("above", "line", "choice"),
    [
        # what is left out stays so, also in a case that Argo does not know
        ("Check pressure gauge 2.", "In case of fog, leave valve R9 out", "Do not check #19."),
        ("Prüfe Manometer 2.", "Sollte Nebel sein, R9 auslassen", "Do not check #19."),
        ("Prüfe Manometer 2.", "Ventil R25 lassen wir heute aus", "Do not check #4."),
        ("Prüfe R31.", "R31 bei Sturm lassen wir weg", "Delete #10."),
        ("Check R9.", "No need for PG 5 but do PG 6", "Do not check #8. Check #13."),
        ("Prüfe R9.", "R31 statt R12", "Do not check #5. Check #10."),
        (
            "Check R9.",
            "Leave all gauges on floor 3 alone apart from PG 4",
            "Do not check #12.",
        ),
        (
            "Prüfe R9.",
            "Lass alle Füllstandsmesser in Ruhe außer Nr. 3",
            "Do not check #2, #7, #16 and #20.",
        ),
        ("Check R9.", "Never more than two valves", ""),
        ("Prüfe R9.", "Nie mehr als zwei Ventile prüfen", ""),
        # what is left out in a case
        (
            "Check PG 4.",
            "If PG 4 shows more than 8 bar, skip R31 and come straight home, mate",
            "If #9 is above 8 bar, return to the docking station.",
        ),
        ("Check PG 1.", "If PG 1 is over 5, leave out R25, mate", "Check #4 unless #1 is above 5."),
        (
            "Prüfe Manometer 1.",
            "Wenn Manometer 1 über 5 ist, R25 weglassen",
            "Check #4 unless #1 is above 5.",
        ),
        ("Check PG 2.", "Unless PG 2 is above 4, skip R7, ey", "Check #11 unless #3 is at most 4."),
        # two limits, two cases, retries
        (
            "Check PG 4.",
            "If PG 4 still above 8 bar, redo every 10 min until it is below.",
            "If #9 is above 8 bar, check #9 every 10 minutes until it is below 8 bar.",
        ),
        (
            "Prüfe Manometer 4.",
            "Liegt Manometer 4 noch über 8 bar, alle 10 min prüfen, bis es unter 7 bar liegt",
            "If #9 is above 8 bar, check #9 every 10 minutes until it is below 7 bar.",
        ),
        (
            "Check PG 2.",
            "If it is between 2 and 4 bar, go on with R12, otherwise read PG 3 instead.",
            "If #3 is between 2 and 4 bar, check #5. Otherwise, check #6.",
        ),
        (
            "Prüfe Manometer 2.",
            "Liegt er zwischen 2 und 4 bar, weiter mit R12, sonst stattdessen Manometer 3 ablesen.",
            "If #3 is between 2 and 4 bar, check #5. Otherwise, check #6.",
        ),
        ("Check PG 1.", "Check R9 up to three attempts", "Check #19, retry twice."),
        ("Check R9.", "R18 (no more than 2 retries)", "Check #14, retry twice."),
        ("Prüfe R9.", "R18 (höchstens 2 Wiederholungen)", "Check #14, retry twice."),
        ("Prüfe R9.", "R18, bis zu drei Versuche", "Check #14, retry twice."),
        # failures
        (
            "Check R9 and R40.",
            "If it can't be read, carry on with level gauge 5.",
            "If #17 fails, check #20.",
        ),
        (
            "Check R9.",
            "Check level gauge 5, and if it can't be read either, go home.",
            "Check #20. If #20 fails, return to the docking station.",
        ),
        (
            "Prüfe R9.",
            "Füllstandsmesser 5 prüfen, und wenn auch der nicht lesbar ist, heimfahren.",
            "Check #20. If #20 fails, return to the docking station.",
        ),
        # areas and times
        (
            "Check R12.",
            "dock at 2 again when done",
            "Return to the docking station in starting area 2.",
        ),
        (
            "Prüfe R12.",
            "wenn fertig wieder an 2 andocken",
            "Return to the docking station in starting area 2.",
        ),
        (
            "",
            "ok then pls start at area 2, do R40 and PG 8",
            "Start in starting area 2. Check #17 and #18.",
        ),
        (
            "Check R9.",
            "robot leaves from area 2 and has to be back there after 30 minutes",
            "Start in starting area 2. End of the mission: starting area 2. "
            "Maximum duration: 30 minutes.",
        ),
        ("Check R9.", "Finish by 20 minutes", "Maximum duration: 20 minutes."),
        (
            "Prüfe R9.",
            "Bei 30 Minuten heimfahren",
            "Maximum duration: 30 minutes. If the time is up, return to the docking station.",
        ),
        ("", "Check PG 2 in 10 minutes", "Wait for 10 minutes. Check #3."),
        (
            "Check R9.",
            "PG 3 by 20 minutes, mate",
            "Check #6 not later than 20 minutes after the start.",
        ),
        (
            "Check PG 6.",
            "at least 5 but at most 8 minutes after pressure gauge 6, read pressure gauge 7",
            "Wait for 5 minutes. Check #15, taking at most 3 minutes.",
        ),
        # order and numbers
        ("Check R9.", "R7 not before R31", "Check #10. Check #11."),
        ("Prüfe R31 und R7.", "R31 erst nach R7", "Move #10 after #11."),
        ("Check R9.", "R40 before R18, mate", "Check #17. Check #14."),
        ("Check PG 3.", "scratch that, number two, not three", "Replace #6 by #3."),
        ("Prüfe Manometer 3.", "Quatsch, Nummer zwei, nicht drei", "Replace #6 by #3."),
        (
            "1. Check PG 1.\n2. Check R12.\n3. Check R7.",
            "Step 2 and step 3 are swapped",
            "Move #11 before #5.",
        ),
        (
            "Prüfe R12, R7 und R9.",
            "R12 und R9 sind vertauscht",
            "Move #19 before #5. Move #5 after #11.",
        ),
        ("Check PG 1.\nCheck R12.", "Swap the two", "Move #5 before #1."),
        ("Prüfe PG 1.\nPrüfe R12.", "Vertausche die beiden", "Move #5 before #1."),
        (
            "Check PG 1.",
            "If it reads 4 to 5 bar home",
            "If #1 is from 4 to 5 bar, return to the docking station.",
        ),
        ("Check PG 1.", "Read it twice if possible", "Check #1 2 times."),
    ],
)
def test_the_first_choice_means_what_the_line_asks_for(
    above: str, line: str, choice: str, catalog: Catalog
) -> None:
    (*_, last) = draft_of(f"{above}\n{line}", catalog).lines
    assert last.state is LineState.OPEN
    assert " ".join(last.choices[0]) == choice.replace("#", "checkpoint ")


@pytest.mark.parametrize(
    "line", ["If it is above 60 psia, go home.", "If it is above 20 °, go home."]
)
def test_no_choice_has_a_unit_that_does_not_fit(line: str, catalog: Catalog) -> None:
    (*_, last) = draft_of(f"Check #1.\n{line}", catalog).lines
    assert last.state is LineState.OPEN
    assert last.choices == ((),)


@pytest.mark.parametrize(
    "line",
    [
        "Check either R9 or R40.",
        "Check checkpoint 1, if possible twice.",
        "Every 15 minutes R9, mate",
        "Read one of them, then skip the other.",
        "Check seven and off we go, mate",
        "If Foo is out of range, read it twice.",
        "R9, then the one after that, mate",
        "PG 4 - then PG 4 and PG 2, mate, why not",
        "Prüfe entweder R9 oder R40.",
        "Alle 15 Minuten R9, ey",
        "R12 oder R7 oder R9 oder R40 oder R18 oder R31 oder R25 oder Manometer 1 oder 2 ablesen",
        "Please read #1 #4 #5 #7 #8 #9 and 11, whatever, in 5 minutes, mate, or home",
    ],
)
def test_each_choice_is_understood_once_it_is_taken(line: str, catalog: Catalog) -> None:
    draft = draft_of(BEFORE + line, catalog)
    open_lines = [one for one in draft.lines if one.state is LineState.OPEN]
    assert open_lines
    for one in open_lines:
        assert len(one.choices) <= 9, "each has a key"
        for number, choice in enumerate(one.choices, start=1):
            taken = draft_of(draft.text, catalog, draft.choose(one.label, number))
            (same,) = (line for line in taken.lines if line.label == one.label)
            assert same.state is not LineState.OPEN, choice


@pytest.mark.parametrize(
    ("line", "never"),
    [
        ("If PG 3 is over 6 bar, leave out R7, mate", "If checkpoint 6 is above 6 bar, check"),
        ("If PG 3 is over 6 bar, R7, mate", "Check checkpoint 11."),
        ("Wenn Manometer 3 über 6 bar ist, R7 dazu, ey", "Check checkpoint 11."),
        ("PG 3 has to be out, R7 stays in, mate", "Delete checkpoint 5."),
        ("skip R7 as R31 is leaking, mate", "Check checkpoint 11."),
        ("R7 bitte weglassen, R31 nicht, ey", "Check checkpoint 11."),
        ("Limit 25 minutes, says Bob", "Wait for 25 minutes."),
        ("Höchstens 25 Minuten, meint Bob", "Wait for 25 minutes."),
    ],
)
def test_no_choice_says_what_the_line_does_not(line: str, never: str, catalog: Catalog) -> None:
    draft = draft_of(f"Maximum duration: 40 min.\n{BEFORE}{line}", catalog)
    (*_, last) = draft.lines
    assert not any(" ".join(choice).startswith(never) for choice in last.choices)
