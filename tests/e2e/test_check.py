"""`argo check` from a shell; `tests/argo_planner/test_check.py` tests its diagnostics."""

import json
from pathlib import Path

from argo_compiler import __version__

WRONG = {"tasks": [{"name": "A", "action": "MEASURE", "object_id": "77"}]}


def test_diagnostics_are_written_for_a_code_host(argo, tmp_path: Path) -> None:
    (tmp_path / "plan.json").write_text(json.dumps(WRONG))
    check = ("check", "plan.json", "--format", "sarif", "-o", "f.sarif")
    result = argo(*check, cwd=tmp_path, status=2)
    assert result.stdout == "plan.json: 1 error\n"
    (run,) = json.loads((tmp_path / "f.sarif").read_text(encoding="utf-8"))["runs"]
    assert run["results"][0]["ruleId"] == "il.unknown-object"


def test_the_version_is_printed(argo_process) -> None:
    assert argo_process("--version").stdout == f"argo {__version__}\n"


def test_diagnostics_do_not_begin_with_the_programs_name(argo, missions: Path, tmp_path) -> None:
    result = argo("import", missions / "mission_1.txt", "-o", tmp_path / "m.json", status=2)
    assert not any(line.startswith("argo:") for line in result.stderr.splitlines())
    assert "2 errors" in result.stderr.splitlines()[-1]
