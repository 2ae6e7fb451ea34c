"""Tests of `make speed` in its smallest size; they assert no time."""

import json
from pathlib import Path

import pytest

from benchmarks import speed


@pytest.mark.long
def test_figures_are_measured_and_stored(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stored = tmp_path / "speed.json"
    assert speed.main(["--smallest", "--write", "--kept", str(stored)]) == 0
    values = json.loads(stored.read_text())
    shown = capsys.readouterr().out
    for figure in speed.FIGURES:
        assert (figure.name in shown) == figure.short
        measured = figure.short and f"{figure.name:24}{'-':>9}" not in shown
        assert (values.get(figure.name, 0.0) > 0.0) == measured


def test_figures_that_became_slower_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    figures = (
        speed.Figure("rate", "x another", lambda _: 8.0, more_is_faster=True),
        speed.Figure("time", "x another", lambda _: 3.0),
        speed.Figure("nearly", "x another", lambda _: 1.1),
        speed.Figure("new", "x another", lambda _: 1.0),
        speed.Figure("absent", "x another", lambda _: None),
    )
    monkeypatch.setattr(speed, "FIGURES", figures)
    stored = tmp_path / "speed.json"
    stored.write_text(json.dumps({"rate": 10.0, "time": 2.0, "nearly": 1.0}))
    assert speed.main(["--kept", str(stored)]) == 1
    shown = capsys.readouterr().out
    assert "slower by more than 15%: rate (0.80), time (0.67)\n" in shown
    assert "not installed: another" in shown
    assert speed.main(["--kept", str(stored), "--only", "nearly", "new"]) == 0


def test_each_figure_has_a_stored_value() -> None:
    assert json.loads(speed.STORED_VALUES.read_text()).keys() == {
        figure.name for figure in speed.FIGURES
    }
