"""What the end-to-end tests share: the command as a user runs it, and the scripts to run it on."""

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


def answer_signals() -> None:
    """For a new process: a suite that runs in the background may have to ignore some signals, and
    what it starts would as well."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)


def started(*arguments: object, **options: Any) -> subprocess.Popen[str]:
    """Begin a process of the command, with pipes for what it prints, and return it."""
    return subprocess.Popen(
        [sys.executable, "-m", "argo_planner", *map(str, arguments)],
        **{
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "text": True,
            "env": {**os.environ, "COLUMNS": "120"},
            "preexec_fn": answer_signals,
            **options,
        },
    )


def ended(
    arguments: tuple[object, ...], status: int, output: str, errors: str, wanted: int | None
) -> subprocess.CompletedProcess[str]:
    """Return what has become of a command, whose exit status has to be the wanted one, if any."""
    assert wanted in (None, status), f"{status}: {output}{errors}"
    return subprocess.CompletedProcess(arguments, status, output, errors)


def told_until(process: subprocess.Popen[str], words: str) -> str:
    """Return what a process prints as errors, up to the line that has these words."""
    assert process.stderr
    said = ""
    while words not in said:
        line = process.stderr.readline()
        assert line, said
        said += line
    return said


def reported(folder: Path) -> RunRecord:
    """Return the record of the run that a folder has the report of."""
    return RunRecord.model_validate_json((folder / "report.json").read_bytes())


class ForkedArgo:
    """Runs `argo` in processes that need no time to load: forked from one that has loaded it.

    Holds that process, and a folder for what the others print.
    """

    def __init__(self, process: subprocess.Popen[str], folder: Path) -> None:
        self._process, self._folder = process, folder

    def __call__(
        self, *arguments: object, cwd: Path | None = None, status: int | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Runs a command to its end, which has to have that exit status, if one is given."""
        files = self._folder / "stdout", self._folder / "stderr"
        for file in files:
            file.unlink(missing_ok=True)
        found = self._carry_out(arguments, cwd or Path.cwd(), *files, None)
        return ended(
            arguments, found, *(file.read_text(encoding="utf-8") for file in files), status
        )

    def kill(
        self,
        *arguments: object,
        output: Path,
        after: float | None,
        number: signal.Signals = signal.SIGKILL,
    ) -> int:
        """Runs a command, adds what it prints to a file and kills it after a time (s), or sends it
        another signal; its exit status, -9 if it was killed."""
        return self._carry_out(arguments, ROOT, output, output, after, number)

    def open(self, site: object) -> None:
        """Makes a site ready for all later commands."""
        assert self._ask({"open": str(site)}) == 0

    def drive(self, mission: object, start_area: int, end_area: int) -> None:
        """Make the ways of a mission on UMAD known to all later commands."""
        assert self._ask({"drive": [str(mission), start_area, end_area]}) == 0

    def _carry_out(
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
    """Runs `argo` with arguments, without the time that it takes to start."""
    with subprocess.Popen(
        [sys.executable, "-m", "tests.e2e.forked_argo"],
        cwd=ROOT,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        preexec_fn=answer_signals,
    ) as process:
        argo = ForkedArgo(process, tmp_path_factory.mktemp("argo"))
        argo.open("umad")
        yield argo
        assert process.stdin
        process.stdin.close()
        assert process.wait(timeout=30) == 0


@pytest.fixture(scope="session")
def argo_process() -> Argo:
    """Runs `argo` with arguments in a process of its own, from its start on."""

    def call(
        *arguments: object, cwd: Path | None = None, status: int | None = None
    ) -> subprocess.CompletedProcess[str]:
        process = started(*arguments, cwd=cwd)
        output, errors = process.communicate(timeout=300)
        return ended(arguments, process.returncode, output, errors, status)

    return call


@pytest.fixture(scope="module")
def navigator() -> Navigator:
    """Return the navigator of the yard."""
    return yard()


@pytest.fixture(scope="session")
def missions() -> Path:
    """The folder with the scripts that the project ships."""
    return ROOT / "scenarios" / "umad" / "missions"


@pytest.fixture(scope="session")
def originals() -> Path:
    """The folder with the competition's own scripts, which the project does not ship."""
    if not ORIGINALS:
        pytest.skip("left out: the competition's own scripts; ARGO_ORIGINALS names their folder")
    return Path(ORIGINALS)
