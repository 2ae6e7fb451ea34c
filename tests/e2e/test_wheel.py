"""Argo installed from a wheel in an empty environment, outside the checkout."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def call(*arguments: object, cwd: Path) -> str:
    ours = {"PYTHONPATH", "PYTHONPYCACHEPREFIX", "VIRTUAL_ENV"}
    environment = {k: v for k, v in os.environ.items() if k not in ours}
    result = subprocess.run(
        [str(a) for a in arguments],
        cwd=cwd,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.mark.long
def test_a_mission_runs_from_the_wheel(tmp_path: Path, missions: Path) -> None:
    build = (sys.executable, "-m", "build", "--wheel", "--no-isolation")
    call(*build, "--outdir", tmp_path, ROOT, cwd=tmp_path)
    (wheel,) = tmp_path.glob("*.whl")
    uv = Path(sys.executable).with_name("uv")
    call(uv, "venv", "--quiet", "--python", sys.executable, tmp_path / "venv", cwd=tmp_path)
    python = tmp_path / "venv" / "bin" / "python"
    install = (uv, "pip", "install", "--quiet", "--python", python)
    install += ("--constraint", ROOT / "constraints.txt")
    call(*install, wheel, cwd=tmp_path)
    away = tmp_path / "away"
    away.mkdir()
    (away / "script.txt").write_bytes((missions / "mission_1.txt").read_bytes())
    argo = tmp_path / "venv" / "bin" / "argo"
    output = call(
        argo, "run", "script.txt", "--site", "umad", "--start-area", 1, "--end-area", 1,
        "--report", "report", cwd=away,
    )  # fmt: skip
    assert "Success" in output
    assert (away / "report" / "report.html").is_file()
    built = "from argo_planner.service.web.page import page_folder_path as f; print(*f().glob('*'))"
    call(*install, f"{wheel}[planner]", cwd=tmp_path)
    assert "index.html" in call(python, "-c", built, cwd=away)
    location = call(python, "-c", "import argo_env; print(argo_env.__file__)", cwd=away)
    assert str(tmp_path) in location
