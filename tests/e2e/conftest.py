"""What the end-to-end tests share: the command as a user runs it, and the scripts to run it on."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ORIGINALS = os.environ.get("ARGO_ORIGINALS")

Argo = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture(scope="session")
def argo() -> Argo:
    """Runs `argo` with arguments in a process of its own."""

    def call(*arguments: object, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-m", "argo_planner", *map(str, arguments)],
            cwd=cwd,
            capture_output=True,
            text=True,
            timeout=300,
            env={**os.environ, "COLUMNS": "120"},
            check=False,
        )

    return call


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
