"""`argo explain`: its text is a script of the same mission."""

import json
import re
from pathlib import Path

import pytest

from argo_compiler.diagnostics import DiagnosticError
from argo_compiler.files.mission_file import read_mission
from argo_compiler.il import Mission
from argo_planner.use_cases.schemas import FileKind, schema
from tests.argo_planner.conftest import argo
from tests.mission_writing import unplaced
from tests.yard import write_yard

SCRIPT = """\
Mission Protocol #1
1. Start in starting area 1.
2. Chekc checkpoint #1 at 0.3 m/s. If it is abnormal, return to the docking station.
3. Check checkpoint #2 tonight, retry twice. If it fails, go to step 2.
4. Repeat steps 2 to 3 three times.

If a gas leak is detected, return to the docking station.
"""


@pytest.fixture
def folder(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    monkeypatch.chdir(tmp_path)
    write_yard(tmp_path)
    (tmp_path / "s.txt").write_text(SCRIPT, encoding="utf-8")
    return tmp_path


def explained(*words: str, status: int = 0) -> str:
    return argo("explain", *words, "--site", "yard.yaml", status=status).stdout


def mission_of(source: str) -> Mission:
    argo("import", source, "-o", f"{source}.json", "--site", "yard.yaml", status=0)
    return unplaced(read_mission(Path(f"{source}.json")))


@pytest.mark.usefixtures("folder")
def test_an_explanation_contains_the_assumptions() -> None:
    said = explained("s.txt")
    assert "2. Check checkpoint #1, at 0.3 m/s." in said
    assert "#1 is gauge 1 on floor 1; abnormal is less than" in said
    assert "Note: assumed: read `Chekc` as `check`" in said
    assert "If it fails, go to step 2." in said
    assert "Note: no effect: line 4: `tonight` has no effect" in said
    assert "repeat steps 2 to 3 3 times" in said.lower()
    assert "If a gas leak is detected, return to the docking station" in said


def test_an_explanation_is_a_script_of_the_same_mission(folder: Path) -> None:
    (folder / "back.txt").write_text(explained("s.txt"), encoding="utf-8")
    assert mission_of("back.txt") == mission_of("s.txt")


@pytest.mark.usefixtures("folder")
def test_for_programs_it_is_data_with_a_schema() -> None:
    found = json.loads(explained("s.txt", "--format", "json"))
    known = json.loads(schema(FileKind.READING))
    assert set(found) == set(known["properties"])
    assert set(found["entries"][0]) == set(known["$defs"]["ReadingEntry"]["properties"])
    first = next(e for e in found["entries"] if e["name"] == "MEASURE 1")
    assert first["assumed"] == ["read `Chekc` as `check`"]
    assert first["source"]["line"] == 3


@pytest.mark.usefixtures("folder")
def test_an_import_prints_the_explanation() -> None:
    result = argo("import", "s.txt", "-o", "m.json", "--site", "yard.yaml")
    assert "2. Check checkpoint #1, at 0.3 m/s." in result.stdout


@pytest.mark.usefixtures("folder")
def test_a_mission_is_explained_as_its_script_is() -> None:
    mission_of("s.txt")
    assert "3. Check checkpoint #2, retry twice." in explained("s.txt.json")


@pytest.mark.usefixtures("folder")
def test_warnings_fail_only_where_that_is_asked_for() -> None:
    explained("s.txt", status=0)
    explained("s.txt", "--strict", status=1)


def test_errors_are_those_of_the_import(folder: Path) -> None:
    (folder / "s.txt").write_text("1. Fly to the moon.\n", encoding="utf-8")
    result = argo("explain", "s.txt", "--site", "yard.yaml")
    assert isinstance(result.exception, DiagnosticError)


def test_what_the_readme_shows():
    root = Path(__file__).parents[2]
    (said,) = re.findall(r"```explained\n(.*?)```", (root / "README.md").read_text("utf-8"), re.S)
    script = root / "scenarios" / "umad" / "missions" / "protocol_3.txt"
    assert argo("explain", script).stdout == said
