"""`argo --language de`: errors and diagnostics in German."""

import sys

import pytest
from typer.testing import CliRunner

from argo_planner.cli import app
from argo_planner.terminal.language import VARIABLE

MISSION = '{"version": 4, "tasks": [{"name": "A", "action": "WAYPOINT"}]}'


@pytest.fixture
def mission(tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, "")
    file = tmp_path / "round.json"
    file.write_text(MISSION, encoding="utf-8")
    return file


def shown(*arguments: object) -> str:
    return CliRunner().invoke(app, [str(argument) for argument in arguments]).output


def test_diagnostics_are_in_the_chosen_language(mission) -> None:
    german = shown("--language", "de", "check", mission)
    assert "Fehler: die Wegpunkt-Aufgabe „A“ hat keinen Ort [il.waypoint-without-pose]" in german
    assert "Abhilfe: geben Sie ihr einen Zielort" in german


def test_the_language_of_the_environment_is_used(mission, monkeypatch) -> None:
    monkeypatch.setenv(VARIABLE, "de")
    assert "die Wegpunkt-Aufgabe „A“ hat keinen Ort" in shown("check", mission)
    assert "the WAYPOINT task 'A' has no pose" in shown("--language", "en", "check", mission)


def test_json_is_english_in_each_language(mission) -> None:
    english = shown("check", "--format", "json", mission)
    assert shown("--language", "de", "check", "--format", "json", mission) == english
    assert "wording" not in english


def test_english_does_not_read_the_catalogue(mission) -> None:
    sys.modules.pop("argo_compiler.base.translation", None)
    assert "has no pose" in shown("check", mission)
    assert "argo_compiler.base.translation" not in sys.modules
