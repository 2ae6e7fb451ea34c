"""Fixtures and helpers of the end-to-end tests: the command `argo`, and scripts for it."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from argo_env.navigation import Navigator
from argo_env.run.record import RunRecord
from tests.yard import yard

ROOT = Path(__file__).parents[2]
ORIGINALS = os.environ.get("ARGO_ORIGINALS")

Argo = Callable[..., subprocess.CompletedProcess[str]]


def reset_signal_handlers() -> None:
    """Let signals end this process, for use in a new process.

    A suite in the background may ignore some signals, and its child processes would inherit that.
    """
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def start_argo(*arguments: object, **options: Any) -> subprocess.Popen[str]:
    """Start a process of `argo` with pipes for its output and errors, and return it."""
    return subprocess.Popen(
        [sys.executable, "-m", "argo_planner", *map(str, arguments)],
        **{
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "text": True,
            "env": {**os.environ, "COLUMNS": "120"},
            "preexec_fn": reset_signal_handlers,
            **options,
        },
    )


def require_status(
    arguments: tuple[object, ...], status: int, output: str, errors: str, wanted: int | None
) -> subprocess.CompletedProcess[str]:
    """Return the result of a command; assert that its exit status is the wanted one, if any."""
    assert wanted in (None, status), f"{status}: {output}{errors}"
    return subprocess.CompletedProcess(arguments, status, output, errors)


def read_errors_until(process: subprocess.Popen[str], words: str) -> str:
    """Return the standard error of a process up to the first line that has these words."""
    assert process.stderr
    errors = ""
    while words not in errors:
        line = process.stderr.readline()
        assert line, errors
        errors += line
    return errors


def read_run_record(folder: Path) -> RunRecord:
    """Return the record in a folder with the report of a run."""
    return RunRecord.model_validate_json((folder / "report.json").read_bytes())


class ForkedArgo:
    """Function that runs `argo` in processes forked from one that has already loaded it.

    Holds that process, and a folder for the output of the forked ones.
    """

    def __init__(self, process: subprocess.Popen[str], folder: Path) -> None:
        self._process, self._folder = process, folder

    def __call__(
        self, *arguments: object, cwd: Path | None = None, status: int | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run a command to its end; assert that its exit status is `status`, if that is given."""
        files = self._folder / "stdout", self._folder / "stderr"
        for file in files:
            file.unlink(missing_ok=True)
        exit_status = self._run_command(arguments, cwd or Path.cwd(), *files, None)
        return require_status(
            arguments, exit_status, *(file.read_text(encoding="utf-8") for file in files), status
        )

    def kill(
        self,
        *arguments: object,
        output: Path,
        after: float | None,
        number: signal.Signals = signal.SIGKILL,
    ) -> int:
        """Run a command, send it a signal after a time, and return its exit status.

        The output and errors are appended to the file `output`. The signal is sent after `after` s,
        or never if that is None; a command that SIGKILL ends has the exit status -9.
        """
        return self._run_command(arguments, ROOT, output, output, after, number)

    def open(self, site: object) -> None:
        """Open a site and prepare its navigator for all later commands."""
        assert self._ask({"open": str(site)}) == 0

    def drive(self, mission: object, start_area: int, end_area: int) -> None:
        """Run a mission on UMAD once, so that all later commands know its paths."""
        assert self._ask({"drive": [str(mission), start_area, end_area]}) == 0

    def _run_command(
        self,
        arguments: tuple[object, ...],
        cwd: Path,
        stdout: Path,
        stderr: Path,
        after: float | None,
        number: signal.Signals = signal.SIGKILL,
    ) -> int:
        return self._ask(
            {
                "arguments": [str(a) for a in arguments],
                "cwd": str(cwd),
                "environment": {**os.environ, "COLUMNS": "120"},
                "stdout": str(stdout),
                "stderr": str(stderr),
                "after": after,
                "signal": number,
            }
        )

    def _ask(self, request: dict[str, object]) -> int:
        assert self._process.stdin
        assert self._process.stdout
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return int(self._process.stdout.readline())


@pytest.fixture(scope="session")
def argo(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ForkedArgo]:
    """Yield a function that runs `argo` with arguments in a forked process."""
    with subprocess.Popen(
        [sys.executable, "-m", "tests.e2e.forked_argo"],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=reset_signal_handlers,
    ) as process:
        argo = ForkedArgo(process, tmp_path_factory.mktemp("argo"))
        argo.open("umad")
        yield argo
        assert process.stdin
        process.stdin.close()
        assert process.wait(timeout=30) == 0


@pytest.fixture(scope="session")
def argo_process() -> Argo:
    """Return a function that runs `argo` with arguments in a new process."""

    def call(
        *arguments: object, cwd: Path | None = None, status: int | None = None
    ) -> subprocess.CompletedProcess[str]:
        process = start_argo(*arguments, cwd=cwd)
        output, errors = process.communicate(timeout=300)
        return require_status(arguments, process.returncode, output, errors, status)

    return call


@pytest.fixture(scope="module")
def navigator() -> Navigator:
    return yard()


@pytest.fixture(scope="session")
def missions() -> Path:
    """Return the folder with the scripts that the project ships."""
    return ROOT / "scenarios" / "umad" / "missions"


@pytest.fixture(scope="session")
def originals() -> Path:
    """Return the folder with the competition's own scripts, which the project does not ship."""
    if not ORIGINALS:
        pytest.skip("left out: the competition's own scripts; ARGO_ORIGINALS names their folder")
    return Path(ORIGINALS)
