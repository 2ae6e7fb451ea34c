"""Ctrl-C, SIGTERM and readers that go away: at whatever moment, nothing is lost and no traceback is
shown."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

FULL = Path("/dev/full")
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143}


def started(*arguments: object, **options) -> subprocess.Popen[str]:
    """A process of the command, with pipes for what it prints."""
    return subprocess.Popen(
        [sys.executable, "-m", "argo_planner", *map(str, arguments)],
        **{
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "text": True,
            "env": {**os.environ, "COLUMNS": "120"},
            **options,
        },
    )


@pytest.mark.parametrize(
    ("number", "module"),
    [
        (signal.SIGINT, "argo_planner.terminal.signals"),
        (signal.SIGTERM, "argo_planner.cli"),
        (signal.SIGINT, "numpy"),
        (signal.SIGTERM, "argo_planner.terminal.run_display"),
    ],
    ids=lambda given: getattr(given, "name", given),
)
def test_while_modules_are_imported(missions: Path, number, module: str) -> None:
    """Python itself says which one it has just imported."""
    environment = {**os.environ, "PYTHONPROFILEIMPORTTIME": "1"}
    with started("run", missions / "protocol_3.txt", env=environment) as process:
        said = []
        for line in process.stderr:
            said.append(line)
            if line.endswith(f" {module}\n"):
                process.send_signal(number)
        output = process.stdout.read()
    own = [line for line in said if not line.startswith("import time:")]
    assert process.returncode == STATUS[number]
    assert own in ([], ["argo: interrupted\n"])
    assert not output


def test_a_signal_that_is_ignored_from_outside_stays_so(missions: Path) -> None:
    """As in a script's background jobs."""
    environment = {**os.environ, "PYTHONPROFILEIMPORTTIME": "1"}
    with started(
        "format", missions / "protocol_3.txt", env=environment,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
    ) as process:  # fmt: skip
        for line in process.stderr:
            if line.endswith(" argo_planner.terminal.importing\n"):
                process.send_signal(signal.SIGINT)
        assert process.stdout.read().startswith("Mission Protocol")
    assert process.returncode == 0


@pytest.mark.parametrize("arguments", [["--help"], ["--version"], ["sites"], ["schema", "mission"]])
def test_a_reader_that_has_gone_is_told_nothing(arguments: list[str]) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with started(*arguments, stdout=writing) as process:
        os.close(writing)
        assert not process.stderr.read()
    assert process.returncode == 141


def test_nobody_reads_what_is_said_either(tmp_path: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    with started("check", tmp_path / "none.json", stdout=writing, stderr=writing) as process:
        os.close(writing)
    assert process.returncode == 2


@pytest.mark.skipif(not FULL.exists(), reason="needs /dev/full, a disk without room")
@pytest.mark.parametrize("arguments", [["--help"], ["sites"]])
def test_output_that_has_no_room_is_told(arguments: list[str]) -> None:
    with FULL.open("w") as full, started(*arguments, stdout=full) as process:
        said = process.stderr.read()
    assert process.returncode == 2
    assert said == "argo: the output can't be written: No space left on device\n"
