import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from argo_compiler.base.quantity_text import (
    duration_text,
    energy_text,
    exceeding_duration_text,
    least_duration_text,
    least_energy_text,
    limit_text,
    most_duration_text,
    most_energy_text,
    rounded_down,
    rounded_up,
)

UNITS = {"h": 3600.0, "min": 60.0, "s": 1.0, "Wh": 1.0}


def amount(text: str) -> float:
    """Return the number of seconds or Wh that a text states."""
    return sum(float(n) * UNITS[unit] for n, unit in re.findall(r"([0-9.e+-]+) (\w+)", text))


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 s"),
        (47.52, "47.5 s"),
        (59.98, "1 min"),
        (60.0, "1 min"),
        (750.4, "12 min 30 s"),
        (3599.6, "1 h"),
        (3605.0, "1 h 5 s"),
        (7500.0, "2 h 5 min"),
        (7530.0, "2 h 5 min 30 s"),
    ],
)
def test_durations(seconds: float, text: str) -> None:
    assert duration_text(seconds) == text


@pytest.mark.parametrize(
    ("energy_wh", "text"), [(1.234, "1.23 Wh"), (999.7, "1000 Wh"), (1234.6, "1235 Wh")]
)
def test_energies(energy_wh: float, text: str) -> None:
    assert energy_text(energy_wh) == text


@given(st.floats(0, 1e6))
def test_rounded_bounds_are_bounds(value: float) -> None:
    noise = 1e-9 * max(1.0, value)
    for least, most in (
        (least_duration_text, most_duration_text),
        (least_energy_text, most_energy_text),
    ):
        assert amount(least(value)) <= value + noise
        assert amount(most(value)) >= value - noise


def test_bounds_are_rounded_to_their_side() -> None:
    assert (least_duration_text(59.99), most_duration_text(59.99)) == ("59.9 s", "1 min")
    assert (least_duration_text(90.6), most_duration_text(90.4)) == ("1 min 30 s", "1 min 31 s")
    assert (least_energy_text(1234.6), most_energy_text(1234.4)) == ("1234 Wh", "1235 Wh")


def test_errors_of_sums_are_not_rounded() -> None:
    assert rounded_down(89.99999999999) == rounded_up(90.00000000001) == 90


@pytest.mark.parametrize(
    ("least", "limit", "texts"),
    [
        (91.6, 90.0, ("1 min 31 s", "1 min 30 s")),
        (90.4, 90.0, ("90.4 s", "1 min 30 s")),
        (90.96, 90.9, ("90.96 s", "90.9 s")),
        (12.34, 12.0, ("12.3 s", "12 s")),
        (12.34, 12.31, ("12.34 s", "12.31 s")),
    ],
)
def test_bound_exceeds_a_limit(least: float, limit: float, texts: tuple[str, str]) -> None:
    assert (exceeding_duration_text(least, limit), limit_text(limit)) == texts
