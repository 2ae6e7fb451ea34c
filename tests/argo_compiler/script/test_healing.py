"""The noise of text recognition is healed, and every character knows where it stood."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.diagnostics import Severity
from argo_compiler.script.documents.healing import heal

WORDS = """
    a and anomaly check checkpoint connected docked duration gauge in is mission mission's normal on
    one point position precise pressure r12 r25 real-time report reporting robot specified the this
    total value values valve when
"""
VOCABULARY = frozenset(WORDS.split())


def healed(text: str, vocabulary: frozenset[str] = VOCABULARY) -> str:
    return heal(text, vocabulary).text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("tota\tal", "total"),
        ("ga\t\tauge 1", "gauge 1"),
        ("gau\tauge", "gauge"),
        ("this\t\ts precise", "this precise"),
        ("docked a\t\td connected", "docked and connected"),
        ("valve R2\t\t5", "valve R25"),
        ("valve R2\t25", "valve R25"),
        ("PRE\tCISE", "PRECISE"),
        ("TOTA\tAL", "TOTAL"),
        ("whe\tn the", "when the"),
        ("Real-\ttime reporting", "Real-time reporting"),
        ("Mission\t's", "Mission's"),
        ("Mission’s", "Mission's"),
    ],
)
def test_a_cut_word_becomes_whole(text: str, expected: str) -> None:
    assert healed(text) == expected


def test_each_healed_word_is_a_warning_with_both_forms() -> None:
    (warning,) = heal("the\n  tota\tal value", VOCABULARY).diagnostics
    assert warning.severity is Severity.WARNING
    assert warning.code == "script.healed"
    assert warning.message == "read `tota al` as `total`"
    assert warning.span is not None
    assert (warning.span.line, warning.span.column, warning.span.length) == (2, 3, 7)
    assert warning.excerpt == "  tota\tal value"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("duration:\t\t20'", "duration: 20'"),
        ("Anomaly\tspecified", "Anomaly specified"),
        ("values,\t/position", "values, /position"),
        ("report\t: As", "report : As"),
        ("gauge\t1", "gauge 1"),
        ("Checkpoint #\t8", "Checkpoint # 8"),
        ("1.\tCheckpoint", "1. Checkpoint"),
        ("\t\tthe value\t", "\tthe value"),
        # typographic variants
        ("\ufeffthe value", "the value"),
        ("the\r\nvalue\rhere", "the\nvalue\nhere"),
        ("20′", "20'"),
        ("“Starting area” 1", '"Starting area" 1'),
        ("the\u00a0value", "the value"),
        ("checkpoint **after** it", "checkpoint after it"),
        ("val\u00adue", "value"),
        ("ﬁrst ﬂoor", "first floor"),
        ("value  \t ", "value"),
    ],
)
def test_what_is_put_right_without_a_word(text: str, expected: str) -> None:
    result = heal(text, VOCABULARY)
    assert result.text == expected
    assert result.diagnostics == ()


@pytest.mark.parametrize(
    ("text", "extra", "readings"),
    [
        ("valve R2\t\t5", {"r2"}, ["R25", "R2 5"]),
        ("the check\tpoint", set(), ["checkpoint", "check point"]),
        ("docked a\t\td", {"add"}, ["add", "and"]),
        ("gauge 1\t2", set(), ["12", "1 2"]),
    ],
)
def test_more_than_one_reading_is_an_error_that_lists_them(
    text: str, extra: set[str], readings: list[str]
) -> None:
    result = heal(text, VOCABULARY | extra)
    (error,) = result.diagnostics
    assert error.code == "script.ambiguous-cut"
    assert error.severity is Severity.ERROR
    assert all(f"`{reading}`" in error.message for reading in readings)
    assert result.unreadable == {1}


def test_no_letter_is_made_up_in_an_identifier() -> None:
    result = heal("valve R\t5", VOCABULARY)
    assert result.text == "valve R 5"
    assert [d.code for d in result.diagnostics] == ["script.unclear-cut"]


def test_intact_letters_come_before_doubled_ones_and_those_before_lost_ones() -> None:
    assert healed("on\tne", frozenset({"onne", "one", "onxne"})) == "onne"
    assert healed("on\tne", frozenset({"one", "onxne"})) == "one"
    assert healed("on\tne", frozenset({"onxne"})) == "onxne"


def test_a_line_that_is_too_long_is_refused_alone() -> None:
    result = heal("a" * 3000 + "\nthe value", VOCABULARY)
    assert [d.code for d in result.diagnostics] == ["script.long-line"]
    assert result.unreadable == {1}
    assert result.lines[1].content == "the value"


def test_positions_are_those_of_the_original() -> None:
    text = "\ufeffthe\r\ndocked a\t\td **connected**"
    line = heal(text, VOCABULARY).lines[1]
    assert line.content == "docked and connected"
    at = line.content.index("connected")
    span = line.span(at, at + len("connected"))
    assert (span.line, span.column, span.length) == (2, 15, 9)


words = st.text("abcdefghijklmnopqrstuvwxyzABCDEF0123456789.,:;'#()", min_size=1, max_size=12)
clean_lines = st.lists(words, max_size=8).map(" ".join)


@given(st.lists(clean_lines, min_size=1, max_size=6).map("\n".join))
def test_text_without_noise_is_unchanged(text: str) -> None:
    if any(line.lstrip().startswith("#") for line in text.split("\n")):
        return
    result = heal(text, VOCABULARY)
    assert result.text == text
    assert result.diagnostics == ()


@given(st.text(st.sampled_from("aegu12 \t\n\r*’#-R5."), max_size=80))
def test_every_character_maps_to_a_place_of_its_own_line(text: str) -> None:
    result = heal(text, VOCABULARY)
    for number, line in enumerate(result.lines, start=1):
        assert len(line.offsets) == len(line.content)
        assert list(line.offsets) == sorted(line.offsets)
        for at in range(len(line.content)):
            assert line.span(at, at + 1).line == number


@given(st.sampled_from(["gauge", "pressure", "docked", "total", "checkpoint"]), st.data())
def test_a_known_word_cut_anywhere_is_healed(word: str, data: st.DataObject) -> None:
    cut = data.draw(st.integers(1, len(word) - 1))
    doubled = data.draw(st.booleans())
    text = word[:cut] + "\t" + word[cut - doubled :]
    assert healed(text, frozenset({"gauge", "pressure", "docked", "total", "checkpoint"})) == word
