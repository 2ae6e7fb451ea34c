"""Durations in fields of forms."""

import pytest
from hypothesis import event, given
from hypothesis import strategies as st

from argo_compiler.base.catalog import Catalog
from argo_compiler.script import DurationReading, import_script, read_duration


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("90 s", 90),
        ("90s", 90),
        (" 5 min ", 300),
        ("90 min.", 5400),
        ("20'", 1200),
        ("20′", 1200),
        ("5\u00a0min", 300),
        ("1:30 h", 5400),
        ("1:30 min", 90),
        ("2:00 h", 7200),
        ("1h30", 5400),
        ("1h30min", 5400),
        ("2min30s", 150),
        ("1 h 30", 5400),
        ("1 h 5 min", 3900),
        ("1:05:00", 3900),
        ("1:05:00 h", 3900),
        ("1,5 h", 5400),
        ("1.5 h", 5400),
        ("half an hour", 1800),
        ("two minutes", 120),
        ("2 Stunden", 7200),
        ("1 Stunde 5", 3900),
        ("eine halbe Stunde", 1800),
        ("anderthalb Stunden", 5400),
        ("0 s", 0),
        ("0", 0),
        ("5m", 300),
        ("12 min 30", 750),
        ("2 days", 172800),
        ("100:00", 6000),
    ],
)
def test_a_text_with_one_meaning(text: str, seconds: float) -> None:
    reading = read_duration(text)
    assert (reading.seconds, reading.possible) == (seconds, ())


@pytest.mark.parametrize(
    ("text", "possible"),
    [
        ("1:30", (90, 5400)),
        ("22:00", (1320, 79200)),
        ("00:30", (30, 1800)),
        ("10", (10, 600, 36000)),
        ("1,5", (1.5, 90, 5400)),
        ("1.200 s", (1.2, 1200)),
    ],
)
def test_a_text_with_several_meanings_is_asked_about(
    text: str, possible: tuple[float, ...]
) -> None:
    reading = read_duration(text)
    assert (reading.seconds, reading.possible) == (None, possible)


@pytest.mark.parametrize(
    "text",
    [
        *("", "1:90", "0:90:00", "1h90", "h", "soon", "-5 min", "5 min 1 h", "10-20 min", "1/2 h"),
        *("5 to 10 min", "5 min please do not", "ca. 5 min", "1'30", "5 bar", "#5", "5 ms"),
        *("1:05:00 min", "1h30 h", "an hour and a half h"),
        *("1" * 400, "1e400 s", "nan s", "9" * 90),
    ],
)
def test_a_text_that_is_no_duration(text: str) -> None:
    assert read_duration(text) == DurationReading(seconds=None, possible=())


UNITS = ("s", "min", "h", "hours", "Minuten", "Stunden", "seconds", "'", "", " and a half hours")
NUMBERS = st.one_of(
    st.integers(0, 130).map(str),
    st.sampled_from(["1.5", "1,5", "2.250", "½", "two", "zwei", "half an", "1e2", "007", "-3"]),
    st.from_regex(r"[0-9]{1,3}:[0-9]{2}(:[0-9]{2})?", fullmatch=True),
    st.from_regex(r"[0-9]{1,2}(h|min)[0-9]{1,2}", fullmatch=True),
)
PARTS = st.tuples(NUMBERS, st.sampled_from(["", " "]), st.sampled_from(UNITS)).map("".join)


@given(st.lists(PARTS, min_size=1, max_size=3).map(" ".join))
def test_a_sure_reading_is_that_of_scripts(catalog: Catalog, text: str) -> None:
    """A script that waits for that long and is read without a question waits as long."""
    seconds = read_duration(text).seconds
    draft = import_script(f"Start in starting area 1.\nWait for {text}.\nCheck #1.\n", catalog)
    waits = [task.wait for task in draft.mission.tasks if task.wait] if draft.mission else []
    event("compared" if waits and seconds else "not compared")
    if seconds and waits:
        assert [wait.duration for wait in waits] == [seconds]
