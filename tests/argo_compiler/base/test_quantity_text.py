import pytest

from argo_compiler.base.quantity_text import duration_text, energy_text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0 s"),
        (47.52, "47.5 s"),
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


@pytest.mark.parametrize(("energy_wh", "text"), [(1.234, "1.23 Wh"), (1234.6, "1235 Wh")])
def test_energies(energy_wh: float, text: str) -> None:
    assert energy_text(energy_wh) == text
