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
