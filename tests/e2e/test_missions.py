"""Resolved missions with the command `argo` alone, from the text of a script to the report."""

import re
from pathlib import Path

import pytest

from argo_compiler.files.mission_file import read_mission
from argo_compiler.hfsm import Hfsm
from argo_env.run.record import RunRecord
from tests.e2e.conftest import read_run_record

pytestmark = pytest.mark.physics

AREAS = ("--start-area", 1, "--end-area", 2)


@pytest.fixture(scope="module")
def first(argo_process, missions: Path, tmp_path_factory: pytest.TempPathFactory):
    """Run mission #1 once; return the result of the command and the folder of the report."""
    folder = tmp_path_factory.mktemp("first")
    return argo_process("run", missions / "mission_1.txt", *AREAS, "--report", folder), folder


def require_mission_1(record: RunRecord) -> None:
    assert [t.name for t in record.mission.tasks] == [
        "START", "MEASURE 1", "MEASURE 4", "MEASURE 8", "DOCK",
    ]  # fmt: skip
    assert [r.checkpoint for r in record.readings] == [1, 4, 8]
    assert record.result.success
    assert record.result.docked
    assert record.result.duration <= 20 * 60
    assert record.contacts == ()


def require_protocol_2(record: RunRecord) -> None:
    names = [t.name for t in record.mission.tasks]
    (group,) = record.mission.groups
    first, last = names.index(group.start), names.index(group.end)
    assert names[0] == "START"
    assert first == 1
    assert last - first + 1 >= 3
    assert names[last + 1 :] == ["MEASURE 2", "MEASURE 14"]
    assert (group.max_repeat_count, group.max_repeat_duration) == (0, 600.0)
    assert all(t.pose and abs(t.pose.z) < 0.01 for t in record.mission.tasks[first : last + 1])
    assert [r.checkpoint for r in record.readings] == [2, 14]
    assert record.tasks[-2].start == pytest.approx(600.1)
    assert record.result.success
    assert record.contacts == ()


@pytest.mark.everywhere
def test_mission_1_runs_to_success(first) -> None:
    result, folder = first
    assert result.returncode == 0, result.stderr
    require_mission_1(read_run_record(folder))
    assert "Success" in result.stdout
    assert "pressure gauge 5" in result.stdout
    assert str(folder / "report.html") in result.stdout.replace("\n", "")
    assert (folder / "site.png").read_bytes().startswith(b"\x89PNG")


def test_a_corrected_word_is_shown(first) -> None:
    result, _ = first
    assert "durat tion" in result.stderr or "durat\ttion" in result.stderr
    assert "duration" in result.stderr


@pytest.mark.long
@pytest.mark.parametrize("folder", ["missions", "originals"])
def test_protocol_2_runs_to_success(argo, request, folder: str, tmp_path: Path) -> None:
    script = request.getfixturevalue(folder) / "protocol_2.txt"
    argo("run", script, "--report", tmp_path, status=0)
    require_protocol_2(read_run_record(tmp_path))


@pytest.mark.long
@pytest.mark.parametrize("area", [1, 2])
def test_the_original_of_mission_1_runs_to_success(argo, originals: Path, tmp_path, area) -> None:
    script = originals / "mission_1.txt"
    areas = ("--start-area", area, "--end-area", area)
    argo("run", script, *areas, "--report", tmp_path, status=0)
    require_mission_1(read_run_record(tmp_path))


@pytest.mark.long
def test_the_same_seed_gives_the_same_report(argo, first, missions: Path, tmp_path: Path) -> None:
    _, folder = first
    script = missions / "mission_1.txt"
    argo("run", script, *AREAS, "--seed", 0, "--report", tmp_path)
    for name in ("report.json", "report.html"):
        assert (tmp_path / name).read_bytes() == (folder / name).read_bytes()


@pytest.mark.long
def test_the_same_seed_gives_the_same_picture(
    argo_process, first, missions: Path, tmp_path: Path
) -> None:
    _, folder = first
    script = missions / "mission_1.txt"
    argo_process("run", script, *AREAS, "--report", tmp_path)
    assert (tmp_path / "site.png").read_bytes() == (folder / "site.png").read_bytes()


def test_import_compile_and_run_step_by_step(argo, first, missions: Path, tmp_path: Path) -> None:
    _, folder = first
    mission, machine, diagram = (tmp_path / n for n in ("m.json", "h.json", "h.mmd"))
    script, at_once = missions / "mission_1.txt", tmp_path / "at once"
    steps = (
        ("run", script, *AREAS, "--drive", "route", "--report", at_once),
        ("import", script, "-o", mission, *AREAS),
        ("compile", mission, "-o", machine, "--mermaid", diagram),
        ("run", mission, "--drive", "route", "--report", tmp_path / "by steps"),
    )
    for step in steps:
        argo(*step, status=0)
    assert read_mission(mission).start_area == 1
    hfsm = Hfsm.model_validate_json(machine.read_text(encoding="utf-8"))
    assert [leaf.task.name for leaf in hfsm.leaves] == [
        "MEASURE 1", "MEASURE 4", "MEASURE 8", "DOCK",
    ]  # fmt: skip
    assert diagram.read_text(encoding="utf-8").startswith("stateDiagram-v2")
    readings = read_run_record(tmp_path / "by steps").readings
    assert readings == read_run_record(at_once).readings
    # Another drive takes another time, but the readings are the same.
    assert [r.value for r in readings] == [r.value for r in read_run_record(folder).readings]


def test_an_abnormal_value_is_no_failure_and_another_seed_gives_other_readings(
    argo, first, missions: Path, tmp_path: Path
) -> None:
    _, folder = first
    script, given = missions / "mission_1.txt", ("--value", "8=9.5", "--seed", 1)
    options = ("--start-area", 2, "--end-area", 2, "--drive", "route")
    result = argo("run", script, *options, *given, "--report", tmp_path, status=0)
    assert re.search(r"9\.50 bar.*abnormal", result.stdout)
    readings = read_run_record(tmp_path).readings
    assert [r.normal for r in readings] == [True, True, False]
    usual = [r.value for r in read_run_record(folder).readings]
    assert all(r.value != value for r, value in zip(readings[:2], usual[:2], strict=True))


def test_a_mission_over_its_maximum_duration_fails(argo, missions: Path, tmp_path: Path) -> None:
    text = (missions / "mission_1.txt").read_text(encoding="utf-8").replace("20'", "2'")
    script = tmp_path / "hasty.txt"
    script.write_text(text, encoding="utf-8")
    areas = ("--start-area", 1, "--end-area", 1)
    result = argo("run", script, *areas, "--drive", "route", "--report", tmp_path, status=1)
    assert "of at most 2:00 min" in result.stdout
    assert not read_run_record(tmp_path).result.within_max_duration


@pytest.mark.parametrize("name", ["run.gif", pytest.param("run.mp4", marks=pytest.mark.long)])
def test_a_run_is_filmed_without_a_display(argo, tmp_path: Path, name: str) -> None:
    script = tmp_path / "short.txt"
    script.write_text(
        "Mission Protocol #3\n1. Set a starting point in front of the site\n"
        "2. Check checkpoint #3\n"
    )
    argo("run", script, "--render", tmp_path / name, status=0)
    head = (tmp_path / name).read_bytes()[:12]
    assert head.startswith(b"GIF89a") or head[4:8] == b"ftyp"


def test_the_report_loads_no_other_files(first) -> None:
    _, folder = first
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"""(?:src|href)\s*=\s*["'](?!#|data:)""", page)
    assert read_run_record(folder).seed == 0
