"""Wrong input ends in one clear message, never in a traceback.

The exit status is 2, or 3 for a script with lines to answer.
"""

import re
import subprocess
from pathlib import Path

import pytest

from tests.argo_planner.use_cases.foreign_files import FOREIGN

SHEET = (
    "Mission's designation:\tMission #9\n"
    "Main mode:\tAutonomous\n"
    "Maximum mission total duration:\t20'\n"
    'Initial position:\tdocked in "Starting area" 1\n'
    'End of the mission:\tdocked in "Starting area" 1\n'
    "The robot will have to control checkpoints in this precise order:\n"
    "1. Checkpoint #1: read the value on pressure gauge 1\n"
)


def require_refusal(result: subprocess.CompletedProcess[str], status: int = 2) -> str:
    """Assert that a command failed with a message and no traceback; return the message."""
    assert result.returncode == status, result.stdout + result.stderr
    assert "Traceback" not in result.stderr + result.stdout
    assert result.stderr.strip()
    return re.sub(r"\s+", " ", result.stderr)


@pytest.mark.parametrize(
    "command", [pytest.param("run", marks=pytest.mark.physics), "import", "compile"]
)
@pytest.mark.parametrize(
    ("name", "content", "expected"),
    [
        ("empty.txt", b"", "empty"),
        ("blank.txt", b" \n\t\n", "empty"),
        ("binary.txt", bytes(range(256)) * 40, ""),
        ("image.txt", b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", ""),
        ("large.txt", b"Mission Protocol #1\n1. Check checkpoint #1\n" * 240_000, "large"),
        ("prose.txt", b"It was a dark and stormy night.\n", ""),
        (
            "wrong_checkpoint.txt",
            SHEET.encode() + b"2. Checkpoint #77: read the value on pressure gauge 77\n",
            ":8:",
        ),
        (
            "unknown_word.txt",
            SHEET.encode() + b"2. Checkpoint #4: befriend the position of valve R25\n",
            "befriend",
        ),
    ],
)
def test_a_bad_script_is_refused(argo, tmp_path: Path, command, name, content, expected) -> None:
    script = tmp_path / name
    script.write_bytes(content)
    output = [] if command == "run" else ["-o", tmp_path / "out.json"]
    answered = name in ("prose.txt", "wrong_checkpoint.txt", "unknown_word.txt")
    message = require_refusal(argo(command, script, *output), 3 if answered else 2)
    assert name in message
    assert expected in message
    assert not (tmp_path / "out.json").exists()


@pytest.mark.physics
def test_each_command_names_a_file_of_another_program(argo, tmp_path: Path) -> None:
    files = [f for f in FOREIGN if f.name in ("order.json", "tree4.xml", "site.sqlite")]
    assert len(files) == 3
    for command in ("check", "run", "route", "explain", "plan", "evaluate"):
        for file in files:
            (tmp_path / file.name).write_bytes(file.content)
            result = argo(command, tmp_path / file.name)
            said = result.stdout + result.stderr
            assert result.returncode != 0
            assert f"is no mission, but {file.named}" in said
            assert "Traceback" not in said


@pytest.mark.physics
def test_an_unknown_word_is_shown_in_its_line_with_a_hint(argo_process, tmp_path) -> None:
    script = tmp_path / "script.txt"
    line = "2. Checkpoint #4: befriend the position of valve R25"
    script.write_text(SHEET + line + "\n")
    result = argo_process("run", script)
    message = require_refusal(result, status=3)
    assert f"{script}:8:19" in message
    assert line in result.stderr
    assert "^" in result.stderr
    assert "hint" in message


def test_missing_areas_are_refused_with_the_options_for_them(
    argo, missions: Path, tmp_path: Path
) -> None:
    message = require_refusal(argo("import", missions / "mission_1.txt", "-o", tmp_path / "m.json"))
    assert "--start-area" in message
    assert "--end-area" in message


@pytest.mark.physics
def test_gui_without_a_display_is_refused(argo, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.delenv("DISPLAY", raising=False)
    (tmp_path / "sheet.txt").write_text(SHEET)
    assert "DISPLAY" in require_refusal(argo("run", tmp_path / "sheet.txt", "--gui"))
