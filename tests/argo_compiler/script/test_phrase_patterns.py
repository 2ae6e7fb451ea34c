"""Phrases in texts, which are found by their first words."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.script.sentences.words.prose import either, phrase_pattern

PHRASES = "call | call me | don't | e-mail | ? | -- | über | für alle | for[ all] | n/a | k | skip"
WHOLE = re.compile(rf"(?<![\w-])(?:{either(PHRASES)})(?![\w-])", re.IGNORECASE)
TEXTS = st.lists(
    st.sampled_from(
        [
            *(
                "call",
                "Call",
                "me",
                "don't",
                "e-mail",
                "?",
                "--",
                "-",
                "ÜBER",
                "für",
                "alle",
                "for",
            ),
            *(
                "all",
                "  ",
                " ",
                " ",
                "n/a",
                "k",
                "\u212a",
                "\u017fkip",
                "skip",
                "recall",
                "1",
                "\n",
            ),
        ]
    ),
    max_size=12,
).map("".join)


def _spans(found):
    return [one.span() for one in found]


@given(TEXTS)
def test_the_same_phrases_are_found_as_by_one_pattern_of_all(text):
    pattern = phrase_pattern(PHRASES)
    assert _spans(pattern.finditer(text)) == _spans(WHOLE.finditer(text))
    assert pattern.sub("#", text) == WHOLE.sub("#", text)
    for at in range(len(text)):
        pairs = ((pattern.search(text, at), WHOLE.search(text, at)),)
        pairs += ((pattern.match(text, at), WHOLE.match(text, at)),)
        for found, expected in pairs:
            assert (found and found.span()) == (expected and expected.span())
    whole, expected = pattern.fullmatch(text), WHOLE.fullmatch(text)
    assert (whole and whole.span()) == (expected and expected.span())


@pytest.mark.parametrize("text", ["call me", "Please Call  me now", "E-mail?", "für  alle"])
def test_phrases_are_found_in_any_case_and_with_any_blanks(text):
    assert phrase_pattern(PHRASES).search(text) is not None


@pytest.mark.parametrize("text", ["", "recall me", "calls", "pre-call", "me"])
def test_no_phrase_is_found_within_a_word(text):
    assert phrase_pattern(PHRASES).search(text) is None
