"""Suggestions of an assistant: all of them proposed, with all that they do not use."""

import json
import random
from contextlib import suppress

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.base.errors import Invalid
from argo_compiler.script import Act, Draft, LineState, draft_text, import_script, read_draft
from argo_compiler.script.assistant.answer import MAX_ANSWER_BYTES, read_answer
from argo_compiler.script.assistant.request import canonical_examples, make_request
from argo_compiler.script.drafts.suggesting import lines_to_ask, suggestions_from
from tests.argo_compiler.script.conftest import measured_in


def draft_of(text: str, catalog: Catalog, **given) -> Draft:
    return import_script(text, catalog, **given)


def answered(text: str, catalog: Catalog, *entries: tuple[int, str, str]) -> Draft:
    """Return the draft of a script once an assistant has answered with these entries."""
    draft = draft_of(text, catalog)
    lines = [{"line": line, "words": words, "sentence": said} for line, words, said in entries]
    found = read_answer(json.dumps({"lines": lines}).encode())
    return draft_of(text, catalog, suggestions=suggestions_from(draft, found))


def line_of(draft: Draft, label: str):
    (line,) = (line for line in draft.lines if line.label == label)
    return line


BEFRIEND = "Start in starting area 1.\nCheck valve R7.\nBefriend valve R12 and the others.\n"


def test_open_lines_alone_are_asked_about(catalog: Catalog) -> None:
    draft = draft_of(f"{BEFRIEND}I'd like to have valve R25.\n", catalog)
    assert [line.label for line in lines_to_ask(draft)] == ["3"]


def test_a_suggestion_is_proposed_and_counts_when_it_is_confirmed(catalog: Catalog) -> None:
    draft = answered(BEFRIEND, catalog, (3, "valve R12", "Check checkpoint 5."))
    line = line_of(draft, "3")
    assert line.state is LineState.PROPOSED
    assert line.sentences == ("Check checkpoint 5.",)
    assert line.unused == ("Befriend", "and the others")
    assert line.reason == "suggested by an assistant"
    assert draft.mission is None
    confirmed = draft_of(
        BEFRIEND, catalog, decisions=draft.confirm(), suggestions=draft.suggestions
    )
    assert line_of(confirmed, "3").act is Act.CONFIRMED
    assert measured_in(confirmed.require_mission()) == ["11", "5"]


def test_what_argo_understands_or_proposes_itself_is_never_overridden(catalog: Catalog) -> None:
    text = f"{BEFRIEND}I'd like to have valve R25.\nThe crane is at the gate.\n"
    before = draft_of(text, catalog)
    after = answered(
        text,
        catalog,
        (1, "Start in starting area 1", "Start in starting area 2."),
        (2, "Check valve R7", "Do not check checkpoint 11."),
        (4, "valve R25", "Check checkpoint 1."),
        (5, "crane", "Check checkpoint 1."),
    )
    assert [(one.state, one.sentences) for one in after.lines] == [
        (one.state, one.sentences) for one in before.lines
    ]


def test_a_question_stays_a_question(catalog: Catalog) -> None:
    text = "Start in starting area 1.\nCheck valve R99.\n"
    before = draft_of(text, catalog)
    assert line_of(before, "2").is_question
    assert lines_to_ask(before) == ()
    after = answered(text, catalog, (2, "valve R99", "Check checkpoint 5."))
    assert line_of(after, "2") == line_of(before, "2")


@pytest.mark.parametrize(
    ("text", "words", "sentence", "unused"),
    [
        # The assistant claims all words, but its sentence has no counterpart for some of them.
        ("Never befriend valve R12.", None, "Check checkpoint 5.", "Never"),
        ("Befriend valve R12, and never valve R25.", None, "Check checkpoint 5.", "never"),
        ("If it rains, befriend valve R12.", None, "Check checkpoint 5.", "If"),
        ("Befriend valve R12 for 20 minutes.", None, "Check checkpoint 5.", "20 minutes"),
        (
            "Befriend valve R12 within 20 minutes.",
            None,
            "Check checkpoint 5. Maximum duration: 10 minutes.",
            "20 minutes",
        ),
        ("Befriend valve R12 and R25.", None, "Check checkpoint 5.", "valve R12 and R25"),
        # It leaves words out.
        ("Befriend valve R12 on no account.", "Befriend valve R12", "Check checkpoint 5.", "on no"),
        ("Befriend valve R12 not.", "Befriend valve R12", "Check checkpoint 5.", "not"),
    ],
)
def test_what_a_suggestion_does_not_use_is_shown(
    text: str, words: str | None, sentence: str, unused: str, catalog: Catalog
) -> None:
    script = f"Start in starting area 1.\nCheck valve R7.\n{text}\n"
    draft = answered(script, catalog, (3, words or text.rstrip("."), sentence))
    lines = [line for line in draft.lines if line.line == 3]
    shown = " ".join(word for line in lines for word in line.unused)
    assert draft.mission is None
    assert unused in shown or all(line.state is LineState.OPEN for line in lines), lines


def test_a_checkpoint_that_the_line_does_not_name_is_pointed_out(catalog: Catalog) -> None:
    draft = answered(BEFRIEND, catalog, (3, "Befriend valve R12", "Check checkpoint 4."))
    line = line_of(draft, "3")
    assert line.state is LineState.PROPOSED
    assert "it names checkpoint 4, which the line does not name" in line.reason
    assert line.unused == ("valve R12 and the others",)


@pytest.mark.parametrize(
    "sentence",
    ["Befriend it.", "Check checkpoint 99.", "Hello!", "42", "Start in area 9."],
)
def test_a_sentence_that_is_not_understood_leaves_its_line_open(
    sentence: str, catalog: Catalog
) -> None:
    draft = answered(BEFRIEND, catalog, (3, "valve R12", sentence))
    line = line_of(draft, "3")
    assert line.state is LineState.OPEN
    assert "Befriend" in line.reason
    assert f"an assistant suggests `{sentence}`" in line.hint
    assert line.choices


def test_words_that_the_line_does_not_have_are_no_claim(catalog: Catalog) -> None:
    before = draft_of(BEFRIEND, catalog)
    draft = answered(
        BEFRIEND,
        catalog,
        (3, "valve R1", "Check checkpoint 5."),  # only a part of a word
        (3, "take a look", "Check checkpoint 5."),
        (99, "valve R12", "Check checkpoint 5."),
        (2, "valve R12", "Check checkpoint 5."),
    )
    line = line_of(draft, "3")
    assert line.state is LineState.OPEN
    assert line.suggested == ()
    assert line.choices == line_of(before, "3").choices


def test_suggestions_stand_in_the_order_of_the_script_and_count_once(catalog: Catalog) -> None:
    text = "Start in starting area 1.\nBefriend valve R12 and valve R25.\n"
    one, other = (2, "valve R12", "Check checkpoint 5."), (2, "valve R25", "Check checkpoint 4.")
    draft = answered(text, catalog, other, one, other, one)
    assert line_of(draft, "2").sentences == ("Check checkpoint 5.", "Check checkpoint 4.")


def test_the_answer_is_kept_in_the_draft(catalog: Catalog) -> None:
    draft = answered(
        f"{BEFRIEND}Photograph the pump.\n", catalog, (3, "valve R12", "Check checkpoint 5.")
    )
    assert lines_to_ask(draft) == ()
    stored = read_draft(draft_text(draft), "it")
    assert stored.suggestions == draft.suggestions
    again = draft_of(draft.text, catalog, suggestions=stored.suggestions)
    assert again == draft
    changed = draft_of(f"{draft.text}Embrace valve R25.\n", catalog, suggestions=stored.suggestions)
    assert [line.label for line in lines_to_ask(changed)] == ["5"]


ENTRY = '{"lines": [{"line": 3, "words": "valve R12", "sentence": "Check checkpoint 5."}]}'


@pytest.mark.parametrize(
    "answer",
    [
        ENTRY,
        f"Sure, here you go {{as asked}}:\n```json\n{ENTRY}\n```\nAnything else?",
        f'<think>{{"lines": 3}}</think>\n{ENTRY}',
        ENTRY.replace('"line"', '"mood": "fine", "line"'),
        ENTRY.replace("valve R12", "valve   R12"),
    ],
)
def test_an_answer_is_found_in_prose(answer: str) -> None:
    (entry,) = read_answer(answer.encode())
    assert (entry.line, entry.words, entry.sentence) == (3, "valve R12", "Check checkpoint 5.")


@pytest.mark.parametrize(
    ("answer", "message"),
    [
        (b"", "no JSON object"),
        (b"I would rather not.", "no JSON object"),
        (b'{"lines": ', "no JSON object"),
        (b'{"tasks": []}', "lines: field required"),
        (b'{"lines": [{"line": "3", "words": "a", "sentence": "b"}]}', "valid integer"),
        (b'{"lines": [{"line": NaN, "words": "a", "sentence": "b"}]}', "form that was asked for"),
        (b'{"lines": [{"line": 1e999, "words": "a", "sentence": "b"}]}', "valid integer"),
        (b'{"lines": [{"line": true, "words": "a", "sentence": "b"}]}', "valid integer"),
        (b'{"lines": [{"line": -1, "words": "a", "sentence": "b"}]}', "greater than"),
        (b'{"lines": [{"line": 3, "words": "", "sentence": "b"}]}', "at least 1 character"),
        (b'{"lines": [{"line": 3, "words": "a", "sentence": ["b"]}]}', "valid string"),
        (b'{"lines": [{"line": ' + b"9" * 5000 + b"}]}", "form that was asked for"),
        (b'{"lines":' + b"[" * 100_000, "form that was asked for"),
        (b'{"a":' * 100_000, "form that was asked for"),
        (b'{"lines": "\xff"}', "not UTF-8"),
        (b"\xff\xfe{\x00", "not UTF-8"),
        (b" " * (MAX_ANSWER_BYTES + 1), "larger than"),
        (
            json.dumps({"lines": [json.loads(ENTRY)["lines"][0]] * 3_000}).encode(),
            "at most 2000 items",
        ),
    ],
    ids=range(18),
)
def test_another_answer_is_refused_in_one_message(answer: bytes, message: str) -> None:
    with pytest.raises(Invalid, match=message):
        read_answer(answer)


def test_entries_that_can_not_be_printed_are_left_out() -> None:
    entry = {"line": 3, "words": "R12", "sentence": "Check checkpoint 5.\x1b]0;x\x07"}
    assert read_answer(json.dumps({"lines": [entry]}).encode()) == ()


def test_broken_answers_are_read_or_refused() -> None:
    """Cut and mutated answers lead to entries or to Invalid, and to no other error."""
    shuffle = random.Random(0)
    for _ in range(500):
        mutated = bytearray(ENTRY.encode())
        for _ in range(shuffle.randrange(1, 6)):
            mutated[shuffle.randrange(len(mutated))] = shuffle.randrange(256)
        del mutated[shuffle.randrange(20, len(mutated) + 1) :]
        with suppress(Invalid):
            assert all(entry.line >= 1 for entry in read_answer(bytes(mutated)))


def examples() -> list[str]:
    lines = canonical_examples().splitlines()
    return [line for line in lines if line and not line.startswith("#")]


@pytest.mark.parametrize("sentence", examples())
def test_the_canonical_examples_are_understood(sentence: str, catalog: Catalog) -> None:
    script = "Check checkpoint 1.\nBefriend valve R25.\n"
    draft = draft_of(script, catalog)
    said = draft_of(script, catalog, decisions=draft.say("2", [sentence]))
    line = line_of(said, "2")
    assert line.state is LineState.UNDERSTOOD or line.is_question, line


def test_the_request_has_the_script_the_site_and_the_language(catalog: Catalog) -> None:
    request = make_request(BEFRIEND, [3, 3], catalog)
    assert "3: Befriend valve R12 and the others." in request.material
    assert "checkpoint 5: valve R12, a valve, floor" in request.material
    assert request.material.endswith("# Lines to translate: 3\n")
    assert "Check all valves on floor 2." in request.instructions
    assert request.open_lines == (3,)


def test_a_german_script_is_answered_in_canonical_sentences(catalog: Catalog) -> None:
    text = "Start im Startbereich 1.\nSchmuse bitte mit Ventil R12.\n"
    draft = answered(text, catalog, (2, "Schmuse bitte mit Ventil R12", "Check checkpoint 5."))
    confirmed = draft_of(text, catalog, decisions=draft.confirm(), suggestions=draft.suggestions)
    assert measured_in(confirmed.require_mission()) == ["5"]
