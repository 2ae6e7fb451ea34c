"""Standard output that lacks characters or space."""

import os
import subprocess
from pathlib import Path

import pytest

from argo_env.files import resources
from tests.processes import ROOT, run_python

ARGO = ("-m", "argo_planner")
MISSION = (resources.scenarios_folder() / "umad" / "missions" / "protocol_3.txt").read_text("utf-8")


def test_characters_that_a_terminal_lacks_are_escaped(tmp_path: Path):
    environment = {**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONPATH": str(ROOT)}
    name = "V\u00e4lve \u2603.txt"
    result = run_python(*ARGO, "check", name, cwd=tmp_path, env=environment, check=False)
    assert result.returncode == 2
    assert result.stdout.startswith(r"V\xe4lve \u2603.txt: error: the file can't be read")
    assert not result.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full, a disk without room")
@pytest.mark.parametrize(
    ("command", "text"), [("check", "Once upon a time\n"), ("format", MISSION)]
)
def test_output_without_space_is_reported(tmp_path: Path, command: str, text: str):
    (tmp_path / "script.txt").write_text(text, encoding="utf-8")
    with open("/dev/full", "w", encoding="utf-8") as full:
        streams = {"capture_output": False, "stdout": full, "stderr": subprocess.PIPE}
        result = run_python(*ARGO, command, tmp_path / "script.txt", **streams, check=False)
    assert result.returncode == 2
    assert result.stderr.endswith("argo: the output can't be written: No space left on device\n")
