"""Drafts: each line has a state, and what a person decides is read in its place."""

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Invalid
from argo_compiler.script import (
    Act,
    Draft,
    DraftActs,
    IncompleteDraft,
    LineState,
    draft_text,
    read_decisions,
)
from tests.argo_compiler.script.conftest import draft_of, measured_in

MAIL = """\
Hi Lena,

I'd like to have pressure gauge 1, and then valve R25.
Please keep it under 15 minutes.
Photograph the pump.
The crane is at the gate.

Thanks
Marek
"""


def state(draft: Draft, label: str) -> LineState:
    (line,) = (line for line in draft.lines if line.label == label)
    return line.state


def test_each_line_has_a_state(catalog: Catalog) -> None:
    draft = draft_of(MAIL, catalog)
    assert [(line.label, line.state) for line in draft.lines] == [
        ("1", LineState.SET_ASIDE),
        ("3", LineState.PROPOSED),
        ("4", LineState.PROPOSED),
        ("5", LineState.OPEN),
        ("6", LineState.SET_ASIDE),
        ("8", LineState.SET_ASIDE),
        ("9", LineState.SET_ASIDE),
    ]
    assert draft.lines[1].sentences == ("Check checkpoint 1 and checkpoint 4.",)
    assert draft.lines[2].sentences == ("Maximum duration: 15 minutes.",)


def test_what_is_proposed_counts_only_when_it_is_confirmed(catalog: Catalog) -> None:
    draft = draft_of("Check #8.\nI'd like to have valve R25.", catalog)
    assert draft.mission is None
    assert [line.label for line in draft.left] == ["2"]
    with pytest.raises(IncompleteDraft, match="1 line to confirm"):
        draft.require_mission()
    confirmed = draft_of("Check #8.\nI'd like to have valve R25.", catalog, draft.confirm())
    assert measured_in(confirmed.require_mission()) == ["8", "4"]
    assert confirmed.lines[1].act is Act.CONFIRMED


def test_a_script_that_is_understood_needs_no_decision(catalog: Catalog) -> None:
    draft = draft_of("Check #8.\nGo home.", catalog)
    assert draft.left == draft.decisions == ()
    assert measured_in(draft.require_mission()) == ["8"]


def test_an_open_line_is_said_in_other_words_or_set_aside(catalog: Catalog) -> None:
    text = "Check #8.\nBefriend valve R25.\nCheck #1."
    draft = draft_of(text, catalog)
    said = draft_of(text, catalog, draft.say("2", ["Check valve R12."]))
    assert measured_in(said.require_mission()) == ["8", "5", "1"]
    aside = draft_of(text, catalog, draft.set_aside(["2"]))
    assert measured_in(aside.require_mission()) == ["8", "1"]
    undone = draft_of(text, catalog, aside.undo(["2"]))
    assert undone.mission is None


def test_the_checkpoints_of_an_open_line_can_be_chosen(catalog: Catalog) -> None:
    text = "Check #8.\nBefriend valve R25."
    draft = draft_of(text, catalog)
    line = draft.left[0]
    assert line.choices == (("Check checkpoint 4.",), ("Do not check checkpoint 4.",), ())
    chosen = draft_of(text, catalog, draft.choose("2", 1))
    assert measured_in(chosen.require_mission()) == ["8", "4"]
    assert measured_in(draft_of(text, catalog, draft.choose("2", 3)).require_mission()) == ["8"]
    with pytest.raises(Invalid, match="3 choices"):
        draft.choose("2", 4)


def test_other_words_for_a_line_are_read_as_a_script_is(catalog: Catalog) -> None:
    draft = draft_of("Check #8.\nBefriend valve R25.", catalog)
    again = draft_of(
        "Check #8.\nBefriend valve R25.", catalog, draft.say("2", ["Befriend valve R12."])
    )
    assert state(again, "2") is LineState.OPEN
    assert again.mission is None


def test_decisions_are_kept_in_the_text_of_the_draft(catalog: Catalog) -> None:
    draft = draft_of(MAIL, catalog)
    decided = draft_of(MAIL, catalog, draft.confirm())
    decided = draft_of(MAIL, catalog, decided.say("5", ["Check valve R12."]))
    read = read_decisions(draft_text(decided), "mail.txt.draft")
    assert read == decided.decisions
    again = draft_of(MAIL, catalog, read)
    assert again == decided
    assert measured_in(again.require_mission()) == ["1", "4", "5"]


def test_a_person_decides_in_the_text_of_the_draft(catalog: Catalog) -> None:
    text = draft_text(draft_of(MAIL, catalog))
    text = text.replace("proposed: Check", "confirmed: Check").replace(
        "proposed: Maximum duration: 15 minutes.", "said: Maximum duration: 10 minutes."
    )
    text = text.replace("open: ", "set aside by hand: ")
    mission = draft_of(MAIL, catalog, read_decisions(text, "it")).require_mission()
    assert measured_in(mission) == ["1", "4"]
    assert mission.max_duration == 600


def test_a_decision_counts_for_a_line_that_has_moved(catalog: Catalog) -> None:
    draft = draft_of("Check #8.\nBefriend valve R25.", catalog)
    decisions = draft.say("2", ["Check valve R12."])
    longer = draft_of("Check #1.\nCheck #8.\n\nBefriend valve R25.\n", catalog, decisions)
    assert measured_in(longer.require_mission()) == ["1", "8", "5"]
    changed = draft_of("Check #8.\nBefriend valve R31.", catalog, decisions)
    assert state(changed, "2") is LineState.OPEN


def test_a_confirmation_counts_only_for_the_same_proposal(catalog: Catalog) -> None:
    text = "Check #{}.\nI need a second look at it, please read it again for me."
    draft = draft_of(text.format(1), catalog)
    decisions = draft.confirm() if state(draft, "2") is LineState.PROPOSED else ()
    other = draft_of(text.format(8), catalog, decisions)
    assert other.mission is None


IN_CONTEXT = "Read {}.\nRead {}.\n - below 3: read R12, then home\nRead R9."


def test_a_choice_counts_only_while_it_is_offered(catalog: Catalog) -> None:
    text = IN_CONTEXT.format("PG1", "PG3")
    draft = draft_of(text, catalog)
    assert "checkpoint 6" in draft.left[0].choices[0][0]
    decisions = draft.choose("3", 1)
    assert decisions[0].act is Act.CHOSEN
    chosen = draft_of(text, catalog, decisions)
    assert draft_of(text, catalog, chosen.decisions).require_mission() == chosen.require_mission()
    assert read_decisions(draft_text(chosen), "it") == chosen.decisions == decisions
    swapped = draft_of(IN_CONTEXT.format("PG3", "PG1"), catalog, decisions)
    assert [line.label for line in swapped.left] == ["3"]
    assert "checkpoint 1" in swapped.left[0].choices[0][0]
    assert swapped.decisions == ()


def test_choices_that_were_offered_together_count_together(catalog: Catalog) -> None:
    text = "Check R12.\nZip to R25.\nRather skip R25, mate.\nGo home."
    draft = draft_of(text, catalog)
    acts = DraftActs(choose=(("2", 1), ("3", 1)))
    decided = draft_of(text, catalog, draft.decide(acts))
    assert [decision.act for decision in decided.decisions] == [Act.CHOSEN, Act.CHOSEN]


@pytest.mark.parametrize(
    ("before", "after", "why"),
    [
        ("Check PG4.\nIf it shows too much, go straight home.", "PG6", "does not offer"),
        ("Check PG1.\nleave it please.", "R25", "another proposal now"),
    ],
)
def test_a_decision_that_no_longer_fits_is_a_warning(
    before: str, after: str, why: str, catalog: Catalog
) -> None:
    draft = draft_of(before, catalog)
    (line,) = draft.left
    decisions = draft.choose("2", 1) if line.choices else draft.confirm()
    assert draft_of(before, catalog, decisions).left == ()
    now = draft_of(before.replace("PG4", after).replace("PG1", after), catalog, decisions)
    assert [line.label for line in now.left] == ["2"]
    (warning,) = (d for d in now.diagnostics if d.code == "script.decision-unused")
    assert why in warning.message


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ("confirm: Check checkpoint 1.", "line 4: `confirm` is no key of a draft"),
        ("said: Check PG 4.\nWait for 2 minutes.", "line 5: `wait for 2 minutes.` is no key"),
        ("said:", "line 4: a sentence is missing"),
        ("said: Check PG 4.\nset aside by hand", "line 5: `set aside by hand` is a second"),
        ("conf", "line 4: `conf` is no key"),
    ],
)
def test_a_line_of_a_draft_that_cannot_be_read_is_named(changed: str, message: str) -> None:
    with pytest.raises(Invalid, match=message):
        read_decisions(f"# draft, version 1: it\n\n1 | Befriend PG 1\n{changed}\n", "it")


@pytest.mark.parametrize("key", ["Set aside by hand", "set aside", "SAID: Check #1."])
def test_keys_of_a_draft_are_read_as_people_write_them(key: str) -> None:
    draft = f"# draft, version 1: it\n\n1 | Befriend PG 1\n{key}\n# a remark\n"
    assert len(read_decisions(draft, "it")) == 1


def test_dots_are_asked_about_once(catalog: Catalog) -> None:
    text = "Start in starting area 1.\nCheck R9 ... and PG 1."
    draft = draft_of(text, catalog)
    assert draft.mission is None
    said = draft_of(text, catalog, draft.say("2.1", ["Check R9."]))
    assert measured_in(said.require_mission()) == ["19", "1"]
    assert draft_of(text, catalog, draft.set_aside(["2"])).left == ()


def test_other_words_may_be_several_sentences_and_fields(catalog: Catalog) -> None:
    text = "Befriend valve R25.\nCheck #1."
    words = "Start in starting area 1. Maximum duration: 35 minutes. Check R9."
    mission = draft_of(text, catalog, draft_of(text, catalog).say("1", [words])).require_mission()
    assert measured_in(mission) == ["19", "1"]
    assert mission.max_duration == 35 * 60


def test_a_later_choice_may_depend_on_an_earlier_one(catalog: Catalog) -> None:
    text = "Befriend PG1.\nBefriend R12 for me.\n - below 3: go home\nTidy up valve R9, or R7."
    draft = draft_of(text, catalog)
    for label in ("1", "2", "3", "4"):
        draft = draft_of(text, catalog, draft.choose(label, 1))
    assert measured_in(draft.require_mission()) == ["1", "5", "19"]
    assert [decision.act for decision in draft.decisions] == [Act.CHOSEN] * 4
    assert "checkpoint 5" in draft.decisions[2].sentences[0]
    undone = draft_of(text, catalog, draft.undo(["2"]))
    assert [line.label for line in undone.left] == ["2", "3"]


def test_lines_with_the_same_text_are_decided_one_by_one(catalog: Catalog) -> None:
    text = "Check #8.\nBefriend it.\nCheck #1.\nBefriend it."
    draft = draft_of(text, catalog)
    one = draft_of(text, catalog, draft.set_aside(["2"]))
    assert state(one, "2") is LineState.SET_ASIDE
    assert state(one, "4") is LineState.OPEN
    more = draft_of(f"{text}\nBefriend it.", catalog, one.decisions)
    assert {state(more, label) for label in ("2", "4", "5")} == {LineState.OPEN}


@pytest.mark.parametrize("label", ["9", "2.3", "x", ""])
def test_a_line_that_is_not_there_is_named(label: str, catalog: Catalog) -> None:
    draft = draft_of("Check #8.\n\nBefriend valve R25.", catalog)
    with pytest.raises(Invalid, match="has no line"):
        draft.set_aside([label])


def test_an_open_line_can_not_be_confirmed(catalog: Catalog) -> None:
    draft = draft_of("Check #8.\nBefriend valve R25.", catalog)
    with pytest.raises(Invalid, match="line 2 of script is open"):
        draft.confirm(["2"])


def test_a_draft_of_another_version_is_refused() -> None:
    with pytest.raises(Invalid, match="is no draft of this version"):
        read_decisions("# draft, version 2: a.txt\n", "a.txt.draft")


@pytest.mark.parametrize(
    "line",
    [
        "Photograph the pump.",
        "Send an SMS to Paul.",
        "Do not let it climb to floor 5.",
        "Close valve R25.",
        "Should it check R18 too?",
        "If it rains, read valve R25 slowly.",
        "Valve R25, rather not valve R12.",
        "sorry, not R25 but R12!",
        "The robot must never enter the tank.",
    ],
)
def test_what_may_ask_for_something_is_neither_proposed_nor_set_aside(
    line: str, catalog: Catalog
) -> None:
    draft = draft_of(f"Check #8.\n{line}", catalog)
    states = {one.state for one in draft.lines if one.line == 2}
    assert LineState.OPEN in states
    assert LineState.PROPOSED not in states


def test_every_line_with_text_is_in_the_draft(catalog: Catalog) -> None:
    text = f"{MAIL}\n| Checkpoint | What |\n|---|---|\n| 1 | read |\n\nFloor 2\n- all valves\n"
    draft = draft_of(text, catalog)
    covered = {n for line in draft.lines for n in range(line.line, line.last_line + 1)}
    wanted = {n for n, line in enumerate(text.split("\n"), 1) if any(map(str.isalnum, line))}
    assert wanted <= covered


def test_lines_that_are_alike_but_for_their_figures_are_lines_of_their_own(
    catalog: Catalog,
) -> None:
    numbers = range(1, 10)
    text = "Start in starting area 1.\n" + "\n".join(f"- Check #{n}" for n in numbers)
    draft = draft_of(text, catalog)
    assert [line.text for line in draft.lines[1:]] == [f"Check #{n}" for n in numbers]
    assert [line.label for line in draft.lines] == [str(n) for n in range(1, 11)]
