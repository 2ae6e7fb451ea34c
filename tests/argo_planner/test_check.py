"""`argo check`: diagnostics of scripts and missions."""

import json
from pathlib import Path

import pytest

from argo_compiler.base.errors import ArgoError
from argo_compiler.diagnostics import has_errors
from argo_compiler.script import IncompleteDraft
from argo_planner.terminal.files import read_upload
from argo_planner.use_cases.checking import check_source
from tests.argo_planner.conftest import argo

MISSIONS = Path(__file__).parents[2] / "scenarios" / "umad" / "missions"


def found(catalog, tmp_path: Path, name: str, text: str, **areas):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    try:
        return check_source(read_upload(path), catalog, **areas)
    except IncompleteDraft as error:
        return error.diagnostics


def places(findings):
    return [(f.code, f.span.line if f.span else None) for f in findings]


def test_missions_that_are_shipped_have_no_errors(catalog):
    for script in sorted(MISSIONS.glob("*.txt")):
        findings = check_source(read_upload(script), catalog, 1, 1)
        codes = [f.code for f in findings if f.severity == "error"]
        # Areas may be chosen only for scripts that name none.
        assert set(codes) <= {"script.area-conflict"}, script


def test_errors_of_parsing_and_of_looking_up_come_together(catalog, tmp_path: Path):
    findings = found(
        catalog,
        tmp_path,
        "script.txt",
        "Mission Protocol #1\n"
        "1. Set a starting point in starting area 1\n"
        "2. Befriend checkpoint #1\n"
        "3. Check checkpoint #77\n",
    )
    assert ("script.not-understood", 3) in places(findings)
    assert ("script.unknown-checkpoint", 4) in places(findings)


def test_structure_and_site_are_checked_together(catalog, tmp_path: Path):
    findings = found(
        catalog,
        tmp_path,
        "plan.json",
        """{"site": "umad", "end_area": 9, "tasks": [
 {"name": "A", "action": "MEASURE", "object_id": "77"},
 {"name": "B", "action": "WAYPOINT",
  "transitions": [{"target": "AB"}]}]}""",
    )
    assert places(findings) == [
        ("il.unknown-area", 1),
        ("il.unknown-object", 2),
        ("il.waypoint-without-pose", 3),
        ("il.unknown-target", 4),
    ]
    assert findings[0].excerpt == '{"site": "umad", "end_area": 9, "tasks": ['


def test_the_paths_of_a_sound_mission_are_analysed(catalog, tmp_path: Path):
    findings = found(
        catalog,
        tmp_path,
        "plan.json",
        """{"tasks": [
 {"name": "A", "action": "MEASURE", "object_id": "1"},
 {"name": "B", "action": "MEASURE", "object_id": "4"}]}""",
    )
    assert places(findings) == [("analysis.unreachable-task", 3)]
    assert not has_errors(findings)


@pytest.mark.parametrize(
    ("name", "code"), [("none.txt", "script.unreadable"), ("none.json", "file.missing")]
)
def test_a_file_that_is_not_there_is_a_finding(tmp_path: Path, name, code):
    found = json.loads(argo("check", tmp_path / name, "--format", "json").stdout)
    assert [finding["code"] for finding in found["diagnostics"]] == [code]


SOUND = {"tasks": [{"name": "A", "action": "MEASURE", "object_id": "1"}]}
ODD = {**SOUND, "current": "B"}
WRONG = {"tasks": [{"name": "A", "action": "MEASURE", "object_id": "77"}]}


@pytest.fixture
def plan(monkeypatch, tmp_path: Path) -> Path:
    """Return the path of a mission in the working folder."""
    monkeypatch.chdir(tmp_path)
    return Path("plan.json")


@pytest.mark.parametrize(
    ("mission", "options", "status", "says"),
    [
        (SOUND, [], 0, "plan.json: no findings"),
        (ODD, [], 0, "plan.json: 1 warning"),
        (ODD, ["--strict"], 1, "[il.unknown-current]"),
        (SOUND, ["--strict"], 0, "no findings"),
        (WRONG, [], 2, "plan.json:1:47: error:"),
        (WRONG, ["--strict"], 2, "plan.json: 1 error"),
        (WRONG, ["--format", "json"], 2, '"code": "il.unknown-object"'),
        (SOUND, ["--format", "sarif"], 0, '"results": []'),
        (SOUND, ["--format", "xml"], 2, ""),
    ],
)
def test_status_and_output(plan, mission, options, status, says):
    plan.write_text(json.dumps(mission))
    assert says in argo("check", plan, *options, status=status).stdout


@pytest.mark.parametrize("options", [["-o", "plan.json"], ["--start-area", "1"]])
def test_requests_that_make_no_sense(plan, options):
    plan.write_text(json.dumps(SOUND))
    assert isinstance(argo("check", plan, *options).exception, ArgoError)
    assert json.loads(plan.read_text()) == SOUND


@pytest.mark.parametrize("name", ["mission", "machine", "progress"])
def test_schemas_are_printed(name):
    assert json.loads(argo("schema", name).stdout)["title"] == f"Argo {name}"


def test_a_file_that_is_not_there_is_named_once(tmp_path: Path):
    path = tmp_path / "none.txt"
    said = "the file can't be read: it does not exist (no such file) [script.unreadable]"
    assert f"{path}: error: {said}" in argo("check", path, status=2).output


def test_a_mission_to_very_many_places_is_checked_without_its_times(catalog, tmp_path: Path):
    ways = [[{"target": f"T{k + 1}"}] if k < 1000 else [] for k in range(1001)]
    tasks = [
        {"name": f"T{k}", "action": "WAYPOINT", "pose": {"x": k, "y": 0, "z": 0}, "transitions": w}
        for k, w in enumerate(ways)
    ]
    path = tmp_path / "mission.json"
    path.write_text(json.dumps({"version": 3, "tasks": tasks}), encoding="utf-8")

    class NotAsked:
        """Travel times that must not be used."""

    findings = check_source(read_upload(path), catalog, travel=NotAsked())
    (finding,) = [f for f in findings if f.code == "analysis.too-many-places"]
    assert (
        "1001 different poses: its times, its energy and its paths are not checked"
        in finding.message
    )
