"""Standard output that can't take what is printed."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def test_letters_that_a_terminal_does_not_have_are_written_by_number(tmp_path: Path):
    result = subprocess.run(
        [sys.executable, "-m", "argo_planner", "check", "V\u00e4lve \u2603.txt"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert result.returncode == 2
    assert result.stdout.startswith(r"V\xe4lve \u2603.txt: error: can't be read")
    assert not result.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs /dev/full, a disk without room")
def test_findings_that_could_not_be_printed_are_told_to_be_lost(tmp_path: Path):
    (tmp_path / "script.txt").write_text("Once upon a time\n", encoding="utf-8")
    with open("/dev/full", "w", encoding="utf-8") as full:
        result = subprocess.run(
            [sys.executable, "-m", "argo_planner", "check", tmp_path / "script.txt"],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert result.returncode == 2
    assert result.stderr.endswith("argo: the output can't be written: No space left on device\n")
