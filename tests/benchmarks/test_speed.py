"""The ratios of `make speed`, in the smallest size; how fast anything is is not looked at."""

import json
from pathlib import Path

import pytest

from benchmarks import speed


@pytest.mark.long
def test_figures_are_measured_and_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = tmp_path / "speed.json"
    assert speed.main(["--smallest", "--write", "--kept", str(kept)]) == 0
    values = json.loads(kept.read_text())
    shown = capsys.readouterr().out
    for figure in speed.FIGURES:
        assert (figure.name in shown) == figure.short
        measured = figure.short and f"{figure.name:24}{'-':>9}" not in shown
        assert (values.get(figure.name, 0.0) > 0.0) == measured


def test_what_has_become_slower_is_named(
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
    kept = tmp_path / "speed.json"
    kept.write_text(json.dumps({"rate": 10.0, "time": 2.0, "nearly": 1.0}))
    assert speed.main(["--kept", str(kept)]) == 1
    shown = capsys.readouterr().out
    assert "slower by more than 15%: rate (0.80), time (0.67)\n" in shown
    assert "not installed: another" in shown
    assert speed.main(["--kept", str(kept), "--only", "nearly", "new"]) == 0


def test_kept_values_are_those_of_the_figures() -> None:
    assert json.loads(speed.KEPT.read_text()).keys() == {figure.name for figure in speed.FIGURES}
